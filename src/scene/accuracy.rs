//! The accuracy that a scene asks for, and the keys that it takes the place of.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::table::Table;
use crate::scene::{ConstraintMethod, FlowModel, Scene, Tolerance};

/// The accuracies that can be asked for: the tightest and the loosest.
const RANGE: [f64; 2] = [1e-5, 0.5];

/// A given tolerance of the linear solver must be this far below the accuracy.
const TOLERANCE_PER_ACCURACY: f64 = 1e-2;

/// Reads `accuracy` of the scene whose root is given.
pub(super) fn read(entry: &Entry, root: &Table, model: FlowModel) -> Result<f64> {
    let accuracy = entry.number()?;
    let [tightest, loosest] = RANGE;
    entry.expect((), (tightest..=loosest).contains(&accuracy), &format!("must be at least {tightest:e} and at most {loosest}"))?;
    entry.expect(
        (),
        model == FlowModel::Stokes,
        "is that of drag and viscosity, which only a flow (flow.model = \"stokes\") has; remove it",
    )?;
    match root.get("resolution") {
        Some(resolution) => Err(resolution.refuse("excludes accuracy, which chooses the resolution; remove one of them")),
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
        Tolerance::Fixed(tolerance) if tolerance > TOLERANCE_PER_ACCURACY * accuracy => {
            let remedy = format!("is too loose for accuracy = {accuracy}; at most {:e}, or remove it", TOLERANCE_PER_ACCURACY * accuracy);
            Err(scene.refuse("method.tolerance", tolerance, &remedy))
        }
        _ => Ok(()),
    }
}
