//! The setting that meets an accuracy: a scene is solved at its start on finer and finer grids until the differences between them say
//! that it is met; the last of these solutions is the result.
//!
//! The modes are as many as each grid carries: their error falls geometrically, and they cost little beside the grid. The first grids are so
//! coarse that most of the work is in the last one. With inertia it is whole runs that are compared, and the last one is repeated with all outputs.

mod answers;
mod cache;
mod estimate;
mod sequence;
mod setting;
mod steadiness;
mod whole_run;

pub use answers::{CalibrationAnswer, EstimatedQuantity};
pub use cache::{Calibrated, FILE, cached};
pub use estimate::Estimate;
pub use sequence::{RefinementSequence, Solved, refine_whole_runs};
pub use setting::{Calibration, RefinementLevel, coarsest};
pub use steadiness::{STEADY, still_to_come, unresolved};
