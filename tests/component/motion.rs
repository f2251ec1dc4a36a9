//! Bodies that move: order in time, warm starts, contacts with the flow, dry bodies.

use nalgebra::{DVector, SMatrix, SVector, Vector2};
use turbid::{
    body::{Motion, pack},
    flow::Drive,
    geometry::{Axis, Ball, Domain},
    observe,
    petsc::Session,
    scene::{ContactModel, Scheme, Step, TimeSection},
    simulation::{Moment, Setup, Simulation, SuspendedBody, Suspension, View},
};

use crate::Test;
use crate::dry::smallest_gap;
use crate::suspension::{assert_near, free, suspended};

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_warm_start_saves_iterations),
        Test::of(a_warm_start_finds_the_solution_that_a_cold_one_finds),
        Test::of(a_neutrally_buoyant_disk_on_the_centre_line_moves_straight_at_its_speed),
        Test::of(a_heavy_disk_in_a_box_is_followed_at_the_order_of_the_scheme),
        Test::of(a_settling_pair_is_followed_at_the_order_of_the_scheme),
        Test::of(two_disks_pressed_together_meet_and_rest),
        Test::of(a_heavy_disk_comes_to_rest_on_the_floor_that_bears_its_weight),
        Test::of(forces_balance_on_each_body_of_a_sheared_crowd_and_its_stress_reaches_the_walls),
    ]
}

fn time(step: Step, end: f64, scheme: Scheme) -> TimeSection {
    TimeSection { step, end, scheme, travel: 0.1 }
}

/// Free disks at fraction 0.3 between sliding walls.
fn sheared(count: usize) -> Setup<2> {
    let height = (count as f64 * std::f64::consts::PI / 0.3 / 2.0).sqrt();
    let wall = |sign: f64| Vector2::new(sign * 0.5 * height, 0.0);
    let domain =
        Domain { size: Vector2::new(2.0 * height, height), axes: [Axis::Periodic, Axis::Walls { lower: wall(-1.0), upper: wall(1.0) }] };
    let centers = pack(&domain, &[] as &[Ball<2>], &vec![1.0; count], 0.1, 1).unwrap();
    let bodies = centers.into_iter().map(|center: SVector<f64, 2>| suspended(center, 1.0, free(), 6)).collect();
    Setup { domain, spacing: 1.0 / 6.0, viscosity: 1.0, drive: Drive::Rest, bodies, tolerance: 1e-6 }
}

/// What is left of the start's error sits in the slow modes of gaps, which a better preconditioner would have to know.
fn a_warm_start_saves_iterations(session: &Session) {
    let suspension = Suspension::new(session, sheared(60)).unwrap();
    let mut simulation = Simulation::flowing(session, suspension, time(Step::Auto, 1.0, Scheme::TwoStep), ContactModel::None);
    let mut iterations = Vec::new();
    for _ in 0..8 {
        let view = simulation.look(&mut |_, _| {}).unwrap();
        iterations.push(view.effort.iterations);
        simulation.step(&view, &mut |_, _| {}).unwrap();
    }
    let warm = iterations[1..].iter().sum::<usize>() as f64 / 7.0;
    assert!(warm <= 0.86 * iterations[0] as f64, "{iterations:?}");
}

fn pulled(force: [f64; 2]) -> Motion<2> {
    Motion::Free { force: force.into(), torque: SMatrix::zeros() }
}

/// Disks of radius 1 in a closed box of fluid at rest.
fn closed_box(size: [f64; 2], cells_per_radius: f64, bodies: Vec<SuspendedBody<2>>) -> Setup<2> {
    let still = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let domain = Domain { size: size.into(), axes: [still; 2] };
    Setup { domain, spacing: 1.0 / cells_per_radius, viscosity: 1.0, drive: Drive::Rest, bodies, tolerance: 1e-10 }
}

fn simulate(session: &Session, setup: Setup<2>, time: TimeSection, contact: ContactModel) -> Simulation<2> {
    Simulation::flowing(session, Suspension::new(session, setup).unwrap(), time, contact)
}

/// Looks and makes a step.
fn step(simulation: &mut Simulation<2>) -> View<2> {
    let view = simulation.look(&mut |_, _| {}).unwrap();
    simulation.step(&view, &mut |_, _| {}).unwrap();
    view
}

/// Contact force on a body.
fn contact_force(view: &View<2>, body: usize) -> Vector2<f64> {
    let on = |pressed: &turbid::contact::ContactForce<2>| {
        let sign = f64::from(i32::from(pressed.contact.other() == Some(body)) - i32::from(pressed.contact.body == body));
        pressed.contact.normal * (sign * pressed.force)
    };
    view.contacts.iter().map(on).sum()
}

fn a_warm_start_finds_the_solution_that_a_cold_one_finds(session: &Session) {
    let setup = Setup { tolerance: 1e-8, ..sheared(20) };
    let mut simulation = simulate(session, setup.clone(), time(Step::Fixed(0.02), 1.0, Scheme::TwoStep), ContactModel::None);
    for _ in 0..5 {
        step(&mut simulation);
    }
    let warm = simulation.look(&mut |_, _| {}).unwrap();
    let centers = simulation.state().centers();
    let mut fresh = Suspension::new(session, setup).unwrap();
    let cold = fresh.solve_at(&Moment { centers: &centers, time: 0.0, touches: &[] }, &mut |_, _| {}).unwrap();
    assert!(warm.effort.iterations < fresh.cost().krylov.iterations, "the start was not warm");
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
    let setup = || Setup { domain: domain.clone(), spacing: 0.125, viscosity: 1.0, drive, bodies: disk(), tolerance: 1e-10 };
    let speed = Suspension::new(session, setup()).unwrap().solve(&mut |_, _| {}).unwrap().bodies[0].twist.velocity[0];
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
    let (first, second) = ((coarse - &middle).norm(), (middle - fine).norm());
    println!("{scheme:?} {steps} {first:e} {second:e} {}", (first / second).log2());
    (first / second).log2()
}

fn a_heavy_disk_in_a_box_is_followed_at_the_order_of_the_scheme(session: &Session) {
    for (place, force, end) in [([2.1, 4.2], [20.0, -40.0], 1.2), ([2.1, 4.2], [40.0, -20.0], 1.5), ([1.8, 4.0], [30.0, -30.0], 1.5)] {
    for cells in [8.0, 10.0] {
    let setup = closed_box([6.0, 6.0], cells, vec![suspended(Vector2::from(place), 1.0, pulled(force), 8)]);
    println!("{place:?} {force:?} {end} {cells}");
    for n in [3, 4, 6] {
    order(session, &setup, end, (Scheme::TwoStep, n));
    order(session, &setup, end, (Scheme::Midpoint, n));
    }
    println!("{}", ends(session, &setup, end, (Scheme::Midpoint, 16)));
    }
    }
}

fn a_settling_pair_is_followed_at_the_order_of_the_scheme(session: &Session) {
    for end in [1.0, 1.5] {
    let disks = vec![suspended(Vector2::new(2.3, 4.4), 1.0, pulled([0.0, -60.0]), 8), suspended(Vector2::new(5.4, 3.6), 1.0, pulled([0.0, -30.0]), 8)];
    let setup = closed_box([8.0, 6.0], 8.0, disks);
    for n in [3, 4, 6] {
    order(session, &setup, end, (Scheme::TwoStep, n));
    order(session, &setup, end, (Scheme::Midpoint, n));
    }
    println!("{}", ends(session, &setup, end, (Scheme::Midpoint, 16)));
    }
}

fn two_disks_pressed_together_meet_and_rest(session: &Session) {
    let domain = Domain { size: Vector2::new(8.0, 5.0), axes: [Axis::Periodic; 2] };
    let bodies = [(2.6, 10.0), (5.1, -10.0)].map(|(x, force)| suspended(Vector2::new(x, 2.513), 1.0, pulled([force, 0.0]), 8));
    let setup = Setup { domain, spacing: 0.125, viscosity: 1.0, drive: Drive::Rest, bodies: bodies.to_vec(), tolerance: 1e-8 };
    let mut simulation = simulate(session, setup, time(Step::Fixed(0.3), 100.0, Scheme::TwoStep), ContactModel::Inelastic);
    let mut view = step(&mut simulation);
    while contact_force(&view, 0).norm() == 0.0 {
        assert!(simulation.state().steps < 30, "they never meet: {}", smallest_gap(&simulation));
        view = step(&mut simulation);
        println!("{} {} {} {} {}", simulation.state().steps, view.twists[0].velocity, simulation.state().bodies[0].center, smallest_gap(&simulation), view.effort.iterations);
        assert!(smallest_gap(&simulation) > -1e-6, "{}", smallest_gap(&simulation));
    }
    for _ in 0..3 {
        let view = step(&mut simulation);
        println!("{} {:?} {:?}", simulation.state().steps, view.twists, smallest_gap(&simulation));
        println!("{:?} {:?}", contact_force(&view, 0), view.solution.as_ref().unwrap().bodies[0].force);
    }
}

fn a_heavy_disk_comes_to_rest_on_the_floor_that_bears_its_weight(session: &Session) {
    let weight = 30.0;
    let setup = closed_box([6.0, 4.0], 8.0, vec![suspended(Vector2::new(3.1, 1.4), 1.0, pulled([0.0, -weight]), 8)]);
    let mut simulation = simulate(session, setup, time(Step::Fixed(0.3), 100.0, Scheme::TwoStep), ContactModel::Inelastic);
    for _ in 0..12 {
        let view = step(&mut simulation);
        println!("{} {:?} {} {} {:?} {:?}", simulation.state().steps, view.twists[0].velocity, simulation.state().bodies[0].center, smallest_gap(&simulation), contact_force(&view, 0), view.solution.as_ref().unwrap().bodies[0].force);
    }
}

/// Free disks at fraction 0.45 between sliding walls, with contacts.
fn forces_balance_on_each_body_of_a_sheared_crowd_and_its_stress_reaches_the_walls(session: &Session) {
    let count = 20;
    let height = (f64::from(count) * std::f64::consts::PI / 0.45 / 1.2).sqrt();
    let wall = |sign: f64| Vector2::new(sign * 0.5 * height, 0.0);
    let axes = [Axis::Periodic, Axis::Walls { lower: wall(-1.0), upper: wall(1.0) }];
    let domain = Domain { size: Vector2::new(1.2 * height, height), axes };
    let centers = pack(&domain, &[] as &[Ball<2>], &vec![1.0; count as usize], 0.05, 1).unwrap();
    let bodies = centers.into_iter().map(|center| suspended(center, 1.0, free(), 6)).collect();
    let setup = Setup { domain, spacing: 1.0 / 6.0, viscosity: 1.0, drive: Drive::Rest, bodies, tolerance: 1e-7 };
    let mut simulation = simulate(session, setup, time(Step::Fixed(0.1), 10.0, Scheme::TwoStep), ContactModel::Inelastic);
    for _ in 0..15 {
        let view = step(&mut simulation);
        let solution = view.solution.as_ref().unwrap();
        let largest = view.contacts.iter().map(|pressed| pressed.force).fold(0.0, f64::max);
        let imbalance = (0..count as usize).map(|body| (contact_force(&view, body) + solution.bodies[body].force).norm()).fold(0.0, f64::max);
        let suspension = simulation.suspension().unwrap();
        let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), solution, &view.contacts).unwrap().unwrap();
        println!("{} gap {:e} contacts {} largest {largest} imbalance {imbalance:e} {} {:?} solves {}", simulation.state().steps, smallest_gap(&simulation), view.contacts.iter().filter(|p| p.force > 0.0).count(), viscosity.relative() / viscosity.from_walls.unwrap() - 1.0, viscosity, view.effort.solves);
        let _ = assert_near;
    }
}
