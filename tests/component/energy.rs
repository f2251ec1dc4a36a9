//! The dissipation of known flows.

use std::f64::consts::TAU;

use nalgebra::SVector;
use turbid::{
    flow::Drive,
    geometry::{Axis, Ball, Domain},
    observe,
    petsc::Session,
};

use crate::{Test, fields::grid, vorticity::filled};

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(the_dissipation_of_a_wave_outside_balls_is_that_of_its_formula),
        Test::of(the_dissipation_between_walls_is_that_of_poiseuille),
    ]
}

/// Two waves of shear have `2 D : D = (k cos k y)^2 + (2 k sin 2 k x)^2` and the product of both besides; outside balls by a sum over fine cells.
fn the_dissipation_of_a_wave_outside_balls_is_that_of_its_formula(session: &Session) {
    fn proof<const D: usize>(session: &Session, cells: [usize; 2], fine: usize) {
        let domain = Domain { size: SVector::<f64, D>::repeat(1.0), axes: [Axis::Periodic; D] };
        let center = |x: f64| SVector::from_fn(|axis, _| if axis == 0 { x } else { 0.41 });
        // one of them lies across the boundary
        let balls = [Ball { center: center(0.47), radius: 0.2 }, Ball { center: center(0.93), radius: 0.15 }];
        let wave = |component: usize, x: &SVector<f64, D>| match component {
            0 => (TAU * x[1]).sin(),
            1 => (2.0 * TAU * x[0]).cos(),
            _ => 0.0,
        };
        let density = |x: &SVector<f64, D>| (TAU * (TAU * x[1]).cos() - 2.0 * TAU * (2.0 * TAU * x[0]).sin()).powi(2);
        let size = 1.0 / fine as f64;
        let point = |place: usize| SVector::from_fn(|axis, _| ((place / fine.pow(axis as u32) % fine) as f64 + 0.5) * size);
        let within = |x: &SVector<f64, D>| balls.iter().any(|ball| domain.nearest_image(x - ball.center).norm() < ball.radius);
        let all = (0..fine.pow(D as u32)).map(point);
        let exact: f64 = all.filter(|x| !within(x)).map(|x| density(&x)).sum::<f64>() * size.powi(D as i32);
        let error = |cells: usize| {
            let grid = grid(session, &domain, cells);
            let found = observe::dissipation(&grid, &balls, &filled(session, &grid, wave), &Drive::Rest).unwrap();
            (found / exact - 1.0).abs()
        };
        let [coarse, finer] = cells.map(error);
        assert!(coarse < 0.02 && finer < 0.1 * coarse, "{D}D: {coarse:.2e}, {finer:.2e}");
    }
    proof::<2>(session, [16, 40], 1200);
    proof::<3>(session, [16, 32], 120);
}

/// `u = y (1 - y)`: a third of the length.
fn the_dissipation_between_walls_is_that_of_poiseuille(session: &Session) {
    let still = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let domain = Domain { size: SVector::from([2.0, 1.0]), axes: [Axis::Periodic, still] };
    for cells in [8, 16] {
        let grid = grid(session, &domain, cells);
        let fluid = filled(session, &grid, |component, x| if component == 0 { x[1] * (1.0 - x[1]) } else { 0.0 });
        let found = observe::dissipation::<2>(&grid, &[], &fluid, &Drive::Rest).unwrap();
        // the midpoint rule of a square misses a twelfth of the square of the spacing
        let midpoint = 2.0 / 3.0 - 2.0 * 4.0 / 12.0 * grid.spacing()[1].powi(2);
        assert!((found - midpoint).abs() < 1e-12, "{cells} cells: {found} {midpoint}");
    }
}
