//! The simple shear that a box and its drive impose.

use nalgebra::{SMatrix, SVector};

use crate::{
    flow::Drive,
    geometry::{Axis, Domain},
};

/// A simple shear: velocity along `flow` grows along axis `gradient`; no other axis has walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear<const D: usize> {
    /// Direction of the flow, a unit vector.
    pub flow: SVector<f64, D>,
    /// Axis along which its velocity grows.
    pub gradient: usize,
    /// Growth of the velocity per length.
    pub rate: f64,
}

impl<const D: usize> Shear<D> {
    /// That of a box and a drive, if it is one.
    pub fn of(domain: &Domain<D>, drive: &Drive<D>) -> Option<Shear<D>> {
        if let Drive::Shear(rate) = drive {
            return (*rate != 0.0).then(|| Shear { flow: unit(0), gradient: 1, rate: *rate });
        }
        (0..D).find_map(|gradient| {
            let Axis::Walls { lower, upper } = domain.axes[gradient] else { return None };
            let difference = upper - lower;
            let speed = difference.norm();
            let sheared = speed > 0.0 && (0..D).all(|axis| axis == gradient || domain.periodic(axis));
            sheared.then(|| Shear { flow: difference / speed, gradient, rate: speed / domain.size[gradient] })
        })
    }

    /// Direction of the gradient, a unit vector.
    pub fn across(&self) -> SVector<f64, D> {
        unit(self.gradient)
    }

    /// Shear component of a stress.
    pub(super) fn of_stress(&self, stress: &SMatrix<f64, D, D>) -> f64 {
        self.flow.dot(&stress.column(self.gradient))
    }

    /// Twice the rate of strain over the rate.
    pub(super) fn doubled_strain(&self) -> SMatrix<f64, D, D> {
        let gradient = self.flow * self.across().transpose();
        gradient + gradient.transpose()
    }
}

fn unit<const D: usize>(axis: usize) -> SVector<f64, D> {
    SVector::from_fn(|other, _| if other == axis { 1.0 } else { 0.0 })
}
