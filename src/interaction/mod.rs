//! Interactions: what bodies do to each other and to walls besides the flow that is resolved.
//!
//! Each is one file that implements [`Interaction`]. A step asks every one of a list in turn for what it contributes, and knows none of them by name:
//! forces that follow from where bodies are, a law of contact, ties between bodies, rows of the coupled system that resist relative motions, and how
//! steep its forces are, which limits explicit steps. What an interaction does not have it leaves at the default, and then nothing is built for it.

mod arrangement;
mod body_force_law;
mod bonds;
mod cluster;
mod conserved;
mod contact_law;
mod expression;
mod friction;
mod gluey;
mod hinge;
mod inelastic;
mod joints;
mod list;
mod lubrication;
mod pair_force_law;
mod pair_resistance;
mod repulsion;
mod spring;
mod ties;
mod welds;

use std::fmt::Debug;

pub use arrangement::{Arrangement, Forces, PairForce, Wrench, stress_of_pair};
pub use body_force_law::{BodyForceLaw, ForceRange};
pub use bonds::{Bend, Bonds, Stretch};
pub use cluster::Cluster;
pub use conserved::{Conserved, Measure, enclosed};
pub use contact_law::{ContactLaw, ContactMemory, Friction, Touch, UnequalFriction};
pub use expression::{Dual, Expression};
pub use gluey::Gluey;
pub use hinge::Hinge;
pub use inelastic::Inelastic;
pub use joints::{JointedChain, Joints};
pub use list::Interactions;
pub use lubrication::Lubrication;
pub use pair_force_law::PairForceLaw;
pub use pair_resistance::PairResistance;
pub use repulsion::Repulsion;
pub use spring::Spring;
pub use ties::{Groups, Ties};
pub use welds::Welds;

/// What bodies do to each other and to walls. All numbers are in the units of the scene.
pub trait Interaction<const D: usize>: Debug {
    /// Its name among the effects of a plan.
    fn name(&self) -> &str;

    /// What is built for it, for the plan.
    fn describe(&self) -> String;

    /// The largest gap at which bodies up to this radius act on each other by forces that follow from where they are.
    fn reach(&self, _largest_radius: f64) -> f64 {
        0.0
    }

    /// The steepest slope of its forces, force over distance, between bodies of which the smallest has this radius: explicit steps are limited by it.
    fn steepest(&self, _radius: f64) -> f64 {
        0.0
    }

    /// Forces and torques that follow from where bodies are.
    fn forces(&self, _arrangement: &Arrangement<D>) -> Forces<D> {
        Forces::default()
    }

    /// What it says of contacts.
    fn contact(&self) -> ContactLaw<'_, D> {
        ContactLaw::default()
    }

    /// How it ties bodies that it names; an interaction that does goes with these bodies alone.
    fn ties(&self) -> Option<&dyn Ties<D>> {
        None
    }

    /// How it resists relative motions of near bodies in a fluid, if it does.
    fn resistance(&self) -> Option<&dyn PairResistance<D>> {
        None
    }
}
