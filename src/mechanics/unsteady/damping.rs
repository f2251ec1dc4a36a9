//! Surfaces in thin gaps give way to quick changes of their multipliers.
//!
//! Where a surface comes within a cell of a wall or of another one, the part of its mobility that jump functions bring is negative for pressures in the
//! gap: at `-0.006 h / mu` at most, a twentieth of what others have. In long steps the fluid adds more than that; in steps that viscosity takes a small part of a cell in
//! it does not yet, and multipliers grow. There a surface gives way by `damping (c - slow)`, with `slow` the mean of its multipliers over the time in
//! which viscosity passes a part of a cell: enough for its mobility to be positive, and nothing where multipliers change slowly.

use crate::system::{assembly::Assembly, fixed_operators::FixedOperators};

/// Velocity by which a surface that touches gives way to a change of a multiplier, over spacing and one over viscosity.
const DAMPING: f64 = 0.015;

/// Gap from which on surfaces are not damped, in cells.
const REACH: f64 = 1.5;

/// Damps bodies in thin gaps, with their slow multipliers before the step and the part of a change that these do not follow in it.
pub fn damp<const D: usize>(fixed: &FixedOperators<D>, assembly: &mut Assembly<D>, slow: &[Vec<f64>], lag: f64) {
    let spacing = fixed.grid.spacing().max();
    let mut gaps = vec![f64::INFINITY; assembly.placed.len()];
    let pairs = assembly.neighbourhood.pairs.iter().flat_map(|pair| [(pair.first, pair.gap), (pair.second, pair.gap)]);
    let walls = assembly.neighbourhood.walls.iter().map(|near| (near.body, near.gap));
    pairs.chain(walls).for_each(|(body, gap)| gaps[body] = gaps[body].min(gap));
    let damping = |body: &usize| DAMPING * spacing * lag * (1.0 - gaps[*body] / (REACH * spacing)).clamp(0.0, 1.0);
    assembly.damping = assembly.layout.local_bodies.iter().map(damping).collect();
    for (&body, damping) in assembly.layout.local_bodies.iter().zip(&assembly.damping).filter(|(_, damping)| **damping > 0.0) {
        let (first, rigid) = (assembly.layout.local(body), fixed.body_types.surface(body).modes.rigid_count());
        let known = assembly.undisturbed[first..].iter_mut().zip(&slow[body]).skip(rigid);
        known.for_each(|(known, slow)| *known -= damping * slow);
    }
}
