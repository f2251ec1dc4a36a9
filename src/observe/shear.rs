//! The simple shear that a box and its drive impose.

use nalgebra::{SMatrix, SVector};

use crate::{flow::Drive, geometry::Domain};

/// A simple shear: velocity along `flow` grows along axis `gradient`; no other axis has walls. Reversed, it flows the other way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear<const D: usize> {
    /// Direction of the flow, a unit vector.
    pub flow: SVector<f64, D>,
    /// Axis along which its velocity grows.
    pub gradient: usize,
    /// Growth of the velocity per length, positive; where nothing is sheared at this instant a tiny part of the largest of all times.
    pub rate: f64,
    /// Whether nothing is sheared at this instant.
    pub at_rest: bool,
}

/// Part of the largest rate that counts as none.
const NO_RATE: f64 = 1e-9;

impl<const D: usize> Shear<D> {
    /// That of a box and a drive, if it is one.
    pub fn of(domain: &Domain<D>, drive: &Drive<D>) -> Option<Shear<D>> {
        if let Some(protocol) = domain.protocol() {
            let (rate, least) = (protocol.rate(domain.time()), NO_RATE * protocol.fastest());
            return Some(Shear { flow: unit(0) * rate.signum(), gradient: 1, rate: rate.abs().max(least), at_rest: rate.abs() < least });
        }
        if let Drive::Shear(rate) = drive {
            return (*rate != 0.0).then(|| Shear { flow: unit(0) * rate.signum(), gradient: 1, rate: rate.abs(), at_rest: false });
        }
        (0..D).find_map(|gradient| {
            let [lower, upper] = domain.axes[gradient].walls()?;
            let difference = upper - lower;
            let speed = difference.norm();
            let sheared = speed > 0.0 && (0..D).all(|axis| axis == gradient || domain.periodic(axis));
            sheared.then(|| Shear { flow: difference / speed, gradient, rate: speed / domain.size[gradient], at_rest: false })
        })
    }

    /// Whether it flows along its axis or against it, 1 or -1.
    pub fn sign(&self) -> f64 {
        self.flow.iter().find(|component| **component != 0.0).map_or(1.0, |component| component.signum())
    }

    /// The strain at a time, with the sign of the rate.
    pub fn strain(&self, domain: &Domain<D>, time: f64) -> f64 {
        // no negative zero at the start
        domain.strain(self.sign() * self.rate, time) + 0.0
    }

    /// Its rate along its axis, negative where it flows against that, or 0 where nothing is sheared.
    pub fn rate_along(&self, domain: &Domain<D>) -> f64 {
        domain.protocol().map_or(self.sign() * self.rate, |protocol| protocol.rate(domain.time()))
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
