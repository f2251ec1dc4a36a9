//! Contact without friction. Inelastic: velocities are projected on those that let nothing overlap,
//!
//! `min 1/2 sum_i w_i |v_i - wanted_i|^2` subject to `gap + dt n . (v_partner - v_body) >= 0` for each
//! [`Contact`] (Moreau 1988; Maury 2006, doi:10.1007/s00211-005-0666-6). The multipliers are the contact
//! forces: they push, never pull, and act only where a gap closes. Balls are convex, so that a gap that
//! the linear constraint keeps open stays open on the whole way, however long the step. [`gluey`] contacts may pull,
//! within what they remember; [`Repulsion`] is a force that keeps bodies apart without any projection.
//!
//! This module knows balls, walls and weights. It does not know what the weights mean (mass, resistance),
//! nor fluid, friction or torque: balls touch along the line of their centres.

mod active;
mod candidates;
mod certificate;
mod failure;
pub mod gluey;
mod groups;
mod interior;
mod island;
mod law;
mod paths;
mod problem;
mod program;
mod project;
mod pulling;
mod repulsion;
mod share;

#[cfg(test)]
mod tests;

pub use candidates::{Contact, Identity, Partner, candidates};
pub use certificate::Certificate;
pub use law::Law;
pub use problem::{Problem, pushes};
pub use project::{ContactForce, Projection, project};
pub use repulsion::Repulsion;
