//! The accuracy that a scene asks for, and the keys that it takes the place of.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::sections::RESOLUTION_KEYS;
use crate::scene::table::Table;
use crate::scene::{BodyGroup, ConstraintMethod, ContactModel, Drive, FlowModel, Motion, Scene, Step, Tolerance};

/// The accuracies that can be asked for: the tightest and the loosest.
const RANGE: [f64; 2] = [1e-5, 0.5];

/// How far below the accuracy a given tolerance of the linear solver must be.
const ACCURACY_PER_TOLERANCE: f64 = 100.0;

/// Reads `accuracy` of the scene whose root is given.
pub(super) fn read(entry: &Entry, root: &Table, model: FlowModel) -> Result<f64> {
    let accuracy = entry.number()?;
    let [tightest, loosest] = RANGE;
    entry.expect((), (tightest..=loosest).contains(&accuracy), &format!("must be at least {tightest:e} and at most {loosest}"))?;
    entry.expect(
        (),
        matches!(model, FlowModel::Stokes | FlowModel::NavierStokes),
        "is that of drag and viscosity, which only a flow (flow.model = \"stokes\") has; remove it",
    )?;
    let resolution = root.section("resolution", &RESOLUTION_KEYS)?;
    match RESOLUTION_KEYS.iter().find_map(|key| resolution.get(key.name)) {
        Some(chosen) => Err(chosen.refuse("excludes accuracy, which chooses it; remove one of them")),
        None => Ok(accuracy),
    }
}

/// Refuses a scene whose method or bodies leave no accuracy to calibrate.
pub(super) fn check(scene: &Scene) -> Result<()> {
    let Some(accuracy) = scene.accuracy else { return Ok(()) };
    if scene.bodies.is_empty() {
        let remedy = "is that of drag and viscosity, and there are no bodies; give resolution.spacing instead";
        return Err(scene.refuse("accuracy", accuracy, remedy));
    }
    if scene.method.constraint != ConstraintMethod::Sharp {
        let word = scene.method.constraint.word();
        let remedy = format!("is met by method.constraint = \"sharp\" only, not by {word:?}; give [resolution] instead");
        return Err(scene.refuse("accuracy", accuracy, &remedy));
    }
    if scene.flow.model == FlowModel::NavierStokes {
        check_inertia(scene, accuracy)?;
    }
    match scene.method.tolerance {
        Tolerance::Fixed(tolerance) if tolerance > accuracy / ACCURACY_PER_TOLERANCE => {
            let remedy = format!("is too loose for accuracy = {accuracy}; at most {:e}, or remove it", accuracy / ACCURACY_PER_TOLERANCE);
            Err(scene.refuse("method.tolerance", tolerance, &remedy))
        }
        _ => Ok(()),
    }
}

/// Refuses runs with inertia whose ends do not answer on finer and finer grids to what the start asks: met is that of forces on bodies which stay where they are in flows that
/// become steady, and of how fast free bodies come to be that settle apart.
fn check_inertia(scene: &Scene, accuracy: f64) -> Result<()> {
    let refuse = |remedy: &str| Err(scene.refuse("accuracy", accuracy, remedy));
    let Some(time) = &scene.time else { return Ok(()) };
    if time.until.is_some() {
        return refuse("is met at time.end with inertia, and time.until ends runs before; remove one of them");
    }
    if time.step != Step::Auto {
        return refuse("is met with inertia by automatic steps, which follow the grid; remove time.step");
    }
    if matches!(scene.flow.drive, Some(Drive::ShearRate(_) | Drive::ShearedBox(_))) {
        return refuse("is not met with inertia in a sheared box, whose answers are means over time; give [resolution] instead");
    }
    if let Some(group) = scene.bodies.iter().find(|group| group.motion != Motion::Free && !group.stays()) {
        let remedy = format!(
            "is not met with inertia by bodies that move with prescribed motion (motion of radius {}); give [resolution] instead",
            group.radius
        );
        return refuse(&remedy);
    }
    let free = scene.bodies.iter().filter(|group| group.motion == Motion::Free).map(BodyGroup::at_least).sum::<usize>();
    if free > 1 && scene.contact.model != ContactModel::None {
        return refuse(
            "is not met with inertia by free bodies that touch, whose trajectories differ between grids by more than any error; give [resolution] instead",
        );
    }
    Ok(())
}
