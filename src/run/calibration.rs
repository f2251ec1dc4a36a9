//! The setting that meets an accuracy: a scene is solved at its start on finer and finer grids until the differences between them say
//! that it is met; the last of these solutions is the result.
//!
//! The modes are as many as each grid carries: their error falls geometrically, and they cost little beside the grid. The first grids are so
//! coarse that most of the work is in the last one.

mod answers;
mod cache;
mod estimate;
mod sequence;
mod setting;

pub use answers::{CalibrationAnswer, EstimatedQuantity};
pub use cache::{Calibrated, FILE, cached};
pub use estimate::Estimate;
pub use sequence::{RefinementSequence, Solved};
pub use setting::{Calibration, RefinementLevel, coarsest};
