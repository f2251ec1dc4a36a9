//! Methods that spread by the adjoint of their interpolation: `C = J^T S`, with strengths `S` on the diagonal.
//!
//! The fluid has to fulfil rows of a body, linear in the velocities at lattice points near it; what makes it do so are forces
//! at the same points. A method says which rows: [`penalty`], [`distributed`] or [`mean_value`]. The matrices of the box stay
//! as they are, as with every method, and so does their inverse.

mod body;
mod distributed;
mod elastic;
mod equations;
mod inertia;
pub mod mean_value;
mod nodes;
mod penalty;
mod rigid;
mod strains;

pub use body::AdjointBody;
pub use distributed::Distributed;
pub use inertia::AdjointWithInertia;
pub use mean_value::MeanValue;
pub use nodes::Collector;
pub use penalty::Penalty;

/// Bytes that a multiplier at a lattice point takes: its node and rows that take it.
const LATTICE_BYTES: f64 = 120.0;
