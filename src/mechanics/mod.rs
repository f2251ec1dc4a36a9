//! How the flow and the bodies in it answer at an instant: Stokes and Navier-Stokes flow, fitted meshes, the scalar model problem.

mod evolution;
pub(crate) mod fitted;
mod flow_solver;
mod history;
mod mesh_level;
mod near_bodies;
mod resistance;
mod scalar;
mod shear_stress;
mod suspension;
pub(crate) mod unsteady;

pub use evolution::{Evolution, EvolutionOnGrid};
pub use fitted::{FittedFlow, FittedInclusions};
pub use flow_solver::FlowSolver;
pub use history::{History, HistoryShape, HistoryView};
pub use mesh_level::MeshLevel;
pub use resistance::Resistance;
pub use scalar::{InclusionState, Inclusions, ScalarSetup, ScalarSolution, SolvedScalar, Uzawa};
pub use shear_stress::{load_stress, shear_stress};
pub use suspension::Suspension;
pub use unsteady::{UnsteadySuspension, is_moved_at_once, starts_at_once};
