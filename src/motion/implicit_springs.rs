//! Springs as rows of the coupled system, implicit over the step to come, so that none limits it.
//!
//! Bodies travel by the two-step rule, which takes a coordinate `x` of theirs to
//!
//! ```text
//! x+ = x + dt (a x' - (a - 1) x'_last) + b        a = 1 + dt / (2 dt_last), or 1 where there is no last step
//! ```
//!
//! with `b` what a length or an area changes by besides: lengths that turn would grow. It is taken from the velocities of the last step. The force is that at a place between: `f = -k ((1 - p) x + p x+)`. A spring that is resolved, `z = k M dt << 1` with the mobility `M`, takes it where it
//! is, and keeps the order of the rule; a stiff one where it will be, and comes to rest in one step without passing it: `p = z^2 / (z^2 + 1/10)`. With
//! `p = 1` and no compliance it is a rod.

use std::collections::HashSet;

use nalgebra::{SMatrix, SVector};

use crate::{
    body::{RigidFunctional, Row},
    interaction::{Spring, Wrench},
};

/// Square of `z` at which a spring is half stiff: energies of free springs then fall in every step (tests).
const HALF_STIFF: f64 = 0.1;

/// Least part of the force that is implicit in rows of the coupled system, so that these have a scale.
pub const LEAST: f64 = 1e-3;

/// `z` from which on a spring keeps its two bodies apart by itself: what would close the gap in a step shortens it by a hundredth of that.
const STIFF: f64 = 100.0;

/// The step for which rows are made.
#[derive(Debug, Clone, Copy)]
pub struct StepAhead<'a, const D: usize> {
    /// Its length; 0 if it is not known yet: then the [first](Self::first) one.
    pub length: f64,
    /// That of the step before; 0 if there was none.
    pub last: f64,
    /// Velocities of all bodies in the step before.
    pub velocities: &'a [SVector<f64, D>],
    /// Force that gives each body a unit velocity.
    pub resistances: &'a [f64],
    /// Forces on bodies besides.
    pub pushes: &'a [Wrench<D>],
    /// How far a body may go in a step.
    pub room: f64,
    /// Least part of a force that is implicit.
    pub least: f64,
}

impl<const D: usize> StepAhead<'_, D> {
    /// The rows of springs, of which `ahead` are as they will be if bodies go on with the velocities of the last step.
    pub fn rows(&self, springs: &[Spring<D>], ahead: &[Spring<D>]) -> Vec<Row<D>> {
        let length = if self.length > 0.0 { self.length } else { self.first(springs) };
        let bent = |(spring, ahead): (&Spring<D>, &Spring<D>)| {
            if spring.smooth { ahead.value - spring.value - self.length * spring.rate(self.velocities) } else { 0.0 }
        };
        let row = |(spring, ahead): (&Spring<D>, &Spring<D>)| self.row(length, spring, bent((spring, ahead)));
        springs.iter().zip(ahead).map(row).collect()
    }

    /// The step in which no spring and no other force alone moves a body farther than the room it has; infinite if there is none.
    pub fn first(&self, springs: &[Spring<D>]) -> f64 {
        self.room / springs.iter().map(|spring| self.fastest(spring)).fold(self.pushed(), f64::max)
    }

    /// The largest speed that a spring alone gives a body; zero for a rod.
    fn fastest(&self, spring: &Spring<D>) -> f64 {
        let speed = |(body, gradient): &(usize, SVector<f64, D>)| gradient.norm() / self.resistances[*body];
        let force = if spring.stiffness.is_finite() { spring.stiffness * spring.value.abs() } else { 0.0 };
        force * spring.ends.iter().map(speed).fold(0.0, f64::max)
    }

    /// The largest speed that another force alone gives a body.
    fn pushed(&self) -> f64 {
        self.pushes.iter().zip(self.resistances).map(|(push, resistance)| push.force.norm() / resistance).fold(0.0, f64::max)
    }

    /// The row of a spring whose coordinate will have changed by `bent` besides what its rate makes of it.
    fn row(&self, length: f64, spring: &Spring<D>, bent: f64) -> Row<D> {
        let ahead = if self.last > 0.0 { 1.0 + 0.5 * length / self.last } else { 1.0 };
        let last = if self.last > 0.0 { spring.rate(self.velocities) } else { 0.0 };
        let part = implicit_part(spring.stiffness * spring.mobility(self.resistances) * length, self.least);
        let compliance = if spring.stiffness.is_finite() { 1.0 / (spring.stiffness * part * ahead * length) } else { 0.0 };
        let rate = -(spring.value / part + bent) / (ahead * length) + (1.0 - 1.0 / ahead) * last;
        let end = |&(body, direction): &(usize, SVector<f64, D>)| (body, RigidFunctional { direction, turn: SMatrix::zeros() });
        Row::new(spring.ends.iter().map(end).collect(), rate, compliance)
    }
}

/// The part of a force that is taken at the end of a step of `stiffness mobility step`.
fn implicit_part(stiffness: f64, least: f64) -> f64 {
    if stiffness.is_finite() { (stiffness * stiffness / (stiffness * stiffness + HALF_STIFF)).max(least) } else { 1.0 }
}

/// Pairs of bodies that springs keep at their distance over a step of this length, bodies having these resistances. A contact of theirs would be a second
/// row for the same rate.
pub fn kept_apart<const D: usize>(springs: &[Spring<D>], resistances: &[f64], step: f64) -> HashSet<[usize; 2]> {
    let stiff = |spring: &&Spring<D>| spring.ends.len() == 2 && spring.stiffness * spring.mobility(resistances) * step > STIFF;
    springs.iter().filter(stiff).map(|spring| pair(spring.ends[0].0, spring.ends[1].0)).collect()
}

/// Two bodies in the order of their numbers.
pub fn pair(one: usize, other: usize) -> [usize; 2] {
    [one.min(other), one.max(other)]
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    /// Two bodies of unit resistance on a spring, from a unit stretch: lengths step by step.
    fn relax(stiffness: f64, step: f64, steps: usize) -> Vec<f64> {
        let along = Vector2::new(1.0, 0.0);
        let (mut stretch, mut last, mut velocity) = (vec![1.0], 0.0, 0.0);
        for _ in 0..steps {
            let spring = Spring { ends: vec![(0, -along), (1, along)], value: stretch[stretch.len() - 1], stiffness, smooth: false };
            let velocities = [along * (-0.5 * velocity), along * (0.5 * velocity)];
            let row =
                StepAhead { length: step, last, velocities: &velocities, resistances: &[1.0; 2], pushes: &[], room: 1.0, least: LEAST }
                    .rows(std::slice::from_ref(&spring), std::slice::from_ref(&spring))
                    .remove(0);
            // rate = mobility force, and the row
            let rate = 2.0 * row.rate / (2.0 + row.compliance);
            let factor = if last > 0.0 { 0.5 * step / last } else { 0.0 };
            stretch.push(spring.value + step * (rate + factor * (rate - velocity)));
            (last, velocity) = (step, rate);
        }
        stretch
    }

    #[test]
    fn springs_relax_at_second_order_and_never_gain_energy_however_long_the_step() {
        let error = |steps: usize| relax(0.5, 1.0 / steps as f64, steps)[steps] - (-1.0_f64).exp();
        let order = (error(64) / error(128)).abs().log2();
        assert!(order > 1.8, "order {order}: {:e} {:e}", error(64), error(128));
        for exponent in -8..=40 {
            let lengths = relax(2.0_f64.powf(0.5 * f64::from(exponent)), 0.5, 40);
            assert!(lengths.windows(2).all(|pair| pair[1].abs() <= pair[0].abs() + 1e-12), "{exponent}: {lengths:?}");
        }
    }

    #[test]
    fn a_rod_has_its_length_after_a_step() {
        let lengths = relax(f64::INFINITY, 0.3, 3);
        assert!(lengths[1..].iter().all(|length| length.abs() < 1e-14), "{lengths:?}");
    }
}
