//! Hard cases: tiny gaps, several radii, seams, units, and what the solver promises of its iterations.

use nalgebra::{SMatrix, Vector2};
use turbid::{
    body::{Motion, pack},
    flow::Drive,
    geometry::{Axis, Ball, Domain},
    petsc::Session,
    simulation::{Setup, SuspendedBody},
};

use crate::suspension::{assert_near, couette, free, periodic_cube, solve, suspended};

/// A gap of a thousandth of a radius, far below the spacing: bounded iterations, and the answer has the symmetry of the scene.
pub fn two_disks_that_nearly_touch(session: &Session) {
    let radius = 0.12;
    let half = radius * 1.0005 * Vector2::new(0.8, 0.6);
    let middle = Vector2::new(0.5, 0.5);
    let disks = vec![suspended(middle - half, radius, free(), 6), suspended(middle + half, radius, free(), 6)];
    let (simulation, solution) = solve(session, periodic_cube(radius / 6.0, Drive::Shear(1.0), disks));
    assert!(simulation.cost().krylov.iterations <= 90, "{} iterations", simulation.cost().krylov.iterations);
    let [first, second] = [&solution.bodies[0].twist, &solution.bodies[1].twist];
    let mean = Vector2::new(0.5, 0.0);
    assert!((first.velocity + second.velocity - 2.0 * mean).norm() < 1e-6, "{} {}", first.velocity, second.velocity);
    assert!((first.spin - second.spin).norm() < 1e-6);
    assert!(first.velocity.norm().is_finite() && first.spin.norm().is_finite());
}

/// A disk a thousandth of a radius away from a moving wall.
pub fn a_disk_that_nearly_touches_a_wall(session: &Session) {
    let radius = 0.15;
    let disk = suspended(Vector2::new(0.4, radius * 1.001), radius, free(), 6);
    let (simulation, solution) = solve(session, couette(1.0, radius / 6.0, 1.0, vec![disk]));
    assert!(simulation.cost().krylov.iterations <= 90, "{} iterations", simulation.cost().krylov.iterations);
    let twist = &solution.bodies[0].twist;
    // it moves with the wall, nearly along it
    assert!(twist.velocity[0] < -0.2 && twist.velocity[0] > -0.5 && twist.velocity[1].abs() < 1e-2, "{}", twist.velocity);
}

/// Where a body lies relative to the periodic seam and to the ranks' blocks does not matter.
pub fn a_body_across_the_seam_is_the_same_body(session: &Session) {
    let at = |center: Vector2<f64>| {
        let disk = suspended(center, 0.2, free(), 6);
        let (_, solution) = solve(session, periodic_cube(1.0 / 32.0, Drive::Shear(1.0), vec![disk]));
        solution.bodies[0].stresslet[(0, 1)]
    };
    let middle = at(Vector2::new(0.513, 0.527));
    assert_near("moved by 16 cells into the corner", at(Vector2::new(0.013, 0.027)), middle, 1e-7);
}

/// Several radii in one scene: a small disk far from a large one changes little, and both are force-free.
pub fn disks_of_two_sizes(session: &Session) {
    let disks = vec![suspended(Vector2::new(0.3, 0.35), 0.2, free(), 8), suspended(Vector2::new(0.75, 0.8), 0.1, free(), 5)];
    let (_, solution) = solve(session, periodic_cube(1.0 / 50.0, Drive::Shear(1.0), disks));
    for state in &solution.bodies {
        assert!(state.force.norm() < 1e-8 && state.torque.norm() < 1e-8);
    }
    let stresslet = |index: usize| solution.bodies[index].stresslet[(0, 1)];
    assert!(stresslet(0) > 3.5 * stresslet(1), "a stresslet grows like the area: {} and {}", stresslet(0), stresslet(1));
}

/// Viscosity, length and rate are units: the numbers scale exactly.
pub fn units_do_not_matter(session: &Session) {
    let scaled = |length: f64, viscosity: f64, force: f64| {
        let pulled = Motion::Free { force: Vector2::new(force, 0.3 * force), torque: SMatrix::zeros() };
        let disks = [[0.3, 0.4], [0.65, 0.62]].map(|center| suspended(Vector2::from(center) * length, 0.15 * length, pulled, 5));
        let domain = Domain { size: Vector2::repeat(length), axes: [Axis::Periodic; 2] };
        let setup =
            Setup { domain, spacing: length / 34.0, viscosity, drive: Drive::Rest, bodies: disks.to_vec(), tolerance: 1e-10 };
        solve(session, setup).1.bodies[0].twist.velocity[0] * viscosity / force
    };
    let reference = scaled(1.0, 1.0, 1.0);
    assert_near("viscosity 1e-9", scaled(1.0, 1e-9, 1.0), reference, 1e-8);
    assert_near("viscosity 1e9", scaled(1.0, 1e9, 1.0), reference, 1e-8);
    assert_near("a thousandth of the length", scaled(1e-3, 1.0, 1e-3), reference, 1e-8);
}

/// A box without bodies and a shear of nothing: the answer is the drive itself.
pub fn no_bodies_at_all(session: &Session) {
    let (simulation, solution) = solve(session, couette(2.0, 0.05, 1.0, Vec::new()));
    assert_eq!(simulation.cost().krylov.iterations, 0);
    assert!(solution.bodies.is_empty() && solution.mean_velocity.norm() < 1e-9);
}

/// Coupled iterations for 100 disks at fraction 0.4 (a/h = 5, K = 4, smallest gap 0.1 radii) stay within the promise.
pub fn iterations_for_a_hundred_disks(session: &Session) {
    let count = 100;
    let radius = (0.4 / std::f64::consts::PI / f64::from(count)).sqrt();
    let domain = Domain { size: Vector2::repeat(1.0), axes: [Axis::Periodic; 2] };
    let centers = pack(&domain, &[] as &[Ball<2>], &vec![radius; count as usize], 0.1, 1).expect("40 % fit");
    let bodies: Vec<SuspendedBody<2>> = centers.into_iter().map(|center| suspended(center, radius, free(), 4)).collect();
    let mut setup = periodic_cube(radius / 5.0, Drive::Shear(1.0), bodies);
    setup.tolerance = 1e-6;
    let (simulation, _) = solve(session, setup);
    let iterations = simulation.cost().krylov.iterations;
    assert!(iterations <= 60, "{iterations} iterations");
}
