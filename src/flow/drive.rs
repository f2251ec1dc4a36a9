//! What keeps the fluid moving, besides walls and bodies.

use nalgebra::SVector;

use crate::geometry::Domain;

/// The drive of a flow; walls move it in addition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive<const D: usize> {
    /// None: no mean pressure gradient along periodic axes of a walled box, no mean velocity in a fully periodic box.
    Rest,
    /// Mean velocity over the whole box, bodies included; the pressure gradient that it takes comes out.
    MeanVelocity(SVector<f64, D>),
    /// Mean gradient of the pressure, felt by bodies too (the flow goes down the gradient).
    PressureGradient(SVector<f64, D>),
    /// Force per unit volume on the fluid alone.
    BodyForce(SVector<f64, D>),
    /// Background flow `u = (rate y, 0, ..)` in a fully periodic box, solved as a periodic disturbance of it.
    Shear(f64),
}

impl<const D: usize> Drive<D> {
    /// The same with its gradient or its force times a factor; the others have none.
    pub fn scaled(&self, factor: f64) -> Drive<D> {
        match self {
            Drive::PressureGradient(gradient) => Drive::PressureGradient(gradient * factor),
            Drive::BodyForce(force) => Drive::BodyForce(force * factor),
            _ => *self,
        }
    }

    /// The velocity of the background at a point: what is known of the flow before solving.
    pub fn background(&self, point: &SVector<f64, D>) -> SVector<f64, D> {
        let mut velocity = SVector::zeros();
        if let Drive::Shear(rate) = self {
            velocity[0] = rate * point[1];
        }
        velocity
    }

    /// The slope of a component of the background along an axis.
    pub fn slope(&self, component: usize, axis: usize) -> f64 {
        self.background(&SVector::from_fn(|other, _| if other == axis { 1.0 } else { 0.0 }))[component]
    }

    /// Whether it gives the mean velocity along periodic axes of a walled box, so that the force that drives it is to be found.
    pub fn leaves_force_open(&self, domain: &Domain<D>) -> bool {
        matches!(self, Drive::MeanVelocity(_)) && !domain.fully_periodic()
    }

    /// Whether it gives the force on a fully periodic box, so that the mean velocity is to be found.
    pub fn leaves_mean_velocity_open(&self, domain: &Domain<D>) -> bool {
        matches!(self, Drive::PressureGradient(_) | Drive::BodyForce(_)) && domain.fully_periodic()
    }

    /// The uniform force per unit volume that acts on the whole box, fluid and bodies.
    pub fn uniform_force(&self) -> SVector<f64, D> {
        match self {
            Drive::PressureGradient(gradient) => -gradient,
            Drive::BodyForce(force) => *force,
            _ => SVector::zeros(),
        }
    }

    /// What of the uniform force acts on the fluid but not on bodies.
    pub fn force_on_fluid_alone(&self) -> SVector<f64, D> {
        match self {
            Drive::BodyForce(force) => *force,
            _ => SVector::zeros(),
        }
    }
}
