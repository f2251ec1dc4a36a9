//! What outputs and quantities see of bodies on their way.

use std::{borrow::Cow, ops::Range};

use nalgebra::{SMatrix, SVector};

use super::statistics::RunStatistics;
use crate::{
    contact::{Contact, Partner, bodies_of, renamed},
    geometry::Domain,
    motion::{Effort, Observation, Simulation},
    observe::{Bond, ForceLine, FrameBody, force_lines},
    parallel::{Peers, World},
    setup::{ContactHistory, Moving, Share, State},
};

/// The contacts of all bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactTotals {
    /// How many bear a force.
    pub active: usize,
    /// On how many bodies these act: two for each but those with walls.
    pub ends: usize,
    /// The sum of these forces.
    pub force: f64,
    /// How many stick.
    pub adhesive: usize,
    /// The least of their memories, 0 if none sticks.
    pub gamma: f64,
}

/// Bodies on their way.
#[derive(Clone, Copy)]
pub struct MotionView<'a, const D: usize> {
    /// The simulation.
    pub simulation: &'a Simulation<D>,
    /// What happens at this instant.
    pub observation: &'a Observation<D>,
    /// What the steps until now cost and kept.
    pub statistics: &'a RunStatistics,
    /// Whether the run ends here.
    pub last: bool,
}

impl<'a, const D: usize> MotionView<'a, D> {
    /// Where the bodies of this rank are.
    pub fn state(&self) -> &'a State<D> {
        self.simulation.state()
    }

    /// The box as it is now.
    pub fn domain(&self) -> &'a Domain<D> {
        self.simulation.domain()
    }

    /// What this instant and the step that led there took, in a flow.
    pub fn effort(&self) -> Option<Effort> {
        self.observation.solution.as_ref()?;
        Some(self.observation.effort + self.statistics.last().map_or_else(Default::default, |last| last.effort))
    }

    /// Contacts that bear a force, of the bodies of this rank: of this instant in a flow, of the last step in a dry run.
    pub fn contact_history(&self) -> Cow<'a, [ContactHistory<D>]> {
        match self.observation.solution {
            Some(_) => self.observation.contacts.iter().filter(|active| active.force != 0.0).map(ContactHistory::of).collect(),
            None => Cow::Borrowed(&self.state().contact_history),
        }
    }

    /// How many contacts bear a force and what these sum up to, how many stick, and their least memory: of all ranks. Collective.
    pub fn contact_totals(&self, world: &World) -> ContactTotals {
        let state = self.state();
        let contacts = self.contact_history();
        let reported = || contacts.iter().filter(|contact| state.reports(contact.body));
        let ends = reported().flat_map(|contact| bodies_of(contact.identity())).count();
        let force: f64 = reported().map(|contact| contact.force).sum();
        let mut sums = [reported().count() as f64, force, state.reported_adhesive_contacts().count() as f64, ends as f64];
        let gamma = state.adhesive_contacts.iter().map(|contact| contact.gamma).fold(0.0, f64::min);
        let peers = state.peers(world);
        peers.sum(&mut sums);
        let [active, ends] = [sums[0], sums[3]].map(|sum| sum as usize);
        ContactTotals { active, ends, force: sums[1], adhesive: sums[2] as usize, gamma: peers.min(gamma) }
    }

    /// The mean of `n n` over the normals of contacts that press, in a flow, whose ranks all know all contacts; nothing where none does.
    pub fn fabric(&self) -> Option<SMatrix<f64, D, D>> {
        let active_contacts = || self.observation.contacts.iter().filter(|active| active.force > 0.0);
        let sum: SMatrix<f64, D, D> = active_contacts().map(|active| active.contact.normal * active.contact.normal.transpose()).sum();
        let count = active_contacts().count();
        (count > 0).then(|| sum / count as f64)
    }

    /// Contacts that bear a force, of the bodies of this rank, as lines between centers or from a center to a wall. Collective.
    pub fn force_lines(&self) -> Vec<ForceLine<D>> {
        let contacts = self.contact_history();
        let (halo, balls) = self.simulation.halo_of(contacts.iter().flat_map(|contact| bodies_of(contact.identity())));
        let place = |number: usize| halo.place(number).expect("bodies of contacts are seen");
        let line = |history: &ContactHistory<D>| {
            let contact = Contact::again(self.domain(), &balls, renamed(history.identity(), place));
            let (ball, other) = (balls[contact.body], contact.partner);
            let radius = if let Partner::Body(other) = other { balls[other].radius } else { 0.0 };
            let way = contact.normal * (ball.radius + contact.gap + radius);
            ForceLine { from: ball.center, way, radii: [ball.radius, radius], force: history.force }
        };
        contacts.iter().filter(|contact| self.state().reports(contact.body)).map(line).collect()
    }

    /// The contact forces of all bodies as lines in the plane of two axes, on the first rank; none elsewhere. Collective.
    pub fn lines_on_first_rank(&self, world: &World, axes: [usize; 2]) -> Vec<Bond> {
        let own = self.force_lines();
        let all = match self.state().share {
            Share::Whole => own,
            Share::Own { .. } => {
                let mut letters = vec![Vec::new(); world.size()];
                letters[0] = own.iter().flat_map(ForceLine::pack).collect();
                Peers::All(world).deliver(&letters).chunks(ForceLine::<D>::LENGTH).map(ForceLine::unpack).collect()
            }
        };
        force_lines(&all, |vector| axes.map(|axis| vector[axis])).0
    }

    /// Bodies at some places in the state, as frames hold them.
    pub fn bodies(&self, places: Range<usize>) -> Vec<FrameBody<D>> {
        let (state, radii) = (self.state(), self.simulation.radii());
        let mut contacts = vec![0; places.len()];
        for body in self.contact_history().iter().flat_map(|contact| bodies_of(contact.identity())) {
            let place = state.place(body).and_then(|place| place.checked_sub(places.start));
            if let Some(count) = place.and_then(|place| contacts.get_mut(place)) {
                *count += 1;
            }
        }
        let body = |(place, contacts): (usize, usize)| {
            let (moving, twist) = (&state.bodies[place], &self.observation.twists[place]);
            let by_fluid = self.observation.solution.as_ref().map(|solution| &solution.bodies[place]);
            FrameBody {
                number: state.number(place),
                center: moving.center,
                radius: radii[place],
                velocity: twist.velocity,
                spin: twist.spin,
                rotation: moving.rotation,
                force: by_fluid.map_or_else(SVector::zeros, |state| state.force),
                torque: by_fluid.map_or_else(SMatrix::zeros, |state| state.torque),
                contacts,
            }
        };
        places.zip(contacts).map(body).collect()
    }

    /// All bodies in the order of their numbers, as frames hold them, on the first rank; none elsewhere. Collective.
    pub fn bodies_on_first_rank(&self, world: &World) -> Vec<FrameBody<D>> {
        let own = self.bodies(0..self.state().bodies.len());
        if self.state().share == Share::Whole {
            return own;
        }
        let (state, mut letters) = (self.state(), vec![Vec::new(); world.size()]);
        for ((moving, twist), body) in state.bodies.iter().zip(&self.observation.twists).zip(&own) {
            letters[0].extend([body.number as f64, body.radius, body.contacts as f64]);
            letters[0].extend(Moving { twist: *twist, ..*moving }.pack());
        }
        let read = |row: &[f64]| {
            let moving = Moving::<D>::unpack(&row[3..]);
            FrameBody {
                number: row[0] as usize,
                center: moving.center,
                radius: row[1],
                velocity: moving.twist.velocity,
                spin: moving.twist.spin,
                rotation: moving.rotation,
                force: SVector::zeros(),
                torque: SMatrix::zeros(),
                contacts: row[2] as usize,
            }
        };
        let mut all: Vec<FrameBody<D>> = Peers::All(world).deliver(&letters).chunks(3 + Moving::<D>::LENGTH).map(read).collect();
        all.sort_unstable_by_key(|body| body.number);
        all
    }
}
