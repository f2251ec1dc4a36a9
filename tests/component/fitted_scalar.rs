//! The scalar inclusion problem on fitted meshes against computed values (reference, section 6.2).

use nalgebra::Vector2;
use turbid::{
    geometry::{Axis, Domain},
    grid::operators::signed,
    mechanics::{FittedInclusions, ScalarSetup, ScalarSolution},
    petsc::Session,
};

use crate::{
    Test,
    scalar::{DISKS, disk, walled},
    suspension::assert_near,
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(values_and_energies_are_of_fourth_order),
        Test::of(values_between_the_nodes_are_those_of_an_independent_program),
        Test::of(nothing_flows_net_out_of_many_disks_and_symmetric_ones_are_equal),
        Test::of(a_channel_knows_no_seam),
    ]
}

fn solve(session: &Session, setup: ScalarSetup<2>) -> (FittedInclusions<2>, ScalarSolution<2>) {
    let mut inclusions = FittedInclusions::new(session, setup).unwrap();
    let solution = inclusions.solve(&mut |_, _| {}).unwrap();
    (inclusions, solution)
}

fn values_and_energies_are_of_fourth_order(session: &Session) {
    for (center, radius, value, squared) in DISKS {
        let errors = [5.0, 20.0].map(|edges| {
            let (_, solution) = solve(session, walled(0.2 / edges, vec![disk(center, radius, 3)]));
            assert!(solution.inclusions[0].flux.abs() < 1e-12, "a flux of {:.1e}", solution.inclusions[0].flux);
            [(solution.inclusions[0].value / value - 1.0).abs(), (-2.0 * solution.energy / squared - 1.0).abs()]
        });
        for quantity in 0..2 {
            let [coarse, fine] = errors.map(|errors| errors[quantity]);
            let order = (coarse / fine).log2() / 2.0;
            assert!(fine < 2e-6 && order > 3.0, "disk {center:?}, {radius}: errors {coarse:.1e}, {fine:.1e}: order {order:.2}");
        }
    }
}

/// At centres of cells (reference, below table 6.2: a disk of radius 0.2).
fn values_between_the_nodes_are_those_of_an_independent_program(session: &Session) {
    let points = [[0.1, 0.1], [0.5, 0.9], [0.9, 0.3]];
    for (center, values) in
        [([0.5, 0.5], [0.011692871577, 0.023687597498, 0.021600541467]), ([0.4, 0.55], [0.011569378975, 0.023183004558, 0.021840277351])]
    {
        // 25 cells: their centres are multiples of 0.02, and odd
        let (inclusions, solution) = solve(session, walled(0.04, vec![disk(center, 0.2, 3)]));
        let grid = inclusions.grid();
        let field = solution.field.local().unwrap();
        for (point, value) in points.into_iter().zip(values) {
            let found = grid
                .block(2)
                .indices()
                .zip(field.iter())
                .find(|(index, _)| (grid.position(2, signed(*index)) - Vector2::from(point)).norm() < 1e-9);
            let mut sum = [found.map_or(0.0, |(_, value)| *value)];
            session.world().sum(&mut sum);
            assert_near(&format!("at {point:?}"), sum[0], value, 2e-4);
        }
    }
}

fn nothing_flows_net_out_of_many_disks_and_symmetric_ones_are_equal(session: &Session) {
    let corners = [[0.3, 0.3], [0.7, 0.3], [0.3, 0.7], [0.7, 0.7]];
    let (_, solution) = solve(session, walled(0.02, corners.map(|center| disk(center, 0.14, 3)).to_vec()));
    for state in &solution.inclusions {
        assert!(state.flux.abs() < 1e-12);
        assert_near("a disk of four", state.value, solution.inclusions[0].value, 1e-5);
    }
}

fn a_channel_knows_no_seam(session: &Session) {
    let channel = |x: f64| {
        let setup = walled(0.025, vec![disk([x, 0.45], 0.2, 3)]);
        ScalarSetup { domain: Domain { axes: [Axis::Periodic, setup.domain.axes[1]], ..setup.domain }, ..setup }
    };
    let [inside, across] = [0.5, 0.01].map(|x| solve(session, channel(x)).1);
    assert_near("the value across the boundary", across.inclusions[0].value, inside.inclusions[0].value, 1e-5);
    assert_near("the energy across the boundary", across.energy, inside.energy, 1e-5);
}
