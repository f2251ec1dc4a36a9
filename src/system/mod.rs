//! The linear system of fluid and bodies: assembled, solved, read back.

pub(crate) mod assembled_system;
pub(crate) mod assembly;
pub(crate) mod bodies;
pub(crate) mod cost;
pub(crate) mod coupled;
pub(crate) mod extrapolation;
pub(crate) mod film_forces;
pub(crate) mod fixed_operators;
pub(crate) mod krylov_workspace;
pub(crate) mod level;
pub(crate) mod mean_flow_constraint;
pub(crate) mod network_resistance;
pub(crate) mod pair_constraints;
pub(crate) mod pair_resistance;
pub(crate) mod points;
pub(crate) mod readback;
pub(crate) mod schur_complement;
pub(crate) mod solution;
pub(crate) mod spectrum;
pub(crate) mod surfaces;
pub(crate) mod unsteady_jump;
pub(crate) mod uzawa;
pub(crate) mod work;

pub use cost::{Cost, ResidualMonitor};
pub use extrapolation::{ExtrapolationHistory, Snapshot};
pub use fixed_operators::check_steady_state;
pub use level::Level;
pub use solution::{BodyState, Lubrication, LubricationPressure, Solution, WallForces};
pub use spectrum::Conditions;
pub use work::Stages;
