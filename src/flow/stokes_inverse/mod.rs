//! Inverses, approximate or exact, of the Stokes operator.

mod cross_section;
mod inverse;
mod iterated;
mod method;
mod multigrid;
mod projection;
mod slender;
mod system;
mod transform;

pub use inverse::StokesInverse;
pub use iterated::IteratedInverse;
pub use method::InverseMethod;
pub use system::FluidSystem;
pub use transform::{TransformInverse, Transposes};

use super::Stokes;
