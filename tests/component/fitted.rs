//! Flow on fitted meshes against computed values (reference, sections 1 to 3), balances, and meshes that move.

use std::f64::consts::PI;

use nalgebra::{SMatrix, Vector2};
use turbid::{
    body::{Motion, Twist},
    flow::{Drive, InverseMethod},
    geometry::{Axis, Domain},
    mechanics::{FittedFlow, FlowSolver, History},
    motion::Simulation,
    observe,
    petsc::Session,
    scene::{ConstraintMethod, Scheme, Step, TimeSection, Tolerance},
    setup::{Configuration, Setup, SuspendedBody},
    system::{ExtrapolationHistory, Snapshot, Solution},
};

use crate::{
    Test,
    suspension::{assert_near, couette, fixed, free, periodic_cube, suspended},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(drag_and_viscosity_of_a_square_array_are_of_fourth_order),
        Test::of(a_free_disk_in_a_couette_cell),
        Test::of(two_disks_in_periodic_shear_between_walls_and_sedimenting),
        Test::of(a_channel_driven_by_each_drive),
        Test::of(a_periodic_box_driven_by_a_gradient_or_a_force),
        Test::of(a_disk_in_a_closed_box),
        Test::of(a_translated_scene_gives_the_same_answer),
        Test::of(the_grid_holds_the_flow_of_the_mesh),
        Test::of(probes_near_a_body_have_the_flow_of_the_mesh),
        Test::of(a_mesh_that_moves_gives_what_a_new_one_gives),
        Test::of(two_disks_pass_each_other_in_shear),
    ]
}

fn solve(session: &Session, setup: Setup<2>) -> (FittedFlow<2>, Solution<2>) {
    let mut fitted = FittedFlow::new(session, setup).unwrap();
    let flow: &mut dyn FlowSolver<2> = &mut fitted;
    let solution = flow.solve(&mut |_, _| {}).unwrap();
    (fitted, solution)
}

const CENTER: [f64; 2] = [0.513, 0.527];

fn array(edges_per_radius: f64, center: [f64; 2], drive: Drive<2>, motion: Motion<2>) -> Setup<2> {
    let radius = (0.3 / PI).sqrt();
    periodic_cube(radius / edges_per_radius, drive, vec![suspended(Vector2::from(center), radius, motion, 3)])
}

fn drag(session: &Session, edges_per_radius: f64, center: [f64; 2]) -> f64 {
    solve(session, array(edges_per_radius, center, Drive::MeanVelocity(Vector2::x()), fixed())).1.bodies[0].force[0]
}

fn drag_and_viscosity_of_a_square_array_are_of_fourth_order(session: &Session) {
    let errors = [4.0, 16.0].map(|edges| {
        let (_, sheared) = solve(session, array(edges, CENTER, Drive::Shear(1.0), free()));
        let viscosity = 1.0 + sheared.bodies[0].stresslet[(0, 1)];
        assert_near("spin", sheared.bodies[0].twist.spin[(1, 0)], -0.5, 1e-5);
        [(drag(session, edges, CENTER) / 102.881303670 - 1.0).abs(), (viscosity / 1.59811597742 - 1.0).abs()]
    });
    for quantity in 0..2 {
        let order = (errors[0][quantity] / errors[1][quantity]).log2() / 2.0;
        assert!(order > 3.4, "order {order:.2}: {errors:?}");
    }
    assert!(errors[1][0] < 1e-5 && errors[1][1] < 3e-6, "{errors:?}");
}

/// In a thin layer around a body that moves, where interpolation from the grid would reach into it: coarse meshes have there what a fine one has.
fn probes_near_a_body_have_the_flow_of_the_mesh(session: &Session) {
    let (center, radius) = (Vector2::from(CENTER), (0.3 / PI).sqrt());
    let probe = |edges: f64| {
        let (fitted, solution) = solve(session, array(edges, CENTER, Drive::MeanVelocity(Vector2::x()), fixed()));
        observe::velocity_probe(&fitted, &solution, 40).unwrap()
    };
    let fine = probe(24.0);
    for (edges, promised) in [(4.0, 2e-2), (8.0, 4e-3)] {
        let coarse = probe(edges);
        let off = |near: bool| {
            let errors = fine.points.iter().zip(fine.values.iter().zip(&coarse.values)).filter(|(point, _)| {
                let gap = ((*point - center).norm() - radius) / radius;
                (-0.1..0.1).contains(&gap) == near
            });
            errors.map(|(_, (one, other))| (one[0] - other[0]).hypot(one[1] - other[1])).fold(0.0, f64::max)
        };
        let (near, far) = (off(true), off(false));
        assert!(near < promised && near < 2.0 * far, "{edges} edges: near the surface {near:.1e}, elsewhere {far:.1e}");
    }
}

fn viscosity(fitted: &FittedFlow<2>, solution: &Solution<2>) -> observe::Viscosity {
    observe::viscosity(fitted.setup(), fitted.grid(), solution, &[]).unwrap().unwrap()
}

/// Reference, section 2.3; the stress on the walls and the stresslet are two roads to one viscosity.
fn a_free_disk_in_a_couette_cell(session: &Session) {
    for (length, radius, spin, stress) in [(1.0, 0.2, -0.462789970, 1.291011445), (2.0, 0.125, -0.482222636, 1.055394686)] {
        let disk = suspended(Vector2::new(0.513, 0.5), radius, free(), 3);
        let (fitted, solution) = solve(session, couette(length, radius / 8.0, 2.0, vec![disk]));
        let viscosity = viscosity(&fitted, &solution);
        assert_near("stress", viscosity.relative(), stress, 2e-5);
        assert_near("stress on the walls", viscosity.from_walls.unwrap(), viscosity.relative(), 1e-8);
        assert_near("spin", solution.bodies[0].twist.spin[(1, 0)], 2.0 * spin, 2e-5);
    }
}

fn pair(motion: Motion<2>) -> Vec<SuspendedBody<2>> {
    // the reference cell is centred at the origin
    [[0.3, 0.4], [0.65, 0.62]].map(|center| suspended(Vector2::from(center), 0.15, motion, 3)).to_vec()
}

fn assert_moves(what: &str, solution: &Solution<2>, references: [[f64; 3]; 2], shift: f64) {
    for (state, [x, y, spin]) in solution.bodies.iter().zip(references) {
        let found = [state.twist.velocity[0] - shift, state.twist.velocity[1], state.twist.spin[(1, 0)]];
        let off = found.iter().zip([x, y, spin]).map(|(found, reference)| (found - reference).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5, "{what}: {found:?} is off {:?} by {off:.1e}", [x, y, spin]);
    }
}

/// Reference, section 2.4, P2.
fn two_disks_in_periodic_shear_between_walls_and_sedimenting(session: &Session) {
    let spacing = 0.15 / 8.0;
    let (fitted, sheared) = solve(session, periodic_cube(spacing, Drive::Shear(1.0), pair(free())));
    let spin = -0.435467158;
    assert_moves("periodic", &sheared, [[-0.057876592, 0.030739627, spin], [0.077876592, -0.030739627, spin]], 0.5);
    assert_near("viscosity in a periodic box", viscosity(&fitted, &sheared).relative(), 1.3457188363, 4e-5);
    let (fitted, walled) = solve(session, couette(1.0, spacing, 1.0, pair(free())));
    let references = [[-0.053755754, 0.018929646, -0.406080384], [0.083329666, -0.018834326, -0.402670314]];
    assert_moves("between walls", &walled, references, 0.0);
    assert_near("viscosity between walls", viscosity(&fitted, &walled).relative(), 1.3813693532, 4e-5);
    let pulled = Motion::Free { force: Vector2::x(), torque: SMatrix::zeros() };
    let (_, falling) = solve(session, periodic_cube(spacing, Drive::Rest, pair(pulled)));
    let down = |spin| [0.049167859, 0.004072376, spin];
    assert_moves("sedimenting", &falling, [down(-0.078226653), down(0.078226653)], 0.0);
    falling.bodies.iter().for_each(|state| assert_near("the fluid holds the weight", -state.force[0], 1.0, 1e-10));
    assert_near("the gradient holds all", falling.pressure_gradient[0], 2.0, 1e-10);
}

/// Reference, section 3.2: a = 0.125.
fn a_channel_driven_by_each_drive(session: &Session) {
    let walls = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let channel = |drive, motion| Setup {
        changing_drive: None,
        domain: Domain { size: Vector2::new(1.0, 1.0), axes: [Axis::Periodic, walls] },
        spacing: 1.0 / 48.0,
        viscosity: 1.0,
        drive,
        bodies: vec![suspended(Vector2::new(0.513, 0.5), 0.125, motion, 3)],
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Fitted,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-9),
    };
    let gradient = |amount: f64| Drive::PressureGradient(Vector2::x() * -amount);
    let (_, by_gradient) = solve(session, channel(gradient(1.0), fixed()));
    assert_near("flux past a fixed disk", by_gradient.mean_velocity[0], 0.0171234769, 1e-4);
    assert_near("force on a fixed disk", by_gradient.bodies[0].force[0], 0.545701167, 1e-4);
    let (_, by_mean) = solve(session, channel(Drive::MeanVelocity(by_gradient.mean_velocity), fixed()));
    assert_near("the gradient that gives this flux", by_mean.pressure_gradient[0], -1.0, 1e-9);
    assert_near("the force at this flux", by_mean.bodies[0].force[0], by_gradient.bodies[0].force[0], 1e-9);
    let (_, freely) = solve(session, channel(gradient(8.0), free()));
    assert_near("speed of a free disk", freely.bodies[0].twist.velocity[0], 0.965019025, 1e-4);
    let pulled = Motion::Prescribed(Twist { velocity: Vector2::x(), spin: SMatrix::zeros() });
    let (_, dragged) = solve(session, channel(Drive::MeanVelocity(Vector2::zeros()), pulled));
    assert_near("drag at zero flux", -dragged.bodies[0].force[0], 21.9145884, 1e-4);
    let (_, loose) = solve(session, channel(Drive::Rest, pulled));
    assert_near("drag at zero gradient", -loose.bodies[0].force[0], 4.52385831, 1e-4);
}

/// Forces balance to rounding: the body bears the whole gradient, or misses what the force on the fluid leaves out.
fn a_periodic_box_driven_by_a_gradient_or_a_force(session: &Session) {
    let gradient = Vector2::new(-2.0, 0.5);
    let (_, solution) = solve(session, array(6.0, CENTER, Drive::PressureGradient(gradient), fixed()));
    assert!((solution.bodies[0].force + gradient).norm() < 1e-9, "{}", solution.bodies[0].force);
    let (_, back) = solve(session, array(6.0, CENTER, Drive::MeanVelocity(solution.mean_velocity), fixed()));
    assert!((back.pressure_gradient - gradient).norm() < 1e-9, "{}", back.pressure_gradient);
    assert!((back.mean_velocity - solution.mean_velocity).norm() < 1e-12);
    let (_, by_force) = solve(session, array(6.0, CENTER, Drive::BodyForce(-gradient), fixed()));
    assert!((by_force.bodies[0].force + gradient * 0.7).norm() < 1e-5, "{}", by_force.bodies[0].force);
    assert!((by_force.mean_velocity - solution.mean_velocity).norm() < 1e-10);
}

fn closed_box(radius: f64, spacing: f64, twist: Twist<2>) -> Setup<2> {
    let still = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    Setup {
        changing_drive: None,
        domain: Domain { size: Vector2::new(1.0, 1.0), axes: [still; 2] },
        spacing,
        viscosity: 2.0,
        drive: Drive::Rest,
        bodies: vec![suspended(Vector2::new(0.5, 0.5), radius, Motion::Prescribed(twist), 3)],
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Fitted,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-9),
    }
}

/// Reference, section 3.4.
fn a_disk_in_a_closed_box(session: &Session) {
    let spin = SMatrix::<f64, 2, 2>::new(0.0, -1.0, 1.0, 0.0);
    for (radius, drag, torque) in [(0.1, 16.92867674, 1.037311010), (0.2, 55.04312168, 1.168276651)] {
        let (_, moving) = solve(session, closed_box(radius, radius / 6.0, Twist { velocity: Vector2::x(), spin: SMatrix::zeros() }));
        assert_near("drag", -moving.bodies[0].force[0], 2.0 * drag, 1e-4);
        assert!(moving.bodies[0].force[1].abs() < 1e-4 * drag && moving.bodies[0].torque.norm() < 1e-4 * drag);
        let (_, turning) = solve(session, closed_box(radius, radius / 6.0, Twist { velocity: Vector2::zeros(), spin }));
        let unit = 2.0 * 4.0 * PI * radius * radius;
        assert_near("torque", -turning.bodies[0].torque[(1, 0)], unit * torque, 1e-4);
    }
}

fn a_translated_scene_gives_the_same_answer(session: &Session) {
    let here = drag(session, 6.0, CENTER);
    for center in [[0.02, 0.97], [0.3, 0.7], [0.999, 0.5]] {
        assert_near(&format!("a disk at {center:?}"), drag(session, 6.0, center), here, 1.5e-4);
    }
}

/// The mean of the velocities on the grid is that of the mesh, and grid velocities in a disk are its rigid motion.
fn the_grid_holds_the_flow_of_the_mesh(session: &Session) {
    let (fitted, solution) = solve(session, couette(1.0, 0.2 / 12.0, 1.0, vec![suspended(Vector2::new(0.9, 0.4), 0.2, free(), 3)]));
    let (grid, state) = (fitted.grid(), &solution.bodies[0]);
    let values = solution.fluid.local().unwrap();
    let (mut sum, mut inside) = ([0.0; 3], 0);
    for axis in 0..2 {
        for (index, value) in grid.block(axis).indices().zip(&values[grid.local_range(axis)]) {
            let point = grid.position(axis, turbid::grid::operators::signed(index));
            let arm = grid.domain().nearest_image(point - state.center);
            sum[axis] += value / grid.unknowns(2) as f64;
            if arm.norm() < 0.2 {
                inside += 1;
                assert!((value - state.twist.at(&arm)[axis]).abs() < 1e-12);
            }
        }
    }
    sum[2] = f64::from(inside);
    session.world().sum(&mut sum);
    assert!(sum[2] > 200.0);
    assert!((sum[0] - solution.mean_velocity[0]).abs() < 5e-4 && sum[1].abs() < 5e-4, "{sum:?} and {:?}", solution.mean_velocity);
}

/// A disk that sinks in a closed box: the mesh goes along for a while, then is made anew, and all agree with a fresh one.
fn a_mesh_that_moves_gives_what_a_new_one_gives(session: &Session) {
    let down = Motion::Free { force: Vector2::y() * -1.0, torque: SMatrix::zeros() };
    let setup = || {
        let mut setup = closed_box(0.1, 0.1 / 5.0, Twist::zero());
        setup.bodies = vec![suspended(Vector2::new(0.4, 0.8), 0.1, down, 3)];
        setup
    };
    let mut fitted = FittedFlow::new(session, setup()).unwrap();
    for (step, y) in [0.8, 0.78, 0.75, 0.7, 0.6, 0.5, 0.3, 0.2].into_iter().enumerate() {
        let centers = [Vector2::new(0.4, y)];
        let moment = Configuration::new(&centers, 0.0, 1e-6);
        let moved = fitted.solve_at(&moment, &mut |_, _| {}).unwrap();
        let fresh = FittedFlow::new(session, setup()).unwrap().solve_at(&moment, &mut |_, _| {}).unwrap();
        let (one, other) = (moved.bodies[0].twist, fresh.bodies[0].twist);
        assert!((one.velocity - other.velocity).norm() < 5e-4 * other.velocity.norm(), "at {y}: {} and {}", one.velocity, other.velocity);
        assert!(step > 3 || fitted.cost().meshes == 1, "a new mesh at {y}");
    }
    let made = fitted.cost().meshes;
    assert!((2..=4).contains(&made), "{made} meshes");
    let past = fitted.history(f64::INFINITY).past.unwrap();
    let last = Snapshot { fluid: None, multipliers: Vec::new(), centers: past.last.centers.clone(), mean_flow: Vec::new() };
    let mut resumed = FittedFlow::new(session, setup()).unwrap();
    let past = Some(ExtrapolationHistory { time: past.time, last, earlier: None });
    resumed.restore(History { past, ..History::default() }).unwrap();
    let centers = [Vector2::new(0.4, 0.19)];
    let moment = Configuration::new(&centers, 0.0, 1e-6);
    let [one, other] = [&mut fitted, &mut resumed].map(|flow| flow.solve_at(&moment, &mut |_, _| {}).unwrap().bodies[0].twist);
    assert!((one.velocity - other.velocity).norm() < 1e-10 * one.velocity.norm(), "a restart does not make the same mesh");
}

/// In a channel whose walls shear two disks past each other, runs whose edges and steps are a third shorter agree.
fn two_disks_pass_each_other_in_shear(session: &Session) {
    let ends = [(3.0, 0.15), (4.5, 0.1)].map(|(edges, step)| {
        let disks = [[0.6, 0.72], [1.4, 0.28]].map(|center| suspended(Vector2::from(center), 0.2, free(), 3)).to_vec();
        let time = TimeSection { end: 3.0, step: Step::Fixed(step), travel: 0.1, error: 1e-3, scheme: Scheme::TwoStep, until: None };
        let fitted = FittedFlow::new(session, couette(2.0, 0.2 / edges, 1.0, disks)).unwrap();
        let mut simulation = Simulation::flowing(session, Box::new(fitted), time);
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        simulation.state().centers()
    });
    for (one, other) in ends[0].iter().zip(&ends[1]) {
        assert!((one - other).norm() < 3e-3, "{one} and {other}");
    }
}
