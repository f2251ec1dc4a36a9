//! Normal stresses of sheared suspensions, against exact values and by two roads.

use nalgebra::{Vector2, Vector3};

use crate::Test;
use crate::suspension::{assert_near, couette, free, periodic_cube, solve, suspended};
use turbid::{
    flow::Drive,
    geometry::{Axis, Ball},
    observe::{self, Viscosity},
    petsc::Session,
    scene::ConstraintMethod,
    simulation::{FlowSolver, Setup, Solution, Suspension},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(two_disks_in_a_periodic_box_have_the_known_normal_stress_difference),
        Test::of(one_body_in_a_box_has_no_normal_stress),
        Test::of(pressure_on_bodies_is_what_walls_bear),
    ]
}

const PAIR: [[f64; 2]; 2] = [[0.3, 0.4], [0.65, 0.62]];

fn viscosity(suspension: &Suspension<2>, solution: &Solution<2>) -> Viscosity {
    observe::viscosity(suspension.setup(), suspension.grid(), solution, &[]).unwrap().unwrap()
}

/// Reference, section 2.4, P2.
fn two_disks_in_a_periodic_box_have_the_known_normal_stress_difference(session: &Session) {
    let disks = PAIR.map(|center| suspended(Vector2::from(center), 0.15, free(), 10));
    let (suspension, solution) = solve(session, periodic_cube(1.0 / 64.0, Drive::Shear(1.0), disks.to_vec()));
    let viscosity = viscosity(&suspension, &solution);
    assert_near("viscosity", viscosity.relative(), 1.3457188363, 1e-3);
    assert!((viscosity.normal.first - 0.074669119).abs() < 1e-3, "{viscosity:?}");
    assert_eq!((viscosity.normal.second, viscosity.normal.contact_pressure), (None, 0.0));
}

/// By symmetry, which holds on a grid as well if the body lies in one of its centres of symmetry.
fn one_body_in_a_box_has_no_normal_stress(session: &Session) {
    let disk = suspended(Vector2::repeat(0.5), 0.2, free(), 6);
    let (suspension, solution) = solve(session, periodic_cube(1.0 / 32.0, Drive::Shear(2.0), vec![disk]));
    let plane = viscosity(&suspension, &solution).normal;
    assert!(plane.first.abs() < 1e-7 && plane.pressure.unwrap().abs() < 1e-7, "{plane:?}");
    let sphere = suspended(Vector3::repeat(0.5), 0.25, free(), 3);
    let (suspension, solution) = solve(session, periodic_cube(1.0 / 16.0, Drive::Shear(2.0), vec![sphere]));
    let space = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap().normal;
    let all = [space.first, space.second.unwrap(), space.pressure.unwrap()];
    assert!(all.iter().all(|stress| stress.abs() < 1e-7), "{space:?}");
}

/// The mean normal stress, here 0.024, is the same on every plane between the walls: on a wall it is the pressure there.
fn pressure_on_bodies_is_what_walls_bear(session: &Session) {
    let methods = [(ConstraintMethod::Sharp, 1e-3), (ConstraintMethod::Penalty(None), 5e-3)];
    for (constraint, error) in methods {
        let disks = PAIR.map(|center| suspended(Vector2::from(center), 0.15, free(), 9));
        let setup = Setup { constraint, ..couette(1.0, 1.0 / 80.0, 2.0, disks.to_vec()) };
        let (suspension, solution) = solve(session, setup);
        let normal = viscosity(&suspension, &solution).normal;
        let across = -normal.pressure.unwrap() - 0.5 * normal.first;
        let borne = wall_stress(session, &suspension, &solution, 2.0);
        assert!((across - borne).abs() < error, "{}: {across} instead of {borne}", constraint.word());
    }
    // multipliers at points inside leave the pressure there open
    let disks = PAIR.map(|center| suspended(Vector2::from(center), 0.15, free(), 9));
    let setup = Setup { constraint: ConstraintMethod::Distributed, ..couette(1.0, 1.0 / 40.0, 2.0, disks.to_vec()) };
    let (suspension, solution) = solve(session, setup);
    assert_eq!(viscosity(&suspension, &solution).normal.pressure, None);
}

/// Mean normal stress on both walls over the rate, less that of the mean pressure of the fluid.
fn wall_stress(session: &Session, suspension: &Suspension<2>, solution: &Solution<2>, rate: f64) -> f64 {
    let grid = suspension.grid();
    let balls: Vec<Ball<2>> = suspension.setup().bodies.iter().map(|suspended| suspended.body.ball).collect();
    assert!(matches!(grid.domain().axes[1], Axis::Walls { .. }));
    let (inside, rows) = (observe::inside(grid, &balls), grid.cells()[1]);
    let values = solution.fluid.local().unwrap();
    let mut sums = [0.0; 3];
    for ((index, pressure), inside) in grid.block(2).indices().zip(&values[grid.local_range(2)]).zip(inside) {
        let from_wall = index[1].min(rows - 1 - index[1]);
        // linear from the two rows next to each wall
        sums[0] += [1.5, -0.5].get(from_wall).unwrap_or(&0.0) * pressure / (2 * grid.cells()[0]) as f64;
        sums[1] += (1.0 - inside) * pressure;
        sums[2] += 1.0 - inside;
    }
    session.world().sum(&mut sums);
    -(sums[0] - sums[1] / sums[2]) / rate
}
