//! Contact. Inelastic and without friction: velocities are projected on those that let nothing overlap,
//!
//! `min 1/2 sum_i w_i |v_i - wanted_i|^2` subject to `gap + dt n . (v_partner - v_body) >= 0` for each
//! [`Contact`] (Moreau 1988; Maury 2006, doi:10.1007/s00211-005-0666-6). The multipliers are the contact
//! forces: they push, never pull, and act only where a gap closes. Balls are convex, so that a gap that
//! the linear constraint keeps open stays open on the whole way, however long the step. Some contacts may pull, down to a
//! lower bound of their own. Which laws there are is said in [`interaction`](crate::interaction).
//!
//! Bodies that meet go on together: nothing rebounds, which makes motions unique. With a rebound they need not be (Bressan 1960,
//! Schatzman 1978, Ballard 2000): take a point above a floor, `q >= 0`, `q(0) = q'(0) = 0`, pressed down by a force that on
//! `(t_(n+1), t_n)`, `t_n = 1/(n+1)`, is zero on the first half and `-8 v_(n+1) / (t_n - t_(n+1))` on the second, `v_n = 3^-n`. It may
//! lie still; and if it keeps its speed at each impact it may as well leave the floor at each `t_(n+1)` with `v_(n+1)` and land at
//! `t_n` with `3 v_(n+1) = v_n`. Pieces of other lengths do the same to any rebound. Without one the point lies still, and so it does here.
//!
//! An island is a quadratic program, solved by one of two methods ([`Solver`]) that are held to the same tolerance. The fast one solves the parts of
//! an island that press, each of which a cheap method has started, by dense equations or an interior point. If it
//! stalls the sure one follows, and if that fails too the step is an [error](crate::error::Error::Contact) that carries the [`Island`].
//!
//! Coulomb friction is in [`friction`](crate::friction). All here knows balls, walls and weights, and not what the weights mean (mass, resistance),
//! nor fluid, friction or torque: balls touch along the line of their centres.

mod adhesive;
mod candidates;
mod distribute;
mod failure;
mod force;
mod friction_report;
mod given;
mod identity;
mod identity_hash;
pub(crate) mod island;
pub(crate) mod kkt_report;
pub(crate) mod loaded_wall;
mod memory;
pub(crate) mod paths;
mod problem;
mod project;
mod projection;
mod replay;
mod share;
pub(crate) mod solver;
mod spanning;
mod tied;
mod tied_program;
pub(crate) mod union_find;
pub(crate) mod view;

#[cfg(test)]
mod tests;

pub use adhesive::AdhesiveContact;
pub use candidates::{Contact, candidates};
pub use force::{ContactForce, pushes};
pub use friction_report::{FRICTION_TOLERANCE, FrictionReport};
pub use given::{GivenPaths, Meeting};
pub use identity::{Identity, Partner, bodies_of, pack, packed_length, renamed, unpack};
pub use kkt_report::KktReport;
pub use loaded_wall::LoadedWall;
pub use memory::Memory;
pub use problem::Problem;
pub use project::{project, project_share};
pub use projection::{Projection, ProjectionShare};
pub use replay::Island;
pub use solver::Solver;
pub use spanning::Spanning;
pub use tied::{RIGID, RigidBalls, TiedProblem};
pub use view::{ProblemShare, View};
