//! `turbid run` and `turbid resume`: an instantaneous solve, or a simulation in time.

mod account;
mod calibration;
mod folder;
mod instant;
mod march;
mod origin;
mod outputs;
mod pairs;
mod scalar;
mod signals;

use std::path::Path;

use crate::{
    error::Result,
    output::{Checkpoint, say, stage_table},
    parallel::World,
    petsc::{Profile, Session},
    scene::Scene,
    study::{Calibration, RefinementSequence},
};
pub use folder::RunFolder;

/// Runs a scene of dimension `D` from its start.
pub fn run<const D: usize>(session: &Session, scene: &Scene, folder: &mut RunFolder) -> Result<()> {
    match scene.time {
        None if scene.scalar() => scalar::run::<D>(session, scene, folder),
        _ if scene.accuracy.is_some() => run_to_accuracy::<D>(session, scene, folder),
        None => instant::run::<D>(session, (scene, scene), folder, None),
        Some(_) => march::run::<D>(session, (scene, scene), folder, (None, None)),
    }
}

/// Runs a scene that asks for an accuracy with the setting that meets it. Found now at an instant, the last solution is the result.
fn run_to_accuracy<const D: usize>(session: &Session, scene: &Scene, folder: &mut RunFolder) -> Result<()> {
    let world = session.world();
    if let Some(calibrated) = calibration::cached(world, folder.path(), scene) {
        let resolved = calibrated.calibration.resolved(scene);
        return match scene.time {
            None => instant::run::<D>(session, (scene, &resolved), folder, Some(&calibrated)),
            Some(_) => march::run::<D>(session, (scene, &resolved), folder, (None, Some(&calibrated))),
        };
    }
    let sequence = RefinementSequence::<D>::begin(session, scene)?;
    folder.claim(scene)?;
    let (calibration, solved) = sequence.refine_until_met()?;
    let calibrated = calibration::keep(world, folder.path(), scene, calibration)?;
    if scene.time.is_none() {
        return instant::write(session, scene, folder, ((&solved.0, &solved.1), Some(&calibrated)));
    }
    drop(solved);
    march::run::<D>(session, (scene, &calibrated.calibration.resolved(scene)), folder, (None, Some(&calibrated)))
}

/// The calibration that a folder has for a scene, if it has one; collective.
pub fn cached(world: &World, folder: &Path, scene: &Scene) -> Option<Calibration> {
    calibration::cached(world, folder, scene).map(|calibrated| calibrated.calibration)
}

/// Goes on with a run.
pub fn resume<const D: usize>(session: &Session, scene: &Scene, folder: &mut RunFolder, checkpoint: &Checkpoint) -> Result<()> {
    if scene.accuracy.is_none() {
        return march::run::<D>(session, (scene, scene), folder, (Some(checkpoint), None));
    }
    let calibrated = match calibration::cached(session.world(), folder.path(), scene) {
        Some(calibrated) => calibrated,
        None => {
            calibration::keep(session.world(), folder.path(), scene, RefinementSequence::<D>::begin(session, scene)?.refine_until_met()?.0)?
        }
    };
    march::run::<D>(session, (scene, &calibrated.calibration.resolved(scene)), folder, (Some(checkpoint), Some(&calibrated)))
}

/// Does a run, and prints what its stages took if a profile is wanted; collective.
pub fn profiled(session: &Session, wanted: bool, run: impl FnOnce() -> Result<()>) -> Result<()> {
    if !wanted {
        return run();
    }
    let profile = Profile::start()?;
    run()?;
    let table = stage_table(session.world(), &profile.finish()?);
    if session.world().rank() == 0 { say(&table) } else { Ok(()) }
}
