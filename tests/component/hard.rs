//! Hard cases: tiny gaps, several radii, seams, units, and what the solver promises of its iterations.

use nalgebra::{SMatrix, Vector2, Vector3};
use turbid::{
    body::{Motion, pack},
    error::Result,
    flow::{Drive, InverseMethod, IteratedInverse, Stokes, StokesInverse},
    geometry::{Axis, Ball, Domain},
    grid::Grid,
    mechanics::Suspension,
    observe,
    petsc::Session,
    scene::{ConstraintMethod, Tolerance},
    setup::{Setup, SuspendedBody},
};

use crate::Test;
use crate::suspension::{assert_near, couette, fixed, free, periodic_cube, solve, suspended};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(two_disks_that_nearly_touch),
        Test::of(a_disk_that_nearly_touches_a_wall),
        Test::of(a_body_across_the_seam_is_the_same_body),
        Test::of(disks_of_two_sizes),
        Test::of(units_do_not_matter),
        Test::of(no_bodies_at_all),
        Test::of(a_lid_driven_box_has_no_viscosity),
        Test::of(iterations_for_dense_disks),
        Test::of(a_dense_fixed_array_does_not_stall),
        Test::of(as_many_modes_as_the_grid_may_carry_are_stable_in_a_crowd),
        Test::of(iterations_with_an_exact_inverse),
        Test::of(iterations_for_spheres),
    ]
}

/// A gap of a thousandth of a radius, far below the spacing: bounded iterations, and the answer has the symmetry of the scene.
fn two_disks_that_nearly_touch(session: &Session) {
    let radius = 0.12;
    let half = radius * 1.0005 * Vector2::new(0.8, 0.6);
    let middle = Vector2::new(0.5, 0.5);
    let disks = vec![suspended(middle - half, radius, free(), 6), suspended(middle + half, radius, free(), 6)];
    let (_, solution) = solve(session, periodic_cube(radius / 6.0, Drive::Shear(1.0), disks));
    assert!(solution.cost.krylov.iterations <= 90, "{} iterations", solution.cost.krylov.iterations);
    let [first, second] = [&solution.bodies[0].twist, &solution.bodies[1].twist];
    let mean = Vector2::new(0.5, 0.0);
    assert!((first.velocity + second.velocity - mean * 2.0).norm() < 1e-6, "{} {}", first.velocity, second.velocity);
    assert!((first.spin - second.spin).norm() < 1e-6);
    assert!(first.velocity.norm().is_finite() && first.spin.norm().is_finite());
}

/// A disk a thousandth of a radius away from a moving wall.
fn a_disk_that_nearly_touches_a_wall(session: &Session) {
    let radius = 0.15;
    let disk = suspended(Vector2::new(0.4, radius * 1.001), radius, free(), 6);
    let (_, solution) = solve(session, couette(1.0, radius / 6.0, 1.0, vec![disk]));
    assert!(solution.cost.krylov.iterations <= 90, "{} iterations", solution.cost.krylov.iterations);
    let twist = &solution.bodies[0].twist;
    // it moves with the wall, nearly along it
    assert!(twist.velocity[0] < -0.2 && twist.velocity[0] > -0.5 && twist.velocity[1].abs() < 1e-2, "{}", twist.velocity);
}

/// Where a body lies relative to the periodic seam and to the ranks' blocks does not matter.
fn a_body_across_the_seam_is_the_same_body(session: &Session) {
    let at = |center: Vector2<f64>| {
        let disk = suspended(center, 0.2, free(), 6);
        let (_, solution) = solve(session, periodic_cube(1.0 / 32.0, Drive::Shear(1.0), vec![disk]));
        solution.bodies[0].stresslet[(0, 1)]
    };
    let middle = at(Vector2::new(0.513, 0.527));
    assert_near("moved by 16 cells into the corner", at(Vector2::new(0.013, 0.027)), middle, 1e-7);
}

/// Several radii in one scene: force-free, the same in any order of the bodies, and settled on the grid.
fn disks_of_two_sizes(session: &Session) {
    let large = |order| suspended(Vector2::new(0.3, 0.35), 0.2, free(), order);
    let small = |order| suspended(Vector2::new(0.75, 0.8), 0.1, free(), order);
    let stresslets = |spacing: f64, bodies: [SuspendedBody<2>; 2]| {
        let (_, solution) = solve(session, periodic_cube(spacing, Drive::Shear(1.0), bodies.to_vec()));
        assert!(solution.bodies.iter().all(|state| state.force.norm() < 1e-8 && state.torque.norm() < 1e-8));
        [0, 1].map(|body| solution.bodies[body].stresslet[(0, 1)])
    };
    let coarse = stresslets(1.0 / 50.0, [large(8), small(5)]);
    let swapped = stresslets(1.0 / 50.0, [small(5), large(8)]);
    let fine = stresslets(1.0 / 100.0, [large(8), small(8)]);
    for body in 0..2 {
        assert_near("swapped", swapped[1 - body], coarse[body], 1e-7);
        assert_near("refined", coarse[body], fine[body], 5e-3);
    }
}

/// Viscosity, length and rate are units: the numbers scale exactly.
fn units_do_not_matter(session: &Session) {
    let scaled = |length: f64, viscosity: f64, force: f64| {
        let pulled = Motion::Free { force: Vector2::new(force, 0.3 * force), torque: SMatrix::zeros() };
        let disks = [[0.3, 0.4], [0.65, 0.62]].map(|center| suspended(Vector2::from(center) * length, 0.15 * length, pulled, 5));
        let domain = Domain { size: Vector2::repeat(length), axes: [Axis::Periodic; 2] };
        let setup = Setup {
            changing_drive: None,
            domain,
            spacing: length / 34.0,
            viscosity,
            drive: Drive::Rest,
            bodies: disks.to_vec(),
            inertia: None,
            trajectories: Default::default(),
            constraint: ConstraintMethod::Sharp,
            interactions: Default::default(),
            inverse: InverseMethod::Hypre,
            tolerance: Tolerance::Fixed(1e-10),
        };
        solve(session, setup).1.bodies[0].twist.velocity[0] * viscosity / force
    };
    let reference = scaled(1.0, 1.0, 1.0);
    assert_near("viscosity 1e-9", scaled(1.0, 1e-9, 1.0), reference, 1e-8);
    assert_near("viscosity 1e9", scaled(1.0, 1e9, 1.0), reference, 1e-8);
    assert_near("a thousandth of the length", scaled(1e-3, 1.0, 1e-3), reference, 1e-8);
}

/// A box without bodies and a shear of nothing: the answer is the drive itself.
fn no_bodies_at_all(session: &Session) {
    let (_, solution) = solve(session, couette(2.0, 0.05, 1.0, Vec::new()));
    assert_eq!(solution.cost.krylov.iterations, 0);
    assert!(solution.bodies.is_empty() && solution.mean_velocity.norm() < 1e-9);
}

/// A lid that drives a closed box shears nothing simply: there is a flow, but no apparent viscosity.
fn a_lid_driven_box_has_no_viscosity(session: &Session) {
    let mut setup = couette(1.0, 0.05, 1.0, vec![suspended(Vector2::new(0.5, 0.5), 0.2, free(), 4)]);
    setup.domain.axes[0] = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let (suspension, solution) = solve(session, setup);
    assert!(observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().is_none());
    assert!(solution.bodies[0].twist.spin[(1, 0)] < -0.1 && solution.bodies[0].twist.velocity.norm() < 1e-3);
}

/// Random disks at fraction 0.4 with gaps of at least 0.1 radii, at five cells per radius with modes up to 4.
fn dense_disks(count: usize) -> Setup<2> {
    let radius = (0.4 / std::f64::consts::PI / count as f64).sqrt();
    let domain = Domain { size: Vector2::repeat(1.0), axes: [Axis::Periodic; 2] };
    let centers = pack(&domain, &[] as &[Ball<2>], &vec![radius; count], 0.1, 1).unwrap();
    let bodies = centers.into_iter().map(|center| suspended(center, radius, free(), 4)).collect();
    let mut setup = periodic_cube(radius / 5.0, Drive::Shear(1.0), bodies);
    setup.tolerance = Tolerance::Fixed(1e-6);
    setup
}

/// With one V-cycle for each scalar inverse, few more iterations than with exact inverses; published: 72 and 94 without near pairs.
fn iterations_for_dense_disks(session: &Session) {
    for (count, promised) in [(100, 40), (400, 48)] {
        let (_, solution) = solve(session, dense_disks(count));
        let iterations = solution.cost.krylov.iterations;
        assert!(iterations <= promised, "{iterations} iterations for {count} disks");
    }
}

/// Seven modes at five cells per radius is all that is accepted. Interpolated from outside, six already gave garbage where
/// gaps are half a cell: the viscosity must be that of the same modes on a grid twice as fine.
fn as_many_modes_as_the_grid_may_carry_are_stable_in_a_crowd(session: &Session) {
    let viscosity = |refinement: f64| {
        let mut setup = dense_disks(40);
        setup.spacing /= refinement;
        setup.bodies.iter_mut().for_each(|suspended| suspended.order = 7);
        let (suspension, solution) = solve(session, setup);
        let iterations = solution.cost.krylov.iterations;
        assert!(iterations <= 90, "{iterations} iterations");
        observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap().relative()
    };
    assert_near("viscosity", viscosity(1.0), viscosity(2.0), 3e-3);
}

/// Pores between fixed disks are nearly closed: the hardest systems, which stall unless GMRES keeps its vectors orthogonal.
fn a_dense_fixed_array_does_not_stall(session: &Session) {
    let mut setup = dense_disks(50);
    setup.drive = Drive::MeanVelocity(Vector2::new(1.0, 0.3));
    setup.bodies.iter_mut().for_each(|suspended| suspended.body.motion = fixed());
    let (_, solution) = solve(session, setup);
    let iterations = solution.cost.krylov.iterations;
    assert!(iterations <= 300, "{iterations} iterations");
    let force: Vector2<f64> = solution.bodies.iter().map(|state| state.force).sum();
    assert!((force + solution.pressure_gradient).norm() < 1e-6 * force.norm());
}

/// With an exact inverse of the fluid the solver iterates as if on the multipliers alone.
fn iterations_with_an_exact_inverse(session: &Session) {
    let iterations = |setup: Setup<2>| {
        let exact = |stokes: &Stokes<2>, grid: &Grid<2>| -> Result<Box<dyn StokesInverse<2>>> {
            Ok(Box::new(IteratedInverse::new(InverseMethod::Hypre.set_up(stokes, grid)?, 1e-10)))
        };
        let mut suspension = Suspension::with_inverse(session, setup, exact).unwrap();
        suspension.solve(&mut |_, _| {}).unwrap().cost.krylov.iterations
    };
    let mut one = periodic_cube(1.0 / 48.0, Drive::Shear(1.0), vec![suspended(Vector2::new(0.513, 0.527), 0.125, free(), 6)]);
    one.tolerance = Tolerance::Fixed(1e-6);
    let (alone, dense) = (iterations(one), iterations(dense_disks(100)));
    assert!(alone <= 8, "{alone} iterations for one free disk");
    assert!(dense <= 30, "{dense} iterations for a hundred");
}

/// Iterations do not grow with the number of spheres: fraction 0.3, four cells per radius, modes up to 3.
fn iterations_for_spheres(session: &Session) {
    let iterations = |count: usize| {
        let radius = (0.3 * 0.75 / std::f64::consts::PI / count as f64).cbrt();
        let domain = Domain { size: Vector3::repeat(1.0), axes: [Axis::Periodic; 3] };
        let centers = pack(&domain, &[] as &[Ball<3>], &vec![radius; count], 0.1, 1).unwrap();
        let bodies = centers.into_iter().map(|center| suspended(center, radius, free(), 3)).collect();
        let mut setup = periodic_cube(radius / 4.0, Drive::Shear(1.0), bodies);
        setup.tolerance = Tolerance::Fixed(1e-6);
        solve(session, setup).1.cost.krylov.iterations
    };
    let (few, many) = (iterations(32), iterations(64));
    assert!(many as f64 <= 1.15 * few as f64, "{few} iterations for 32 spheres, {many} for 64");
}
