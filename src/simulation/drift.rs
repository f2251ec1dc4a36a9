//! Bodies carried by Stokes flow: their velocities follow from their places, contact forces included.
//!
//! Contacts act in the flow: the contact model says who touches and presses, from velocities in unbounded fluid; the
//! coupled system finds the forces that keep just these from approaching; both are repeated until they agree
//! ([`Drift::agree`]). If they should go round in circles, one contact after the other is changed, the first one that is
//! wrong (the least-index rule of Murty 1974, which ends for any positive definite mobility). Then bodies travel by the
//! two-step rule `v + dt/(2 dt_last) (v - v_last)`, the midpoint rule or Euler's, and what the rule adds to `v` is
//! projected once more, so that nothing overlaps whatever the step. The contact forces press on in this projection: else
//! bodies that landed in the last step would bounce, as the rule looks back at the velocity with which they came.
//!
//! Gluey contacts may pull as much as takes their memory back: those that are held are unknowns as above, with forces of any
//! sign; those that let go in the step pull with a known force, and act as the forces of a repulsion do.

use std::{collections::HashMap, time::Instant};

use nalgebra::SVector;

use super::{
    Dynamics, Effort, FlowSolver, Held, Moment, Moving, Past, Seen, Solution, State, Travel, View,
    pace::{Pace, Stride, Urge},
    rounds::Rounds,
};
use crate::{
    body::Twist,
    contact::{self, Certificate, Contact, ContactForce, Law, Partner, Problem, Projection, gluey, pushes},
    error::{Error, Result},
    geometry::{Ball, Domain, near_pairs, near_walls},
    petsc::{Session, Stage, enter},
    scene::Scheme,
};

/// Rounds that flow and contacts are given to agree.
const MOST_ROUNDS: usize = 60;

/// Difference between the velocities by the flow and by the contact model, over the largest ([`fastest`]), that counts as agreement,
/// unless the flow is solved to less. Films at roughness resist a million times more than bodies alone, and let velocities be known less well.
const AGREEMENT: f64 = 1e-5;
const AGREEMENT_IN_FILMS: f64 = 1e-4;

/// Gap, in radii, up to which a contact of the last step is tried first.
const MEMORY_REACH: f64 = 0.1;

/// Overlap, in radii, at which a run without a law of contact ends.
const OVERLAP: f64 = 1e-6;

/// The same under a repulsion, which gives way a little.
const SOFT_OVERLAP: f64 = 0.02;

/// Part of a force that is rounding.
const ROUNDING: f64 = 1e-12;

/// Bodies carried by Stokes flow.
pub struct Drift<const D: usize> {
    session: Session,
    suspension: Box<dyn FlowSolver<D>>,
    pace: Pace,
    /// The law of contact.
    law: Law,
    /// Force that gives each body a unit velocity in unbounded fluid; none without a law of contact.
    weights: Vec<f64>,
}

/// Where bodies are, and the contacts that may pull, with the least force of each.
type Crowd<'a, const D: usize> = (&'a Domain<D>, &'a [Ball<D>], &'a [ContactForce<D>]);

/// Velocities on which flow and contacts agree.
struct Agreed<const D: usize> {
    solution: Solution<D>,
    twists: Vec<Twist<D>>,
    contacts: Vec<ContactForce<D>>,
    stride: Stride,
}

impl<const D: usize> Drift<D> {
    /// Bodies of a suspension that move at a pace, under a law of contact with the force that gives each a unit velocity in unbounded fluid.
    pub fn new(session: &Session, mut suspension: Box<dyn FlowSolver<D>>, pace: Pace, (law, weights): (Law, Vec<f64>)) -> Drift<D> {
        suspension.remember(None);
        Drift { session: session.clone(), suspension, pace, law, weights }
    }

    fn balls(&self, state: &State<D>) -> Vec<Ball<D>> {
        state.balls(&self.pace.radii)
    }

    /// The box in a state.
    fn domain(&self, state: &State<D>) -> Domain<D> {
        self.suspension.setup().domain.clone().at(state.time)
    }

    /// What bodies that move so do to each other: where images slide, without what all take part in, but with what that does to neighbours.
    fn felt(&self, state: &State<D>, twists: &[Twist<D>]) -> Vec<SVector<f64, D>> {
        let domain = &self.suspension.setup().domain;
        let strain = domain.shear_rate().abs();
        let felt = |((body, twist), radius): ((&Moving<D>, &Twist<D>), &f64)| {
            let own = twist.velocity - domain.carried(&body.center);
            if strain > 0.0 { SVector::from_fn(|axis, _| if axis == 0 { own.norm() + strain * radius } else { 0.0 }) } else { own }
        };
        state.bodies.iter().zip(twists).zip(&self.pace.radii).map(felt).collect()
    }

    /// Solves the flow with contacts that keep gaps open over the step to come.
    fn agree(&mut self, state: &State<D>, effort: &mut Effort, seen: Seen) -> Result<Agreed<D>> {
        let (balls, centers) = (self.balls(state), state.centers());
        let domain = self.domain(state);
        self.refuse_overlap(&domain, &balls, state.time)?;
        if !self.projects() {
            return self.with_known_forces(state, &balls, effort, seen);
        }
        let mut pressed = self.expected(state, &balls)?;
        let (mut chosen, mut step, mut difference) = (None, state.last_step, 0.0);
        let agreement = if self.suspension.setup().lubrication.is_some() { AGREEMENT_IN_FILMS } else { AGREEMENT };
        let tightest = self.suspension.setup().tolerance.at_an_instant();
        let mut tolerance = self.suspension.setup().tolerance.in_a_step(self.travelled(state));
        let mut rounds = Rounds::new();
        for _ in 0..MOST_ROUNDS {
            let loose = loose(self.floors(state, &balls, step), &pressed);
            let pushes = pushes(balls.len(), loose.iter().copied());
            let moment = Moment { centers: &centers, time: state.time, pressed: &pressed, step, pushes: &pushes, tolerance };
            let mut solution = self.suspension.solve_at(&moment, seen)?;
            effort.add_solve(self.suspension.cost());
            let mut twists: Vec<Twist<D>> = solution.bodies.iter().map(|body| body.twist).collect();
            let stride = *chosen.get_or_insert_with(|| self.pace.next(&urges(self.felt(state, &twists)), state.time, state.last_step));
            let start = Instant::now();
            // not the length, which the end of the run cuts short: a run that ends later must find the same
            step = if stride.natural > 0.0 { stride.natural } else { state.last_step };
            pressed.iter_mut().zip(&solution.contact_forces).for_each(|(pressed, force)| pressed.force = *force);
            let unpressed = self.without_contacts(velocities(&twists), pressed.iter().chain(&loose));
            let floors = self.floors(state, &balls, step);
            let projection = self.project((&domain, &balls, &floors), &unpressed, step)?;
            effort.contact += start.elapsed().as_secs_f64();
            let scale = fastest(&twists, &unpressed);
            let apart = largest_difference(&twists, &projection.velocities);
            difference = apart / scale;
            if difference <= agreement.max(tolerance) {
                for ((twist, body), velocity) in twists.iter_mut().zip(&mut solution.bodies).zip(&projection.velocities) {
                    (twist.velocity, body.twist.velocity) = (*velocity, *velocity);
                }
                return Ok(Agreed { solution, twists, contacts: projection.forces, stride });
            }
            let projected = closed(projection, &floors);
            if identities(&projected) == identities(&pressed) {
                // what is left of the residual may be what they differ by
                tolerance = tightest.max(0.1 * tolerance);
            }
            let with_one_changed = |tried| self.with_one_changed(tried, (&domain, &balls, &floors), (&velocities(&twists), scale), step);
            pressed = rounds.next((apart, pressed), projected, with_one_changed);
        }
        Err(Error::Diverged(format!(
            "at time {} flow and contacts do not agree after {MOST_ROUNDS} rounds (velocities differ by {difference:.1e}); \
             a shorter time.step or a finer grid may help",
            state.time
        )))
    }

    /// Whether contact forces are found by projections, as a law has it that lets nothing overlap.
    fn projects(&self) -> bool {
        matches!(self.law, Law::Inelastic | Law::Gluey { .. })
    }

    /// Solves the flow once: contact forces follow from the places of bodies, or there are none.
    fn with_known_forces(&mut self, state: &State<D>, balls: &[Ball<D>], effort: &mut Effort, seen: Seen) -> Result<Agreed<D>> {
        let contacts = match self.law {
            Law::Repulsion(repulsion) => repulsion.forces(&self.domain(state), balls, &self.weights),
            _ => Vec::new(),
        };
        let (centers, pushes) = (state.centers(), pushes(balls.len(), contacts.iter().copied()));
        let tolerance = self.suspension.setup().tolerance.in_a_step(self.travelled(state));
        let moment = Moment { centers: &centers, time: state.time, pressed: &[], step: state.last_step, pushes: &pushes, tolerance };
        let solution = self.suspension.solve_at(&moment, seen)?;
        effort.add_solve(self.suspension.cost());
        let twists: Vec<Twist<D>> = solution.bodies.iter().map(|body| body.twist).collect();
        let stride = self.pace.next(&urges(self.felt(state, &twists)), state.time, state.last_step);
        Ok(Agreed { solution, twists, contacts, stride })
    }

    /// The contacts that stick, each with the least force that it may bear for a step.
    fn floors(&self, state: &State<D>, balls: &[Ball<D>], step: f64) -> Vec<ContactForce<D>> {
        let viscosity = self.suspension.setup().viscosity;
        gluey::floors((&self.domain(state), balls), &state.stuck, step, |_| viscosity)
    }

    /// The contacts that stick after a step with these forces.
    fn remembered(&self, forces: &[ContactForce<D>], state: &State<D>, step: f64) -> Vec<gluey::Stuck<D>> {
        let Law::Gluey { least } = self.law else { return Vec::new() };
        gluey::remembered(forces, &state.stuck, (step, least), |_| self.suspension.setup().viscosity)
    }

    /// The longest way of the last step, in radii of the body that went it.
    fn travelled(&self, state: &State<D>) -> f64 {
        let last: Vec<Twist<D>> = state.bodies.iter().map(|body| body.twist).collect();
        let ways = self.felt(state, &last).into_iter().zip(&self.pace.radii).map(|(velocity, radius)| velocity.norm() / radius);
        state.last_step * ways.fold(0.0, f64::max)
    }

    /// The contacts that press now if bodies want to go on as in the last step. With films, which slow bodies down as gaps close, those that
    /// pressed then.
    fn expected(&self, state: &State<D>, balls: &[Ball<D>]) -> Result<Vec<ContactForce<D>>> {
        if state.last_step == 0.0 {
            return Ok(Vec::new());
        }
        let reach = MEMORY_REACH * self.pace.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let forces: HashMap<_, f64> = state.held.iter().map(|held| (held.identity(), held.force)).collect();
        let domain = self.domain(state);
        let near = contact::candidates(&domain, balls, &self.weights, reach);
        let pressed = |contact: Contact<D>| forces.get(&contact.identity()).map(|&force| ContactForce { contact, force });
        let mut held: Vec<ContactForce<D>> = near.into_iter().filter_map(pressed).collect();
        let floors = self.floors(state, balls, state.last_step);
        if self.suspension.setup().lubrication.is_some() {
            held.retain(|held| held.force > (1.0 - ROUNDING) * least(&floors, &held.contact));
            return Ok(held);
        }
        let velocities = state.bodies.iter().map(|body| body.twist.velocity).collect();
        let unpressed = self.without_contacts(velocities, &held);
        Ok(closed(self.project((&domain, balls, &floors), &unpressed, state.last_step)?, &floors))
    }

    /// The same contacts but for the first that pulls more than it may, which goes, or that is not held and closes too far, which comes.
    fn with_one_changed(
        &self,
        mut pressed: Vec<ContactForce<D>>,
        (domain, balls, floors): Crowd<D>,
        (velocities, fastest): (&[SVector<f64, D>], f64),
        step: f64,
    ) -> Vec<ContactForce<D>> {
        let slack = AGREEMENT * fastest;
        for contact in contact::candidates(domain, balls, &self.weights, 2.0 * fastest * step) {
            match pressed.iter().position(|pressed| pressed.contact.identity() == contact.identity()) {
                Some(place) if pressed[place].force < least(floors, &contact) - slack * self.softest(&contact) => {
                    pressed.remove(place);
                    return pressed;
                }
                None if contact.opening(velocities) < -contact.gap / step - slack => {
                    pressed.push(ContactForce { contact, force: 0.0 });
                    return pressed;
                }
                _ => {}
            }
        }
        pressed
    }

    /// The velocities that bodies would have without the contact forces, if each were alone but for the film that bears most of a force.
    fn without_contacts<'a>(
        &self,
        mut velocities: Vec<SVector<f64, D>>,
        pressed: impl IntoIterator<Item = &'a ContactForce<D>>,
    ) -> Vec<SVector<f64, D>> {
        for ContactForce { contact, force } in pressed {
            let push = contact.normal * (*force * self.felt_part(contact));
            velocities[contact.body] += push / self.weights[contact.body];
            if let Some(other) = contact.other() {
                velocities[other] -= push / self.weights[other];
            }
        }
        velocities
    }

    /// The part of a contact force that moves the two as if each were alone: their film resists the rest.
    fn felt_part(&self, contact: &Contact<D>) -> f64 {
        let mobility = 1.0 / self.weights[contact.body] + contact.other().map_or(0.0, |other| 1.0 / self.weights[other]);
        self.suspension.film_resistance(contact).map_or(1.0, |resistance| 1.0 / (1.0 + resistance * mobility))
    }

    /// Force that moves the more mobile end of a contact at unit velocity.
    fn softest(&self, contact: &Contact<D>) -> f64 {
        contact.other().map_or(f64::INFINITY, |other| self.weights[other]).min(self.weights[contact.body])
    }

    /// The projection of velocities, with the forces that cause it between bodies with these films.
    fn project(&self, (domain, balls, floors): Crowd<D>, velocities: &[SVector<f64, D>], step: f64) -> Result<Projection<D>> {
        let _stage = enter(Stage::Contacts);
        let felt = |floor: &ContactForce<D>| ContactForce { force: floor.force * self.felt_part(&floor.contact), ..*floor };
        let floors: Vec<ContactForce<D>> = floors.iter().map(felt).collect();
        let problem = Problem { domain, balls, weights: &self.weights, velocities, step, floors: &floors };
        let mut projection = contact::project(self.session.world(), &problem)?;
        projection.forces.iter_mut().for_each(|pressed| pressed.force /= self.felt_part(&pressed.contact));
        projection.certificate.total_force = projection.forces.iter().map(|pressed| pressed.force).sum();
        Ok(projection)
    }

    /// Without a law of contact nothing keeps bodies apart, and a repulsion may be too soft: where they overlap, a flow has no meaning.
    fn refuse_overlap(&self, domain: &Domain<D>, balls: &[Ball<D>], time: f64) -> Result<()> {
        if self.projects() {
            return Ok(());
        }
        let pairs = near_pairs(domain, balls, 0.0).into_iter().map(|pair| (pair.first, pair.gap));
        let walls = near_walls(domain, balls, 0.0).into_iter().map(|pair| (pair.body, pair.gap));
        let (overlap, remedy) = match self.law {
            Law::Repulsion(_) => (SOFT_OVERLAP, "raise contact.stiffness or contact.range"),
            _ => (OVERLAP, "set contact.model = \"inelastic\" or a shorter time.step"),
        };
        match pairs.chain(walls).find(|&(body, gap)| gap < -overlap * balls[body].radius) {
            Some((body, gap)) => {
                Err(Error::Diverged(format!("at time {time} body {body} overlaps another or a wall by {:.1e}; {remedy}", -gap)))
            }
            None => Ok(()),
        }
    }

    /// The motions by which bodies travel before contacts are kept.
    fn rule(&mut self, state: &State<D>, view: &View<D>, effort: &mut Effort, seen: Seen) -> Result<Vec<Twist<D>>> {
        match self.pace.time.scheme {
            Scheme::Euler => Ok(view.twists.clone()),
            Scheme::TwoStep if state.last_step > 0.0 => Ok(two_step(state, view, self.projects())),
            _ => self.midpoint(state, view, effort, seen),
        }
    }

    /// Motions half a step ahead.
    fn midpoint(&mut self, state: &State<D>, view: &View<D>, effort: &mut Effort, seen: Seen) -> Result<Vec<Twist<D>>> {
        let half = 0.5 * view.stride.length;
        let mut ahead = state.clone();
        ahead.advance(&view.twists, half);
        ahead.held = view.contacts.iter().map(Held::of).collect();
        ahead.stuck = self.remembered(&view.contacts, state, half);
        Ok(self.agree(&ahead, effort, seen)?.twists)
    }
}

impl<const D: usize> Dynamics<D> for Drift<D> {
    fn look(&mut self, state: &State<D>, seen: Seen) -> Result<View<D>> {
        let mut effort = Effort::default();
        let Agreed { mut solution, twists, contacts, stride } = self.agree(state, &mut effort, seen)?;
        let domain = self.domain(state);
        for (body, moving) in solution.bodies.iter_mut().zip(&state.bodies) {
            // centres of solutions are in the box: so are the motions that go with them
            body.twist.velocity -= domain.image_velocity(&moving.center);
        }
        Ok(View { twists, contacts, solution: Some(solution), stride, effort })
    }

    fn travel(&mut self, state: &State<D>, view: &View<D>, seen: Seen) -> Result<Travel<D>> {
        let mut effort = Effort::default();
        let mut moves = self.rule(state, view, &mut effort, seen)?;
        let velocities = velocities(&moves);
        let step = self.pace.shortened(&self.felt(state, &moves), view.stride.length, state.last_step);
        let (mut stuck, mut certificate) = (Vec::new(), None);
        if self.projects() {
            let (start, balls) = (Instant::now(), self.balls(state));
            let domain = self.domain(state);
            let unpressed = self.without_contacts(velocities, &view.contacts);
            let projection = self.project((&domain, &balls, &self.floors(state, &balls, step)), &unpressed, step)?;
            stuck = self.remembered(&projection.forces, state, step);
            moves.iter_mut().zip(projection.velocities).for_each(|(twist, velocity)| twist.velocity = velocity);
            certificate = Some(projection.certificate);
            effort.contact += start.elapsed().as_secs_f64();
        } else if self.law != Law::None {
            certificate = Some(Certificate::of_forces(&view.contacts, &self.balls(state)));
        }
        Ok(Travel { step, moves, twists: view.twists.clone(), contacts: view.contacts.clone(), stuck, certificate, effort })
    }

    fn suspension(&self) -> Option<&dyn FlowSolver<D>> {
        Some(self.suspension.as_ref())
    }

    fn remember(&mut self, past: Past<D>) {
        self.suspension.remember(Some(past));
    }
}

/// `v + dt/(2 dt_last) (v - v_last)`; bodies that came into contact or out of it since the last step do not look back, if contact
/// forces `jump`.
fn two_step<const D: usize>(state: &State<D>, view: &View<D>, jump: bool) -> Vec<Twist<D>> {
    let now: Vec<Held<D>> = view.contacts.iter().filter(|pressed| pressed.force != 0.0).map(Held::of).collect();
    let (before, after) = (contacts_of(&state.held, state.bodies.len()), contacts_of(&now, state.bodies.len()));
    let factor = 0.5 * view.stride.length / state.last_step;
    let rule = |(body, (now, last)): (usize, (&Twist<D>, &Twist<D>))| {
        if jump && before[body] != after[body] {
            return *now;
        }
        Twist { velocity: now.velocity + (now.velocity - last.velocity) * factor, spin: now.spin + (now.spin - last.spin) * factor }
    };
    view.twists.iter().zip(state.bodies.iter().map(|body| &body.twist)).enumerate().map(rule).collect()
}

/// For each body its contacts, seen from it.
fn contacts_of<const D: usize>(held: &[Held<D>], bodies: usize) -> Vec<Vec<(Partner, [i32; D])>> {
    let mut of_body = vec![Vec::new(); bodies];
    for contact in held {
        of_body[contact.body].push((contact.partner, contact.image));
        if let Partner::Body(partner) = contact.partner {
            of_body[partner].push((Partner::Body(contact.body), contact.image.map(|image| -image)));
        }
    }
    of_body.iter_mut().for_each(|contacts| contacts.sort_unstable());
    of_body
}

fn urges<const D: usize>(velocities: Vec<SVector<f64, D>>) -> Vec<Urge<D>> {
    velocities.into_iter().map(|velocity| Urge { velocity, acceleration: SVector::zeros() }).collect()
}

fn velocities<const D: usize>(twists: &[Twist<D>]) -> Vec<SVector<f64, D>> {
    twists.iter().map(|twist| twist.velocity).collect()
}

/// The contacts of a projection that are held closed: they bear more than the least force that they may.
fn closed<const D: usize>(mut projection: Projection<D>, floors: &[ContactForce<D>]) -> Vec<ContactForce<D>> {
    projection.forces.retain(|pressed| pressed.force > (1.0 - ROUNDING) * least(floors, &pressed.contact));
    projection.forces
}

/// Who touches whom.
fn identities<const D: usize>(contacts: &[ContactForce<D>]) -> Vec<contact::Identity<D>> {
    let mut identities: Vec<_> = contacts.iter().map(|pressed| pressed.contact.identity()).collect();
    identities.sort_unstable();
    identities
}

/// The contacts that stick but are not held: they pull as they let go.
fn loose<const D: usize>(mut floors: Vec<ContactForce<D>>, pressed: &[ContactForce<D>]) -> Vec<ContactForce<D>> {
    floors.retain(|floor| !pressed.iter().any(|pressed| pressed.contact.identity() == floor.contact.identity()));
    floors
}

/// The least force that a contact may bear.
fn least<const D: usize>(floors: &[ContactForce<D>], contact: &Contact<D>) -> f64 {
    let found = floors.binary_search_by_key(&contact.identity(), |floor| floor.contact.identity());
    found.map_or(0.0, |place| floors[place].force)
}

/// Largest velocity, with contact forces or without them: where they hold bodies at rest, only what they resist tells how
/// small a velocity is.
fn fastest<const D: usize>(twists: &[Twist<D>], unpressed: &[SVector<f64, D>]) -> f64 {
    twists.iter().map(|twist| &twist.velocity).chain(unpressed).map(|velocity| velocity.norm()).fold(f64::MIN_POSITIVE, f64::max)
}

/// Largest difference of velocities.
fn largest_difference<const D: usize>(twists: &[Twist<D>], velocities: &[SVector<f64, D>]) -> f64 {
    twists.iter().zip(velocities).map(|(twist, velocity)| (twist.velocity - velocity).norm()).fold(0.0, f64::max)
}
