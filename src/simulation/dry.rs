//! Bodies without a fluid: inertia, gravity, and contacts (Moreau's time stepping).
//!
//! Velocities live half way between places: `v' = P(v + k f/m)`, `x' = x + dt v'`, with the projection `P` of the contact
//! model and `k` the mean of the last step and this one, which makes free flight exact under a constant force. With the
//! scheme `euler`, `k = dt`: the scheme of Maury (2006, doi:10.1007/s00211-005-0666-6) as published.

use std::time::Instant;

use nalgebra::{SMatrix, SVector};

use super::{
    Dynamics, Effort, Seen, State, Travel, View, law,
    pace::{Pace, Urge},
    placement::{bodies, domain, vector},
};
use crate::{
    body::{Motion, Twist, skew},
    contact::{self, Certificate, ContactForce, Law, Problem, Projection, Repulsion, gluey, pushes},
    error::{Error, Result},
    geometry::Domain,
    petsc::{Session, Stage, enter},
    scene::{Scene, Scheme},
};

/// A body without a fluid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DryBody<const D: usize> {
    /// Radius.
    pub radius: f64,
    /// Place at the start.
    pub center: SVector<f64, D>,
    /// Motion at the start, and for ever if nothing can change it.
    pub twist: Twist<D>,
    /// Mass, infinite if its motion is given.
    pub mass: f64,
    /// Moment of inertia.
    pub inertia: f64,
    /// Acceleration by the forces on it besides contacts.
    pub acceleration: SVector<f64, D>,
    /// The same of its spin.
    pub spin_up: SMatrix<f64, D, D>,
}

/// A dry scene resolved in its dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct DrySetup<const D: usize> {
    /// The box.
    pub domain: Domain<D>,
    /// The bodies.
    pub bodies: Vec<DryBody<D>>,
    /// How they notice each other and the walls.
    pub contact: Law,
}

/// Dry bodies in motion.
pub struct Dry<const D: usize> {
    session: Session,
    setup: DrySetup<D>,
    pace: Pace,
}

impl<const D: usize> DrySetup<D> {
    /// Resolves a dry scene of dimension `D`.
    ///
    /// # Errors
    /// Bodies overlap or lie outside, or do not fit at the asked fraction.
    pub fn of(scene: &Scene) -> Result<DrySetup<D>> {
        let domain = domain(scene);
        let of_group = |(group, body): (usize, crate::body::Body<D>)| {
            let given = &scene.bodies[group];
            let start = Twist {
                velocity: given.velocity.as_deref().map_or(SVector::zeros(), vector::<D>),
                spin: given.spin.as_deref().map_or(SMatrix::zeros(), skew::<D>),
            };
            let mass = given.density * body.ball.volume();
            // of a homogeneous disk, 1/2 m r^2, and of a sphere, 2/5 m r^2
            let inertia = mass * body.ball.radius.powi(2) * 2.0 / (D + 2) as f64;
            let (center, radius) = (body.ball.center, body.ball.radius);
            match body.motion {
                Motion::Free { force, torque } => {
                    DryBody { radius, center, twist: start, mass, inertia, acceleration: force / mass, spin_up: torque / inertia }
                }
                Motion::Prescribed(twist) => DryBody {
                    radius,
                    center,
                    twist,
                    mass: f64::INFINITY,
                    inertia: f64::INFINITY,
                    acceleration: SVector::zeros(),
                    spin_up: SMatrix::zeros(),
                },
            }
        };
        let bodies: Vec<DryBody<D>> = bodies(scene, &domain)?.into_iter().map(of_group).collect();
        let setup = DrySetup { contact: law::of_dry(scene.contact.model, &domain, &bodies), domain, bodies };
        law::check(scene, setup.contact, setup.longest_step())?;
        Ok(setup)
    }

    /// The longest step with which contact is stable; infinite if it limits none.
    pub fn longest_step(&self) -> f64 {
        law::longest_dry_step(self.contact, &self.bodies)
    }

    /// The bodies at the start.
    pub fn start(&self) -> State<D> {
        State::start(self.bodies.iter().map(|body| (body.center, body.twist)))
    }
}

impl<const D: usize> Dry<D> {
    /// Dry bodies that move at a pace.
    pub fn new(session: &Session, setup: DrySetup<D>, pace: Pace) -> Dry<D> {
        Dry { session: session.clone(), setup, pace }
    }

    /// Without a contact model bodies notice no walls: a run in which they leave the box has no meaning.
    fn refuse_outside(&self, state: &State<D>) -> Result<()> {
        for (number, body) in state.bodies.iter().enumerate() {
            for axis in (0..D).filter(|&axis| !self.setup.domain.periodic(axis)) {
                if !(0.0..=self.setup.domain.size[axis]).contains(&body.center[axis]) {
                    let (name, time) = (["x", "y", "z"][axis], state.time);
                    return Err(Error::Diverged(format!(
                        "at time {time} body {number} has left the box along {name}; set contact.model = \"inelastic\" or an earlier time.end"
                    )));
                }
            }
        }
        Ok(())
    }

    /// Over how long forces act on velocities in a step.
    fn push(&self, last_step: f64, step: f64) -> f64 {
        match self.pace.time.scheme {
            Scheme::Euler => step,
            _ => 0.5 * (last_step + step),
        }
    }

    fn masses(&self) -> Vec<f64> {
        self.setup.bodies.iter().map(|body| body.mass).collect()
    }

    /// The impulse of a memory of one: the mass with which a gap resists being opened.
    fn reduced_mass(&self, contact: &contact::Contact<D>) -> f64 {
        let inverse = |body: usize| 1.0 / self.setup.bodies[body].mass;
        1.0 / (inverse(contact.body) + contact.other().map_or(0.0, inverse))
    }

    /// The forces of a repulsion, and the accelerations by all forces.
    fn repelled(&self, repulsion: &Repulsion, state: &State<D>) -> (Vec<ContactForce<D>>, Vec<SVector<f64, D>>) {
        let forces = repulsion.forces(&self.setup.domain, &state.balls(&self.pace.radii), &self.masses());
        let pushes = pushes(self.setup.bodies.len(), forces.iter().copied());
        let accelerations = self.setup.bodies.iter().zip(pushes).map(|(body, push)| body.acceleration + push / body.mass).collect();
        (forces, accelerations)
    }

    /// Accelerations by all forces but those that a projection finds.
    fn accelerations(&self, state: &State<D>) -> Vec<SVector<f64, D>> {
        match &self.setup.contact {
            Law::Repulsion(repulsion) => self.repelled(repulsion, state).1,
            _ => self.setup.bodies.iter().map(|body| body.acceleration).collect(),
        }
    }

    /// Velocities that keep contacts, next to those wanted.
    fn project(&self, state: &State<D>, moves: &[Twist<D>], step: f64) -> Result<Projection<D>> {
        let (_stage, domain, balls) = (enter(Stage::Contacts), &self.setup.domain, state.balls(&self.pace.radii));
        let weights: Vec<f64> = self.masses().iter().map(|mass| mass / step).collect();
        let velocities: Vec<SVector<f64, D>> = moves.iter().map(|twist| twist.velocity).collect();
        let floors = gluey::floors((domain, &balls), &state.stuck, step, |contact| self.reduced_mass(contact));
        let problem = Problem { domain, balls: &balls, weights: &weights, velocities: &velocities, step, floors: &floors };
        contact::project_from(self.session.world(), &problem, &state.memory())
    }
}

impl<const D: usize> Dynamics<D> for Dry<D> {
    fn look(&mut self, state: &State<D>, _: Seen) -> Result<View<D>> {
        let twists: Vec<Twist<D>> = state.bodies.iter().map(|body| body.twist).collect();
        let urges: Vec<Urge<D>> = twists
            .iter()
            .zip(self.accelerations(state))
            // velocities live half a step before places
            .map(|(twist, acceleration)| Urge { velocity: twist.velocity + acceleration * (0.5 * state.last_step), acceleration })
            .collect();
        let stride = self.pace.next(&urges, state.time, state.last_step);
        Ok(View { twists, contacts: Vec::new(), solution: None, stride, effort: Effort::default() })
    }

    fn travel(&mut self, state: &State<D>, view: &View<D>, _: Seen) -> Result<Travel<D>> {
        let (start, step) = (Instant::now(), view.stride.length);
        let push = self.push(state.last_step, step);
        let pushed = |((twist, body), acceleration): ((&Twist<D>, &DryBody<D>), SVector<f64, D>)| Twist {
            velocity: twist.velocity + acceleration * push,
            spin: twist.spin + body.spin_up * push,
        };
        let mut moves: Vec<Twist<D>> = view.twists.iter().zip(&self.setup.bodies).zip(self.accelerations(state)).map(pushed).collect();
        let (mut contacts, mut stuck, mut certificate) = (Vec::new(), Vec::new(), None);
        match self.setup.contact {
            Law::None => self.refuse_outside(state)?,
            Law::Repulsion(repulsion) => {
                contacts = self.repelled(&repulsion, state).0;
                certificate = Some(Certificate::of_forces(&contacts, &state.balls(&self.pace.radii)));
            }
            law @ (Law::Inelastic | Law::Gluey { .. }) => {
                let projection = self.project(state, &moves, step)?;
                moves.iter_mut().zip(&projection.velocities).for_each(|(twist, velocity)| twist.velocity = *velocity);
                if let Law::Gluey { least } = law {
                    stuck = gluey::remembered(&projection.forces, &state.stuck, (step, least), |contact| self.reduced_mass(contact));
                }
                (contacts, certificate) = (projection.forces, Some(projection.certificate));
            }
        }
        let effort = Effort { contact: start.elapsed().as_secs_f64(), ..Effort::default() };
        Ok(Travel { step, twists: moves.clone(), moves, contacts, stuck, certificate, effort })
    }
}
