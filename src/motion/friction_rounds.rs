//! Friction at contacts in a flow: coupled solves for states of contacts, and the exact law of the network of bodies and films for the next states, in turn.
//!
//! Where these were tried before in the step, only contacts that miss the law most change, each as if it were alone; fewer of them until that was not tried.

use std::time::Instant;

use super::{
    friction_contacts::{Wrenches, contact_again, jammed, wrenches_at, wrenches_of},
    quasi_static::{Agreed, FlowRows, KnownInstant, MOST_ROUNDS, QuasiStatic, disagreement},
    step_control::StepSize,
    stepper::Effort,
};
use crate::{
    body::{Row, Twist},
    contact::{Contact, ContactForce, FrictionReport},
    error::{Error, Result},
    friction::{ContactWrench, FlowContacts, HeldContact, ImmersedBodies},
    interaction::Spring,
    petsc::{Stage, enter},
    system::{ResidualMonitor, Solution},
};

/// Natural map of forces and velocities, over the largest velocity that contacts would have without forces, below which flow and contacts agree: without
/// films, and with films, which let velocities be known less well.
const AGREEMENT: f64 = 1e-5;
const AGREEMENT_IN_FILMS: f64 = FrictionReport::TOLERANCE_IN_FLOW;

/// The same up to which the best that was found is taken after so many rounds: near jamming a contact may neither stick nor slip as others do, and the cone of
/// one is exceeded by a part like this. It is told of each step, and of how many.
const ACCEPTABLE: f64 = 1e-2;
const PATIENCE: usize = 12;

/// Tolerance of a solve over what the one before missed the law by, and over what is agreement.
const FOLLOWS: f64 = 1e-2;
const TIGHTEST: f64 = 0.1;

/// The same where contacts are held as in the round before: what is missed is then the solve's; and how often.
const TIGHTER: f64 = 0.1;
const MOST_REPEATED: i32 = 2;

/// Part of the largest miss of the law from which contacts change where the network has nothing new to say.
const WORST: f64 = 0.5;

/// The flow with which a step begins.
struct FirstFlow<const D: usize> {
    solution: Solution<D>,
    twists: Vec<Twist<D>>,
    wrenches: Wrenches<D>,
    step_size: StepSize,
}

/// A flow, how bodies move in it, and the wrench of each contact on its partner.
type FrictionFlow<const D: usize> = (Solution<D>, Vec<Twist<D>>, Vec<ContactWrench<D>>);

/// Where the rounds of an instant stand.
struct Rounds<'a, const D: usize, const W: usize> {
    contacts: FlowContacts<'a, D, W>,
    held: Vec<HeldContact<D>>,
    /// All that was tried.
    tried: Vec<Vec<HeldContact<D>>>,
    /// How often in a row the network has said that contacts are held as they were.
    repeated: i32,
}

impl<'a, const D: usize, const W: usize> Rounds<'a, D, W> {
    /// Contacts that are held as those with these wrenches were.
    fn new(immersed: ImmersedBodies<'a, D>, contacts: Vec<Contact<D>>, wrenches: &Wrenches<D>) -> Self {
        let contacts = FlowContacts::new(immersed, contacts);
        let held = contacts.by_wrenches(&wrenches_at(&contacts, wrenches));
        Rounds { contacts, held, tried: Vec::new(), repeated: 0 }
    }

    /// The same with more contacts, which bear no force yet.
    fn with(self, more: Vec<Contact<D>>, wrenches: &mut Vec<ContactWrench<D>>) -> Self {
        let known: Wrenches<D> = self.contacts.contacts.iter().map(Contact::identity).zip(wrenches.iter().copied()).collect();
        let immersed = self.contacts.immersed;
        let mut contacts = [self.contacts.contacts, more].concat();
        contacts.sort_by_key(Contact::identity);
        let rounds = Rounds::new(immersed, contacts, &known);
        *wrenches = wrenches_at(&rounds.contacts, &known);
        rounds
    }

    /// What flow and contacts agree on.
    fn agreed(
        &self,
        instant: &KnownInstant<D>,
        solution: Solution<D>,
        twists: Vec<Twist<D>>,
        wrenches: &[ContactWrench<D>],
        step_size: StepSize,
    ) -> Agreed<D> {
        let mut contacts = instant.forces.contacts.clone();
        for (contact, ContactWrench { force, couple }) in self.contacts.contacts.iter().zip(wrenches) {
            let normal = force.dot(&contact.normal);
            if normal > 0.0 {
                let tangential = force - contact.normal * normal;
                contacts.push(ContactForce { contact: *contact, force: normal, tangential, couple: *couple });
            }
        }
        Agreed { solution, twists, contacts, friction: Some(self.contacts.report()), step_size }
    }

    /// What ends rounds that go on for too long: the best that they have agreed on, if it is acceptable, or that bodies are jammed.
    fn out_of_patience(
        &self,
        instant: &KnownInstant<D>,
        round: usize,
        step: f64,
        residual: f64,
        best: &mut Option<Agreed<D>>,
        agreed: impl FnOnce() -> Agreed<D>,
    ) -> Result<Option<Agreed<D>>> {
        if residual <= ACCEPTABLE && best.as_ref().is_none_or(|best| residual < missed_by(best)) {
            *best = Some(agreed());
        }
        if round >= PATIENCE
            && let Some(best) = best.take()
        {
            return Ok(Some(best));
        }
        if round == PATIENCE && self.contacts.is_jammed() == Some(true) {
            return Err(jammed(instant, step));
        }
        Ok(None)
    }

    /// Goes on to the next states.
    fn next(&mut self) {
        let _stage = enter(Stage::Contacts);
        let by_network = self.contacts.by_network();
        if let Some(same) = by_network.as_ref().filter(|next| self.repeated < MOST_REPEATED && are_like(&self.held, next)) {
            // with new directions of slip and new forces about which redundant rows are regular, and solved to less
            (self.held, self.repeated) = (same.clone(), self.repeated + 1);
            return;
        }
        let next = by_network.filter(|next| !self.was_tried(next)).unwrap_or_else(|| self.with_worst_changed());
        self.tried.push(std::mem::replace(&mut self.held, next));
        self.repeated = 0;
    }

    /// The states with those of the contacts changed that miss the law by at least half of the most, or else with the first one that makes them new.
    fn with_worst_changed(&self) -> Vec<HeldContact<D>> {
        let (alone, misses) = (self.contacts.by_contact(), self.contacts.misses());
        let most = misses.iter().copied().fold(0.0, f64::max);
        let with = |changes: &dyn Fn(usize) -> bool| -> Vec<HeldContact<D>> {
            (0..alone.len()).map(|place| if changes(place) { alone[place] } else { self.held[place] }).collect()
        };
        let mut order: Vec<usize> = (0..alone.len()).filter(|&place| !alone[place].is_like(&self.held[place])).collect();
        order.sort_by(|&one, &other| misses[other].total_cmp(&misses[one]));
        let several = with(&|place| misses[place] >= WORST * most);
        let single = order.into_iter().map(|which| with(&|place| place == which));
        std::iter::once(several).chain(single).find(|next| !self.was_tried(next)).unwrap_or(alone)
    }

    /// Tolerance of the next solve, over what is agreement.
    fn tightest(&self) -> f64 {
        TIGHTEST * TIGHTER.powi(self.repeated)
    }

    fn was_tried(&self, next: &[HeldContact<D>]) -> bool {
        are_like(&self.held, next) || self.tried.iter().any(|tried| are_like(tried, next))
    }
}

impl<const D: usize> QuasiStatic<D> {
    /// Flow and contacts with friction in turn.
    pub(super) fn agree_with_friction(
        &mut self,
        instant: &KnownInstant<D>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Agreed<D>> {
        if D == 2 { self.agree_of_width::<3>(instant, effort, monitor) } else { self.agree_of_width::<6>(instant, effort, monitor) }
    }

    fn agree_of_width<const W: usize>(
        &mut self,
        instant: &KnownInstant<D>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Agreed<D>> {
        let placed = &instant.placed;
        let FirstFlow { mut solution, mut twists, wrenches, step_size } = self.first_flow::<W>(instant, effort, monitor)?;
        let expected = instant.expected_step(step_size);
        let step = if expected > 0.0 { expected } else { placed.state.last_step };
        let (network, surfaces) = (self.network(instant, step), instant.interactions.surfaces());
        let immersed = ImmersedBodies { domain: &placed.domain, balls: &placed.touching, resistance: &network, surfaces: &surfaces, step };
        let rounds = Rounds::<D, W>::new(immersed, self.may_touch(instant, &twists, step, &wrenches), &wrenches);
        let mut wrenches = wrenches_at(&rounds.contacts, &wrenches);
        if instant.begins_on_springs() {
            // of springs the step is a part
            (solution, twists, wrenches) = self.flow_with_friction(instant, &rounds, step, self.tolerance_of(instant), effort, monitor)?;
        }
        self.rounds_with_friction(instant, rounds, (solution, twists, wrenches), step_size, effort, monitor)
    }

    /// Rounds of contacts and flow, from a flow with the wrenches of its contacts, until the law of friction is kept.
    fn rounds_with_friction<const W: usize>(
        &mut self,
        instant: &KnownInstant<D>,
        mut rounds: Rounds<D, W>,
        (mut solution, mut twists, mut wrenches): FrictionFlow<D>,
        step_size: StepSize,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Agreed<D>> {
        let (state, step) = (instant.placed.state, rounds.contacts.immersed.step);
        let agreement = if instant.interactions.resist() { AGREEMENT_IN_FILMS } else { AGREEMENT };
        let mut best = None;
        for round in 0..MOST_ROUNDS {
            let start = Instant::now();
            let mut residual = rounds.contacts.take(&wrenches, &twists);
            if round == 0 && !instant.springs.is_empty() && step != state.last_step {
                rounds.contacts.forget();
            }
            if residual <= agreement {
                let missing = self.missing(instant, &twists, step, &rounds.contacts)?;
                if missing.is_empty() {
                    effort.contact += start.elapsed().as_secs_f64();
                    return Ok(rounds.agreed(instant, solution, twists, &wrenches, step_size));
                }
                rounds = rounds.with(missing, &mut wrenches);
                residual = rounds.contacts.take(&wrenches, &twists);
            }
            let agreed = || rounds.agreed(instant, solution, twists, &wrenches, step_size);
            if let Some(best) = rounds.out_of_patience(instant, round, step, residual, &mut best, agreed)? {
                return Ok(best);
            }
            rounds.next();
            effort.contact += start.elapsed().as_secs_f64();
            self.stop.heed(self.session.world(), state.time)?;
            let tolerance = self.tolerance_of(instant).min((FOLLOWS * residual).max(agreement * rounds.tightest()));
            (solution, twists, wrenches) = self.flow_with_friction(instant, &rounds, step, tolerance, effort, monitor)?;
        }
        Err(law_missed(state.time, step, rounds.contacts.take(&wrenches, &twists)))
    }

    /// The flow with which a step begins: with the contacts of the last one, if there are any, held as they were.
    fn first_flow<const W: usize>(
        &mut self,
        instant: &KnownInstant<D>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<FirstFlow<D>> {
        let (placed, step) = (&instant.placed, instant.placed.state.last_step);
        let balls = &placed.touching;
        let memory = if step > 0.0 { wrenches_of(placed) } else { Wrenches::new() };
        let network = self.network(instant, step);
        let surfaces = instant.interactions.surfaces();
        let immersed = ImmersedBodies { domain: &placed.domain, balls, resistance: &network, surfaces: &surfaces, step };
        let mut contacts: Vec<Contact<D>> = memory.keys().map(|&identity| contact_again(placed, identity)).collect();
        contacts.sort_by_key(Contact::identity);
        let rounds = Rounds::<D, W>::new(immersed, contacts, &memory);
        let (solution, twists, wrenches) = self.flow_with_friction(instant, &rounds, step, self.tolerance_of(instant), effort, monitor)?;
        let wrenches = rounds.contacts.contacts.iter().map(Contact::identity).zip(wrenches).collect();
        let pushes = if instant.begins_on_springs() { Spring::pulled(&instant.springs, instant.pushes()) } else { instant.pushes() };
        let step_size = self.step_size(instant, &twists, &pushes)?;
        Ok(FirstFlow { solution, twists, wrenches, step_size })
    }

    /// Solves the flow with contacts held as rounds have them; gives the wrench of each on its partner.
    fn flow_with_friction<const W: usize>(
        &mut self,
        instant: &KnownInstant<D>,
        rounds: &Rounds<D, W>,
        step: f64,
        tolerance: f64,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<FrictionFlow<D>> {
        let held = rounds.contacts.rows(&rounds.held);
        let (rows, guess): (Vec<Row<D>>, Vec<f64>) = held.iter().map(|held| (held.row.clone(), held.guess)).unzip();
        let rows = FlowRows { rows: &rows, guess: &guess, pushes: &instant.pushes(), step, tolerance };
        let (solution, twists) = self.flow_with(instant, &rows, effort, monitor)?;
        let mut wrenches = vec![ContactWrench::zero(); rounds.contacts.contacts.len()];
        for (held, force) in held.iter().zip(&solution.contact_forces) {
            wrenches[held.contact] = wrenches[held.contact] + held.unit * *force;
        }
        Ok((solution, twists, wrenches))
    }
}

fn law_missed(time: f64, step: f64, residual: f64) -> Error {
    disagreement(time, step, &format!("the law of friction is missed by {residual:.1e}"))
}

/// By how much what was found misses the law.
fn missed_by<const D: usize>(found: &Agreed<D>) -> f64 {
    found.friction.map_or(f64::INFINITY, |report| report.residual)
}

/// Whether contacts are held alike.
fn are_like<const D: usize>(one: &[HeldContact<D>], other: &[HeldContact<D>]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(one, other)| one.is_like(other))
}
