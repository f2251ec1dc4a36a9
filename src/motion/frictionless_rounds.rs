//! Flow and contacts without friction in turn, until they agree.

use std::time::Instant;

use nalgebra::SVector;

use super::{
    active_set_iteration::ActiveSetIteration,
    contact_step::identities,
    implicit_springs::{kept_apart, pair},
    keeping_apart::largest_difference,
    quasi_static::{Agreed, FlowRows, KnownInstant, MOST_ROUNDS, Placed, QuasiStatic, disagreement, velocities},
    stepper::Effort,
};
use crate::{
    body::{Row, Twist},
    contact::ContactForce,
    error::Result,
    interaction::{Spring, Touch},
    mechanics::ResidualMonitor,
};

/// Difference between the velocities by the flow and by the contact model, over the largest ([`fastest`]), that counts as agreement,
/// unless the flow is solved to less. Films at roughness resist a million times more than bodies alone, and let velocities be known less well.
const AGREEMENT: f64 = 1e-5;
const AGREEMENT_IN_FILMS: f64 = 1e-4;

/// Part of the tolerance of a solve at an instant down to which the flow is solved where nothing else is left to agree on.
const TIGHTEST: f64 = 1e-3;

/// Gap, in radii, up to which a contact of the last step is tried first.
const MEMORY_REACH: f64 = 0.1;

impl<const D: usize> QuasiStatic<D> {
    /// Flow and frictionless contacts in turn.
    pub(super) fn agree_without_friction(
        &mut self,
        instant: &KnownInstant<D>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Agreed<D>> {
        let KnownInstant { placed, interactions, forces, springs, .. } = instant;
        let (state, touch, tightest) = (placed.state, interactions.touch(), self.suspension.setup().tolerance.at_an_instant());
        let mut tolerance = self.tolerance_of(instant);
        let agreement = if interactions.resist() { AGREEMENT_IN_FILMS } else { AGREEMENT };
        let mut active_contacts = self.expected(placed, touch)?;
        let (mut chosen, mut step, mut difference) = (None, state.last_step, 0.0);
        let mut rounds = ActiveSetIteration::new();
        for round in 0..MOST_ROUNDS {
            if round > 0 {
                self.stop.heed(self.session.world(), state.time)?;
            }
            let tied = kept_apart(springs, &self.weights, step);
            active_contacts.retain(|active| active.contact.other().is_none_or(|other| !tied.contains(&pair(active.contact.body, other))));
            let loose = self.contact_step(placed, step).loose(&active_contacts);
            let pushes = forces.on_bodies(instant.centers.len(), &loose);
            let (rows, guess): (Vec<Row<D>>, Vec<f64>) =
                active_contacts.iter().map(|active| (active.contact.row(step), active.force)).unzip();
            let flow_rows = FlowRows { rows: &rows, guess: &guess, pushes: &pushes, step, tolerance };
            let (mut solution, mut twists) = self.flow_with(instant, &flow_rows, effort, monitor)?;
            let begins = step == 0.0 && !springs.is_empty();
            let step_size = match chosen {
                Some(step_size) => step_size,
                None if begins => *chosen.insert(self.step_size(placed, &twists, &Spring::pulled(springs, pushes), instant.tried)?),
                None => *chosen.insert(self.step_size(placed, &twists, &pushes, instant.tried)?),
            };
            if begins && step_size.natural > 0.0 {
                // of springs the step is a part
                step = step_size.natural;
                continue;
            }
            if touch != Some(Touch::Hard) {
                return Ok(Agreed { solution, twists, contacts: forces.contacts.clone(), friction: None, step_size });
            }
            let start = Instant::now();
            // not the length, which the end of the run cuts short: a run that ends later must find the same
            step = if step_size.natural > 0.0 { step_size.natural } else { state.last_step };
            active_contacts.iter_mut().zip(&solution.contact_forces).for_each(|(active, force)| active.force = *force);
            let contacts = self.contact_step(placed, step);
            let unpressed = contacts.without_contacts(velocities(&twists), active_contacts.iter().chain(&loose));
            let near_contacts = if rounds.holds() { self.near(&active_contacts) } else { Vec::new() };
            let projection = contacts.project(&unpressed, &near_contacts)?;
            effort.contact += start.elapsed().as_secs_f64();
            let scale = fastest(&twists, &unpressed);
            let apart = largest_difference(&twists, &projection.velocities);
            difference = apart / scale;
            if difference <= agreement.max(tolerance) {
                for ((twist, body), velocity) in twists.iter_mut().zip(&mut solution.bodies).zip(&projection.velocities) {
                    (twist.velocity, body.twist.velocity) = (*velocity, *velocity);
                }
                let contacts = [&forces.contacts[..], &projection.forces].concat();
                return Ok(Agreed { solution, twists, contacts, friction: None, step_size });
            }
            let projected = contacts.closed(projection);
            if identities(&projected) == identities(&active_contacts) {
                // what is left of the residual may be what they differ by
                tolerance = (TIGHTEST * tightest).max(0.1 * tolerance);
            }
            let with_one_changed = |tried| contacts.with_one_changed(tried, &velocities(&twists), scale, AGREEMENT * scale);
            active_contacts = rounds.next(apart, active_contacts, projected, with_one_changed);
        }
        Err(disagreement(state.time, step, &format!("velocities differ by {difference:.1e}")))
    }

    /// The contacts that are tried first.
    fn expected(&self, placed: &Placed<D>, touch: Option<Touch>) -> Result<Vec<ContactForce<D>>> {
        let state = placed.state;
        if touch != Some(Touch::Hard) || state.last_step == 0.0 {
            return Ok(Vec::new());
        }
        let reach = MEMORY_REACH * self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let velocities = state.bodies.iter().map(|body| body.twist.velocity).collect();
        self.contact_step(placed, state.last_step).expected(&state.contact_history, velocities, reach)
    }

    /// The contacts of these whose bodies are near each other before the step.
    fn near(&self, active_contacts: &[ContactForce<D>]) -> Vec<ContactForce<D>> {
        active_contacts.iter().filter(|active| active.contact.gap < MEMORY_REACH * self.radii[active.contact.body]).copied().collect()
    }
}

/// Largest velocity, with contact forces or without them: where they hold bodies at rest, only what they resist tells how
/// small a velocity is.
fn fastest<const D: usize>(twists: &[Twist<D>], unpressed: &[SVector<f64, D>]) -> f64 {
    twists.iter().map(|twist| &twist.velocity).chain(unpressed).map(|velocity| velocity.norm()).fold(f64::MIN_POSITIVE, f64::max)
}
