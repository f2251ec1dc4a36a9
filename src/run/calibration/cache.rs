//! `calibration.json`: the setting that meets the accuracy of a scene, found once for an output folder.

use std::{fs, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    answers::{CalibrationAnswer, EstimatedQuantity},
    setting::Calibration,
};
use crate::{
    error::Result,
    mechanics::FlowSolver,
    output::{AccuracySummary, EstimatedErrors, Summary, write_whole},
    parallel::World,
    scene::{FlowModel, Scene},
    system::Solution,
};

/// Name of the file.
pub const FILE: &str = "calibration.json";

/// A calibration and whether this run made it.
pub struct Calibrated {
    /// The setting.
    pub calibration: Calibration,
    /// Whether an earlier run had found it.
    pub cached: bool,
}

/// The file: a calibration and what it belongs to.
#[derive(Serialize, Deserialize)]
struct Cache {
    version: String,
    scene: String,
    calibration: Calibration,
}

/// The calibration that a folder has for a scene, the same on all ranks; nothing if there is none, or one of another scene or version, or of whole runs to another end
/// where a run does not go on.
pub fn cached(world: &World, folder: &Path, scene: &Scene, goes_on: bool) -> Option<Calibration> {
    let text = if world.rank() == 0 { fs::read_to_string(folder.join(FILE)).unwrap_or_default() } else { String::new() };
    let cache: Cache = serde_json::from_str(&world.broadcast(0, &text)).ok()?;
    let there = Scene::parse(&scene.name, folder, &cache.scene, &[]).ok()?;
    let to_end = goes_on || scene.flow.model != FlowModel::NavierStokes || scene.end() == there.end();
    let fits = cache.version == env!("CARGO_PKG_VERSION") && to_end && scene.difference(&there).is_none();
    fits.then_some(cache.calibration)
}

impl Calibrated {
    /// Keeps the calibration for later runs of the same scene; collective.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn keep(&self, world: &World, folder: &Path, scene: &Scene) -> Result<()> {
        let write = || {
            let (version, calibration) = (env!("CARGO_PKG_VERSION").into(), self.calibration.clone());
            let cache = Cache { version, scene: scene.copied_text()?, calibration };
            let text = serde_json::to_string_pretty(&cache).expect("a calibration is plain numbers and text");
            write_whole(&folder.join(FILE), text.as_bytes())
        };
        world.on_first_rank(write)
    }

    /// Attaches the bars to the summary of a state; collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn attach<const D: usize>(&self, summary: &mut Summary, suspension: &dyn FlowSolver<D>, solution: &Solution<D>) -> Result<()> {
        let calibration = &self.calibration;
        let drag = CalibrationAnswer::all(suspension, solution)?.into_iter().find(|answer| answer.quantity == EstimatedQuantity::Drag);
        let given = suspension.setup().bodies.iter().filter(|suspended| !suspended.body.free()).count();
        let accuracy = AccuracySummary {
            asked: calibration.accuracy,
            cells_per_radius: calibration.cells_per_radius,
            calibrated_on: calibration.levels.iter().map(|level| level.cells_per_radius).collect(),
            calibration_seconds: (!self.cached).then(|| calibration.seconds()),
            estimated: EstimatedErrors {
                drag: calibration.error(EstimatedQuantity::Drag),
                velocity: calibration.error(EstimatedQuantity::Velocity),
                viscosity: calibration.error(EstimatedQuantity::Viscosity),
                mean_velocity: calibration.error(EstimatedQuantity::MeanVelocity),
            },
            drag: None,
        };
        // errors are those of forces and torques together
        summary.attach(accuracy, drag.map(|drag| drag.norm() / (given as f64).sqrt()));
        Ok(())
    }
}
