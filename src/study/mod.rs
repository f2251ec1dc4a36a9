//! Studies: how solvers scale, how hard their systems are, how far known answers are met, and which setting meets an accuracy.

mod calibration;
mod conditioning;
mod cost;
mod fit;
mod forecast;
mod inverses;
mod launcher;
mod scaling;
mod validation;
mod viscosity;

pub use calibration::{Answer, Calibration, Estimate, Ladder, Quantity, Rung, Solved, coarsest};
pub use conditioning::{ConditioningOptions, conditioning};
pub use cost::{CostOptions, cost};
pub use forecast::Forecast;
pub use inverses::{InverseOptions, inverses};
pub use scaling::{Network, ScalingOptions, scaling};
pub use validation::{Bar, Case, KnownScene, bars, cases, crowds, known_scenes, random_scene, validation};
pub use viscosity::{ViscosityOptions, viscosity};
