//! How long a step may be for what a flow carries along.

use super::momentum::inertia;
use crate::{
    body::{Body, Motion, Twist, components},
    flow::Drive,
    interaction::Wrench,
    scene::ConstraintMethod,
    setup::{Setup, SuspendedBody},
    surface::Shape,
};

/// Cells that the flow passes in an automatic step at most.
pub const COURANT: f64 = 0.5;

/// Cells that the flow passes in any step at most: beyond, waves grow that viscosity does not hold.
pub const LARGEST_COURANT: f64 = 0.7;

/// Length of the first step, which is of first order, over that in which something moves as far as in later ones.
const FIRST: f64 = 0.25;

/// The same where a stream is there at once, as later steps have it then: around a body it is twice as fast.
const AROUND: f64 = 0.5;

/// Length of any step over that in which a free body without support falls as far: what lies in a heap keeps its contacts.
const SUPPORTED: f64 = 0.5;

/// Square of the way of viscosity in a step, in cells, down to which free bodies of half the density of the fluid are stable by `sharp`; the power of the density by which it
/// grows for lighter ones, and up to where: measured for a tenth and a hundredth of the density.
const SHORTEST_DIFFUSION: f64 = 0.0026;
const BY_DENSITY: f64 = -0.84;
const SHORTEST_OF_ANY: f64 = 0.026;

/// The shortest step in which all free bodies lighter than the fluid are stable on cells of a size; 0 without any, and by other methods than `sharp`. In shorter ones the jumps of
/// steady flow make a surface more mobile than the fluid that the body displaces is.
pub fn shortest_step<const D: usize>(setup: &Setup<D>, spacing: f64) -> f64 {
    let inertia = inertia(setup);
    let free = setup.bodies.iter().zip(&inertia.bodies).filter(|(suspended, _)| suspended.body.free());
    let lightest = free.map(|(_, density)| density / inertia.fluid).fold(f64::INFINITY, f64::min);
    if lightest >= 1.0 || setup.constraint != ConstraintMethod::Sharp {
        return 0.0;
    }
    let diffusion = (SHORTEST_DIFFUSION * (2.0 * lightest).powf(BY_DENSITY)).min(SHORTEST_OF_ANY);
    diffusion * spacing * spacing * inertia.fluid / setup.viscosity
}

/// The longest step of a flow with a largest speed along an axis, on cells of a size; none lets a free body fall far that loses its support, unless
/// viscosity holds it up.
pub fn longest_step<const D: usize>(setup: &Setup<D>, spacing: f64, fastest: f64) -> f64 {
    let way = COURANT * spacing;
    let ends = setup.domain.axes.iter().map(|axis| way / axis.fastest_wall()).fold(f64::INFINITY, f64::min);
    (way / fastest).min(ends).min(SUPPORTED * fall(setup, way))
}

/// The longest first step: a part of that in which the flow as it is, the drive, walls, given motions, or forces from rest (those of the setup and `pushes`
/// on the bodies, if any) move something across as many cells as later steps may.
pub fn first_step<const D: usize>(setup: &Setup<D>, spacing: f64, fastest: f64, pushes: &[Wrench<D>]) -> f64 {
    let way = COURANT * spacing;
    let motions = setup.fastest_motions().into_iter().enumerate();
    let by_bodies = motions.map(|(body, motion)| by_motion(setup, way, body, motion, pushes.get(body))).fold(f64::INFINITY, f64::min);
    let walls = setup.domain.axes.iter().filter(|axis| axis.walled());
    let by_walls = walls.map(|axis| way / axis.fastest_wall()).fold(f64::INFINITY, f64::min);
    let by_drive = from_rest(way, inertia(setup).fluid, setup.strongest_drive().uniform_force().norm());
    (AROUND * way / fastest.max(stream(setup))).min(FIRST * by_bodies.min(by_walls).min(by_drive))
}

/// The largest speed that the fluid is given at once.
fn stream<const D: usize>(setup: &Setup<D>) -> f64 {
    let inflow = setup.domain.open().map_or(0.0, |(_, inflow)| inflow.speed.abs());
    if let Drive::MeanVelocity(velocity) = setup.drive { inflow.max(velocity.amax()) } else { inflow }
}

/// The time in which the surface of a body goes so far, from rest where it is free.
fn by_motion<const D: usize>(setup: &Setup<D>, way: f64, body: usize, motion: Motion<D>, push: Option<&Wrench<D>>) -> f64 {
    let (ball, inertia) = (setup.bodies[body].body.ball, inertia(setup));
    match motion {
        Motion::Prescribed(twist) => way / (twist.velocity.norm() + twist.spin.norm() * ball.radius),
        Motion::Free { force, torque } => {
            let density = inertia.bodies[body] + inertia.fluid;
            let (force, torque) = push.map_or((force, torque), |push| (force + push.force, torque + push.torque));
            let turning: f64 = components(&torque).iter().map(|component| component * component).sum::<f64>().sqrt();
            from_rest(way, density * ball.volume(), force.norm()).min(from_rest(
                way,
                density * ball.moment_of_inertia(),
                turning * ball.radius,
            ))
        }
    }
}

/// Whether velocities jump at the start: those of free bodies that something moves at once, or beside walls, bodies or a stream that do.
pub fn starts_at_once<const D: usize>(setup: &Setup<D>) -> bool {
    let starts = inertia(setup).starts.iter().any(|start| *start != Twist::zero());
    starts || setup.domain.shear_rate() != 0.0 || stream(setup) > 0.0 || is_moved_at_once(setup)
}

/// Whether walls or bodies of prescribed motion jump at the start: what moves them is an impulse.
pub fn is_moved_at_once<const D: usize>(setup: &Setup<D>) -> bool {
    let walls = setup.domain.axes.iter().any(|axis| axis.walled() && axis.fastest_wall() > 0.0);
    let mut given: Vec<_> = setup.bodies.iter().map(|suspended| suspended.body.given_motion()).collect();
    setup.trajectories.twists(0.0).for_each(|(body, twist)| given[body] = Some(twist));
    walls || given.into_iter().flatten().any(|twist| twist != Twist::zero())
}

/// The time in which a force moves a mass so far; infinite without a force.
fn from_rest(way: f64, mass: f64, force: f64) -> f64 {
    (2.0 * way * mass / force).sqrt()
}

/// The shortest time in which a free body goes a way, from rest or, where that takes longer, at the speed that viscosity allows.
fn fall<const D: usize>(setup: &Setup<D>, way: f64) -> f64 {
    let inertia = inertia(setup);
    let of_body = |(suspended, density): (&SuspendedBody<D>, &f64)| {
        let Body { ball, motion } = suspended.body;
        let Motion::Free { force, .. } = motion else { return f64::INFINITY };
        let falling = from_rest(way, (density + inertia.fluid) * ball.volume(), force.norm());
        falling.max(way * setup.resistance(&ball) / force.norm())
    };
    setup.bodies.iter().zip(&inertia.bodies).map(of_body).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::scene::Scene;

    /// The first step of a scene at rest but for a part of it, in a channel with a viscosity of 0.1, a density of 1 and cells of an eighth.
    fn first(part: &str) -> f64 {
        let text = format!(
            "domain.size = [6.0, 4.0]\nflow.model = \"navier-stokes\"\nflow.viscosity = 0.1\nflow.density = 1.0\nresolution.spacing = 0.125\n\
             time.end = 10.0\n{part}"
        );
        let scene = Scene::parse("scene", std::path::Path::new("."), &text, &[]).unwrap();
        first_step(&Setup::<2>::of(&scene).unwrap(), 0.125, 0.0, &[])
    }

    #[test]
    fn the_first_step_knows_all_that_will_move_the_flow() {
        let (way, stream) = (FIRST * COURANT * 0.125, AROUND * COURANT * 0.125);
        assert_eq!(first("domain.y = \"walls\"\n"), f64::INFINITY);
        for (part, expected) in [
            ("domain.y = \"walls\"\nflow.drive = { mean_velocity = [2.0, 0.0] }\n", stream / 2.0),
            ("domain.y = { lower = [0.0, 0.0], upper = [-4.0, 0.0] }\n", way / 4.0),
            ("domain.y = \"walls\"\ndomain.x = { inflow = 1.5 }\n", stream / 1.5),
            ("domain.y = \"walls\"\nflow.drive = { pressure_gradient = [-8.0, 0.0] }\n", FIRST * (2.0 * 0.0625 / 8.0_f64).sqrt()),
        ] {
            assert!((first(part) / expected - 1.0).abs() < 1e-12, "{part}: {}, {expected}", first(part));
        }
        let torque = |torque: f64| first(&format!("[[bodies]]\nradius = 0.5\ncenters = [[3.0, 2.0]]\ndensity = 1.0\ntorque = {torque}\n"));
        assert!((torque(1.0) / torque(4.0) - 2.0).abs() < 1e-12 && torque(4.0) < 0.1, "{}", torque(4.0));
    }

    #[test]
    fn forces_between_bodies_count_in_the_first_step() {
        let text = "[domain]\nsize = [6.0, 4.0]\n[flow]\nmodel = \"navier-stokes\"\ndensity = 1.0\n[resolution]\ncells_per_radius = 4\n\
                    [[bodies]]\nradius = 0.5\ncenters = [[3.0, 2.0]]\ndensity = 1.0\n[time]\nend = 10.0\n";
        let scene = Scene::parse("scene", std::path::Path::new("."), text, &[]).unwrap();
        let setup = Setup::<2>::of(&scene).unwrap();
        let step = |force: f64| first_step(&setup, 0.125, 0.0, &[Wrench { force: Vector2::new(0.0, force), ..Wrench::zero() }]);
        assert_eq!(step(0.0), f64::INFINITY);
        let mass = 2.0 * 0.25 * std::f64::consts::PI;
        assert!((step(3.0) / (FIRST * (2.0 * 0.0625 * mass / 3.0).sqrt()) - 1.0).abs() < 1e-12);
    }
}
