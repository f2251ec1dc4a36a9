//! How bodies enter the fluid: the blocks that they add to the linear system of the box.
//!
//! With the fluid unknowns `(u, p)` and the multipliers `c`,
//!
//! ```text
//! K (u, p) - C c = 0          C: spread
//! J u      + E c = velocity   J: interpolate,  E: local
//! ```
//!
//! A [`Method`] of imposing rigidity fills [`Blocks`]; who solves with them does not know which method it was. The scalar inclusion problem
//! has the same blocks, with one component and one rigid mode. [`method_of`] lists the methods.

mod adjoint;
mod blocks;
mod body;
mod conservation;
mod dense;
mod index_box;
mod interior;
mod interpolant;
mod kept_values;
mod layout;
pub mod lubrication;
mod method;
mod methods;
mod near;
mod neighbourhood;
mod placed;
mod places;
mod pores;
mod rows;
mod scalar;
mod sharp;
mod unknowns;

pub use adjoint::{AdjointBody, Collector};
pub use blocks::{Assembled, Blocks, rotations, surrounded};
pub use body::{BodyBlocks, FreeInverse};
pub use index_box::IndexBox;
pub use kept_values::Precision;
pub use layout::MultiplierLayout;
pub use method::{FlowMethod, Method, Size};
pub use methods::{method_of, method_with_inertia};
pub use near::{Given, PairPreconditioner, PairTables, RigidBlock};
pub use neighbourhood::{Neighbourhood, PAIR_REACH};
pub use placed::{Neighbour, Placed, Surrounded, neighbours};
pub use places::{Entries, EntriesMut, Places};
pub use pores::{PoreShare, Pores};
pub use scalar::{InclusionMethod, ScalarBlocks};
pub use sharp::{FreshlyCleared, freshly_cleared, jump};
pub use unknowns::Unknowns;
