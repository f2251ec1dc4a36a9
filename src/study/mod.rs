//! Studies: how solvers scale, how hard their systems are, how far known answers are met, and which setting meets an accuracy.

mod command;
mod conditioning;
mod cost;
mod experiment;
mod fit;
mod inverses;
mod registry;
mod scaling;
mod sweep;
mod validation;
mod viscosity;

pub use command::{PetscOptions, SceneArguments, Study, StudyCommand, positive};
pub use conditioning::Conditioning;
pub use cost::Cost;
pub use inverses::Inverses;
pub use registry::{SelectedStudy, studies};
pub use scaling::Scaling;
pub use sweep::ParameterSweep;
pub use validation::{Bar, Case, KnownScene, Validation, cases, known_scenes, random_scene};
pub use viscosity::ViscosityStudy;
