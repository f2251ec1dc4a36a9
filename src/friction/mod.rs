//! Coulomb friction by the exact law, at the level of velocities and without stiffness.
//!
//! Of each contact, with the normal from the body to the partner, the force `r = (r_N, r_T)` on the partner and the velocity `u = (u_N, u_T)` of its surface
//! relative to the body's, `u_N` with the gap over the step: `r` lies in `{ |r_T| <= mu r_N }`, `u + mu |u_T| e_N` in the dual cone, and both are orthogonal
//! (De Saxce and Feng 1998). A contact is open, sticks (`u = 0`), or slips against its friction (`r_T = -mu r_N u_T / |u_T|`). A step never gains energy.
//!
//! With a critical load the excess of `r_N` counts, and couples resist rolling and twisting in the same way: each is one more pair of cones, and one more
//! block of rows, that has the normal force of its contact in its bound ([`FrictionLaw`]).
//!
//! An island is solved by sweeps and an interior point of the exact law; where neither reaches the tolerance the best forces are taken, and the residual
//! is told. In any case the least change of velocities follows with which nothing overlaps; its forces are normal ones, and add to those found.

mod bounds;
mod certificate;
mod cone;
mod flow;
mod frame;
mod islands;
mod jamming;
mod law;
mod medium;
mod misses;
mod program;
mod project;
mod row_block;
mod secant;
mod share;
mod solver;
mod surfaces;
mod tied;
mod turns;

#[cfg(test)]
mod tests;

pub use cone::ContactState;
pub use flow::held_contact::HeldContact;
pub use flow::held_rows::HeldRow;
pub use flow::in_flow::FlowContacts;
pub use flow::network::{ImmersedBodies, NearResistance, NetworkResistance};
pub use frame::carried;
pub use law::FrictionLaw;
pub use program::FrictionIsland;
pub use project::project_with_friction;
pub use share::{FrictionProjection, FrictionShare};
pub use surfaces::SurfaceFriction;
pub use tied::contacts::contacts_on_the_way;
pub use tied::islands::{RigidTwists, TiedFriction, TiedWrenches};
pub use turns::ContactWrench;
