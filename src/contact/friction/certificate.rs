//! How far the forces and velocities of a step are from the law, whatever found them.

use nalgebra::SVector;

use super::{
    SurfaceFriction,
    cone::{ContactState, natural_map},
    frame::Frame,
};
use crate::{
    body::Twist,
    contact::{Contact, FrictionReport, View},
    geometry::Domain,
    parallel::Peers,
};

/// A step that was made.
pub struct Certified<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// The bodies that a rank sees.
    pub view: &'a View<D>,
    /// Their masses and moments of inertia.
    pub masses: &'a [[f64; 2]],
    /// Motions that they wanted.
    pub twists: &'a [Twist<D>],
    /// Motions that they have.
    pub ends: &'a [Twist<D>],
    /// All contacts of own bodies, of bodies by place.
    pub contacts: &'a [Contact<D>],
    /// Length of the step.
    pub step: f64,
    /// Coefficients of friction.
    pub surfaces: &'a SurfaceFriction,
}

/// Completes the report with the residual, with contacts that stick and slip, and with the work of forces, of all ranks. Collective.
pub fn certify<const D: usize>(
    peers: Peers,
    step: &Certified<D>,
    force: &dyn Fn(&Contact<D>) -> SVector<f64, D>,
    report: &mut FrictionReport,
) {
    let (mut largest, mut unit, mut sums) = (0.0f64, 0.0f64, [0.0; 3]);
    for contact in step.contacts.iter().filter(|contact| step.view.answers(contact.identity())) {
        let scaled = step.scaled(contact, &force(contact));
        largest = largest.max(natural_map(&scaled.impulse, &scaled.velocity, scaled.friction));
        unit = scaled.wanted.iter().fold(unit, |unit, wanted| unit.max(wanted.abs()));
        match ContactState::of(&scaled.impulse, &scaled.velocity, scaled.friction) {
            ContactState::Open => {}
            ContactState::Sticking => sums[0] += 1.0,
            ContactState::Slipping => sums[1] += 1.0,
        }
    }
    sums[2] = step.view.halo.own().iter().map(|&body| step.work(body)).sum();
    peers.sum(&mut sums);
    let (largest, unit) = (peers.max(largest), peers.max(unit));
    report.residual = if unit > 0.0 { largest / unit } else { 0.0 };
    (report.sticking, report.slipping, report.work) = (sums[0] as usize, sums[1] as usize, sums[2]);
}

/// A contact in rows of norm 1.
struct Scaled<const D: usize> {
    impulse: [f64; D],
    velocity: [f64; D],
    wanted: [f64; D],
    friction: f64,
}

impl<const D: usize> Certified<'_, D> {
    fn scaled(&self, contact: &Contact<D>, force: &SVector<f64, D>) -> Scaled<D> {
        let frame = Frame::new(contact, &self.view.balls);
        let bodies = [Some(contact.body), contact.other()].into_iter().zip(frame.arms);
        let mobilities = bodies.filter_map(|(body, arm)| body.map(|body| (self.masses[body], arm)));
        let (along, across) = mobilities
            .fold((0.0, 0.0), |(along, across), ([mass, inertia], arm)| (along + 1.0 / mass, across + 1.0 / mass + arm * arm / inertia));
        let norms: [f64; D] = std::array::from_fn(|axis| if axis == 0 { along.sqrt() } else { across.sqrt() });
        let velocity = |twists: &[Twist<D>]| {
            let velocity = frame.velocity((self.domain, contact), twists, self.step);
            std::array::from_fn(|axis| velocity[axis] / norms[axis])
        };
        let force = frame.components(force);
        Scaled {
            impulse: std::array::from_fn(|axis| force[axis] * self.step * norms[axis]),
            velocity: velocity(self.ends),
            wanted: velocity(self.twists),
            friction: self.surfaces.of(self.view.identity(contact)) * norms[1] / norms[0],
        }
    }

    /// The change of the kinetic energy of a body, as the product of a change and a sum.
    fn work(&self, body: usize) -> f64 {
        let ([mass, inertia], [before, after]) = (self.masses[body], [&self.twists[body], &self.ends[body]]);
        if mass.is_infinite() {
            return 0.0;
        }
        let moved = mass * (after.velocity - before.velocity).dot(&(after.velocity + before.velocity));
        // a skew matrix has each component of the spin twice
        let turned = 0.5 * inertia * (after.spin - before.spin).dot(&(after.spin + before.spin));
        0.5 * (moved + turned)
    }
}
