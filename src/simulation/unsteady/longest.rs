//! How long a step may be for what a flow carries along.

use super::momentum::inertia;
use crate::{
    body::{Body, Motion},
    simulation::{Setup, SuspendedBody},
};

/// Cells that the flow passes in a step at most.
const COURANT: f64 = 0.5;

/// Length of the first step, which is of first order, over that in which forces from rest move something as far.
const FIRST: f64 = 0.25;

/// Length of any step over that in which a free body without support falls as far: what lies in a heap keeps its contacts.
const SUPPORTED: f64 = 0.5;

/// The longest step of a flow with a largest speed along an axis, on cells of a size.
///
/// None lets a free body fall far that loses its support, unless viscosity holds it up. At rest, before the first step, until forces, walls and prescribed motions move something across as many cells as later ones may.
pub fn longest_step<const D: usize>(setup: &Setup<D>, spacing: f64, fastest: f64) -> f64 {
    let (way, inertia) = (COURANT * spacing, inertia(setup));
    let of_body = |(body, motion): (usize, Motion<D>)| {
        let ball = setup.bodies[body].body.ball;
        match motion {
            Motion::Prescribed(twist) => way / (twist.velocity.norm() + twist.spin.norm() * ball.radius),
            Motion::Free { force, .. } => {
                let mass = (inertia.bodies[body] + inertia.fluid) * ball.volume();
                (2.0 * way * mass / force.norm()).sqrt()
            }
        }
    };
    let by_bodies = setup.fastest_motions().into_iter().enumerate().map(of_body).fold(f64::INFINITY, f64::min);
    let walls = setup.domain.axes.iter().map(|axis| way / axis.fastest_wall()).fold(f64::INFINITY, f64::min);
    let drive = (2.0 * way * inertia.fluid / setup.drive.uniform_force().norm()).sqrt();
    if fastest > 0.0 { (way / fastest).min(walls).min(SUPPORTED * fall(setup, way)) } else { FIRST * by_bodies.min(walls).min(drive) }
}

/// The shortest time in which a free body goes a way, from rest or, where that takes longer, at the speed that viscosity allows.
fn fall<const D: usize>(setup: &Setup<D>, way: f64) -> f64 {
    let inertia = inertia(setup);
    let of_body = |(suspended, density): (&SuspendedBody<D>, &f64)| {
        let Body { ball, motion } = suspended.body;
        let Motion::Free { force, .. } = motion else { return f64::INFINITY };
        let from_rest = (2.0 * way * (density + inertia.fluid) * ball.volume() / force.norm()).sqrt();
        from_rest.max(way * setup.resistance(&ball) / force.norm())
    };
    setup.bodies.iter().zip(&inertia.bodies).map(of_body).fold(f64::INFINITY, f64::min)
}
