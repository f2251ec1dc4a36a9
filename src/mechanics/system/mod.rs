//! The linear system of fluid and bodies: assembled, solved, read back.

pub mod assembled_system;
pub mod assembly;
pub mod bodies;
pub mod coupled;
pub mod extrapolation;
pub mod film_forces;
pub mod fixed_operators;
pub mod krylov_workspace;
pub mod level;
pub mod mean_flow_constraint;
pub mod network;
pub mod network_resistance;
pub mod pair_constraint;
pub mod pair_constraints;
pub mod pair_resistance;
pub mod points;
pub mod readback;
pub mod schur_complement;
pub mod spectrum;
pub mod surfaces;
pub mod unsteady_jump;
pub mod uzawa;

pub use extrapolation::{ExtrapolationHistory, Snapshot};
pub use fixed_operators::check_steady_state;
pub use level::Level;
pub use spectrum::Conditions;
