//! How an interaction resists relative motions of near bodies in a fluid: unknown forces with rows of their own in the coupled system.

use crate::{
    constraint::{MultiplierLayout, Neighbourhood, lubrication::LubricationPairs},
    contact::Contact,
};

/// Resistance to relative motions of near bodies, and of bodies and walls.
pub trait PairResistance<const D: usize> {
    /// Relative motions that it resists, of near bodies that have a side on a body of this rank.
    fn rows(&self, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> LubricationPairs<D>;

    /// What its rows resist the approach of a contact by, force over velocity and viscosity; bodies have these radii and orders of modes.
    fn approach(&self, contact: &Contact<D>, of: &dyn Fn(usize) -> (f64, usize)) -> f64;

    /// What the resolved flow resists already of the same motions between bodies of this rank and walls, for the preconditioner.
    fn resolved_at_walls(&self, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> LubricationPairs<D>;
}
