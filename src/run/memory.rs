//! Whether a run fits into the memory of the machine.

use super::calibration::coarsest;
use crate::{
    error::{Error, Offer, Result},
    parallel::World,
    plan::demand,
    scene::{ConstraintMethod, Scene},
};

/// Refuses a scene that takes more memory than all machines of this run have free; collective.
///
/// # Errors
/// [`Error::Refused`], also for what cannot be placed.
pub fn check_memory(world: &World, scene: &Scene) -> Result<()> {
    let free = world.available_memory_bytes();
    let bytes = world.agree(bytes(scene, world.size()))?;
    if bytes <= free { Ok(()) } else { Err(refusal(scene, bytes, free)) }
}

/// Refuses to plan what already takes too long to plan: a mesh that is made for the plan, cells beyond all memory; collective.
///
/// # Errors
/// As [`check_memory`].
pub fn check_memory_of_plan(world: &World, scene: &Scene) -> Result<()> {
    let bytes = world.agree(bytes(scene, world.size()))?;
    if bytes.is_infinite() || scene.method.constraint == ConstraintMethod::Fitted { check_memory(world, scene) } else { Ok(()) }
}

/// About as many bytes as a scene takes on all of so many ranks together.
fn bytes(scene: &Scene, ranks: usize) -> Result<f64> {
    let resolved = if scene.accuracy.is_some() { coarsest(scene) } else { scene.clone() };
    if scene.dimension() == 2 { demand::<2>(&resolved, ranks) } else { demand::<3>(&resolved, ranks) }
}

fn refusal(scene: &Scene, bytes: f64, free: f64) -> Error {
    let taken = if bytes.is_finite() { format!("about {:.1} GB", bytes / 1e9) } else { "more memory than can be told".into() };
    let remedy = format!("takes {taken}, and {:.1} GB are free; coarsen it or shrink domain.size, take more machines", free / 1e9);
    let refused = match (&scene.resolution, scene.accuracy) {
        (Some(resolution), _) => {
            let (key, value) = resolution.spacing.key();
            scene.refuse(key, value, &remedy)
        }
        (None, Some(accuracy)) => scene.refuse("accuracy", accuracy, &remedy),
        (None, None) => scene.refuse("domain.size", format!("{:?}", scene.domain.size), &remedy),
    };
    match refused {
        Error::Refused(refusal) => refusal.offering(Offer::Insist),
        other => other,
    }
}
