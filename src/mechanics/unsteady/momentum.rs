//! The momentum of bodies in a step.
//!
//! As the fluid inside moves along, a body has the inertia of its mass in excess of that fluid, and its whole moment of inertia:
//! `(m - rho V) v' = F`, `I w' = T`, with what it exerts on the fluid taken from the force `F` and the torque `T`.
//!
//! Contacts give impulses `p`, which change velocities at once, where the formula takes them for smooth. So it is that of velocities less what impulses have
//! brought: with the rate of change `g0 v + g1 v0 + g2 v-`, where `g0 + g1 + g2 = 0`, the force of contacts in a step is `g0 p - g2 p0`, with `p0` the impulse of the
//! step before. A force `p / dt` instead would bring two thirds of an impulse in the step and the rest later: bodies that have met would part at
//! half their speed.

use nalgebra::SMatrix;

use super::scheme::StepWeights;
use crate::{
    body::{Motion, Twist, components},
    geometry::Ball,
    interaction::Wrench,
    setup::{Inertia, Setup},
    surface::Shape,
    system::{BodyState, Level},
};

/// The bodies of a setup in a step: rates of change of their motions are `rate` times the new one and a history, over time.
pub struct Momentum<'a, const D: usize> {
    setup: &'a Setup<D>,
    inertia: &'a Inertia<D>,
    rate: f64,
    history: Vec<Twist<D>>,
    /// Forces and torques that impulses of the step before leave in this one.
    impulsive: Vec<Wrench<D>>,
}

impl<'a, const D: usize> Momentum<'a, D> {
    /// Those of a step with these weights from these levels, the last one first.
    pub fn new<'b>(setup: &'a Setup<D>, weights: &StepWeights, levels: impl Iterator<Item = &'b Level<D>>) -> Momentum<'a, D> {
        let mut history = vec![Twist::zero(); setup.bodies.len()];
        let mut levels = levels.peekable();
        let left = |impulse: &Wrench<D>| Wrench { force: impulse.force * -weights.rate[2], torque: impulse.torque * -weights.rate[2] };
        let impulsive = levels.peek().map_or(Vec::new(), |last| last.impulses.iter().map(left).collect());
        for (level, weight) in levels.zip(&weights.rate[1..]) {
            for (sum, twist) in history.iter_mut().zip(&level.twists) {
                sum.velocity += twist.velocity * *weight;
                sum.spin += twist.spin * *weight;
            }
        }
        Momentum { setup, inertia: inertia(setup), rate: weights.rate[0], history, impulsive }
    }

    /// Known forces and torques on all bodies besides those of the setup, `given` (none if empty) and what histories bring.
    pub fn pushes(&self, given: &[Wrench<D>]) -> Vec<Wrench<D>> {
        let of_body = |body: usize| {
            let (ball, density) = (self.ball(body), self.inertia.bodies[body]);
            let push = given.get(body).copied().unwrap_or_else(Wrench::zero);
            let Twist { velocity, spin } = self.history[body];
            Wrench {
                force: push.force + self.impulsive[body].force - velocity * ((density - self.inertia.fluid) * ball.volume()),
                torque: push.torque + self.impulsive[body].torque - spin * (density * ball.moment_of_inertia()),
            }
        };
        (0..self.history.len()).map(of_body).collect()
    }

    /// Spin-ups `rho w' / mu` that are known: by torques on free bodies, those `given` included, and by prescribed motions.
    pub fn known_spin_ups(&self, given: &[Wrench<D>]) -> Vec<Vec<f64>> {
        let of_body = |body: usize| match self.setup.bodies[body].body.motion {
            Motion::Prescribed(twist) => self.spin_up(body, &twist.spin),
            Motion::Free { torque, .. } => {
                let torque = torque + given.get(body).map_or(SMatrix::zeros(), |push| push.torque);
                self.scaled(&(torque / (self.inertia.bodies[body] * self.ball(body).moment_of_inertia())))
            }
        };
        (0..self.history.len()).map(of_body).collect()
    }

    /// Adds to the forces of the fluid on bodies what accelerates the fluid inside; returns how bodies spin up.
    pub fn complete(&self, states: &mut [BodyState<D>]) -> Vec<Vec<f64>> {
        let of_body = |(body, state): (usize, &mut BodyState<D>)| {
            let acceleration = state.twist.velocity * self.rate + self.history[body].velocity;
            state.force += acceleration * (self.inertia.fluid * self.ball(body).volume());
            self.spin_up(body, &state.twist.spin)
        };
        states.iter_mut().enumerate().map(of_body).collect()
    }

    fn spin_up(&self, body: usize, spin: &SMatrix<f64, D, D>) -> Vec<f64> {
        self.scaled(&(spin * self.rate + self.history[body].spin))
    }

    fn scaled(&self, rate: &SMatrix<f64, D, D>) -> Vec<f64> {
        components(rate).iter().map(|rate| self.inertia.fluid / self.setup.viscosity * rate).collect()
    }

    fn ball(&self, body: usize) -> Ball<D> {
        self.setup.bodies[body].body.ball
    }
}

/// What fluid and bodies of a flow with inertia weigh.
pub fn inertia<const D: usize>(setup: &Setup<D>) -> &Inertia<D> {
    setup.inertia.as_ref().expect("a flow with inertia has masses")
}
