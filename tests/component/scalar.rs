//! The scalar inclusion problem against computed values (reference, section 6.2), symmetries and balances.

use nalgebra::{SVector, Vector2};
use turbid::{
    geometry::{Axis, Ball, Domain},
    petsc::Session,
    scene::{Scene, Tolerance},
    simulation::{Inclusions, ScalarSetup, ScalarSolution},
};

use crate::{Test, suspension::assert_near};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![Test::of(explore)]
}

/// Centre, radius, value in the disk and integral of the squared gradient, for a unit source in the unit square.
const DISKS: [([f64; 2], f64, f64, f64); 6] = [
    ([0.5, 0.5], 0.10, 0.06274534820228, 0.030897858487),
    ([0.5, 0.5], 0.15, 0.05364913825614, 0.026343103811),
    ([0.5, 0.5], 0.20, 0.04382838849255, 0.021005256073),
    ([0.5, 0.5], 0.25, 0.03400744814349, 0.015525359083),
    ([0.5, 0.5], 0.30, 0.02473452517060, 0.010462322612),
    ([0.4, 0.55], 0.20, 0.04067803527883, 0.020998646033),
];

fn walled<const D: usize>(spacing: f64, inclusions: Vec<(Ball<D>, usize)>) -> ScalarSetup<D> {
    let still = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let domain = Domain { size: SVector::repeat(1.0), axes: [still; D] };
    ScalarSetup { domain, spacing, source: 1.0, inclusions, tolerance: Tolerance::Fixed(1e-10) }
}

fn solve<const D: usize>(session: &Session, setup: ScalarSetup<D>) -> (Inclusions<D>, ScalarSolution<D>) {
    let mut inclusions = Inclusions::new(session, setup).unwrap();
    let solution = inclusions.solve(&mut |_, _| {}).unwrap();
    (inclusions, solution)
}

fn disk([x, y]: [f64; 2], radius: f64, order: usize) -> (Ball<2>, usize) {
    (Ball { center: Vector2::new(x, y), radius }, order)
}

fn explore(session: &Session) {
    for (center, radius, value, energy) in DISKS {
        for cells in [24, 32, 48, 64, 96, 128, 192] {
            for order in [4, 6, 8, 12] {
                if (order as f64) > 1.4 * radius * cells as f64 || radius * (cells as f64) < 3.0 {
                    continue;
                }
                let (inclusions, solution) = solve(session, walled(1.0 / f64::from(cells), vec![disk(center, radius, order)]));
                let state = solution.inclusions[0];
                let out = inclusions.cost();
                println!(
                    "{center:?} r {radius} n {cells} K {order}: U {:.2e} E {:.2e} flux {:.1e} its {} field {:.3e}",
                    state.value / value - 1.0,
                    -2.0 * solution.energy / energy - 1.0,
                    state.flux,
                    out.krylov.iterations,
                    solution.field.norm().unwrap()
                );
            }
        }
    }
}
