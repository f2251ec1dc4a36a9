//! Suspensions against published and independently computed values (sources: docs/validation.md).

use std::f64::consts::PI;

use crate::Test;
use nalgebra::{SMatrix, SVector, Vector2};
use turbid::{
    body::{Body, Motion, Twist},
    flow::{Drive, InverseMethod},
    geometry::{Axis, Ball, Domain},
    mechanics::FlowSolver,
    observe,
    petsc::Session,
    plan::flow_solver,
    scene::{ConstraintMethod, Tolerance},
    setup::{Setup, SuspendedBody},
    system::Solution,
    validation::cases,
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::only_on(1, known_answers_are_met),
        Test::of(wall_force_and_stresslets_give_the_same_viscosity),
        Test::of(drag_on_a_square_array_has_the_digits_of_an_independent_program),
        Test::of(the_drag_error_is_of_second_order),
        Test::of(two_disks_in_a_couette_cell),
        Test::of(a_channel_driven_by_each_drive),
        Test::of(a_periodic_box_driven_by_a_pressure_gradient),
        Test::of(two_disks_sedimenting_in_a_periodic_box),
        Test::of(a_disk_in_a_closed_box),
    ]
}

pub fn free<const D: usize>() -> Motion<D> {
    Motion::Free { force: SVector::zeros(), torque: SMatrix::zeros() }
}

pub fn fixed<const D: usize>() -> Motion<D> {
    Motion::Prescribed(Twist::zero())
}

pub fn suspended<const D: usize>(center: SVector<f64, D>, radius: f64, motion: Motion<D>, order: usize) -> SuspendedBody<D> {
    SuspendedBody { body: Body { ball: Ball { center, radius }, motion }, order }
}

pub fn periodic_cube<const D: usize>(spacing: f64, drive: Drive<D>, bodies: Vec<SuspendedBody<D>>) -> Setup<D> {
    let domain = Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; D] };
    Setup {
        domain,
        spacing,
        viscosity: 1.0,
        drive,
        bodies,
        inertia: None,
        changing_drive: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-9),
    }
}

/// A channel of height 1 along x whose walls move at -1/2 and 1/2 times `rate`.
pub fn couette(length: f64, spacing: f64, rate: f64, bodies: Vec<SuspendedBody<2>>) -> Setup<2> {
    let walls = Axis::Walls { lower: Vector2::x() * (-0.5 * rate), upper: Vector2::x() * (0.5 * rate) };
    let domain = Domain { size: Vector2::new(length, 1.0), axes: [Axis::Periodic, walls] };
    Setup {
        domain,
        spacing,
        viscosity: 1.0,
        drive: Drive::Rest,
        bodies,
        inertia: None,
        changing_drive: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-9),
    }
}

pub fn solve<const D: usize>(session: &Session, setup: Setup<D>) -> (Box<dyn FlowSolver<D>>, Solution<D>) {
    let mut suspension = flow_solver(session, setup).unwrap();
    let solution = suspension.solve(&mut |_, _| {}).unwrap();
    (suspension, solution)
}

pub fn assert_near(what: &str, value: f64, reference: f64, tolerance: f64) {
    let error = value / reference - 1.0;
    assert!(error.abs() <= tolerance, "{what}: {value} is off {reference} by {error:.2e}, allowed {tolerance:.2e}");
}

fn radius_of_disk(fraction: f64) -> f64 {
    (fraction / PI).sqrt()
}

/// Force over viscosity and mean velocity of a square array of cylinders.
fn square_array(session: &Session, fraction: f64, cells: usize, order: usize, center: [f64; 2]) -> f64 {
    let disk = suspended(Vector2::from(center), radius_of_disk(fraction), fixed(), order);
    let setup = periodic_cube(1.0 / cells as f64, Drive::MeanVelocity(Vector2::x()), vec![disk]);
    solve(session, setup).1.bodies[0].force[0]
}

const CENTER: [f64; 2] = [0.513, 0.527];

/// Published and exactly computable values (`turbid validation` prints them); means over many random configurations, beds and the longest rod on one rank
/// alone.
fn known_answers_are_met(session: &Session) {
    let alone = session.world().size() == 1;
    let quick = |name: &str| !["random", "bed of", "rod of 10"].iter().any(|slow| name.contains(slow));
    for case in cases().into_iter().filter(|case| alone || quick(case.name)) {
        let value = (case.solve)(session).unwrap();
        assert_near(&format!("{}, {}", case.name, case.resolution), value, case.reference, case.tolerance);
    }
}

/// The stress on the walls and the stresslets are two roads to one viscosity, also where disks are close to walls.
fn wall_force_and_stresslets_give_the_same_viscosity(session: &Session) {
    for height in [0.5, 0.22, 0.205] {
        let disk = suspended(Vector2::new(0.513, height), 0.2, free(), 6);
        let (suspension, solution) = solve(session, couette(1.0, 1.0 / 30.0, 1.0, vec![disk]));
        let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap();
        assert_near(&format!("centre at {height}"), viscosity.from_walls.unwrap(), viscosity.relative(), 1e-6);
    }
}

/// The same discrete problem solved by an independent program (dense multipliers, exact inverse by FFT), digit by digit:
/// with momentum conserved. Without `constraint::conservation` both give 102.8798 and 102.8721 (interpolation from inside).
fn drag_on_a_square_array_has_the_digits_of_an_independent_program(session: &Session) {
    assert_near("32 cells", square_array(session, 0.3, 32, 8, CENTER), 102.845163, 2e-8);
    assert_near("64 cells", square_array(session, 0.3, 64, 8, CENTER), 102.871304, 2e-8);
}

/// Root mean square over 8 positions on the grid, with modes enough that they do not limit.
fn the_drag_error_is_of_second_order(session: &Session) {
    let error = |cells: usize| {
        let squares = (0..8).map(|position| {
            let shift = |factor: f64| 0.5 + (f64::from(position) * factor).fract() / cells as f64;
            let force = square_array(session, 0.3, cells, 12.min(cells / 4), [shift(0.38), shift(0.62)]);
            (force / 102.881303670 - 1.0).powi(2)
        });
        (squares.sum::<f64>() / 8.0).sqrt()
    };
    let (coarse, fine) = (error(16), error(128));
    let order = (coarse / fine).log2() / 3.0;
    assert!(order >= 1.8, "errors {coarse:.2e} on 16 cells, {fine:.2e} on 128: order {order:.2}");
}

/// Two free disks in a Couette cell with zero mean pressure gradient (reference, section 2.4, P2).
fn two_disks_in_a_couette_cell(session: &Session) {
    // the reference cell is centred at the origin
    let disks = [[0.3, 0.4], [0.65, 0.62]].map(|center| suspended(Vector2::from(center), 0.15, free(), 9));
    let (suspension, solution) = solve(session, couette(1.0, 1.0 / 60.0, 1.0, disks.to_vec()));
    let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap();
    assert_near("viscosity", viscosity.relative(), 1.3813693532, 2e-3);
    let references = [[-0.053755754, 0.018929646, -0.406080384], [0.083329666, -0.018834326, -0.402670314]];
    for (state, reference) in solution.bodies.iter().zip(references) {
        let found = [state.twist.velocity[0], state.twist.velocity[1], state.twist.spin[(1, 0)]];
        // a thousandth of the speed of the walls
        assert!(found.iter().zip(reference).all(|(found, reference)| (found - reference).abs() < 1e-3), "{found:?} is off {reference:?}");
    }
}

/// The channel of height 1 and length 1 with a fixed or free disk (reference, section 3.2: a = 0.125).
fn a_channel_driven_by_each_drive(session: &Session) {
    let walls = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let channel = |drive, motion| Setup {
        domain: Domain { size: Vector2::new(1.0, 1.0), axes: [Axis::Periodic, walls] },
        spacing: 1.0 / 64.0,
        viscosity: 1.0,
        drive,
        bodies: vec![suspended(Vector2::new(0.513, 0.5), 0.125, motion, 8)],
        inertia: None,
        changing_drive: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-9),
    };
    let gradient = |amount: f64| Drive::PressureGradient(Vector2::x() * -amount);
    let (_, by_gradient) = solve(session, channel(gradient(1.0), fixed()));
    assert_near("flux past a fixed disk", by_gradient.mean_velocity[0], 0.0171234769, 5e-3);
    assert_near("force on a fixed disk", by_gradient.bodies[0].force[0], 0.545701167, 5e-3);
    let (_, by_mean) = solve(session, channel(Drive::MeanVelocity(by_gradient.mean_velocity), fixed()));
    assert_near("the gradient that gives this flux", by_mean.pressure_gradient[0], -1.0, 1e-6);
    assert_near("the force at this flux", by_mean.bodies[0].force[0], by_gradient.bodies[0].force[0], 1e-6);
    let (_, viscous) = solve(session, Setup { viscosity: 4.0, ..channel(gradient(1.0), fixed()) });
    assert_near("flux of a fluid four times as viscous", 4.0 * viscous.mean_velocity[0], by_gradient.mean_velocity[0], 1e-6);
    assert_near("the force of a fluid four times as viscous", viscous.bodies[0].force[0], by_gradient.bodies[0].force[0], 1e-6);
    let (_, freely) = solve(session, channel(gradient(8.0), free()));
    assert_near("speed of a free disk", freely.bodies[0].twist.velocity[0], 0.965019025, 2e-3);
    let pulled = Motion::Prescribed(Twist { velocity: Vector2::x(), spin: SMatrix::zeros() });
    let (_, pulled) = solve(session, channel(Drive::MeanVelocity(Vector2::zeros()), pulled));
    assert_near("drag at zero flux", -pulled.bodies[0].force[0], 21.9145884, 5e-3);
}

/// In a periodic box the force on fixed bodies balances the given gradient, and mean velocity and gradient are each other's inverse.
fn a_periodic_box_driven_by_a_pressure_gradient(session: &Session) {
    let disk = || vec![suspended(Vector2::from(CENTER), radius_of_disk(0.3), fixed(), 6)];
    let gradient = Vector2::new(-2.0, 0.5);
    let (_, solution) = solve(session, periodic_cube(1.0 / 32.0, Drive::PressureGradient(gradient), disk()));
    assert!((solution.bodies[0].force + gradient).norm() < 1e-7, "{}", solution.bodies[0].force);
    let (_, back) = solve(session, periodic_cube(1.0 / 32.0, Drive::MeanVelocity(solution.mean_velocity), disk()));
    assert!((back.pressure_gradient - gradient).norm() < 1e-6, "{}", back.pressure_gradient);
    let (_, by_force) = solve(session, periodic_cube(1.0 / 32.0, Drive::BodyForce(-gradient), disk()));
    // the fluid alone is pushed: the body misses what the gradient does to its own volume
    assert!((by_force.bodies[0].force + gradient * 0.7).norm() < 1e-7, "{}", by_force.bodies[0].force);
    assert!((by_force.mean_velocity - solution.mean_velocity).norm() < 1e-9);
}

/// Two disks falling side by side in a periodic box (reference, section 2.4, P2 periodic sedimentation).
fn two_disks_sedimenting_in_a_periodic_box(session: &Session) {
    let pulled = Motion::Free { force: Vector2::x(), torque: SMatrix::zeros() };
    let disks = [[0.3, 0.4], [0.65, 0.62]].map(|center| suspended(Vector2::from(center), 0.15, pulled, 9));
    let (_, solution) = solve(session, periodic_cube(1.0 / 60.0, Drive::Rest, disks.to_vec()));
    for (state, spin) in solution.bodies.iter().zip([-0.078226653, 0.078226653]) {
        assert_near("along the force", state.twist.velocity[0], 0.049167859, 5e-3);
        assert!((state.twist.velocity[1] - 0.004072376).abs() < 2e-4, "{}", state.twist.velocity[1]);
        assert_near("spin", state.twist.spin[(1, 0)], spin, 1e-2);
        assert_near("the fluid holds the weight", -state.force[0], 1.0, 1e-7);
    }
    assert_near("the gradient holds all", solution.pressure_gradient[0], 2.0, 1e-7);
}

/// Torque on a disk turning in a closed box (reference, section 3.4: a = 0.2) and drag on one that moves.
fn a_disk_in_a_closed_box(session: &Session) {
    let still = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let closed = |twist| Setup {
        domain: Domain { size: Vector2::new(1.0, 1.0), axes: [still; 2] },
        spacing: 1.0 / 48.0,
        viscosity: 2.0,
        drive: Drive::Rest,
        bodies: vec![suspended(Vector2::new(0.5, 0.5), 0.2, Motion::Prescribed(twist), 8)],
        inertia: None,
        changing_drive: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-9),
    };
    let spin = SMatrix::<f64, 2, 2>::new(0.0, -1.0, 1.0, 0.0);
    let (_, turning) = solve(session, closed(Twist { velocity: Vector2::zeros(), spin }));
    assert_near("torque", -turning.bodies[0].torque[(1, 0)], 2.0 * 4.0 * PI * 0.04 * 1.168276651, 2e-3);
    let (_, moving) = solve(session, closed(Twist { velocity: Vector2::x(), spin: SMatrix::zeros() }));
    assert_near("drag", -moving.bodies[0].force[0], 2.0 * 55.04312168, 5e-3);
}
