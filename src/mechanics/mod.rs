//! How the flow and the bodies in it answer at an instant: the coupled linear system, Stokes and Navier-Stokes flow, fitted meshes, the scalar model problem.

mod configuration;
mod cost;
mod evolution;
pub(crate) mod fitted;
mod flow_solver;
mod history;
mod mesh_level;
pub(crate) mod placement;
mod resistance;
pub(crate) mod room;
mod scalar;
mod setup;
mod shear_stress;
mod solution;
pub(crate) mod state;
mod suspension;
pub(crate) mod system;
pub(crate) mod unsteady;
mod work;

pub use configuration::Configuration;
pub use cost::{Cost, ResidualMonitor};
pub use evolution::{Evolution, EvolutionOnGrid};
pub use fitted::{FittedFlow, FittedInclusions};
pub use flow_solver::FlowSolver;
pub use history::{History, HistoryShape, HistoryView};
pub use mesh_level::MeshLevel;
pub use resistance::Resistance;
pub use scalar::{InclusionState, Inclusions, ScalarSetup, ScalarSolution, SolvedScalar, Uzawa};
pub use setup::{Inertia, Setup, SuspendedBody};
pub use shear_stress::{load_stress, shear_stress};
pub use solution::{BodyState, Lubrication, Solution, WallForces};
pub use state::{ContactHistory, FoundShear, GivenPlace, Moving, Share, State, WallMotion};
pub use suspension::Suspension;
pub use system::{Conditions, ExtrapolationHistory, Level, Snapshot, check_steady_state};
pub use unsteady::UnsteadySuspension;
pub use work::Stages;
