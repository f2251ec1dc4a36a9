//! Coordinates of a few bodies that a force opposes in proportion: of what potentials of bonds are made.

use nalgebra::SVector;

use super::Wrench;
use crate::linalg::CANCELLATION;

/// What a coordinate differs from that at rest by, both in units of `unit`: nothing where that is rounding, so that what is at rest stays so.
pub fn beyond_rounding(value: f64, unit: f64) -> f64 {
    if value.abs() > CANCELLATION * unit { value } else { 0.0 }
}

/// A coordinate of the centres of a few bodies, and the potential `stiffness coordinate^2 / 2`.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring<const D: usize> {
    /// The bodies, with the gradient of the coordinate by the centre of each. The gradients add up to zero.
    pub ends: Vec<(usize, SVector<f64, D>)>,
    /// The coordinate, zero at rest.
    pub value: f64,
    /// Force over coordinate; infinite for what cannot give way.
    pub stiffness: f64,
    /// Whether the coordinate is smooth, so that its change along a step is known beyond its rate: lengths and areas are, a curvature is not where
    /// a chain is straight.
    pub smooth: bool,
}

impl<const D: usize> Spring<D> {
    /// Rate of the coordinate for velocities of all bodies.
    pub fn rate(&self, velocities: &[SVector<f64, D>]) -> f64 {
        self.ends.iter().map(|(body, gradient)| gradient.dot(&velocities[*body])).sum()
    }

    /// The coordinate's own mobility, rate over force, by the resistances of all bodies each alone.
    pub fn mobility(&self, resistances: &[f64]) -> f64 {
        self.ends.iter().map(|(body, gradient)| gradient.norm_squared() / resistances[*body]).sum()
    }

    /// The forces on bodies besides others, none or one for each body, once springs that give way pull as well.
    pub fn pulled(springs: &[Spring<D>], mut pushes: Vec<Wrench<D>>) -> Vec<Wrench<D>> {
        for spring in springs.iter().filter(|spring| spring.stiffness.is_finite()) {
            spring.ends.iter().for_each(|(body, gradient)| pushes[*body].force -= gradient * (spring.stiffness * spring.value));
        }
        pushes
    }

    /// The energy that it stores; none for what cannot give way.
    pub fn energy(&self) -> f64 {
        if self.stiffness.is_finite() { 0.5 * self.stiffness * self.value * self.value } else { 0.0 }
    }
}
