//! The sections of a scene besides its bodies, and how each is read.

mod contact;
mod domain;
mod flow;
mod interactions;
mod lubrication;
mod method;
mod output;
mod protocol;
mod resolution;
mod time;

pub use contact::{ContactModel, ContactSection};
pub(in crate::scene) use contact::{FRICTION_KEYS, KEYS as CONTACT_KEYS, friction};
pub(in crate::scene) use domain::{AXIS_KEYS, KEYS as DOMAIN_KEYS, PROFILES};
pub use domain::{AxisSection, DomainSection, NormalLoad};
pub(super) use flow::{DRIVE_KEYS, DRIVES, KEYS as FLOW_KEYS};
pub use flow::{Drive, FlowModel, FlowSection};
pub(super) use interactions::KEYS as INTERACTION_KEYS;
pub use interactions::{ForceTexts, InteractionSection};
pub(super) use lubrication::KEYS as LUBRICATION_KEYS;
pub use lubrication::{LubricationModel, LubricationSection};
pub(super) use method::KEYS as METHOD_KEYS;
pub use method::{ConstraintMethod, MethodSection, MultiplierSolver, Tolerance};
pub(super) use output::KEYS as OUTPUT_KEYS;
pub(in crate::scene) use output::PLANES;
pub use output::{Colour, MOST_WITH_FORCES, OutputSection};
pub(super) use protocol::{FACTOR_OSCILLATION_KEYS, FACTOR_STEP_KEYS, OSCILLATION_KEYS, STEP_KEYS, STRESS_STEP_KEYS};
pub(super) use resolution::{KEYS as RESOLUTION_KEYS, SPACING_KEYS, SPACINGS};
pub use resolution::{Modes, ResolutionSection, Spacing};
pub(super) use time::{KEYS as TIME_KEYS, UNTIL_KEYS};
pub use time::{Scheme, Step, TimeSection, Until};
