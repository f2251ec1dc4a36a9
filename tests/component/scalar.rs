//! The scalar inclusion problem against computed values (reference, section 6.2), symmetries and balances.

use nalgebra::{SVector, Vector2, Vector3};
use turbid::{
    body::pack,
    geometry::{Axis, Ball, Domain},
    grid::{dirichlet, operators::signed},
    mechanics::{InclusionState, Inclusions, ScalarSetup, ScalarSolution},
    petsc::Session,
    scene::{ConstraintMethod, Tolerance},
};

use crate::{Test, suspension::assert_near};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(values_and_energies_are_those_of_an_independent_program),
        Test::of(errors_are_of_second_order_and_iterations_do_not_grow),
        Test::of(a_sphere_off_the_centre_is_of_second_order),
        Test::of(nothing_flows_net_out_of_many_disks),
        Test::of(nothing_flows_net_out_of_many_spheres),
        Test::of(symmetric_inclusions_have_equal_values),
        Test::of(a_channel_repeats_itself_and_knows_no_seam),
    ]
}

/// Centre, radius, value in the disk and integral of the squared gradient, for a unit source in the unit square.
pub const DISKS: [([f64; 2], f64, f64, f64); 6] = [
    ([0.5, 0.5], 0.10, 0.06274534820228, 0.030897858487),
    ([0.5, 0.5], 0.15, 0.05364913825614, 0.026343103811),
    ([0.5, 0.5], 0.20, 0.04382838849255, 0.021005256073),
    ([0.5, 0.5], 0.25, 0.03400744814349, 0.015525359083),
    ([0.5, 0.5], 0.30, 0.02473452517060, 0.010462322612),
    ([0.4, 0.55], 0.20, 0.04067803527883, 0.020998646033),
];

pub fn walled<const D: usize>(spacing: f64, inclusions: Vec<(Ball<D>, usize)>) -> ScalarSetup<D> {
    let still = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let domain = Domain { size: SVector::repeat(1.0), axes: [still; D] };
    ScalarSetup {
        domain,
        spacing,
        source: 1.0,
        gradient: None,
        inclusions,
        constraint: ConstraintMethod::Sharp,
        tolerance: Tolerance::Fixed(1e-10),
    }
}

pub fn solve<const D: usize>(session: &Session, setup: ScalarSetup<D>) -> (Inclusions<D>, ScalarSolution<D>) {
    let mut inclusions = Inclusions::new(session, setup).unwrap();
    let solution = inclusions.solve(&mut |_, _| {}).unwrap();
    (inclusions, solution)
}

pub fn disk([x, y]: [f64; 2], radius: f64, order: usize) -> (Ball<2>, usize) {
    (Ball { center: Vector2::new(x, y), radius }, order)
}

/// Errors relative to the reference, of value and energy.
fn errors(session: &Session, (center, radius, value, squared): ([f64; 2], f64, f64, f64), cells: u32, order: usize) -> ([f64; 2], usize) {
    let (inclusions, solution) = solve(session, walled(1.0 / f64::from(cells), vec![disk(center, radius, order)]));
    assert!(solution.inclusions[0].flux.abs() < 1e-9);
    let errors = [solution.inclusions[0].value / value - 1.0, -2.0 * solution.energy / squared - 1.0];
    (errors, inclusions.cost().krylov.iterations)
}

fn values_and_energies_are_those_of_an_independent_program(session: &Session) {
    for disk in DISKS {
        let ([value, energy], _) = errors(session, disk, 64, 8);
        assert!(value.abs() < 3e-4 && energy.abs() < 3e-4, "disk {disk:?}: errors {value:.1e}, {energy:.1e}");
    }
}

fn errors_are_of_second_order_and_iterations_do_not_grow(session: &Session) {
    let coarse = errors(session, DISKS[5], 32, 8);
    for cells in [64, 128, 256] {
        let fine = errors(session, DISKS[5], cells, 8);
        let bound = (32.0 / f64::from(cells)).powf(1.8);
        for (fine, coarse) in fine.0.iter().zip(coarse.0) {
            assert!(fine.abs() < bound * coarse.abs(), "{cells} cells: {fine:.1e} after {coarse:.1e}");
        }
        assert!(fine.1 <= coarse.1 + 2, "{} iterations after {}", fine.1, coarse.1);
    }
}

/// Each refinement brings a quarter of the change of the one before.
fn a_sphere_off_the_centre_is_of_second_order(session: &Session) {
    let found = [16, 32, 64].map(|cells| {
        let sphere = Ball { center: Vector3::new(0.42, 0.47, 0.55), radius: 0.25 };
        let (_, solution) = solve(session, walled(1.0 / f64::from(cells), vec![(sphere, 4)]));
        [solution.inclusions[0].value, solution.energy]
    });
    for [coarse, middle, fine] in [0, 1].map(|quantity| found.map(|found| found[quantity])) {
        let ratio = (middle - coarse) / (fine - middle);
        assert!((3.3..4.7).contains(&ratio), "changes go down by {ratio}: {coarse}, {middle}, {fine}");
    }
}

/// Inclusions with given centres between walls: no net flux by multipliers and by the grid, and a constant in each.
pub fn balanced<const D: usize>(session: &Session, setup: ScalarSetup<D>, flat: f64, most_iterations: usize) {
    let volume: f64 = setup.inclusions.iter().map(|(ball, _)| ball.volume()).sum();
    let (inclusions, solution) = solve(session, setup);
    let iterations = inclusions.cost().krylov.iterations;
    assert!(solution.inclusions.iter().all(|state| state.flux.abs() < 1e-9));
    let (size, edges) = (inclusions.setup().domain.size, inclusions.grid().spacing());
    let mut rows = solution.field.like().unwrap();
    dirichlet::minus_laplacian(session, inclusions.grid()).unwrap().multiply(&solution.field, &mut rows).unwrap();
    let flux = rows.mean().unwrap() * size.product();
    // cells beside a wall have a quarter less of the source
    let expected = size.product() - volume - 0.5 * edges.sum();
    let highest = solution.inclusions.iter().map(|state| state.value).fold(0.0, f64::max);
    let worst = session.world().max(deviation(&inclusions, &solution)) / highest;
    assert!((flux / expected - 1.0).abs() < 1e-8, "the grid lets {flux} out, not {expected}");
    assert!(worst < flat, "values inside differ by {worst:.1e}");
    assert!(iterations <= most_iterations, "{iterations} iterations");
}

/// Largest difference, on this rank, of the scalar at a cell centre in an inclusion from the value of that inclusion.
fn deviation<const D: usize>(inclusions: &Inclusions<D>, solution: &ScalarSolution<D>) -> f64 {
    let (grid, field) = (inclusions.grid(), solution.field.local().unwrap());
    let cells = grid.block(D).indices().map(|index| grid.position(D, signed(index)));
    let deviations = cells.zip(field.iter()).flat_map(|(position, value)| {
        let holds = move |state: &&InclusionState<D>| (position - state.center).norm() < state.radius;
        solution.inclusions.iter().filter(holds).map(move |state| (value - state.value).abs())
    });
    deviations.fold(0.0, f64::max)
}

pub fn random<const D: usize>(count: usize, radius: f64, gap: f64, cells_per_radius: f64, order: usize) -> ScalarSetup<D> {
    let mut setup = walled(radius / cells_per_radius, Vec::new());
    let centers = pack(&setup.domain, &[], &vec![radius; count], gap, 3).unwrap();
    setup.inclusions = centers.into_iter().map(|center| (Ball { center, radius }, order)).collect();
    setup
}

fn nothing_flows_net_out_of_many_disks(session: &Session) {
    balanced(session, random::<2>(30, 0.065, 0.2, 8.0, 8), 3e-3, 40);
}

fn nothing_flows_net_out_of_many_spheres(session: &Session) {
    balanced(session, random::<3>(10, 0.13, 0.3, 5.0, 4), 2e-2, 25);
}

fn symmetric_inclusions_have_equal_values(session: &Session) {
    let corners = [[0.3, 0.3], [0.7, 0.3], [0.3, 0.7], [0.7, 0.7]];
    let (_, solution) = solve(session, walled(1.0 / 40.0, corners.map(|center| disk(center, 0.14, 6)).to_vec()));
    for state in &solution.inclusions {
        assert_near("a disk of four", state.value, solution.inclusions[0].value, 1e-8);
    }
    let faces: Vec<(Ball<3>, usize)> = (0..6)
        .map(|face| {
            (
                Ball {
                    center: Vector3::from_fn(|axis, _| if axis == face / 2 { 0.3 + 0.4 * (face % 2) as f64 } else { 0.5 }),
                    radius: 0.12,
                },
                4,
            )
        })
        .collect();
    let (_, solution) = solve(session, walled(1.0 / 32.0, faces));
    for state in &solution.inclusions {
        // quadrature on a sphere has a pole, and is not alike along the axes
        assert_near("a sphere of six", state.value, solution.inclusions[0].value, 1e-5);
    }
}

/// Periodic along x, with one disk of every length 1.
pub fn channel(length: usize, x: f64) -> ScalarSetup<2> {
    let disks = (0..length).map(|place| disk([x + place as f64, 0.45], 0.2, 7)).collect();
    let setup = walled(1.0 / 40.0, disks);
    let domain = Domain { size: Vector2::new(length as f64, 1.0), axes: [Axis::Periodic, setup.domain.axes[1]] };
    ScalarSetup { domain, ..setup }
}

fn a_channel_repeats_itself_and_knows_no_seam(session: &Session) {
    let (_, once) = solve(session, channel(1, 0.51));
    let (_, twice) = solve(session, channel(2, 0.51));
    let (_, across) = solve(session, channel(1, 0.01));
    for state in twice.inclusions.iter().chain(&across.inclusions) {
        assert_near("the value in a channel", state.value, once.inclusions[0].value, 1e-8);
    }
    assert_near("the energy of two cells", twice.energy, 2.0 * once.energy, 1e-8);
    assert_near("the energy across the boundary", across.energy, once.energy, 1e-8);
}
