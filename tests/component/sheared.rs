//! Boxes whose images slide: the same lattice in another box, whole turns, whole cells, and runs in time.

use nalgebra::{SVector, Vector2, Vector3};
use turbid::{
    body::pack,
    error::Error,
    flow::{Drive, InverseMethod, Stokes},
    geometry::{Axis, Ball, Domain, LeesEdwards, near_pairs},
    grid::{Grid, operators::signed},
    motion::Simulation,
    observe::{self, CellCenters, CellVorticity},
    petsc::Session,
    plan::flow_solver,
    scene::{ConstraintMethod, ContactModel, MultiplierSolver, Scheme, Step, TimeSection, Tolerance},
    setup::{Setup, State, SuspendedBody},
};

use crate::{
    Test,
    suspension::{assert_near, free, solve, suspended},
};

/// Viscosity of the square lattice of free disks, fraction 0.3, in shear along an edge (exact, from lattice sums).
const SQUARE: f64 = 1.59811597742;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_square_lattice_slid_by_half_its_edge_is_the_centred_lattice),
        Test::of(a_cubic_lattice_slid_by_half_its_edge_is_that_of_a_box_of_two),
        Test::of(lattices_on_an_oblique_grid_are_as_exact_as_on_a_straight_one),
        Test::of(a_turn_of_the_box_changes_nothing),
        Test::of(where_the_box_is_cut_changes_nothing),
        Test::of(multigrid_and_transforms_agree_across_the_seam),
        Test::of(a_part_of_a_cell_is_refused_where_a_grid_may_not_be_oblique),
        Test::of(where_a_box_is_cut_changes_nothing_on_an_oblique_grid),
        Test::of(what_frames_hold_of_an_oblique_grid_is_at_the_centres_of_its_cells),
        Test::of(steps_shorter_than_a_cell_lead_where_long_ones_do),
        Test::of(a_lattice_comes_back_after_a_strain_of_one),
        Test::of(disks_go_the_same_way_wherever_the_box_is_cut),
        Test::of(midpoint_and_two_step_rules_keep_the_beat),
        Test::of(disks_that_meet_across_the_seam_do_not_overlap),
    ]
}

/// A box of images displaced by `start`, sheared at unit rate.
fn sheared<const D: usize>(size: SVector<f64, D>, start: f64) -> Domain<D> {
    let mut domain = Domain { size, axes: [Axis::Periodic; D] };
    domain.axes[1] = Axis::Sheared(LeesEdwards::steady(start, size[1], 0.0));
    domain
}

fn setup<const D: usize>(domain: Domain<D>, spacing: f64, bodies: Vec<SuspendedBody<D>>) -> Setup<D> {
    Setup {
        changing_drive: None,
        domain,
        spacing,
        viscosity: 1.0,
        drive: Drive::Shear(1.0),
        bodies,
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Transform,
        tolerance: Tolerance::Fixed(1e-10),
    }
}

fn viscosity<const D: usize>(session: &Session, setup: Setup<D>) -> f64 {
    let (suspension, solution) = solve(session, setup);
    observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap().relative()
}

/// Random disks at fraction 0.3 in a square box of images displaced by a number of cells, moved on by so many cells.
fn dense_suspension(count: usize, cells: f64, aside: f64, moved: [f64; 2]) -> Setup<2> {
    dense_suspension_at(0.3, count, cells, (aside, moved))
}

fn dense_suspension_at(fraction: f64, count: usize, cells: f64, (aside, moved): (f64, [f64; 2])) -> Setup<2> {
    let size = (count as f64 * std::f64::consts::PI / fraction).sqrt();
    let (spacing, domain) = (size / cells, sheared(Vector2::repeat(size), aside * size / cells));
    let centers: Vec<Vector2<f64>> = pack(&domain, &[] as &[Ball<2>], &vec![1.0; count], 0.03 / fraction, 3).unwrap();
    let there = |center: Vector2<f64>| domain.wrap(center + Vector2::from(moved) * spacing);
    let bodies = centers.into_iter().map(|center| suspended(there(center), 1.0, free(), 5)).collect();
    setup(domain, spacing, bodies)
}

fn a_square_lattice_slid_by_half_its_edge_is_the_centred_lattice(session: &Session) {
    let radius = (0.3 / std::f64::consts::PI).sqrt();
    let disk = |x: f64, y: f64| suspended(Vector2::new(x, y), radius, free(), 6);
    // one of the disks lies across the boundary
    for (x, y) in [(0.513, 0.47), (0.07, 0.95)] {
        let one = viscosity(session, setup(sheared(Vector2::repeat(1.0), 0.5), 1.0 / 24.0, vec![disk(x, y)]));
        let plain = Domain { size: Vector2::new(1.0, 2.0), axes: [Axis::Periodic; 2] };
        let two = viscosity(session, setup(plain, 1.0 / 24.0, vec![disk(x, y), disk(x + 0.5, y + 1.0)]));
        assert!((one / two - 1.0).abs() < 1e-8, "{one} and {two} differ by {:e}", one / two - 1.0);
        assert!((one / SQUARE - 1.0).abs() > 0.05, "{one} is not that of the square lattice");
    }
}

fn a_cubic_lattice_slid_by_half_its_edge_is_that_of_a_box_of_two(session: &Session) {
    let sphere = |x: f64, y: f64| suspended(Vector3::new(x, y, 0.43), 0.35, free(), 2);
    let one = viscosity(session, setup(sheared(Vector3::repeat(1.0), 0.5), 1.0 / 12.0, vec![sphere(0.21, 0.9)]));
    let plain = Domain { size: Vector3::new(1.0, 2.0, 1.0), axes: [Axis::Periodic; 3] };
    let two = viscosity(session, setup(plain, 1.0 / 12.0, vec![sphere(0.21, 0.9), sphere(0.71, 1.9)]));
    assert!((one / two - 1.0).abs() < 1e-8, "{one} and {two} differ by {:e}", one / two - 1.0);
}

/// An odd number of cells: images lie half a cell more than whole ones aside, and the grid is oblique.
fn lattices_on_an_oblique_grid_are_as_exact_as_on_a_straight_one(session: &Session) {
    let radius = (0.3 / std::f64::consts::PI).sqrt();
    let disk = |x: f64, y: f64| suspended(Vector2::new(x, y), radius, free(), 6);
    for (x, y) in [(0.513, 0.47), (0.07, 0.95)] {
        let slid = |cells: f64| viscosity(session, setup(sheared(Vector2::repeat(1.0), 0.5), 1.0 / cells, vec![disk(x, y)]));
        let plain = Domain { size: Vector2::new(1.0, 2.0), axes: [Axis::Periodic; 2] };
        let reference = viscosity(session, setup(plain, 1.0 / 88.0, vec![disk(x, y), disk(x + 0.5, y + 1.0)]));
        for (cells, tolerance) in [(23.0, 4e-4), (35.0, 1e-4), (53.0, 3e-5)] {
            assert_near("viscosity of the centred lattice", slid(cells), reference, tolerance);
        }
    }
    let sphere = |x: f64, y: f64| suspended(Vector3::new(x, y, 0.43), 0.35, free(), 2);
    let slid = viscosity(session, setup(sheared(Vector3::repeat(1.0), 0.5), 1.0 / 25.0, vec![sphere(0.21, 0.9)]));
    let plain = Domain { size: Vector3::new(1.0, 2.0, 1.0), axes: [Axis::Periodic; 3] };
    let two = viscosity(session, setup(plain, 1.0 / 25.0, vec![sphere(0.21, 0.9), sphere(0.71, 1.9)]));
    assert_near("viscosity of a centred lattice of spheres", slid, two, 5e-5);
}

fn a_turn_of_the_box_changes_nothing(session: &Session) {
    let once = viscosity(session, dense_suspension(6, 44.0, 13.0, [0.0; 2]));
    for aside in [13.0 + 44.0, 13.0 - 5.0 * 44.0] {
        let turned = viscosity(
            session,
            Setup { domain: dense_suspension(6, 44.0, aside, [0.0; 2]).domain, ..dense_suspension(6, 44.0, 13.0, [0.0; 2]) },
        );
        assert!((turned / once - 1.0).abs() < 1e-8, "{turned} and {once}");
    }
}

/// Bodies moved by whole cells see the same grid, and their images across the boundary too.
fn where_the_box_is_cut_changes_nothing(session: &Session) {
    let methods = [
        ConstraintMethod::Sharp,
        ConstraintMethod::MeanValue(MultiplierSolver::Krylov),
        ConstraintMethod::Distributed,
        ConstraintMethod::Penalty(Some(1e-3)),
    ];
    for constraint in methods {
        let moved = |by: [f64; 2]| viscosity(session, Setup { constraint, ..dense_suspension(6, 44.0, 13.0, by) });
        let here = moved([0.0; 2]);
        for by in [[0.0, 17.0], [9.0, 35.0], [30.0, 8.0]] {
            let there = moved(by);
            assert!((there / here - 1.0).abs() < 1e-7, "{constraint:?}: {there} and {here} differ by {:e}", there / here - 1.0);
        }
    }
}

fn multigrid_and_transforms_agree_across_the_seam(session: &Session) {
    let by = |inverse| viscosity(session, Setup { inverse, ..dense_suspension(6, 44.0, 13.0, [3.0, 20.0]) });
    let (multigrid, transforms) = (by(InverseMethod::Hypre), by(InverseMethod::Transform));
    assert!((multigrid / transforms - 1.0).abs() < 1e-7, "{multigrid} and {transforms}");
}

/// Bodies moved along its lines see the same grid.
fn where_a_box_is_cut_changes_nothing_on_an_oblique_grid(session: &Session) {
    let (aside, slope) = (13.37, 0.37 / 44.0);
    let moved = |[along_x, along_y]: [f64; 2], inverse| {
        viscosity(session, Setup { inverse, ..dense_suspension(6, 44.0, aside, [along_x + slope * along_y, along_y]) })
    };
    let here = moved([0.0; 2], InverseMethod::Transform);
    for by in [[0.0, 17.0], [9.0, 35.0], [30.0, 8.0]] {
        let there = moved(by, InverseMethod::Transform);
        assert!((there / here - 1.0).abs() < 1e-7, "{there} and {here} differ by {:e}", there / here - 1.0);
    }
    let multigrid = moved([3.0, 20.0], InverseMethod::Hypre);
    assert!((multigrid / here - 1.0).abs() < 1e-7, "{multigrid} and {here}");
    let whole = viscosity(session, dense_suspension(6, 44.0, 13.0, [0.0; 2]));
    assert!((whole / here - 1.0).abs() > 1e-5, "images 13 and 13.37 cells aside have one viscosity");
}

/// Ends and steps are those asked for, and places converge to those of whole cells with the square of the step.
fn steps_shorter_than_a_cell_lead_where_long_ones_do(session: &Session) {
    let cell = 1.0 / 44.0;
    let went = |step: f64, end: f64| {
        run(simulation(
            session,
            dense_suspension(6, 44.0, 0.0, [0.0; 2]),
            time(Step::Fixed(step), end, Scheme::TwoStep),
            ContactModel::None,
        ))
    };
    let apart = |one: &State<2>, two: &State<2>| {
        let gaps = one.bodies.iter().zip(&two.bodies).map(|(one, two)| (one.center - two.center).norm());
        gaps.fold(0.0, f64::max)
    };
    let (curve, short) = went(0.4 * cell, 8.0 * cell);
    assert_eq!(curve.len(), 21);
    let [(_, long), (_, twice)] = [2.0, 4.0].map(|cells| went(cells * cell, 8.0 * cell));
    let [near, far] = [&long, &twice].map(|state| apart(state, &short));
    assert!(near < 5e-4 && far > 2.5 * near, "{near:e} {far:e}");
    let (curve, state) = went(1.3 * cell, 3.7 * cell);
    assert_eq!((curve.len(), state.time), (4, 3.7 * cell));
}

/// A wave that the images of an oblique grid carry on, as a fluid vector has it, at the centres of cells that are drawn along the axes.
fn what_frames_hold_of_an_oblique_grid_is_at_the_centres_of_its_cells(session: &Session) {
    let errors = |cells: f64| {
        let (world, domain) = (session.world(), sheared(Vector2::new(1.0, 0.8), 0.3 + 0.4 / cells));
        let grid = Grid::oblique(&domain, 1.0 / cells, world.size(), world.rank()).unwrap();
        assert!((grid.slope() * 0.8 * cells).abs() > 0.05);
        let wave = Vector2::new(1.0, (1.0 - domain.shift()) / 0.8) * std::f64::consts::TAU;
        let value = |field: usize, point: Vector2<f64>| (wave.dot(&point) + field as f64).sin();
        let mut fluid = Stokes::new(session, &grid).vector().unwrap();
        for field in 0..3 {
            let entries = &mut fluid.local_mut().unwrap()[grid.local_range(field)];
            entries
                .iter_mut()
                .zip(grid.block(field).indices())
                .for_each(|(entry, index)| *entry = value(field, grid.position(field, signed(index))));
        }
        let mut centers = CellCenters::new(&grid, &fluid).unwrap();
        let (velocity, pressure) = (centers.velocity(&fluid).unwrap(), centers.pressure(&fluid).unwrap());
        let vorticity = CellVorticity::new(&grid, &fluid).unwrap().evaluate(&grid, &fluid, &Drive::Rest).unwrap();
        let mut worst = [0.0f64; 3];
        for (((cell, velocity), pressure), vorticity) in grid.block(2).indices().zip(velocity).zip(pressure).zip(vorticity) {
            let point = grid.upright_center(signed(cell));
            let slope = |field: usize, axis: usize| wave[axis] * (wave.dot(&point) + field as f64).cos();
            let curl = slope(1, 0) - slope(0, 1);
            let off = [velocity[0] - value(0, point), pressure - value(2, point), (vorticity - curl) / wave.norm()];
            worst.iter_mut().zip(off).for_each(|(worst, off)| *worst = worst.max(off.abs()));
        }
        worst.map(|worst| world.max(worst))
    };
    let (coarse, fine) = (errors(20.0), errors(40.0));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!(fine < 0.01 && coarse > 3.4 * fine, "{coarse:e} {fine:e}");
    }
}

fn a_part_of_a_cell_is_refused_where_a_grid_may_not_be_oblique(session: &Session) {
    let world = session.world();
    let error = Grid::new(&sheared(Vector2::repeat(1.0), 0.03), 1.0 / 16.0, world.size(), world.rank()).err().unwrap();
    let Error::Refused(text) = error else { panic!("{error:?}") };
    assert!(text.remedy.contains("0.48 cells aside"), "{text}");
}

fn simulation(session: &Session, setup: Setup<2>, time: TimeSection, contact: ContactModel) -> Simulation<2> {
    Simulation::flowing(session, flow_solver(session, setup.with_contact(contact)).unwrap(), time)
}

/// Runs to the end; returns viscosities by time, and the last state.
fn run(mut simulation: Simulation<2>) -> (Vec<(f64, f64)>, State<2>) {
    let mut curve = Vec::new();
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let (suspension, solution) = (simulation.suspension().unwrap(), observation.solution.as_ref().unwrap());
        let found = observe::viscosity(suspension.setup(), suspension.grid(), solution, &observation.contacts).unwrap().unwrap();
        curve.push((simulation.state().time, found.relative()));
        if simulation.over() {
            return (curve, simulation.state().clone());
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

fn time(step: Step, end: f64, scheme: Scheme) -> TimeSection {
    TimeSection { step, end, scheme, travel: 0.1, error: 1e-3, until: None }
}

/// The disk is carried along; what is to be seen depends on the strain up to whole numbers alone.
fn a_lattice_comes_back_after_a_strain_of_one(session: &Session) {
    let radius = (0.3 / std::f64::consts::PI).sqrt();
    let disk = suspended(Vector2::new(0.5, 0.5), radius, free(), 8);
    let setup = setup(sheared(Vector2::repeat(1.0), 0.0), 1.0 / 24.0, vec![disk]);
    let (curve, state) = run(simulation(session, setup, time(Step::Fixed(1.0 / 6.0), 1.0, Scheme::TwoStep), ContactModel::None));
    assert_eq!(curve.len(), 7);
    assert_near("viscosity of the square lattice", curve[0].1, SQUARE, 5e-3);
    assert_near("viscosity after a strain of one", curve[6].1, curve[0].1, 1e-7);
    assert_near("viscosity by symmetry", curve[5].1, curve[1].1, 1e-7);
    // points of surfaces are not symmetric about the centre
    assert!((state.bodies[0].center - Vector2::new(1.0, 0.5)).norm() < 2e-5, "{}", state.bodies[0].center);
}

/// A box cut half its height further up: half a step moves the disks on the grid by half as many cells as images slide, one.
fn disks_go_the_same_way_wherever_the_box_is_cut(session: &Session) {
    let end = 16.0 / 44.0;
    let went = |setup: Setup<2>| run(simulation(session, setup, time(Step::Fixed(4.0 / 44.0), end, Scheme::Midpoint), ContactModel::None));
    let (here, there) = (dense_suspension(6, 44.0, 0.0, [0.0, 4.0]), dense_suspension(6, 44.0, 0.0, [0.0, 26.0]));
    let (domain, half) = (here.domain.clone(), 0.5 * here.domain.size[1]);
    let row = |center: &Vector2<f64>| (center[1] / domain.size[1]).floor();
    let starts: Vec<Vector2<f64>> = there.bodies.iter().map(|suspended| suspended.body.ball.center).collect();
    let ((curve, state), (other_curve, other_state)) = (went(here), went(there));
    for ((_, one), (_, two)) in curve.iter().zip(&other_curve) {
        assert!((one / two - 1.0).abs() < 1e-7, "{one} and {two}");
    }
    let domain = domain.clone().at(end);
    let crossed = other_state.bodies.iter().zip(&starts).filter(|(body, start)| row(&body.center) != row(start)).count();
    for (one, two) in state.bodies.iter().zip(&other_state.bodies) {
        // the one cut moves by `half` more
        let moved = two.center - one.center - Vector2::new(half * end, half);
        assert!(domain.nearest_image(moved).norm() < 1e-6, "{moved}");
    }
    let crossing = state.bodies.iter().filter(|body| row(&body.center) != 0.0).count();
    assert!(crossed + crossing > 0, "none crossed the seam");
}

fn midpoint_and_two_step_rules_keep_the_beat(session: &Session) {
    let shift_period = 1.0 / 44.0;
    for (scheme, together) in [(Scheme::Midpoint, 2.0), (Scheme::TwoStep, 1.0), (Scheme::Euler, 1.0)] {
        let mut simulation =
            simulation(session, dense_suspension(6, 44.0, 0.0, [0.0; 2]), time(Step::Auto, 8.0 * shift_period, scheme), ContactModel::None);
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            let first = simulation.state().steps == 0 && scheme == Scheme::TwoStep;
            let units = simulation.step(&observation, &mut |_, _| {}).unwrap().length / shift_period / if first { 2.0 } else { together };
            assert!((units - units.round()).abs() < 1e-9 && units > 0.5, "{scheme:?}: {units}");
        }
        assert!((simulation.state().time - 8.0 * shift_period).abs() < 1e-12);
    }
}

fn disks_that_meet_across_the_seam_do_not_overlap(session: &Session) {
    let mut simulation = simulation(
        session,
        dense_suspension_at(0.5, 14, 44.0, (0.0, [0.0; 2])),
        time(Step::Auto, 1.5, Scheme::TwoStep),
        ContactModel::Inelastic,
    );
    let (mut across, radii) = (0, vec![1.0; 14]);
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        across += observation.contacts.iter().filter(|active| active.force > 0.0 && active.contact.image[1] != 0).count();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
        let smallest = near_pairs(simulation.domain(), &simulation.state().balls(&radii), 0.5).into_iter().map(|pair| pair.gap);
        let smallest = smallest.fold(f64::INFINITY, f64::min);
        assert!(smallest > -1e-9, "overlap of {smallest:e} at {}", simulation.state().time);
        let total: Vector2<f64> = observation.solution.unwrap().bodies.iter().map(|body| body.force).sum();
        assert!(total.norm() < 1e-4, "net force {total}");
    }
    assert!(across > 0, "none met across the boundary");
}
