//! A wall that a load presses on granular bodies: its velocity along its normal is one more unknown of the contacts of a step.
//!
//! The wall feels the load and its contacts, and no other force. It lets most bodies hang together, so every rank knows all of them, solves the same
//! problem and finds the same.

use std::time::Instant;

use nalgebra::SVector;

use super::{
    Granular,
    all_bodies::{AllBodies, all_twists},
    chains::GranularStep,
    pressed_wall::PressedWall,
    velocities,
};
use crate::{
    body::{Regions, Twist},
    contact::{ContactForce, KktReport, LoadedWall, Problem, ProblemShare, bodies_of, project_share},
    error::Result,
    friction::{FrictionShare, project_with_friction},
    geometry::Ball,
    motion::stepper::{Effort, StepOutcome},
    parallel::Peers,
    petsc::{Stage, enter},
    setup::{ContactHistory, State, WallMotion},
};

/// Motions of all bodies, the wall last, with the forces of contacts.
struct Pressed<const D: usize> {
    twists: Vec<Twist<D>>,
    forces: Vec<ContactForce<D>>,
    /// The sum of those on the wall and on what is fixed to it.
    on_wall: SVector<f64, D>,
    kkt_report: KktReport,
}

impl<const D: usize> Granular<D> {
    /// A step of bodies that want to move so, under the wall. Collective.
    pub(super) fn advance_under_load(
        &self,
        state: &State<D>,
        pressed: &PressedWall,
        wanted: &[Twist<D>],
        step: GranularStep,
    ) -> Result<StepOutcome<D>> {
        let (start, _stage) = (Instant::now(), enter(Stage::Contacts));
        let wall = state.wall.expect("a wall under a load has a place");
        let mut all = self.all_bodies(state, wanted, &velocities(wanted));
        all.press(pressed, &wall, step.push);
        let found = self.press(state, pressed, &all, step)?;
        let moves: Vec<Twist<D>> = state.numbers().iter().map(|&number| found.twists[number]).collect();
        let own = |force: &&ContactForce<D>| bodies_of(force.contact.identity()).any(|body| state.place(body).is_some());
        let contacts = [&self.known.contacts[..], &found.forces.iter().filter(own).copied().collect::<Vec<_>>()].concat();
        let velocity = found.twists[all.balls.len() - 1].velocity[wall.axis];
        Ok(StepOutcome {
            step: step.length,
            twists: moves.clone(),
            moves,
            contacts,
            adhesive_contacts: Vec::new(),
            kkt_report: Some(found.kkt_report),
            shear: state.shear,
            wall: Some(WallMotion { position: wall.position + velocity * step.length, velocity, force: found.on_wall, ..wall }),
            effort: Effort { contact: start.elapsed().as_secs_f64(), ..Effort::default() },
        })
    }

    /// The motions of all bodies and of the wall that contacts leave, and their forces.
    fn press(&self, state: &State<D>, pressed: &PressedWall, all: &AllBodies<D>, step: GranularStep) -> Result<Pressed<D>> {
        let wall = LoadedWall { axis: pressed.load.axis, place: all.balls.len() - 1, fixed: &pressed.load.fixed };
        let (weights, regions) = (all.masses.iter().map(|[mass, _]| mass / step.push).collect::<Vec<f64>>(), Regions::new(&self.domain, 1));
        let velocities = velocities(&all.twists);
        let problem = Problem { wall: Some(wall), ..Problem::new(&self.domain, &all.balls, &weights, &velocities, step.length) };
        let share = ProblemShare { problem, regions: &regions, spanning: (&self.session).into() };
        let history = state.whole_contact_history(self.session.world());
        let found = if self.interactions.friction().is_some() {
            self.press_with_friction(state, &share, all, &history, step.push)?
        } else {
            let memory = history.iter().map(|contact| (wall.of_body(contact.identity()), contact.force)).collect();
            let projection = project_share(Peers::Alone, &share, &memory)?.projection;
            let twists = all.twists.iter().zip(&projection.velocities).map(|(twist, &velocity)| Twist { velocity, ..*twist }).collect();
            Pressed { twists, forces: projection.forces, on_wall: SVector::zeros(), kkt_report: projection.kkt_report }
        };
        let forces = found.forces.iter().map(|force| ContactForce { contact: wall.of_box(force.contact), ..*force }).collect();
        let sign = |body: usize, sign: f64| if wall.carries(body) { sign } else { 0.0 };
        let on_wall = |force: &ContactForce<D>| {
            force.whole() * (force.contact.other().map_or(0.0, |other| sign(other, 1.0)) + sign(force.contact.body, -1.0))
        };
        Ok(Pressed { forces, on_wall: found.forces.iter().map(on_wall).sum(), ..found })
    }

    /// The same with friction.
    fn press_with_friction(
        &self,
        state: &State<D>,
        share: &ProblemShare<D>,
        all: &AllBodies<D>,
        history: &[ContactHistory<D>],
        duration: f64,
    ) -> Result<Pressed<D>> {
        let wall = share.problem.wall.expect("a load presses a wall");
        let memory = history.iter().map(|contact| (wall.of_body(contact.identity()), contact.force)).collect();
        let last = history.iter().map(|contact| (wall.of_body(contact.identity()), contact.tangential)).collect();
        let inertias: Vec<f64> = all.masses.iter().map(|[_, inertia]| *inertia).collect();
        let spins: Vec<_> = all.twists.iter().map(|twist| twist.spin).collect();
        let (surfaces, tolerance) = (&self.interactions.surfaces(), self.friction_tolerance());
        let starts = self.starts_with_wall(state, wall.axis);
        let friction = FrictionShare { surfaces, starts: &starts, spins: &spins, inertias: &inertias, duration, tolerance, last: &last };
        let found = project_with_friction(Peers::Alone, share, &friction, &memory)?;
        let twists = found.velocities.iter().zip(&found.spins).map(|(&velocity, &spin)| Twist { velocity, spin }).collect();
        Ok(Pressed { twists, forces: found.forces, on_wall: SVector::zeros(), kkt_report: found.kkt_report })
    }
}

impl<const D: usize> Granular<D> {
    /// Motions of all bodies at the start of a step, and that of the wall, across this axis. Collective.
    fn starts_with_wall(&self, state: &State<D>, axis: usize) -> Vec<Twist<D>> {
        let velocity = state.wall.map_or(0.0, |wall| wall.velocity);
        let wall = Twist { velocity: SVector::from_fn(|other, _| if other == axis { velocity } else { 0.0 }), ..Twist::zero() };
        [all_twists(self.peers(), state, &state.twists()), vec![wall]].concat()
    }
}

impl<const D: usize> AllBodies<D> {
    /// Adds the wall, with the velocity that the load alone gives it, and lets it carry the bodies that are fixed to it.
    fn press(&mut self, pressed: &PressedWall, wall: &WallMotion<D>, push: f64) {
        let (velocity, mass) = (pressed.wanted(wall, push), [pressed.load.mass, f64::INFINITY]);
        let along = |value: f64| SVector::from_fn(|axis, _| if axis == wall.axis { value } else { 0.0 });
        for &body in &pressed.load.fixed {
            self.masses[body] = mass;
            self.twists[body].velocity[wall.axis] = velocity;
        }
        self.balls.push(Ball { center: along(wall.position), radius: f64::INFINITY });
        self.masses.push(mass);
        self.twists.push(Twist { velocity: along(velocity), ..Twist::zero() });
    }
}
