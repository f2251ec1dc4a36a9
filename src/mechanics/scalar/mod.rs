//! The scalar inclusion problem: `-Lap u = f` outside of balls in each of which `u` is a constant to be found.
//!
//! Nothing flows net through the surface of an inclusion, and `u = 0` on the walls. The solution minimises
//!
//! ```text
//! J(v) = 1/2 integral of |grad v|^2 - integral of f v outside the inclusions
//! ```
//!
//! among the fields that are constant in each inclusion. In a fully periodic box without a source, the mean of `grad u` is given in the
//! place of walls: its flux tells how well the whole conducts. It is the model problem of rigid bodies in a fluid: constants in the
//! place of rigid motions, fluxes in the place of tractions.

mod inclusions;
mod outcome;
mod placed;
mod setup;
mod solution;
mod system;
mod thin_gap;
mod uzawa;

pub use inclusions::Inclusions;
pub use setup::ScalarSetup;
pub use solution::{InclusionState, ScalarSolution, SolvedScalar};
pub use uzawa::Uzawa;
