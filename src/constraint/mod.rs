//! How bodies enter the fluid: the blocks that they add to the linear system of the box.
//!
//! With the fluid unknowns `(u, p)` and the multipliers `c`,
//!
//! ```text
//! K (u, p) - C c = 0          C: spread
//! J u      + E c = velocity   J: sample,  E: local
//! ```
//!
//! A method of imposing rigidity fills [`Blocks`]; who solves with them does not know which method it was.

mod adjoint;
mod blocks;
mod conservation;
mod crowd;
mod dense;
pub mod fitted;
mod interpolant;
mod layout;
pub mod lubrication;
mod near;
mod patch;
mod places;
mod pores;
mod rows;
mod scalar;
mod sharp;

pub use adjoint::{AdjointBlocks, AdjointBody, FreeInverse, assemble as assemble_adjoint, count as count_adjoint};
pub use blocks::Blocks;
pub use crowd::Crowd;
pub use layout::Layout;
pub use near::{Given, NearPairs, PairTables, RigidBlock};
pub use patch::Patch;
pub use pores::{Pores, Share as PoreShare};
pub use scalar::{InclusionMethod, PlacedInclusion, ScalarBlocks};
pub use sharp::{BodyBlocks, INTERPOLATION_REACH, Neighbour, Passed, Placed, SharpBlocks, Situation, Workspace, assemble, jump, passed};

/// The ways to make bodies rigid on a grid that ignores them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Surface multipliers, stencils corrected for the jumps.
    Sharp,
    /// Surface multipliers, linear interpolation.
    MeanValue,
    /// Rigid at every lattice point inside.
    Distributed,
    /// Fluid inside that is `1/epsilon` times as viscous.
    Penalty {
        /// Viscosity of the fluid over that inside.
        epsilon: f64,
    },
}

impl Method {
    /// Whether multipliers are coefficients of the surface modes, as many whatever the body's place.
    pub fn on_surfaces(self) -> bool {
        matches!(self, Method::Sharp | Method::MeanValue)
    }
}
