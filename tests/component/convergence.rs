//! When a solve has converged, whatever the scene is measured in and however long its box is.

use nalgebra::{SVector, Vector2, Vector3};
use turbid::{
    body::Motion,
    flow::{Drive, InverseMethod},
    geometry::{Axis, Domain},
    mechanics::{FittedInclusions, Inclusions, ScalarSetup, ScalarSolution},
    petsc::Session,
    plan::flow_solver,
    scene::{ConstraintMethod, MultiplierSolver},
    setup::Setup,
    system::{BodyState, Solution},
};

use crate::{
    Test,
    scalar::{disk, walled},
    suspension::{couette, fixed, free, periodic_cube, suspended},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_uniform_flow_takes_all_free_bodies_with_it_at_once),
        Test::of(units_of_length_and_viscosity_change_nothing),
        Test::of(units_change_no_scalar),
        Test::of(iterations_do_not_grow_along_slender_boxes),
    ]
}

const MEAN_VALUE: ConstraintMethod = ConstraintMethod::MeanValue(MultiplierSolver::Krylov);
const UZAWA: ConstraintMethod = ConstraintMethod::MeanValue(MultiplierSolver::Uzawa(None));
const PENALTY: ConstraintMethod = ConstraintMethod::Penalty(None);
const ON_GRIDS: [ConstraintMethod; 5] = [ConstraintMethod::Sharp, MEAN_VALUE, UZAWA, ConstraintMethod::Distributed, PENALTY];
const INVERSES: [InverseMethod; 2] = [InverseMethod::Hypre, InverseMethod::Transform];

/// All methods on grids with both inverses.
fn methods() -> impl Iterator<Item = (ConstraintMethod, InverseMethod)> {
    ON_GRIDS.into_iter().flat_map(|constraint| INVERSES.map(|inverse| (constraint, inverse)))
}

fn solve<const D: usize>(session: &Session, setup: Setup<D>) -> (Solution<D>, turbid::petsc::Report) {
    let mut solver = flow_solver(session, setup).unwrap();
    let solution = solver.solve(&mut |_, _| {}).unwrap();
    let cost = solution.cost.krylov;
    (solution, cost)
}

/// The right-hand side is nothing but rounding: a solver that scales its residual by it takes noise for a flow.
fn a_uniform_flow_takes_all_free_bodies_with_it_at_once(session: &Session) {
    let disks =
        || [[0.21, 0.23], [0.53, 0.26], [0.27, 0.7], [0.76, 0.74]].map(|center| suspended(center.into(), 0.125, free(), 4)).to_vec();
    let balls = || [[0.3, 0.3, 0.3], [0.7, 0.72, 0.6]].map(|center| suspended(center.into(), 0.2, free(), 2)).to_vec();
    let periodic = |constraint, inverse| {
        let setup = periodic_cube(1.0 / 32.0, Drive::MeanVelocity(Vector2::x()), disks());
        Setup { constraint, inverse, ..setup }
    };
    for (constraint, inverse) in methods().chain([(ConstraintMethod::Fitted, InverseMethod::Hypre)]) {
        carried(session, Vector2::x(), periodic(constraint, inverse));
        let alike = Axis::Walls { lower: Vector2::x(), upper: Vector2::x() };
        let domain = Domain { size: Vector2::new(1.0, 1.0), axes: [Axis::Periodic, alike] };
        carried(session, Vector2::x(), Setup { domain, drive: Drive::Rest, ..periodic(constraint, inverse) });
    }
    for (constraint, inverse) in methods() {
        let velocity = Vector3::new(1.0, 0.5, 0.0);
        let setup = periodic_cube(1.0 / 15.0, Drive::MeanVelocity(velocity), balls());
        carried(session, velocity, Setup { constraint, inverse, ..setup });
    }
}

fn carried<const D: usize>(session: &Session, velocity: SVector<f64, D>, setup: Setup<D>) {
    let (name, tolerance) = (format!("{:?} {:?} {D}D", setup.constraint, setup.inverse), setup.tolerance.at_an_instant());
    let direct = setup.constraint == ConstraintMethod::Fitted;
    let (solution, report) = solve(session, setup);
    assert!(report.residual <= tolerance && (direct || report.iterations == 0), "{name}: {report:?}");
    for body in &solution.bodies {
        // a direct solver is as exact as its matrix is well conditioned
        let off = (body.twist.velocity - velocity).norm().max(body.twist.spin.norm());
        assert!(off < if direct { 1e-11 } else { 1e-13 }, "{name}: off by {off:.1e}");
    }
}

/// What is found, in the units of the scene: length `unit`, time 1, viscosity as it is.
fn numbers(bodies: &[BodyState<2>], unit: f64, viscosity: f64) -> Vec<f64> {
    let of = |body: &BodyState<2>| {
        let motion = body.twist.velocity / unit;
        let force = body.force / (unit * viscosity);
        let moments =
            [body.torque[(1, 0)], body.stresslet[(0, 0)], body.stresslet[(0, 1)]].map(|moment| moment / (unit * unit * viscosity));
        [motion.as_slice(), &[body.twist.spin[(1, 0)]], force.as_slice(), &moments].concat()
    };
    bodies.iter().flat_map(of).collect()
}

fn assert_same(name: &str, one: &[f64], other: &[f64]) {
    let largest = one.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let difference = one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
    assert!(difference <= 1e-8 * largest, "{name}: {difference:.1e} of {largest:.1e}");
}

/// From nanometres to kilometres, from gases to ice.
const UNITS: [(f64, f64); 4] = [(1e-9, 1.0), (1e-6, 1e-12), (1e3, 1e-5), (1.0, 1e12)];

fn units_of_length_and_viscosity_change_nothing(session: &Session) {
    let wall = |unit: f64| Axis::Walls { lower: -Vector2::x() * unit, upper: Vector2::x() * unit };
    let setup = |unit: f64, viscosity: f64, walled: bool| {
        let bodies: [([f64; 2], f64, Motion<2>); 3] =
            [([0.21, 0.24], 0.14, free()), ([0.54, 0.28], 0.125, free()), ([0.63, 0.71], 0.13, fixed())];
        let bodies = bodies.map(|(center, radius, motion)| suspended(Vector2::from(center) * unit, radius * unit, motion, 4)).to_vec();
        let axes = [Axis::Periodic, if walled { wall(unit) } else { Axis::Periodic }];
        let domain = Domain { size: Vector2::new(unit, unit), axes };
        Setup { domain, viscosity, ..periodic_cube(unit / 32.0, Drive::MeanVelocity(Vector2::x() * unit), bodies) }
    };
    // Uzawa's iteration takes thousands of solves to such a tolerance
    let methods = methods().filter(|(constraint, _)| *constraint != UZAWA);
    for (constraint, inverse) in methods.chain([(ConstraintMethod::Fitted, InverseMethod::Hypre)]) {
        for walled in [false, true] {
            let of = |unit, viscosity| {
                let setup = Setup { constraint, inverse, ..setup(unit, viscosity, walled) };
                numbers(&solve(session, setup).0.bodies, unit, viscosity)
            };
            let plain = of(1.0, 1.0);
            for (unit, viscosity) in UNITS {
                let name = format!("{constraint:?} {inverse:?}, unit {unit:e}, viscosity {viscosity:e}, walls {walled}");
                assert_same(&name, &plain, &of(unit, viscosity));
            }
        }
    }
}

fn units_change_no_scalar(session: &Session) {
    let setup = |method, unit: f64| {
        let mut setup =
            walled(unit / 32.0, vec![disk([0.31 * unit, 0.35 * unit], 0.14 * unit, 4), disk([0.62 * unit, 0.6 * unit], 0.16 * unit, 4)]);
        setup.domain.size *= unit;
        ScalarSetup { constraint: method, ..setup }
    };
    // values grow like the square of lengths, energies like their fourth power
    let numbers = |solution: ScalarSolution<2>, unit: f64| {
        let mut numbers: Vec<f64> = solution.inclusions.iter().map(|inclusion| inclusion.value / unit.powi(2)).collect();
        numbers.push(solution.energy / unit.powi(4));
        numbers
    };
    let methods = [ConstraintMethod::Sharp, MEAN_VALUE, ConstraintMethod::Distributed, ConstraintMethod::Penalty(Some(1e-6))];
    for unit in [1e-9, 1e-6, 1e3] {
        for method in methods {
            let of = |unit| numbers(Inclusions::new(session, setup(method, unit)).unwrap().solve(&mut |_, _| {}).unwrap(), unit);
            assert_same(&format!("{method:?} unit {unit:e}"), &of(1.0), &of(unit));
        }
        let of = |unit| {
            let mut fitted = FittedInclusions::new(session, setup(ConstraintMethod::Sharp, unit)).unwrap();
            numbers(fitted.solve(&mut |_, _| {}).unwrap(), unit)
        };
        assert_same(&format!("fitted unit {unit:e}"), &of(1.0), &of(unit));
    }
}

/// A pressure that varies along a channel moves the less the longer its waves are: without the flow along it solved apart, iterations
/// grow like the aspect.
fn iterations_do_not_grow_along_slender_boxes(session: &Session) {
    let body = || suspended(Vector2::new(2.1, 0.53), 0.3, free(), 3);
    let channel = |length: f64, closed: bool| {
        let mut setup = couette(length, 0.1, 1.0, vec![body()]);
        if closed {
            setup.domain.axes[0] = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
        }
        setup
    };
    let mean_velocity = |length: f64| Setup { drive: Drive::MeanVelocity(Vector2::x()), ..channel(length, false) };
    let plane = |length: f64, kind: usize| match kind {
        0 => channel(length, false),
        1 => channel(length, true),
        _ => mean_velocity(length),
    };
    for kind in 0..3 {
        let of = |length: f64| solve(session, plane(length, kind)).1.iterations;
        let (short, long) = (of(10.0), of(1000.0));
        assert!(long <= short + 3 && short < 40, "boxes {kind}: {short} iterations, then {long}");
    }
    let by = |inverse| solve(session, Setup { inverse, ..mean_velocity(1000.0) }).0;
    let (hypre, transform) = (by(InverseMethod::Hypre), by(InverseMethod::Transform));
    assert!((hypre.bodies[0].twist.velocity - transform.bodies[0].twist.velocity).norm() < 1e-6);
    let duct = |length: f64| {
        let still = Axis::Walls { lower: Vector3::zeros(), upper: Vector3::zeros() };
        let lid = Axis::Walls { lower: -Vector3::x(), upper: Vector3::x() };
        let domain = Domain { size: Vector3::new(length, 1.0, 1.0), axes: [still, lid, still] };
        let ball = suspended(Vector3::new(2.1, 0.53, 0.5), 0.3, free(), 2);
        let setup = Setup { domain, ..periodic_cube(0.1, Drive::Rest, vec![ball]) };
        let mut suspension = flow_solver(session, setup).unwrap();
        suspension.solve(&mut |_, _| {}).unwrap().cost.krylov.iterations
    };
    let (short, long) = (duct(6.0), duct(60.0));
    assert!(long <= short + 3 && short < 50, "ducts: {short} iterations, then {long}");
}
