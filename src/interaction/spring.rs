//! Coordinates of a few bodies that a force opposes in proportion: of what potentials of bonds are made.

use nalgebra::{SMatrix, SVector};

/// Most bodies whose places a coordinate depends on.
pub const MOST_ENDS: usize = 3;

/// A coordinate of the centres of a few bodies, and the potential `stiffness coordinate^2 / 2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring<const D: usize> {
    /// The bodies, with the gradient of the coordinate by the centre of each. The gradients add up to zero.
    pub ends: [Option<(usize, SVector<f64, D>)>; MOST_ENDS],
    /// The coordinate, zero at rest.
    pub value: f64,
    /// Force over coordinate; infinite for what cannot give way.
    pub stiffness: f64,
}

impl<const D: usize> Spring<D> {
    /// The bodies that it acts on, with gradients.
    pub fn each(&self) -> impl Iterator<Item = &(usize, SVector<f64, D>)> {
        self.ends.iter().flatten()
    }

    /// Rate of the coordinate for velocities of all bodies.
    pub fn rate(&self, velocities: &[SVector<f64, D>]) -> f64 {
        self.each().map(|(body, gradient)| gradient.dot(&velocities[*body])).sum()
    }

    /// The coordinate's own mobility, rate over force, by the resistances of all bodies each alone.
    pub fn mobility(&self, resistances: &[f64]) -> f64 {
        self.each().map(|(body, gradient)| gradient.norm_squared() / resistances[*body]).sum()
    }

    /// The energy that it stores; none for what cannot give way.
    pub fn energy(&self) -> f64 {
        if self.stiffness.is_finite() { 0.5 * self.stiffness * self.value * self.value } else { 0.0 }
    }

    /// What a generalised force along the coordinate adds to the stress, times volume: minus the first moment of the forces on bodies.
    pub fn stress(&self, force: f64, centers: &[SVector<f64, D>]) -> SMatrix<f64, D, D> {
        let moment: SMatrix<f64, D, D> = self.each().map(|(body, gradient)| gradient * force * centers[*body].transpose()).sum();
        -moment
    }
}
