//! Bodies that move: order in time, warm starts, contacts with the flow, dry bodies.

use std::{f64::consts::PI, path::Path};

use nalgebra::{DVector, SMatrix, SVector, Vector2};
use turbid::{
    body::{Motion, pack},
    flow::{Drive, InverseMethod},
    geometry::{Axis, Ball, Domain},
    motion::{Observation, Simulation},
    observe::{self, Part},
    petsc::Session,
    plan::flow_solver,
    scene::{ConstraintMethod, ContactModel, Scene, Scheme, Step, TimeSection, Tolerance},
    setup::{Configuration, Setup, SuspendedBody},
};

use crate::Test;
use crate::dry::smallest_gap;
use crate::suspension::{assert_near, free, suspended};

pub fn tests() -> Vec<Test> {
    vec![
        Test::only_on(1, a_warm_start_saves_iterations),
        Test::of(bodies_on_trajectories_are_where_these_lead_with_fluid_and_without),
        Test::of(a_warm_start_finds_the_solution_that_a_cold_one_finds),
        Test::of(a_neutrally_buoyant_disk_on_the_centre_line_moves_straight_at_its_speed),
        Test::only_on(1, a_heavy_disk_in_a_box_is_followed_at_the_order_of_the_scheme),
        Test::only_on(1, a_settling_pair_is_followed_at_the_order_of_the_scheme),
        Test::of(only_bodies_that_moved_are_assembled_anew),
        Test::of(two_disks_pressed_together_meet_and_rest),
        Test::of(a_heavy_disk_comes_to_rest_on_the_floor_that_bears_its_weight),
        Test::of(forces_balance_on_each_body_of_a_sheared_crowd_and_its_stress_reaches_the_walls),
    ]
}

fn time(step: Step, end: f64, scheme: Scheme) -> TimeSection {
    TimeSection { step, end, scheme, travel: 0.1, error: 1e-3, until: None }
}

/// Free disks of radius 1 between sliding walls in a box `aspect` times as long as high, packed with gaps between them.
fn between_sliding_walls(count: usize, fraction: f64, aspect: f64, gap: f64) -> Setup<2> {
    let height = (count as f64 * std::f64::consts::PI / fraction / aspect).sqrt();
    let wall = |sign: f64| Vector2::new(sign * 0.5 * height, 0.0);
    let axes = [Axis::Periodic, Axis::Walls { lower: wall(-1.0), upper: wall(1.0) }];
    let domain = Domain { size: Vector2::new(aspect * height, height), axes };
    let centers = pack(&domain, &[] as &[Ball<2>], &vec![1.0; count], gap, 1).unwrap();
    let bodies = centers.into_iter().map(|center: SVector<f64, 2>| suspended(center, 1.0, free(), 6)).collect();
    Setup {
        changing_drive: None,
        domain,
        spacing: 1.0 / 6.0,
        viscosity: 1.0,
        drive: Drive::Rest,
        bodies,
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-6),
    }
}

fn sheared(count: usize) -> Setup<2> {
    between_sliding_walls(count, 0.3, 2.0, 0.1)
}

/// A solve that starts from the last two takes at most 60 % of the iterations of the first, once its tolerance goes with the error
/// of the step. To the same residual it saves little: what is left of the start's error sits in the slow modes of the crowd.
fn a_warm_start_saves_iterations(session: &Session) {
    for inverse in [InverseMethod::Hypre, InverseMethod::Transform] {
        for (tolerance, part) in [(Tolerance::Auto, 0.6), (Tolerance::Fixed(1e-6), 0.9)] {
            let suspension = flow_solver(session, Setup { inverse, tolerance, ..sheared(60) }).unwrap();
            // in which the fastest bodies, beside the walls, move a tenth of a radius
            let mut simulation = Simulation::flowing(session, suspension, time(Step::Fixed(0.012), 1.0, Scheme::TwoStep));
            let mut iterations = Vec::new();
            for _ in 0..8 {
                let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
                iterations.push(observation.effort.iterations);
                simulation.step(&observation, &mut |_, _| {}).unwrap();
            }
            let warm = iterations[1..].iter().sum::<usize>() as f64 / 7.0;
            assert!(warm <= part * iterations[0] as f64, "{inverse:?} to {tolerance:?}: {iterations:?}");
        }
    }
}

fn pulled(force: [f64; 2]) -> Motion<2> {
    Motion::Free { force: force.into(), torque: SMatrix::zeros() }
}

/// Disks of radius 1 in a closed box of fluid at rest.
fn closed_box(size: [f64; 2], cells_per_radius: f64, bodies: Vec<SuspendedBody<2>>) -> Setup<2> {
    let still = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let domain = Domain { size: size.into(), axes: [still; 2] };
    Setup {
        changing_drive: None,
        domain,
        spacing: 1.0 / cells_per_radius,
        viscosity: 1.0,
        drive: Drive::Rest,
        bodies,
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-10),
    }
}

fn simulate(session: &Session, setup: Setup<2>, time: TimeSection, contact: ContactModel) -> Simulation<2> {
    Simulation::flowing(session, flow_solver(session, setup.with_contact(contact)).unwrap(), time)
}

/// Looks and makes a step.
fn step(simulation: &mut Simulation<2>) -> Observation<2> {
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap();
    observation
}

/// Contact force on a body.
fn contact_force(observation: &Observation<2>, body: usize) -> Vector2<f64> {
    let on = |active: &turbid::contact::ContactForce<2>| {
        let sign = f64::from(i32::from(active.contact.other() == Some(body)) - i32::from(active.contact.body == body));
        active.contact.normal * (sign * active.force)
    };
    observation.contacts.iter().map(on).sum()
}

fn a_warm_start_finds_the_solution_that_a_cold_one_finds(session: &Session) {
    let setup = Setup { tolerance: Tolerance::Fixed(1e-8), ..sheared(20) };
    let mut simulation = simulate(session, setup.clone(), time(Step::Fixed(0.02), 1.0, Scheme::TwoStep), ContactModel::None);
    for _ in 0..5 {
        step(&mut simulation);
    }
    let warm = simulation.evaluate(&mut |_, _| {}).unwrap();
    let centers = simulation.state().centers();
    let mut fresh = flow_solver(session, setup).unwrap();
    let cold = fresh.solve_at(&Configuration::new(&centers, 0.0, 1e-8), &mut |_, _| {}).unwrap();
    assert!(warm.effort.iterations < cold.cost.krylov.iterations, "the start was not warm");
    let fastest = cold.bodies.iter().map(|body| body.twist.velocity.norm()).fold(0.0, f64::max);
    for (warm, cold) in warm.twists.iter().zip(&cold.bodies) {
        let error = (warm.velocity - cold.twist.velocity).norm() / fastest;
        assert!(error < 10.0 * 1e-8, "{error:e}");
    }
}

/// In steps of whole cells the disk always lies alike on the grid, so that its velocity has no noise of the grid.
fn a_neutrally_buoyant_disk_on_the_centre_line_moves_straight_at_its_speed(session: &Session) {
    let wall = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let domain = Domain { size: Vector2::new(6.0, 4.0), axes: [Axis::Periodic, wall] };
    let disk = || vec![suspended(Vector2::new(1.013, 2.0), 1.0, free(), 8)];
    let drive = Drive::MeanVelocity(Vector2::x());
    let setup = || Setup {
        changing_drive: None,
        domain: domain.clone(),
        spacing: 0.125,
        viscosity: 1.0,
        drive,
        bodies: disk(),
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-10),
    };
    let speed = flow_solver(session, setup()).unwrap().solve(&mut |_, _| {}).unwrap().bodies[0].twist.velocity[0];
    assert!(speed > 1.0 && speed < 1.5, "faster than the mean, slower than the fastest fluid: {speed}");
    let two_cells = 0.25 / speed;
    let mut simulation = simulate(session, setup(), time(Step::Fixed(two_cells), 10.0, Scheme::TwoStep), ContactModel::None);
    for _ in 0..8 {
        step(&mut simulation);
        let expected = Vector2::new(1.013 + speed * simulation.state().time, 2.0);
        let error = (simulation.state().bodies[0].center - expected).norm();
        // the tolerance of the solver, and what is lost from residual to velocity
        assert!(error < 1e-8, "{error:e} after a time {}", simulation.state().time);
    }
    assert!(simulation.state().bodies[0].center[0] > 3.0);
}

/// Where bodies are at the end, in so many steps.
fn ends(session: &Session, setup: &Setup<2>, end: f64, (scheme, steps): (Scheme, u32)) -> DVector<f64> {
    let length = end / f64::from(steps);
    let mut simulation = simulate(session, setup.clone(), time(Step::Fixed(length), end, scheme), ContactModel::None);
    while !simulation.over() {
        step(&mut simulation);
    }
    assert_eq!(simulation.state().steps, steps as usize);
    DVector::from_vec(simulation.state().centers().iter().flat_map(|center| [center[0], center[1]]).collect())
}

/// The order that places at the end show between a number of steps, twice and four times as many.
fn order(session: &Session, setup: &Setup<2>, end: f64, (scheme, steps): (Scheme, u32)) -> f64 {
    let [coarse, middle, fine] = [1, 2, 4].map(|factor| ends(session, setup, end, (scheme, factor * steps)));
    ((coarse - &middle).norm() / (middle - fine).norm()).log2()
}

/// Bodies that cover about a radius, in steps of 0.3 to 0.04 radii. Longer steps are not yet in the range where the leading
/// error rules; in shorter ones second order errors sink to the noise of the grid: a velocity that changes by some 1e-4 with
/// the place of a body between grid points moves the end by about as many radii, and the finest difference is 4e-4 or more.
fn assert_orders(session: &Session, setup: &Setup<2>, end: f64) {
    for (scheme, steps) in [(Scheme::TwoStep, 6), (Scheme::Midpoint, 4)] {
        let order = order(session, setup, end, (scheme, steps));
        assert!(order >= 1.8, "{scheme:?} is of order {order:.2}");
    }
    let order = order(session, setup, end, (Scheme::Euler, 4));
    assert!((0.8..=1.2).contains(&order), "Euler is of order {order:.2}");
}

/// It falls aslant and turns to the side: walls slow it down and the more so, the nearer they are.
fn a_heavy_disk_in_a_box_is_followed_at_the_order_of_the_scheme(session: &Session) {
    let disk = suspended(Vector2::new(2.1, 4.2), 1.0, pulled([20.0, -40.0]), 8);
    assert_orders(session, &closed_box([6.0, 6.0], 10.0, vec![disk]), 1.2);
}

/// The heavier one falls past the lighter one and carries it along.
fn a_settling_pair_is_followed_at_the_order_of_the_scheme(session: &Session) {
    let disk = |center: [f64; 2], weight: f64| suspended(Vector2::from(center), 1.0, pulled([0.0, -weight]), 8);
    assert_orders(session, &closed_box([8.0, 6.0], 8.0, vec![disk([2.3, 4.4], 60.0), disk([5.4, 3.6], 30.0)]), 1.0);
}

const SCHEMES: [Scheme; 3] = [Scheme::TwoStep, Scheme::Midpoint, Scheme::Euler];

/// Steps until a contact bears a force, then some more; gives what was seen after a contact that closed its gap.
fn meet(simulation: &mut Simulation<2>, rests: usize) -> Vec<Observation<2>> {
    let mut observations = Vec::new();
    while observations.len() < rests {
        assert!(simulation.state().steps < 40, "bodies never meet");
        let closed = !simulation.state().contact_history.is_empty();
        let observation = step(simulation);
        assert!(smallest_gap(simulation) > -1e-6, "{}", smallest_gap(simulation));
        if closed {
            observations.push(observation);
        }
    }
    observations
}

/// They lie in mirror symmetry on the grid, so that nothing turns the line of their centres out of that of the forces.
fn two_disks_pressed_together_meet_and_rest(session: &Session) {
    let domain = Domain { size: Vector2::new(8.0, 5.0), axes: [Axis::Periodic; 2] };
    let force = |body: usize| Vector2::new(if body == 0 { 10.0 } else { -10.0 }, 0.0);
    let disk = |body: usize| suspended(Vector2::new([2.75, 5.0][body], 2.5), 1.0, pulled(force(body).into()), 8);
    let bodies = vec![disk(0), disk(1)];
    let setup = Setup {
        changing_drive: None,
        domain,
        spacing: 0.125,
        viscosity: 1.0,
        drive: Drive::Rest,
        bodies,
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Hypre,
        tolerance: Tolerance::Fixed(1e-8),
    };
    for scheme in SCHEMES {
        let mut simulation = simulate(session, setup.clone(), time(Step::Fixed(0.3), 100.0, scheme), ContactModel::Inelastic);
        for observation in meet(&mut simulation, 4) {
            let bodies = &observation.solution.as_ref().unwrap().bodies;
            for body in [0, 1] {
                // alone in the box, the force would move a disk at about 0.5
                let speed = observation.twists[body].velocity.norm();
                assert!(speed < 1e-5, "{scheme:?}: body {body} moves at {speed:e}");
                let (by_contact, exerted) = (contact_force(&observation, body), bodies[body].force);
                assert!((by_contact + force(body)).norm() < 1e-4 * 10.0, "{scheme:?}: body {body} is pressed by {by_contact}");
                assert!(exerted.norm() < 1e-4 * 10.0, "{scheme:?}: the fluid still acts on body {body} with {exerted}");
            }
        }
    }
}

/// It falls along the middle of the box, in mirror symmetry.
fn a_heavy_disk_comes_to_rest_on_the_floor_that_bears_its_weight(session: &Session) {
    let weight = Vector2::new(0.0, -30.0);
    let setup = closed_box([6.0, 4.0], 8.0, vec![suspended(Vector2::new(3.0, 1.2), 1.0, pulled(weight.into()), 8)]);
    for scheme in SCHEMES {
        let mut simulation = simulate(session, setup.clone(), time(Step::Fixed(0.3), 100.0, scheme), ContactModel::Inelastic);
        for observation in meet(&mut simulation, 3) {
            let exerted = observation.solution.as_ref().unwrap().bodies[0].force;
            // it set out at 0.3
            assert!(observation.twists[0].velocity.norm() < 1e-5, "{scheme:?}: it moves at {}", observation.twists[0].velocity);
            assert!(
                (contact_force(&observation, 0) + weight).norm() < 1e-4 * 30.0,
                "{scheme:?}: the floor bears {}",
                contact_force(&observation, 0)
            );
            assert!(exerted.norm() < 1e-4 * 30.0, "{scheme:?}: the fluid still acts with {exerted}");
        }
        assert!((simulation.state().bodies[0].center[1] - 1.0).abs() < 1e-6, "{}", simulation.state().bodies[0].center);
    }
}

/// Free disks at fraction 0.45 between sliding walls: what the fluid does to each is what contacts undo, and the walls feel
/// the stresses of both. Flow and contacts agree to 1e-5 of the largest velocity; measured is 1e-7.
fn forces_balance_on_each_body_of_a_sheared_crowd_and_its_stress_reaches_the_walls(session: &Session) {
    let count = 20;
    let setup = Setup { tolerance: Tolerance::Fixed(1e-7), ..between_sliding_walls(count, 0.45, 1.2, 0.05) };
    let mut simulation = simulate(session, setup, time(Step::Fixed(0.1), 10.0, Scheme::TwoStep), ContactModel::Inelastic);
    let mut touching = 0;
    for number in 0..15 {
        let observation = step(&mut simulation);
        assert!(smallest_gap(&simulation) > -1e-6, "step {number}: {}", smallest_gap(&simulation));
        let solution = observation.solution.as_ref().unwrap();
        let largest = observation.contacts.iter().map(|active| active.force).fold(0.0, f64::max);
        for body in 0..count {
            let imbalance = (contact_force(&observation, body) + solution.bodies[body].force).norm();
            // 1e-9: rounding, where there are no contacts
            assert!(imbalance < 1e-4 * largest + 1e-9, "step {number}, body {body}: {imbalance:e} of {largest}");
        }
        let suspension = simulation.suspension().unwrap();
        let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), solution, &observation.contacts).unwrap().unwrap();
        assert_near(&format!("step {number}"), viscosity.relative(), viscosity.from_walls.unwrap(), 1e-3);
        touching += usize::from(viscosity.parts.get(Part::Contact).unwrap() > 1e-2);
    }
    assert!(touching > 5, "they touch in {touching} steps only");
}

/// A disk that goes its way among others that stay: their blocks are kept, and the answer is that of a fresh assembly.
fn only_bodies_that_moved_are_assembled_anew(session: &Session) {
    let setup = |way: f64| Setup {
        changing_drive: None,
        domain: Domain { size: Vector2::repeat(6.0), axes: [Axis::Periodic; 2] },
        spacing: 1.0 / 6.0,
        viscosity: 1.0,
        drive: Drive::Shear(1.0),
        bodies: [[1.5 + way, 1.5], [4.5, 1.5], [1.5, 4.5], [4.5, 4.5]].map(|center| suspended(center.into(), 1.0, free(), 5)).to_vec(),
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Transform,
        tolerance: Tolerance::Fixed(1e-9),
    };
    let mut suspension = flow_solver(session, setup(0.0)).unwrap();
    // a little way; then so close to the second disk that it meets its interpolation; then no further
    for (way, expected) in [(0.0, 4.0), (0.1, 1.0), (0.75, 2.0), (0.75, 0.0)] {
        let centers: Vec<Vector2<f64>> = setup(way).bodies.iter().map(|suspended| suspended.body.ball.center).collect();
        let moment = Configuration::new(&centers, 0.0, 1e-9);
        let solution = suspension.solve_at(&moment, &mut |_, _| {}).unwrap();
        let mut assembled = [solution.cost.assembled as f64];
        session.world().sum(&mut assembled);
        assert_eq!(assembled, [expected], "on a way of {way}");
        let fresh = flow_solver(session, setup(way)).unwrap().solve(&mut |_, _| {}).unwrap();
        assert!(solution.bodies.iter().zip(&fresh.bodies).all(|(kept, fresh)| kept.twist == fresh.twist), "on a way of {way}");
    }
}

/// An oscillation and a path, from the scene and from a table, in steps that do not know of them; in Stokes flow the force follows the velocity.
fn bodies_on_trajectories_are_where_these_lead_with_fluid_and_without(session: &Session) {
    let listed = "[[0, 0, 0], [0.3, 0.1, 0.2], [0.5, 0, 0.1]]";
    for (model, path) in [("stokes", listed), ("none", listed), ("none", "\"tests/data/path.csv\"")] {
        let text = format!(
            "domain = {{ size = [8.0, 6.0], y = \"walls\" }}\nflow.model = \"{model}\"\n{}contact.model = \"inelastic\"\n\
             time = {{ end = 0.8, step = \"auto\" }}\n\
             [[bodies]]\nradius = 0.5\ncenters = [[2.0, 3.0]]\nmotion = {{ amplitude = [0.2, -0.1], rotation = 0.3, frequency = 0.5, phase = 0.4 }}\n\
             [[bodies]]\nradius = 0.5\ncenters = [[6.0, 3.0]]\nmotion = {{ path = {path} }}\n",
            if model == "stokes" { "resolution = { cells_per_radius = 4, modes = 4 }\nmethod.tolerance = 1e-9\n" } else { "" }
        );
        let scene = Scene::parse("trajectories", Path::new(env!("CARGO_MANIFEST_DIR")), &text, &[]).unwrap();
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            if let Some(solution) = &observation.solution {
                let velocity = PI * (PI * simulation.state().time + 0.4).cos() * Vector2::new(0.2, -0.1);
                let difference = (solution.bodies[0].twist.velocity - velocity).norm();
                assert!(difference < 1e-7, "the solver leaves {difference:e} of {velocity}");
                // the other one is at rest then
                assert!(
                    simulation.state().steps > 0
                        || solution.bodies[0].force.dot(&velocity) < -0.9 * solution.bodies[0].force.norm() * velocity.norm()
                );
            }
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        let state = simulation.whole_state();
        let part = (PI * state.time + 0.4_f64).sin() - 0.4_f64.sin();
        for (body, place) in [(0, Vector2::new(2.0, 3.0) + Vector2::new(0.2, -0.1) * part), (1, Vector2::new(6.0, 3.1))] {
            assert!((state.bodies[body].center - place).norm() < 1e-12, "{model}: {}", state.bodies[body].center);
        }
    }
}
