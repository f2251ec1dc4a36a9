//! The constraint methods on Stokes flow: what all of them promise, and how well each keeps it.

use crate::{
    Test,
    suspension::{assert_near, couette, fixed, free, periodic_cube, solve, suspended},
};
use nalgebra::{SMatrix, Vector2, Vector3};
use std::rc::Rc;
use turbid::{
    body::Motion,
    constraint::{AdjointBody, BodyBlocks, Collector, Method, Placed, Size, Surrounded, Unknowns},
    flow::{Drive, InverseMethod},
    grid::{Grid, Node},
    linalg::SparseRows,
    mechanics::Suspension,
    motion::Simulation,
    observe,
    petsc::Session,
    plan::flow_solver,
    scene::{ConstraintMethod, MultiplierSolver, Scheme, Step, TimeSection, Tolerance},
    setup::Setup,
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(drags_have_the_digits_of_an_independent_program),
        Test::of(errors_fall_with_the_spacing_as_predicted),
        Test::of(a_scene_translated_by_whole_cells_has_the_same_drag),
        Test::of(a_scene_translated_by_parts_of_a_cell_has_the_error_of_the_grid),
        Test::of(a_symmetric_scene_has_a_symmetric_answer),
        Test::of(the_fluid_inside_moves_as_the_body_does),
        Test::of(what_bodies_bear_is_what_walls_and_stresslets_say),
        Test::of(loads_are_borne_to_the_last_digit),
        Test::of(multigrid_and_transforms_agree),
        Test::of(iterations_of_the_penalty_feel_neither_spacing_nor_epsilon),
        Test::of(the_penalty_errs_in_proportion_to_epsilon),
        Test::of(uzawa_finds_what_krylov_finds),
        Test::of(uzawa_beyond_its_bound_diverges_with_a_diagnosis),
        Test::of(spheres),
        Test::of(bodies_that_move_are_assembled_anew),
        Test::of(all_methods_move_two_disks_past_each_other),
        Test::of(a_method_of_ones_own_is_one_implementation),
    ]
}

const MEAN_VALUE: ConstraintMethod = ConstraintMethod::MeanValue(MultiplierSolver::Krylov);
const PENALTY: ConstraintMethod = ConstraintMethod::Penalty(None);

/// The methods on fixed grids, with the relative error that each may have at ten cells a radius.
const METHODS: [(ConstraintMethod, f64); 4] =
    [(ConstraintMethod::Sharp, 1e-3), (MEAN_VALUE, 0.11), (ConstraintMethod::Distributed, 0.13), (PENALTY, 0.01)];

/// Drag of the square array of cylinders at fraction 0.3 (reference, section 1.1).
const DRAG: f64 = 102.881303670;

/// One fixed disk of the square array at fraction 0.3.
fn array(constraint: ConstraintMethod, cells: usize, center: [f64; 2]) -> Setup<2> {
    let order = (cells * 5 / 16).min(16);
    let disk = suspended(center.into(), (0.3 / std::f64::consts::PI).sqrt(), fixed(), order);
    let setup = periodic_cube(1.0 / cells as f64, Drive::MeanVelocity(Vector2::x()), vec![disk]);
    Setup { constraint, inverse: InverseMethod::Transform, tolerance: Tolerance::Fixed(1e-8), ..setup }
}

fn drag(session: &Session, setup: Setup<2>) -> f64 {
    solve(session, setup).1.bodies[0].force[0]
}

/// Forces at all points inside, not at their outermost layer alone: dense multipliers and an exact inverse by FFT, in another language.
fn drags_have_the_digits_of_an_independent_program(session: &Session) {
    for (cells, reference) in [(16, 88.73476), (32, 93.26258), (64, 97.81366)] {
        assert_near("distributed", drag(session, array(ConstraintMethod::Distributed, cells, [0.5, 0.5])), reference, 1e-6);
    }
}

/// Mean square errors over positions on the grid; the penalty errs by less than its first order promises.
fn errors_fall_with_the_spacing_as_predicted(session: &Session) {
    let error = |constraint, cells: usize| {
        let squares = (0..4).map(|position| {
            let shift = |factor: f64| 0.5 + (f64::from(position) * factor).fract() / cells as f64;
            (drag(session, array(constraint, cells, [shift(0.38), shift(0.62)])) / DRAG - 1.0).powi(2)
        });
        (squares.sum::<f64>() / 4.0).sqrt()
    };
    for (constraint, least) in [(MEAN_VALUE, 0.9), (ConstraintMethod::Distributed, 0.8), (PENALTY, 0.9)] {
        let (coarse, fine) = (error(constraint, 16), error(constraint, 64));
        let order = (coarse / fine).log2() / 2.0;
        assert!(order >= least, "{}: errors {coarse:.2e} and {fine:.2e}, order {order:.2}", constraint.word());
    }
}

/// The same sums in another place, also across the boundary: measured 1e-13 on one rank; on more of them the tolerance of the solver counts.
fn a_scene_translated_by_whole_cells_has_the_same_drag(session: &Session) {
    for (constraint, _) in METHODS {
        let of = |shift: [f64; 2]| {
            let center = shift.map(|cells| (0.513 + cells / 32.0) % 1.0);
            drag(session, Setup { tolerance: Tolerance::Fixed(1e-12), ..array(constraint, 32, center) })
        };
        let here = of([0.0, 0.0]);
        for shift in [[3.0, 0.0], [0.0, 5.0], [16.0, 15.0]] {
            assert_near(&format!("{} {shift:?} cells away", constraint.word()), of(shift), here, 1e-9);
        }
    }
}

/// By parts of a cell the error changes: about its mean it scatters with the places of the surface between nodes. Of the 13 % of distributed
/// multipliers at ten cells a radius this is less than half; the rest is the layer of half a cell by which their disk is too small.
fn a_scene_translated_by_parts_of_a_cell_has_the_error_of_the_grid(session: &Session) {
    let errors = |constraint, cells: usize| {
        let places = [[0.0, 0.0], [0.5, 0.5], [0.25, 0.75], [0.1, 0.4], [0.7, 0.3], [0.416, 0.864]];
        let errors =
            places.map(|place| drag(session, array(constraint, cells, place.map(|part: f64| 0.5 + part / cells as f64))) / DRAG - 1.0);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        (mean, errors.iter().map(|error| (error - mean).abs()).fold(0.0, f64::max))
    };
    for (constraint, mean, tolerance, scatter) in [
        (ConstraintMethod::Sharp, -3.6e-4, 1e-4, 3e-4),
        (MEAN_VALUE, 0.096, 2e-3, 5e-3),
        (ConstraintMethod::Distributed, -0.132, 5e-3, 0.07),
        (PENALTY, -2e-3, 1e-3, 5e-3),
    ] {
        let [coarse, middle, fine] = [16, 32, 64].map(|cells| errors(constraint, cells));
        let said = format!("{}: mean and scatter {coarse:?}, {middle:?}, {fine:?}", constraint.word());
        assert!((middle.0 - mean).abs() < tolerance && middle.1 < scatter, "{said}");
        // at least of first order, up to a third in the mean
        assert!(fine.0.abs() < 0.33 * coarse.0.abs() && fine.1 < 0.25 * coarse.1, "{said}");
    }
    for (constraint, error) in METHODS {
        assert_near(constraint.word(), drag(session, array(constraint, 32, [0.991, 0.004])), DRAG, error);
    }
}

fn a_symmetric_scene_has_a_symmetric_answer(session: &Session) {
    for (constraint, _) in METHODS {
        let (_, solution) = solve(session, array(constraint, 32, [0.5, 0.5]));
        let (force, torque) = (solution.bodies[0].force, solution.bodies[0].torque);
        assert!(force[1].abs() < 1e-6 * force[0] && torque[(1, 0)].abs() < 1e-6 * force[0], "{}: {force}, {torque}", constraint.word());
    }
}

/// Two cells from the surface the velocity of a free disk's inside is its own: to the tolerance where it is imposed at the points
/// themselves, to the order of the method else.
fn the_fluid_inside_moves_as_the_body_does(session: &Session) {
    let (center, radius) = (Vector2::new(0.42, 0.47), 0.25);
    for (constraint, allowed) in
        [(ConstraintMethod::Sharp, 1e-4), (MEAN_VALUE, 2e-2), (ConstraintMethod::Distributed, 1e-5), (PENALTY, 1e-4)]
    {
        let setup = couette(1.0, 1.0 / 40.0, 1.0, vec![suspended(center, radius, free(), 10)]);
        let (suspension, solution) = solve(session, Setup { constraint, tolerance: Tolerance::Fixed(1e-7), ..setup });
        let (grid, twist) = (suspension.grid(), solution.bodies[0].twist);
        let (values, first) = (solution.fluid.local().unwrap(), solution.fluid.range().unwrap().start);
        let mut worst = 0.0_f64;
        for component in 0..2 {
            for index in grid.block(component).indices() {
                let index = index.map(|along| along as isize);
                let offset = grid.position(component, index) - center;
                if let (true, Node::Unknown(place)) = (offset.norm() < radius - 0.05, grid.fluid_node(component, index)) {
                    worst = worst.max((values[place - first] - twist.at(&offset)[component]).abs());
                }
            }
        }
        assert!(session.world().max(worst) < allowed, "{}: {worst:.1e}", constraint.word());
    }
}

/// The stress on the walls, and the one of the stresslets, of a free disk between sliding walls (reference, section 2.3).
fn what_bodies_bear_is_what_walls_and_stresslets_say(session: &Session) {
    for (constraint, error) in METHODS {
        let disk = suspended(Vector2::new(0.513, 0.5), 0.25, free(), 10);
        let setup = couette(1.0, 1.0 / 40.0, 1.0, vec![disk]);
        let (suspension, solution) = solve(session, Setup { constraint, tolerance: Tolerance::Fixed(1e-8), ..setup });
        let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap();
        assert_near(constraint.word(), viscosity.from_walls.unwrap(), viscosity.relative(), 1e-6);
        assert_near(constraint.word(), viscosity.relative(), 1.495293069, error);
        assert_near(constraint.word(), solution.bodies[0].twist.spin[(1, 0)], -0.441397925, error);
    }
}

fn loads_are_borne_to_the_last_digit(session: &Session) {
    let torque = SMatrix::<f64, 2, 2>::new(0.0, 0.3, -0.3, 0.0);
    let force = Vector2::new(0.7, -1.0);
    for (constraint, _) in METHODS {
        let disk = suspended(Vector2::new(0.41, 0.37), 0.2, Motion::Free { force, torque }, 6);
        let still = suspended(Vector2::new(0.83, 0.71), 0.15, fixed(), 5);
        let setup = periodic_cube(1.0 / 32.0, Drive::MeanVelocity(Vector2::zeros()), vec![disk, still]);
        let (_, solution) = solve(session, Setup { constraint, tolerance: Tolerance::Fixed(1e-9), ..setup });
        let state = &solution.bodies[0];
        assert!((state.force + force).norm() < 1e-6 && (state.torque + torque).norm() < 1e-6, "{}: {state:?}", constraint.word());
        assert!(state.twist.velocity.dot(&force) > 0.0);
    }
}

fn multigrid_and_transforms_agree(session: &Session) {
    for (constraint, _) in METHODS {
        let of = |inverse| drag(session, Setup { inverse, tolerance: Tolerance::Fixed(1e-7), ..array(constraint, 24, [0.513, 0.527]) });
        assert_near(constraint.word(), of(InverseMethod::Hypre), of(InverseMethod::Transform), 1e-5);
    }
}

/// Iterations of hypre's way in, which never sees `epsilon`: 15 to 30 on all of them.
fn iterations_of_the_penalty_feel_neither_spacing_nor_epsilon(session: &Session) {
    for (cells, epsilon) in [(16, 1e-6), (48, 1e-2), (48, 1e-4), (48, 1e-8), (48, 1e-12)] {
        let setup = array(ConstraintMethod::Penalty(Some(epsilon)), cells, [0.513, 0.527]);
        let (_, solution) = solve(session, Setup { inverse: InverseMethod::Hypre, tolerance: Tolerance::Fixed(1e-6), ..setup });
        let iterations = solution.cost.krylov.iterations;
        assert!(iterations <= 30, "{cells} cells, epsilon {epsilon:e}: {iterations} iterations");
    }
}

fn the_penalty_errs_in_proportion_to_epsilon(session: &Session) {
    let of = |epsilon| drag(session, array(ConstraintMethod::Penalty(Some(epsilon)), 32, [0.513, 0.527]));
    let limit = of(1e-10);
    let parts = [1e-2, 1e-3, 1e-4].map(|epsilon| (1.0 - of(epsilon) / limit) / epsilon);
    assert!(parts.iter().all(|part| (1.5..3.0).contains(part)), "lacking parts over epsilon: {parts:?}");
}

fn uzawa_finds_what_krylov_finds(session: &Session) {
    let by = |solver, cells| {
        let setup = array(ConstraintMethod::MeanValue(solver), cells, [0.513, 0.527]);
        let (_, solution) = solve(session, Setup { tolerance: Tolerance::Fixed(1e-7), ..setup });
        (solution.bodies[0].force[0], solution.cost.krylov.iterations)
    };
    let (coarse, fine) = (by(MultiplierSolver::Uzawa(None), 16), by(MultiplierSolver::Uzawa(None), 48));
    assert_near("drag", coarse.0, by(MultiplierSolver::Krylov, 16).0, 1e-5);
    assert!(fine.1 as f64 > 1.5 * coarse.1 as f64, "iterations grow as cells shrink: {} and {}", coarse.1, fine.1);
}

fn uzawa_beyond_its_bound_diverges_with_a_diagnosis(session: &Session) {
    let setup = array(ConstraintMethod::MeanValue(MultiplierSolver::Uzawa(Some(100.0))), 16, [0.5, 0.5]);
    let failure = flow_solver(session, setup).unwrap().solve(&mut |_, _| {}).err().unwrap().to_string();
    assert!(failure.contains("method.uzawa_step = 100.000 lies beyond its bound"), "{failure}");
}

/// The simple cubic array at fraction 0.064: 2.810198 times the drag of Stokes (reference, section 1.2), with four cells a radius:
/// first-order methods err by twice what they do with eight.
fn spheres(session: &Session) {
    let radius = (0.064 * 0.75 / std::f64::consts::PI).cbrt();
    let reference = 2.810198125 * 6.0 * std::f64::consts::PI * radius;
    for (constraint, error) in [(ConstraintMethod::Sharp, 0.01), (MEAN_VALUE, 0.2), (ConstraintMethod::Distributed, 0.2), (PENALTY, 0.04)] {
        let sphere = suspended(Vector3::new(0.513, 0.527, 0.481), radius, fixed(), 3);
        let setup = periodic_cube(1.0 / 17.0, Drive::MeanVelocity(Vector3::x()), vec![sphere]);
        let setup = Setup { constraint, inverse: InverseMethod::Transform, tolerance: Tolerance::Fixed(1e-6), ..setup };
        let (_, solution) = solve(session, setup);
        assert_near(constraint.word(), solution.bodies[0].force[0], reference, error);
        let iterations = solution.cost.krylov.iterations;
        assert!(iterations < 100, "{}: {iterations} iterations", constraint.word());
    }
}

fn bodies_that_move_are_assembled_anew(session: &Session) {
    for constraint in [MEAN_VALUE, ConstraintMethod::Distributed, PENALTY] {
        let bodies = [[0.2, 0.3], [0.7, 0.4], [0.45, 0.8]].map(|center| suspended(center.into(), 0.12, free(), 4));
        let setup = Setup { constraint, tolerance: Tolerance::Fixed(1e-9), ..couette(1.0, 0.03, 1.0, bodies.to_vec()) };
        let mut suspension = flow_solver(session, setup.clone()).unwrap();
        suspension.solve(&mut |_, _| {}).unwrap();
        let mut moved = setup;
        moved.bodies[1].body.ball.center += Vector2::new(0.013, 0.007);
        let centers: Vec<_> = moved.bodies.iter().map(|suspended| suspended.body.ball.center).collect();
        let moment = turbid::setup::Configuration::new(&centers, 0.0, 1e-9);
        let kept = suspension.solve_at(&moment, &mut |_, _| {}).unwrap();
        let mut assembled = [kept.cost.assembled as f64];
        session.world().sum(&mut assembled);
        assert_eq!(assembled[0], 1.0, "{}", constraint.word());
        let (_, fresh) = solve(session, moved);
        for (kept, fresh) in kept.bodies.iter().zip(&fresh.bodies) {
            assert!((kept.twist.velocity - fresh.twist.velocity).norm() < 1e-7, "{}", constraint.word());
        }
    }
}

/// Two disks that shear brings together go around each other, as the sharp method has it, within each method's error.
fn all_methods_move_two_disks_past_each_other(session: &Session) {
    let places = METHODS.map(|(constraint, error)| {
        let bodies = [[0.3, 0.58], [0.7, 0.42]].map(|center| suspended(center.into(), 0.12, free(), 5));
        let setup = Setup { constraint, tolerance: Tolerance::Fixed(1e-6), ..couette(1.0, 0.024, 1.0, bodies.to_vec()) };
        let time = TimeSection { step: Step::Fixed(0.1), end: 1.0, travel: 0.1, error: 1e-3, scheme: Scheme::TwoStep, until: None };
        let suspension = flow_solver(session, setup).unwrap();
        let mut simulation = Simulation::flowing(session, suspension, time);
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        (constraint, error, simulation.state().centers()[0])
    });
    let sharp = places[0].2;
    for (constraint, error, place) in places {
        assert!((place - sharp).norm() < 0.2 * error + 1e-12, "{}: {place} instead of {sharp}", constraint.word());
        assert!((sharp[0] - 0.3).abs() > 0.03);
    }
}

/// Surface multipliers, the velocity at each point of the surface that of the nearest node: the mean-value method with other weights.
struct Nearest;

impl Method<2, Box<dyn BodyBlocks<2>>> for Nearest {
    fn description(&self) -> String {
        "surface multipliers at the nearest nodes".into()
    }

    fn assemble(&self, grid: &Grid<2>, bodies: &[Surrounded<2>], _memory: Vec<Vec<f32>>) -> Vec<Box<dyn BodyBlocks<2>>> {
        bodies.iter().map(|body| Box::new(at_nearest_nodes(grid, body.placed)) as Box<_>).collect()
    }

    fn bytes(&self, _grid: &Grid<2>, size: &Size<2>) -> f64 {
        8.0 * size.count as f64
    }
}

fn at_nearest_nodes(grid: &Grid<2>, placed: &Placed<2>) -> AdjointBody<2> {
    let (mut collector, mut rows) = (Collector::new(grid, Unknowns::Fluid, placed.center), SparseRows::default());
    for point in placed.surface.offsets().map(|offset| placed.center + offset) {
        for component in 0..2 {
            let place = |axis: usize| point[axis] / grid.spacing()[axis] - grid.stagger(component, axis);
            let node = collector.node(component, std::array::from_fn(|axis| place(axis).round() as isize));
            rows.push(node.map(|node| (node, 1.0)));
        }
    }
    AdjointBody::on_surface(grid, placed, collector.nodes, rows, Vec::new())
}

/// What no scene knows is solved as what all know, to the accuracy of a method of first order.
fn a_method_of_ones_own_is_one_implementation(session: &Session) {
    let setup = array(ConstraintMethod::Sharp, 40, [0.513, 0.527]);
    let mut suspension = Suspension::with_method(session, setup, Rc::new(Nearest)).unwrap();
    let solution = suspension.solve(&mut |_, _| {}).unwrap();
    assert_near("drag", solution.bodies[0].force[0], DRAG, 0.25);
    assert!(solution.cost.krylov.iterations < 200, "{} iterations", solution.cost.krylov.iterations);
}
