//! The machinery of a run: it solves what a [`Setup`] or a [`DrySetup`] describes, at an instant or in time.

mod assembly;
mod basis;
mod bodies;
mod closure;
mod condensed;
mod coupled;
mod drift;
mod dry;
mod dynamics;
mod faster;
mod fitted;
mod flow_solver;
mod memory;
mod pace;
mod placement;
mod plan;
mod scalar;
mod setup;
#[expect(clippy::module_inception, reason = "the time loop is what the module is named after")]
mod simulation;
mod solution;
mod spectrum;
mod state;
mod surfaces;
mod suspension;
mod touching;
mod uzawa;
mod work;

use basis::check_steady_state;
pub use drift::Drift;
pub use dry::{Dry, DryBody, DrySetup};
pub use dynamics::{Dynamics, Effort, Seen, Travel, View};
pub use faster::Faster;
pub use fitted::{FittedFlow, FittedInclusions};
pub use flow_solver::{FlowSolver, flow_solver};
pub use memory::{Past, Snapshot};
pub use pace::{Pace, Stride, Urge};
pub use plan::Plan;
pub use scalar::{InclusionState, Inclusions, ScalarSetup, ScalarSolution, Uzawa};
pub use setup::{Setup, SuspendedBody};
pub use simulation::{Simulation, StepReport};
pub use solution::{BodyState, Solution};
pub use spectrum::Conditions;
pub use state::{Held, Moving, State};
pub use suspension::{Cost, Moment, Suspension};
pub use work::Stages;
