//! Interactions: what bodies do to each other and to walls besides the flow that is resolved.
//!
//! Each is one file that implements [`Interaction`]. A step asks every one of a list in turn for what it contributes, and knows none of them by name:
//! forces that follow from where bodies are, bounds that keep them from overlapping, rows of the coupled system that resist relative motions, what is
//! to be remembered, and how steep its forces are, which limits explicit steps. What an interaction does not have it leaves at the default, and then
//! nothing is built for it.

mod arrangement;
mod bonds;
mod cluster;
mod conserved;
mod friction;
mod gluey;
mod hinge;
mod inelastic;
mod joints;
mod list;
mod lubrication;
mod repulsion;
mod spring;
mod welds;

use std::{fmt::Debug, ops::Range};

pub use arrangement::{Arrangement, PairForce, Wrench};
pub use bonds::{Bend, Bonds, Stretch};
pub use cluster::Cluster;
pub use conserved::{Conserved, Measure, enclosed};
pub use friction::Friction;
pub use gluey::Gluey;
pub use hinge::Hinge;
pub use inelastic::Inelastic;
pub use joints::{JointedChain, Joints};
pub use list::Interactions;
pub use lubrication::Lubrication;
pub use repulsion::Repulsion;
pub use spring::Spring;
pub use welds::Welds;

use nalgebra::SVector;

use crate::{
    body::Row,
    constraint::{MultiplierLayout, Neighbourhood, lubrication::LubricationPairs},
    contact::{AdhesiveContact, Contact, ContactForce},
};

/// How bodies notice that they touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Touch {
    /// Velocities are projected on those with which nothing overlaps at the end of a step.
    Hard,
    /// Forces push bodies apart, which may overlap a little.
    Soft {
        /// Overlap, in radii, at which they are too weak.
        overlap: f64,
        /// What to do then.
        remedy: &'static str,
    },
}

/// What bodies do to each other and to walls. All numbers are in the units of the scene.
pub trait Interaction<const D: usize>: Debug {
    /// Its name among the effects of a plan.
    fn name(&self) -> &'static str;

    /// What is built for it, for the plan.
    fn describe(&self) -> String;

    /// How bodies notice contact by it, if they do.
    fn touch(&self) -> Option<Touch> {
        None
    }

    /// Friction at contacts, if there is any.
    fn friction(&self) -> Option<Friction> {
        None
    }

    /// The largest gap at which bodies up to this radius act on each other by forces that follow from where they are.
    fn reach(&self, _largest_radius: f64) -> f64 {
        0.0
    }

    /// Forces along the lines of centres that follow from where bodies are, where they count as contacts.
    fn contact_forces(&self, _arrangement: &Arrangement<D>) -> Vec<ContactForce<D>> {
        Vec::new()
    }

    /// Other forces and torques that follow from where bodies are. A pair is the same on every rank that knows both bodies.
    fn pair_forces(&self, _arrangement: &Arrangement<D>) -> Vec<PairForce<D>> {
        Vec::new()
    }

    /// Whether it may have [`pair_forces`](Interaction::pair_forces), now or when bodies are nearer: their part of the stress is then a number at any time.
    fn acts_at_a_distance(&self) -> bool {
        self.touch().is_none() && self.reach(1.0) > 0.0
    }

    /// The steepest slope of its forces, force over distance, between bodies of which the smallest has this radius: explicit steps are limited by it.
    fn steepest(&self, _radius: f64) -> f64 {
        0.0
    }

    /// Contacts that may pull, each with the least force that it may bear for a step, a negative number; sorted by [`Contact::identity`].
    fn lower_bounds(&self, _arrangement: &Arrangement<D>, _memory: &[AdhesiveContact<D>], _step: f64) -> Vec<ContactForce<D>> {
        Vec::new()
    }

    /// What is remembered after a step with these contact forces.
    fn remember(
        &self,
        _arrangement: &Arrangement<D>,
        _memory: &[AdhesiveContact<D>],
        _forces: &[ContactForce<D>],
        _step: f64,
    ) -> Vec<AdhesiveContact<D>> {
        Vec::new()
    }

    /// Coordinates of a few bodies that forces oppose in proportion, to be followed implicitly, always in the same order; centres are those of one
    /// image of each body, however far from the box.
    fn springs(&self, _arrangement: &Arrangement<D>) -> Vec<Spring<D>> {
        Vec::new()
    }

    /// The same of one of its chains alone, whose bodies have these centres.
    fn springs_of(&self, _chain: &Range<usize>, _center: &dyn Fn(usize) -> SVector<f64, D>) -> Vec<Spring<D>> {
        Vec::new()
    }

    /// Bodies that it ties together, chain by chain.
    fn chains(&self) -> Vec<Range<usize>> {
        Vec::new()
    }

    /// Pairs of bodies that it ties, to be seen in pictures.
    fn bonds(&self) -> Vec<[usize; 2]> {
        Vec::new()
    }

    /// Whether it names bodies, so that it goes with these alone.
    fn ties(&self) -> bool {
        !(self.chains().is_empty() && self.bonds().is_empty() && self.clusters().is_empty())
    }

    /// Rows by which it makes bodies with these centres move or turn as one.
    fn welds(&self, _centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
        Vec::new()
    }

    /// Whether these rows turn bodies.
    fn turns(&self) -> bool {
        false
    }

    /// Bodies that it makes move as one.
    fn clusters(&self) -> &[Cluster<D>] {
        &[]
    }

    /// For each body the number of the cluster that it is in, from 1 on, or 0; nothing without clusters.
    fn cluster_of(&self) -> &[usize] {
        &[]
    }

    /// What its membranes keep, cell by cell.
    fn conserved(&self) -> Vec<Conserved> {
        Vec::new()
    }

    /// Whether it has rows in the coupled system of fluid and bodies.
    fn resists(&self) -> bool {
        false
    }

    /// Relative motions that it resists, of near bodies that have a side on a body of this rank: unknown forces with rows of their own.
    fn rows(&self, _crowd: &Neighbourhood<D>, _layout: &MultiplierLayout) -> LubricationPairs<D> {
        LubricationPairs::default()
    }

    /// What the resolved flow resists already of the same motions between bodies of this rank and walls, for the preconditioner.
    fn resolved_at_walls(&self, _crowd: &Neighbourhood<D>, _layout: &MultiplierLayout) -> LubricationPairs<D> {
        LubricationPairs::default()
    }

    /// What its rows resist the approach of a contact by, force over velocity and viscosity; bodies have these radii and orders of modes.
    fn approach_resistance(&self, _contact: &Contact<D>, _of: &dyn Fn(usize) -> (f64, usize)) -> f64 {
        0.0
    }
}
