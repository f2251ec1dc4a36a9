//! The sections of a scene besides its bodies, and how each is read.

mod contact;
mod domain;
mod flow;
mod lubrication;
mod method;
mod output;
mod resolution;
mod time;

pub use contact::{ContactModel, ContactSection};
pub(in crate::scene) use domain::PROFILES;
pub use domain::{AxisSection, DomainSection};
pub(super) use flow::DRIVES;
pub use flow::{Drive, FlowModel, FlowSection};
pub use lubrication::{LubricationModel, LubricationSection};
pub use method::{ConstraintMethod, MethodSection, MultiplierSolver, Tolerance};
pub(in crate::scene) use output::PLANES;
pub use output::{Colour, MOST_WITH_FORCES, OutputSection};
pub(super) use resolution::SPACINGS;
pub use resolution::{Modes, ResolutionSection, Spacing};
pub use time::{Scheme, Step, TimeSection, Until};
