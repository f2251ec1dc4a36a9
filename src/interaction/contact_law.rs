//! What an interaction says of contacts: how they are noticed, how rough surfaces are, and what is remembered of them.

use std::fmt::Debug;

use super::Arrangement;
use crate::{
    contact::{AdhesiveContact, ContactForce, FRICTION_TOLERANCE},
    friction::SurfaceFriction,
    geometry::Ball,
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

/// Coulomb friction at inelastic contacts of bodies with each other and with walls ([`contact`](crate::contact)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Largest tangential force over the normal force, the same at all contacts but where [surfaces differ](ContactLaw::surfaces); 0 of surfaces that are
    /// rough alone.
    pub coefficient: f64,
    /// Gap at which bodies in a fluid touch, over the mean of their radii; walls are smooth, and touched at half of it.
    pub roughness: f64,
    /// Residual to which forces of dry bodies are found.
    pub tolerance: f64,
}

impl Friction {
    /// Friction of a coefficient and a roughness, with forces as exact as they can be found.
    pub fn new(coefficient: f64, roughness: f64) -> Friction {
        Friction { coefficient, roughness, tolerance: FRICTION_TOLERANCE }
    }

    /// Balls that touch where bodies with their roughness do.
    pub fn touching<const D: usize>(&self, balls: &[Ball<D>]) -> Vec<Ball<D>> {
        balls.iter().map(|ball| Ball { radius: ball.radius * (1.0 + 0.5 * self.roughness), ..*ball }).collect()
    }
}

/// Friction of surfaces that differ, or have more than a coefficient.
#[derive(Debug, Clone)]
pub struct UnequalFriction {
    /// With the coefficient of the roughest surface.
    pub friction: Friction,
    /// All surfaces.
    pub surfaces: SurfaceFriction,
}

/// A law of contact, or a part of one.
#[derive(Debug, Clone, Copy, Default)]
pub struct ContactLaw<'a, const D: usize> {
    /// How bodies notice contact by it, if they do.
    pub touch: Option<Touch>,
    /// Friction at contacts, if there is any.
    pub friction: Option<Friction>,
    /// Friction of surfaces that differ or have more than a coefficient, if they do.
    pub surfaces: Option<&'a SurfaceFriction>,
    /// What contacts remember, if they do.
    pub memory: Option<&'a dyn ContactMemory<D>>,
}

/// What contacts remember from step to step.
pub trait ContactMemory<const D: usize>: Debug {
    /// Contacts that may pull, each with the least force that it may bear for a step, a negative number; sorted by
    /// [`Contact::identity`](crate::contact::Contact::identity).
    fn lower_bounds(&self, arrangement: &Arrangement<D>, memory: &[AdhesiveContact<D>], step: f64) -> Vec<ContactForce<D>>;

    /// What is remembered after a step with these contact forces.
    fn remember(
        &self,
        arrangement: &Arrangement<D>,
        memory: &[AdhesiveContact<D>],
        forces: &[ContactForce<D>],
        step: f64,
    ) -> Vec<AdhesiveContact<D>>;
}

impl<const D: usize> From<Touch> for ContactLaw<'_, D> {
    fn from(touch: Touch) -> Self {
        ContactLaw { touch: Some(touch), ..ContactLaw::default() }
    }
}
