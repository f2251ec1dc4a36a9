//! How far the forces and velocities of a step are from the law, whatever found them.

use super::{
    ContactWrench, FrictionLaw, SurfaceFriction,
    cone::{ContactState, natural_map},
    frame::Frame,
    program::FrictionIsland,
};
use crate::{
    body::Twist,
    contact::{Contact, FrictionReport, LoadedWall, View},
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
    /// Motions that they had at the start.
    pub starts: &'a [Twist<D>],
    /// Motions that they wanted.
    pub twists: &'a [Twist<D>],
    /// Motions that they have.
    pub ends: &'a [Twist<D>],
    /// All contacts of own bodies, of bodies by place.
    pub contacts: &'a [Contact<D>],
    /// Length of the step.
    pub step: f64,
    /// Over how long forces act on its velocities.
    pub duration: f64,
    /// How surfaces rub.
    pub surfaces: &'a SurfaceFriction,
    /// The wall that a load presses on them, if there is one.
    pub wall: Option<LoadedWall<'a>>,
}

/// Completes the report with the residual, with contacts that stick and slip, and with the work of forces, of all ranks. Collective.
pub fn certify<const D: usize>(
    peers: Peers,
    step: &Certified<D>,
    wrench: &dyn Fn(&Contact<D>) -> ContactWrench<D>,
    report: &mut FrictionReport,
) {
    let (mut largest, mut unit, mut sums) = (0.0f64, 0.0f64, [0.0; 3]);
    for contact in step.contacts.iter().filter(|contact| step.view.answers(contact.identity())) {
        let judged = step.judged(contact, &wrench(contact));
        largest = largest.max(judged.miss);
        unit = unit.max(judged.unit);
        match judged.state {
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

/// How a contact keeps its law, in rows of norm 1.
struct Judged {
    miss: f64,
    /// The largest velocity wanted.
    unit: f64,
    state: ContactState,
}

impl<const D: usize> Certified<'_, D> {
    fn judged(&self, contact: &Contact<D>, wrench: &ContactWrench<D>) -> Judged {
        let law = self.surfaces.of(self.view.identity(contact));
        match D {
            _ if law.is_plain() && self.wall.is_none_or(|wall| !wall.meets(contact)) => {
                self.judged_by_coefficient(contact, wrench, law.coefficient)
            }
            2 => self.judged_by_law::<3>(contact, wrench, law),
            _ => self.judged_by_law::<6>(contact, wrench, law),
        }
    }

    fn judged_by_law<const W: usize>(&self, contact: &Contact<D>, wrench: &ContactWrench<D>, law: FrictionLaw) -> Judged {
        let Certified { domain, view: View { balls, .. }, masses, step, duration, .. } = *self;
        let (contacts, laws) = (&[*contact], &[law]);
        let wall = self.wall;
        let island = |twists| FrictionIsland { domain, balls, masses, twists, step, contacts, laws, duration, wall };
        let (wanted, after) = (island(self.twists).program::<W>(), island(self.ends).program::<W>());
        let impulses = island(self.ends).impulses(&after, &[*wrench]);
        let velocities: Vec<[f64; D]> = after.row_blocks.iter().map(|row_block| row_block.offset).collect();
        let miss = (0..impulses.len()).map(|place| after.miss(place, &impulses, &velocities[place])).fold(0.0, f64::max);
        Judged { miss, unit: wanted.unit, state: after.state(0, &impulses, &velocities) }
    }

    fn judged_by_coefficient(&self, contact: &Contact<D>, wrench: &ContactWrench<D>, coefficient: f64) -> Judged {
        let frame = Frame::new(contact, &self.view.balls);
        let bodies = [Some(contact.body), contact.other()].into_iter().zip(frame.arms);
        let mobilities = bodies.filter_map(|(body, arm)| body.map(|body| (self.masses[body], arm)));
        let (along, across) = mobilities
            .fold((0.0, 0.0), |(along, across), ([mass, inertia], arm)| (along + 1.0 / mass, across + 1.0 / mass + arm * arm / inertia));
        let norms: [f64; D] = std::array::from_fn(|axis| if axis == 0 { along.sqrt() } else { across.sqrt() });
        let scaled = |twists: &[Twist<D>]| -> [f64; D] {
            let velocity = frame.velocity(self.domain, contact, twists, self.step);
            std::array::from_fn(|axis| velocity[axis] / norms[axis])
        };
        let (force, velocity, friction) = (frame.components(&wrench.force), scaled(self.ends), coefficient * norms[1] / norms[0]);
        let impulse = std::array::from_fn(|axis| force[axis] * self.duration * norms[axis]);
        Judged {
            miss: natural_map(&impulse, &velocity, friction, 0.0),
            unit: scaled(self.twists).iter().fold(0.0, |unit, wanted| unit.max(wanted.abs())),
            state: ContactState::of(&impulse, &velocity, friction),
        }
    }

    /// What contacts did on a body: their impulse times the mean of its motions at the start and at the end, so that it is with the work of other forces the
    /// change of the kinetic energy.
    fn work(&self, body: usize) -> f64 {
        let ([mass, inertia], [start, wanted, end]) = (self.masses[body], [&self.starts[body], &self.twists[body], &self.ends[body]]);
        // what is fixed to a wall moves with it
        if mass.is_infinite() || self.wall.is_some_and(|wall| body != wall.place && wall.carries(body)) {
            return 0.0;
        }
        let moved = mass * (end.velocity - wanted.velocity).dot(&(end.velocity + start.velocity));
        // a wall does not turn
        let inertia = if inertia.is_finite() { inertia } else { 0.0 };
        // a skew matrix has each component of the spin twice
        let turned = 0.5 * inertia * (end.spin - wanted.spin).dot(&(end.spin + start.spin));
        0.5 * (moved + turned)
    }
}
