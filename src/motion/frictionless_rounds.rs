//! Flow and contacts without friction in turn, until they agree.

use std::time::Instant;

use nalgebra::SVector;

use super::{
    active_set_iteration::ActiveSetIteration,
    contact_step::identities,
    implicit_springs::{kept_apart, pair},
    keeping_apart::largest_difference,
    quasi_static::{Agreed, FlowRows, KnownInstant, MOST_ROUNDS, Placed, QuasiStatic, disagreement, velocities},
    step_control::StepSize,
    stepper::Effort,
};
use crate::{
    body::{Row, Twist},
    contact::ContactForce,
    error::Result,
    interaction::{Spring, Touch},
    system::{ResidualMonitor, Solution},
};

/// Difference between the velocities by the flow and by the contact model, over the largest ([`fastest`]), that counts as agreement,
/// unless the flow is solved to less. Films at roughness resist a million times more than bodies alone, and let velocities be known less well.
const AGREEMENT: f64 = 1e-5;
const AGREEMENT_IN_FILMS: f64 = 1e-4;

/// Part of the tolerance of a solve at an instant down to which the flow is solved where nothing else is left to agree on.
const TIGHTEST: f64 = 1e-3;

/// Gap, in radii, up to which a contact of the last step is tried first.
const MEMORY_REACH: f64 = 0.1;

/// Where the rounds of an instant stand.
struct Rounds<const D: usize> {
    /// Contacts that the flow holds closed.
    active_contacts: Vec<ContactForce<D>>,
    /// The step that follows, once it is known.
    step_size: Option<StepSize>,
    /// Length of the step over which contacts are looked at.
    step: f64,
    /// Tolerance of the flow.
    tolerance: f64,
    /// Difference between the velocities of the last round, over the largest.
    difference: f64,
    iteration: ActiveSetIteration<ContactForce<D>>,
}

/// The flow of a round.
struct RoundFlow<const D: usize> {
    solution: Solution<D>,
    /// How bodies move in it.
    twists: Vec<Twist<D>>,
    /// The step that follows.
    step_size: StepSize,
}

impl<const D: usize> QuasiStatic<D> {
    /// Flow and frictionless contacts in turn.
    pub(super) fn agree_without_friction(
        &mut self,
        instant: &KnownInstant<D>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Agreed<D>> {
        let state = instant.placed.state;
        let mut rounds = Rounds {
            active_contacts: self.expected(&instant.placed, instant.interactions.touch())?,
            step_size: None,
            step: state.last_step,
            tolerance: self.tolerance_of(instant),
            difference: 0.0,
            iteration: ActiveSetIteration::new(),
        };
        for round in 0..MOST_ROUNDS {
            if round > 0 {
                self.stop.heed(self.session.world(), state.time)?;
            }
            if let Some(agreed) = self.round(instant, &mut rounds, effort, monitor)? {
                return Ok(agreed);
            }
        }
        Err(disagreement(state.time, rounds.step, &format!("velocities differ by {:.1e}", rounds.difference)))
    }

    /// The flow with the active contacts, and the contacts next to its velocities; nothing where another round must follow.
    fn round(
        &mut self,
        instant: &KnownInstant<D>,
        rounds: &mut Rounds<D>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Option<Agreed<D>>> {
        let KnownInstant { placed, interactions, forces, springs, .. } = instant;
        let step = rounds.step;
        let tied = kept_apart(springs, &self.weights, step);
        rounds
            .active_contacts
            .retain(|active| active.contact.other().is_none_or(|other| !tied.contains(&pair(active.contact.body, other))));
        let loose = self.contact_step(placed, step).loose(&rounds.active_contacts);
        let pushes = forces.on_bodies(instant.centers.len(), &loose);
        let (rows, guess): (Vec<Row<D>>, Vec<f64>) =
            rounds.active_contacts.iter().map(|active| (active.contact.row(step), active.force)).unzip();
        let flow_rows = FlowRows { rows: &rows, guess: &guess, pushes: &pushes, step, tolerance: rounds.tolerance };
        let (solution, twists) = self.flow_with(instant, &flow_rows, effort, monitor)?;
        let begins = step == 0.0 && instant.begins_on_springs();
        let step_size = match rounds.step_size {
            Some(step_size) => step_size,
            None => {
                let pushes = if begins { Spring::pulled(springs, pushes) } else { pushes };
                *rounds.step_size.insert(self.step_size(instant, &twists, &pushes)?)
            }
        };
        let expected = instant.expected_step(step_size);
        if begins && expected > 0.0 {
            // of springs the step is a part
            rounds.step = expected;
            return Ok(None);
        }
        if interactions.touch() != Some(Touch::Hard) {
            return Ok(Some(Agreed { solution, twists, contacts: forces.contacts.clone(), friction: None, step_size }));
        }
        rounds.step = if expected > 0.0 { expected } else { placed.state.last_step };
        self.compare(instant, rounds, RoundFlow { solution, twists, step_size }, &loose, effort)
    }

    /// The contacts next to the velocities of a flow; where these differ, those that the next round holds.
    fn compare(
        &self,
        instant: &KnownInstant<D>,
        rounds: &mut Rounds<D>,
        flow: RoundFlow<D>,
        loose: &[ContactForce<D>],
        effort: &mut Effort,
    ) -> Result<Option<Agreed<D>>> {
        let (start, RoundFlow { mut solution, mut twists, step_size }) = (Instant::now(), flow);
        rounds.active_contacts.iter_mut().zip(&solution.contact_forces).for_each(|(active, force)| active.force = *force);
        let contacts = self.contact_step(&instant.placed, rounds.step);
        let unpressed = contacts.without_contacts(velocities(&twists), rounds.active_contacts.iter().chain(loose));
        let near_contacts = if rounds.iteration.holds() { self.near(&rounds.active_contacts) } else { Vec::new() };
        let projection = contacts.project(&unpressed, &near_contacts)?;
        effort.contact += start.elapsed().as_secs_f64();
        let scale = fastest(&twists, &unpressed);
        let apart = largest_difference(&twists, &projection.velocities);
        rounds.difference = apart / scale;
        let agreement = if instant.interactions.resist() { AGREEMENT_IN_FILMS } else { AGREEMENT };
        if rounds.difference <= agreement.max(rounds.tolerance) {
            for ((twist, body), velocity) in twists.iter_mut().zip(&mut solution.bodies).zip(&projection.velocities) {
                (twist.velocity, body.twist.velocity) = (*velocity, *velocity);
            }
            let contacts = [&instant.forces.contacts[..], &projection.forces].concat();
            return Ok(Some(Agreed { solution, twists, contacts, friction: None, step_size }));
        }
        let projected = contacts.closed(projection);
        if identities(&projected) == identities(&rounds.active_contacts) {
            // what is left of the residual may be what they differ by
            let tightest = self.suspension.setup().tolerance.at_an_instant();
            rounds.tolerance = (TIGHTEST * tightest).max(0.1 * rounds.tolerance);
        }
        let with_one_changed = |tried| contacts.with_one_changed(tried, &velocities(&twists), scale, AGREEMENT * scale);
        let tried = std::mem::take(&mut rounds.active_contacts);
        rounds.active_contacts = rounds.iteration.next(apart, tried, projected, with_one_changed);
        Ok(None)
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
