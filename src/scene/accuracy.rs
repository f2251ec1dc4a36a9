//! The accuracy that a scene asks for, and the keys that it takes the place of.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::sections::RESOLUTION_KEYS;
use crate::scene::table::Table;
use crate::scene::{ConstraintMethod, FlowModel, Scene, Tolerance};

/// The accuracies that can be asked for: the tightest and the loosest.
const RANGE: [f64; 2] = [1e-5, 0.5];

/// How far below the accuracy a given tolerance of the linear solver must be.
const ACCURACY_PER_TOLERANCE: f64 = 100.0;

/// Reads `accuracy` of the scene whose root is given.
pub(super) fn read(entry: &Entry, root: &Table, model: FlowModel) -> Result<f64> {
    let accuracy = entry.number()?;
    let [tightest, loosest] = RANGE;
    entry.expect((), (tightest..=loosest).contains(&accuracy), &format!("must be at least {tightest:e} and at most {loosest}"))?;
    let remedy = "is met in Stokes flow only; give [resolution] instead, and turbid cost tells the error of each";
    entry.expect((), model != FlowModel::NavierStokes, remedy)?;
    entry.expect(
        (),
        model == FlowModel::Stokes,
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
    match scene.method.tolerance {
        Tolerance::Fixed(tolerance) if tolerance > accuracy / ACCURACY_PER_TOLERANCE => {
            let remedy = format!("is too loose for accuracy = {accuracy}; at most {:e}, or remove it", accuracy / ACCURACY_PER_TOLERANCE);
            Err(scene.refuse("method.tolerance", tolerance, &remedy))
        }
        _ => Ok(()),
    }
}
