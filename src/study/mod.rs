//! Studies: what accuracy costs, how results depend on keys of a scene, how solvers scale, and how hard their systems are.

mod command;
mod conditioning;
mod cost;
mod fit;
mod inverses;
mod scaling;
mod sweep;
mod viscosity;

pub use command::{PetscOptions, SceneArguments, Study, StudyCommand, positive};
pub use conditioning::Conditioning;
pub use cost::CostStudy;
pub use inverses::Inverses;
pub use scaling::Scaling;
pub use sweep::ParameterSweep;
pub use viscosity::{SuspensionSetting, ViscosityStudy};
