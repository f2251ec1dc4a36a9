//! Contact without friction or rebound: velocities are projected on those that let nothing overlap.
//!
//! `min 1/2 sum_i w_i |v_i - wanted_i|^2` subject to `gap + dt n . (v_partner - v_body) >= 0` for each
//! [`Contact`] (Moreau 1988; Maury 2006, doi:10.1007/s00211-005-0666-6). The multipliers are the contact
//! forces: they push, never pull, and act only where a gap closes. Balls are convex, so that a gap that
//! the linear constraint keeps open stays open on the whole way, however long the step.
//!
//! This module knows balls, walls and weights. It does not know what the weights mean (mass, resistance),
//! nor fluid, friction or torque: balls touch along the line of their centres.

mod active;
mod augmented;
mod candidates;
mod certificate;
mod dual;
mod failure;
mod groups;
mod interior;
mod island;
mod memory;
mod paths;
mod problem;
mod program;
mod project;
mod share;
mod solver;

#[cfg(test)]
mod tests;

pub use candidates::{Contact, Partner, candidates};
pub use certificate::Certificate;
pub use memory::Memory;
pub use problem::Problem;
pub use solver::Solver;
pub use project::{ContactForce, Projection, project, project_from};
