//! Contacts of bodies in a flow over a step: who presses, as if each body were alone in the fluid but for the films that it has.

use std::collections::{HashMap, HashSet};

use nalgebra::SVector;

use crate::{
    body::Twist,
    contact::{self, Contact, ContactForce, Identity, Problem, Projection},
    error::Result,
    geometry::{Ball, Domain},
    interaction::Arrangement,
    mechanics::FlowSolver,
    petsc::{Session, Stage, enter},
    setup::ContactHistory,
};

/// Gap, in radii of the largest body, up to which bodies are near each other: a little more than the gaps of rods of the default length, 0.1, which rounding
/// would count or not.
const NEAR: f64 = 0.101;

/// Part of a force that is rounding.
const SMALLEST_FORCE: f64 = 1e-12;

/// Bodies that may touch on their way over a step.
pub struct ContactStep<'a, const D: usize> {
    /// The ranks that share the problem.
    pub session: &'a Session,
    /// The flow that knows what films resist.
    pub flow: &'a dyn FlowSolver<D>,
    /// Where the bodies are.
    pub arrangement: Arrangement<'a, D>,
    /// Contacts that may pull, with the least force of each; sorted by identity.
    pub bounds: Vec<ContactForce<D>>,
    /// Length of the step.
    pub step: f64,
}

/// The smallest gap of balls of such weights near each other or near a wall, in radii of the smaller one; infinite without any.
pub(super) fn smallest_gap<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], weights: &[f64], cluster_of: &[usize]) -> f64 {
    let reach = NEAR * balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let near = contact::candidates(domain, balls, weights, reach).into_iter();
    let near = near.filter(|contact| !contact.within_cluster(cluster_of, |body| body));
    near.map(|contact| contact.gap / contact.smaller_radius(balls)).fold(f64::INFINITY, f64::min)
}

impl<const D: usize> ContactStep<'_, D> {
    /// The projection of velocities, with the forces that cause it between bodies with these films. Contacts that are `held` do not close, though on their
    /// curved way bodies might miss each other.
    pub fn project(&self, velocities: &[SVector<f64, D>], held: &[ContactForce<D>]) -> Result<Projection<D>> {
        let _stage = enter(Stage::Contacts);
        let scaled = |bound: &ContactForce<D>| ContactForce { force: bound.force * self.mobile_part(&bound.contact), ..*bound };
        let mut lower_bounds: Vec<ContactForce<D>> = self.bounds.iter().map(scaled).collect();
        let bound = |held: &ContactForce<D>| ContactForce { force: self.least(&held.contact) * self.mobile_part(&held.contact), ..*held };
        lower_bounds.extend(held.iter().map(bound));
        lower_bounds.sort_by_key(|bound| bound.contact.identity());
        lower_bounds.dedup_by_key(|bound| bound.contact.identity());
        let Arrangement { domain, balls, weights, .. } = self.arrangement;
        let cluster_of = self.flow.setup().interactions.cluster_of();
        let problem = Problem { lower_bounds: &lower_bounds, cluster_of, ..Problem::new(domain, balls, weights, velocities, self.step) };
        let mut projection = contact::project(self.session.world(), &problem, self.session.into())?;
        projection.forces.iter_mut().for_each(|active| active.force /= self.mobile_part(&active.contact));
        projection.kkt_report.total_force = projection.forces.iter().map(|active| active.force).sum();
        Ok(projection)
    }

    /// The smallest gap, in radii of the smaller body, after bodies have moved so; infinite if none are near each other.
    pub fn smallest_gap_after(&self, moves: &[Twist<D>]) -> f64 {
        let Arrangement { domain, balls, weights, .. } = self.arrangement;
        let moved: Vec<Ball<D>> =
            balls.iter().zip(moves).map(|(ball, twist)| Ball { center: ball.center + twist.velocity * self.step, ..*ball }).collect();
        smallest_gap(&domain.after(self.step), &moved, weights, self.flow.setup().interactions.cluster_of())
    }

    /// The velocities that bodies would have without contact forces, if each were alone but for the film that bears most of a force.
    pub fn without_contacts<'b>(
        &self,
        mut velocities: Vec<SVector<f64, D>>,
        active_contacts: impl IntoIterator<Item = &'b ContactForce<D>>,
    ) -> Vec<SVector<f64, D>> {
        let weights = self.arrangement.weights;
        for ContactForce { contact, force, .. } in active_contacts {
            let push = contact.normal * (*force * self.mobile_part(contact));
            velocities[contact.body] += push / weights[contact.body];
            if let Some(other) = contact.other() {
                velocities[other] -= push / weights[other];
            }
        }
        velocities
    }

    /// Those of the contact forces of the last step that press now if bodies want to go on with these velocities. With films, which slow bodies
    /// down as gaps close, those that pressed then.
    pub fn expected(
        &self,
        contact_history: &[ContactHistory<D>],
        velocities: Vec<SVector<f64, D>>,
        reach: f64,
    ) -> Result<Vec<ContactForce<D>>> {
        let forces: HashMap<_, f64> = contact_history.iter().map(|contact| (contact.identity(), contact.force)).collect();
        let again = |contact: Contact<D>| forces.get(&contact.identity()).map(|&force| ContactForce::normal(contact, force));
        let mut expected: Vec<ContactForce<D>> = self.arrangement.near(reach).into_iter().filter_map(again).collect();
        if self.flow.setup().interactions.resist() {
            expected.retain(|expected| expected.force > (1.0 - SMALLEST_FORCE) * self.least(&expected.contact));
            return Ok(expected);
        }
        let unpressed = self.without_contacts(velocities, &expected);
        Ok(self.closed(self.project(&unpressed, &[])?))
    }

    /// The contacts of a projection that are held closed: they bear more than the least force that they may.
    pub fn closed(&self, mut projection: Projection<D>) -> Vec<ContactForce<D>> {
        projection.forces.retain(|active| active.force > (1.0 - SMALLEST_FORCE) * self.least(&active.contact));
        projection.forces
    }

    /// The contacts that stick but are not held: they pull as they let go.
    pub fn loose(&self, active_contacts: &[ContactForce<D>]) -> Vec<ContactForce<D>> {
        let held: HashSet<Identity<D>> = active_contacts.iter().map(|active| active.contact.identity()).collect();
        self.bounds.iter().filter(|bound| !held.contains(&bound.contact.identity())).copied().collect()
    }

    /// The same contacts but for the first that pulls more than it may, which goes, or that is not held and closes too far, which comes; velocities
    /// that differ by less than `slack` are the same.
    pub fn with_one_changed(
        &self,
        mut active_contacts: Vec<ContactForce<D>>,
        velocities: &[SVector<f64, D>],
        fastest: f64,
        slack: f64,
    ) -> Vec<ContactForce<D>> {
        let places: HashMap<Identity<D>, usize> =
            active_contacts.iter().enumerate().map(|(place, active)| (active.contact.identity(), place)).collect();
        let cluster_of = self.flow.setup().interactions.cluster_of();
        for contact in
            self.arrangement.near(2.0 * fastest * self.step).into_iter().filter(|contact| !contact.within_cluster(cluster_of, |body| body))
        {
            match places.get(&contact.identity()).copied() {
                Some(place) if active_contacts[place].force < self.least(&contact) - slack * self.softest(&contact) => {
                    active_contacts.remove(place);
                    return active_contacts;
                }
                None if contact.opening(velocities) < -contact.gap / self.step - slack => {
                    active_contacts.push(ContactForce::normal(contact, 0.0));
                    return active_contacts;
                }
                _ => {}
            }
        }
        active_contacts
    }

    /// The least force that a contact may bear.
    fn least(&self, contact: &Contact<D>) -> f64 {
        let found = self.bounds.binary_search_by_key(&contact.identity(), |bound| bound.contact.identity());
        found.map_or(0.0, |place| self.bounds[place].force)
    }

    /// The part of a contact force that moves the two as if each were alone: their film resists the rest.
    fn mobile_part(&self, contact: &Contact<D>) -> f64 {
        let weights = self.arrangement.weights;
        let mobility = 1.0 / weights[contact.body] + contact.other().map_or(0.0, |other| 1.0 / weights[other]);
        1.0 / (1.0 + self.flow.resistance().of_film(contact) * mobility)
    }

    /// Force that moves the more mobile end of a contact at unit velocity.
    fn softest(&self, contact: &Contact<D>) -> f64 {
        let weights = self.arrangement.weights;
        contact.other().map_or(f64::INFINITY, |other| weights[other]).min(weights[contact.body])
    }
}

/// Who touches whom, in order.
pub fn identities<const D: usize>(contacts: &[ContactForce<D>]) -> Vec<Identity<D>> {
    let mut identities: Vec<_> = contacts.iter().map(|active| active.contact.identity()).collect();
    identities.sort_unstable();
    identities
}
