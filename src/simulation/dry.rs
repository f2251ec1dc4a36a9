//! Bodies without a fluid: inertia, gravity, and contacts (Moreau's time stepping).
//!
//! Velocities live half way between places: `v' = P(v + k f/m)`, `x' = x + dt v'`, with the projection `P` of the contact
//! model and `k` the mean of the last step and this one, which makes free flight exact under a constant force. With the
//! scheme `euler`, `k = dt`: the scheme of Maury (2006, doi:10.1007/s00211-005-0666-6) as published.

use std::time::Instant;

use nalgebra::{SMatrix, SVector};

use super::{
    Dynamics, Effort, Seen, State, Travel, View,
    pace::{Pace, Urge},
    placement::{bodies, domain, vector},
};
use crate::{
    body::{Motion, Twist, skew},
    contact::{self, Problem},
    error::{Error, Result},
    geometry::Domain,
    petsc::{Session, Stage, enter},
    scene::{ContactModel, Scene, Scheme},
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
    /// Whether they notice each other and the walls.
    pub contact: bool,
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
        let bodies = bodies(scene, &domain)?.into_iter().map(of_group).collect();
        Ok(DrySetup { domain, bodies, contact: scene.contact.model == ContactModel::Inelastic })
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
}

impl<const D: usize> Dynamics<D> for Dry<D> {
    fn look(&mut self, state: &State<D>, _: Seen) -> Result<View<D>> {
        let twists: Vec<Twist<D>> = state.bodies.iter().map(|body| body.twist).collect();
        let urges: Vec<Urge<D>> = twists
            .iter()
            .zip(&self.setup.bodies)
            // velocities live half a step before places
            .map(|(twist, body)| Urge {
                velocity: twist.velocity + body.acceleration * (0.5 * state.last_step),
                acceleration: body.acceleration,
            })
            .collect();
        let stride = self.pace.next(&urges, state.time, state.last_step);
        Ok(View { twists, contacts: Vec::new(), solution: None, stride, effort: Effort::default() })
    }

    fn travel(&mut self, state: &State<D>, view: &View<D>, _: Seen) -> Result<Travel<D>> {
        let (start, step) = (Instant::now(), view.stride.length);
        let push = self.push(state.last_step, step);
        let pushed = |(twist, body): (&Twist<D>, &DryBody<D>)| Twist {
            velocity: twist.velocity + body.acceleration * push,
            spin: twist.spin + body.spin_up * push,
        };
        let mut moves: Vec<Twist<D>> = view.twists.iter().zip(&self.setup.bodies).map(pushed).collect();
        let (mut contacts, mut certificate) = (Vec::new(), None);
        if self.setup.contact {
            let _stage = enter(Stage::Contacts);
            let balls = state.balls(&self.pace.radii);
            let weights: Vec<f64> = self.setup.bodies.iter().map(|body| body.mass / step).collect();
            let velocities: Vec<SVector<f64, D>> = moves.iter().map(|twist| twist.velocity).collect();
            let problem = Problem { domain: &self.setup.domain, balls: &balls, weights: &weights, velocities: &velocities, step };
            let projection = contact::project_from(self.session.world(), &problem, &state.memory())?;
            moves.iter_mut().zip(projection.velocities).for_each(|(twist, velocity)| twist.velocity = velocity);
            (contacts, certificate) = (projection.forces, Some(projection.certificate));
        } else {
            self.refuse_outside(state)?;
        }
        let effort = Effort { contact: start.elapsed().as_secs_f64(), ..Effort::default() };
        Ok(Travel { step, twists: moves.clone(), moves, contacts, certificate, effort })
    }
}
