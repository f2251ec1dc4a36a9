//! The setting that a calibration finds.

use serde::{Deserialize, Serialize};

use super::{answers::EstimatedQuantity, estimate::Estimate};
use crate::scene::{Modes, ResolutionSection, Scene, Spacing, Tolerance};

/// Cells per radius of the first grid.
pub const COARSEST: f64 = 3.0;

/// The tolerance of the linear solver over the accuracy, at most.
const TOLERANCE_PER_ACCURACY: f64 = 1e-2;

/// A setting that meets an accuracy, and how it was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// The accuracy asked for.
    pub accuracy: f64,
    /// The cells per radius of the smallest body that meet it.
    pub cells_per_radius: f64,
    /// The estimated errors of that setting.
    pub estimates: Vec<Estimate>,
    /// All grids that were solved on, from coarse to fine; the last one is the setting.
    #[serde(rename = "rungs")]
    pub levels: Vec<RefinementLevel>,
    /// Ranks that it took.
    pub ranks: usize,
}

/// One grid of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RefinementLevel {
    /// Cells per radius of the smallest body.
    pub cells_per_radius: f64,
    /// Highest order of the modes of any body.
    pub order: usize,
    /// Unknowns of the grid.
    pub grid_unknowns: usize,
    /// Multipliers of bodies.
    pub multiplier_unknowns: usize,
    /// Iterations of the linear solver.
    pub iterations: usize,
    /// Wall-clock seconds: set-up, jump corrections and solve.
    pub seconds: f64,
}

impl Calibration {
    /// The scene with the resolution that was found.
    pub fn resolved(&self, scene: &Scene) -> Scene {
        resolved(scene, self.cells_per_radius)
    }

    /// The estimated relative error of a quantity, if the scene answers it.
    pub fn error(&self, quantity: EstimatedQuantity) -> Option<f64> {
        self.estimates.iter().find(|estimate| estimate.quantity == quantity).map(|estimate| estimate.error)
    }

    /// Wall-clock seconds of all grids but the last, which is the result.
    pub fn seconds(&self) -> f64 {
        self.levels.iter().rev().skip(1).map(|level| level.seconds).sum()
    }
}

/// The scene with so many cells per radius, the modes and the tolerance that go with them.
pub fn resolved(scene: &Scene, cells: f64) -> Scene {
    let tolerance = match (scene.method.tolerance, scene.accuracy) {
        (Tolerance::Auto, Some(accuracy)) => Tolerance::AtMost(TOLERANCE_PER_ACCURACY * accuracy),
        (given, _) => given,
    };
    scene.resolved(ResolutionSection { spacing: Spacing::CellsPerRadius(cells), modes: Modes::Most }, tolerance)
}

/// The scene on the coarsest grid of its calibration.
pub fn coarsest(scene: &Scene) -> Scene {
    resolved(scene, COARSEST)
}
