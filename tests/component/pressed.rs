//! A wall that a load presses on dry bodies: exact cases, conservation, restarts, and what may not matter. Radius and density are 1 but where it is said.

use nalgebra::SVector;
use turbid::{
    body::components,
    contact::FrictionReport,
    geometry::Domain,
    interaction::{Friction, Inelastic, Interactions},
    mechanics::History,
    motion::{GranularBody, GranularSetup, Simulation, StepReport, WallLoad},
    petsc::Session,
    scene::{Scheme, Step, TimeSection},
    setup::{State, WallMotion},
};

use crate::{
    Test,
    friction::{ball, channel, fixed, noise, sized},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_wall_above_nothing_falls_as_a_body_does),
        Test::of(each_contact_of_a_column_bears_the_load),
        Test::of(an_impact_of_the_wall_keeps_momentum),
        Test::of(a_disk_that_is_fixed_to_the_wall_presses_two_apart_or_stands_on_them),
        Test::of(a_ball_under_a_wall_that_slides_rolls_at_half_its_speed),
        Test::of(a_layer_is_sheared_alike_on_any_number_of_ranks),
        Test::of(a_restart_under_the_wall_repeats_a_run),
        Test::of(units_do_not_matter_under_the_wall),
    ]
}

/// A wall across the last axis.
fn load<const D: usize>(force: f64, mass: f64, fixed: &[usize]) -> WallLoad {
    WallLoad { axis: D - 1, force, mass, fixed: fixed.to_vec() }
}

/// Bodies under a wall, with friction if it is not 0.
fn start<const D: usize>(
    session: &Session,
    domain: Domain<D>,
    bodies: &[GranularBody<D>],
    load: WallLoad,
    (friction, step, scheme): (f64, f64, Scheme),
) -> Simulation<D> {
    let interactions = Interactions::default().with(Inelastic);
    let interactions = if friction > 0.0 { interactions.with(Friction::new(friction, 0.0)) } else { interactions };
    let setup = GranularSetup { domain, bodies: bodies.to_vec(), trajectories: Default::default(), interactions, load: Some(load) };
    let time = TimeSection { step: Step::Fixed(step), end: 1e6 * step, scheme, travel: 0.1, error: 1e-3, until: None };
    Simulation::granular(session, setup, time)
}

fn step<const D: usize>(simulation: &mut Simulation<D>) -> StepReport {
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap()
}

fn steps<const D: usize>(simulation: &mut Simulation<D>, count: usize) {
    (0..count).for_each(|_| {
        step(simulation);
    });
}

fn wall<const D: usize>(simulation: &Simulation<D>) -> WallMotion<D> {
    simulation.state().wall.unwrap()
}

/// At the acceleration load over mass: without an error by two steps, by Euler's with that of `n (n + 1) / 2` steps squared.
fn a_wall_above_nothing_falls_as_a_body_does(session: &Session) {
    let (dt, count, acceleration) = (0.01, 50, 3.0 / 4.0);
    for (scheme, exact) in [(Scheme::TwoStep, 0.5 * 50.0 * 50.0), (Scheme::Euler, 0.5 * 50.0 * 51.0)] {
        let body = ball([5.0, 1.0], [0.0; 2], SVector::zeros());
        let mut simulation = start(session, channel::<2>(20.0), &[body], load::<2>(3.0, 4.0, &[]), (0.0, dt, scheme));
        steps(&mut simulation, count);
        let fallen = 20.0 - wall(&simulation).position;
        assert!((fallen - acceleration * dt * dt * exact).abs() < 1e-12, "{scheme:?}: {fallen}");
        assert_eq!(simulation.domain().size[1], wall(&simulation).position);
    }
}

fn column<const D: usize>(session: &Session, friction: f64, (count, mass): (usize, f64)) {
    let center = |level: usize| std::array::from_fn(|axis| if axis + 1 == D { 1.1 + 2.2 * level as f64 } else { 5.0 });
    let bodies: Vec<_> = (0..count).map(|level| ball::<D>(center(level), [0.0; D], SVector::zeros())).collect();
    let mut simulation = start(session, channel::<D>(30.0), &bodies, load::<D>(7.0, mass, &[]), (friction, 0.1, Scheme::TwoStep));
    steps(&mut simulation, 200);
    let (state, wall) = (simulation.whole_state(), wall(&simulation));
    assert_eq!(state.contact_history.len(), count + 1);
    // friction is found to a residual of 1e-9 of the largest velocity that the load gives in a step
    let tolerance = if friction > 0.0 { 1e-7 } else { 1e-9 };
    for contact in &state.contact_history {
        assert!((contact.force - 7.0).abs() < tolerance, "{D}D, {count} balls, friction {friction}, a wall of {mass}: {}", contact.force);
    }
    assert!((wall.position - 2.0 * count as f64).abs() < 1e-9 && wall.velocity.abs() < 1e-7, "{wall:?}");
    assert!((wall.force[D - 1] - 7.0).abs() < tolerance, "{wall:?}");
}

fn each_contact_of_a_column_bears_the_load(session: &Session) {
    for friction in [0.0, 0.5] {
        for kind in [(1, 1.0), (3, 2.0), (8, 50.0)] {
            column::<2>(session, friction, kind);
            column::<3>(session, friction, kind);
        }
    }
}

/// What the floor gives is all that bodies and wall gain besides the load, in every step; bodies at rest on it bear the wall as it comes.
fn an_impact_of_the_wall_keeps_momentum(session: &Session) {
    let place = |number: usize| [2.5 * (number % 4) as f64 + 1.5 + 0.4 * noise(number), 1.3 + 2.1 * (number / 4) as f64];
    let disk = |number: usize| sized(0.9 + 0.1 * noise(100 + number), place(number), [noise(200 + number), 0.0], SVector::zeros());
    let bodies: Vec<_> = (0..12).map(disk).collect();
    let (dt, force, mass) = (0.05, 5.0, 3.0);
    for friction in [0.0, 0.4] {
        let mut simulation = start(session, channel::<2>(10.5), &bodies, load::<2>(force, mass, &[]), (friction, dt, Scheme::Euler));
        let momentum = |state: &State<2>| {
            let of_bodies: f64 = state.bodies.iter().zip(&bodies).map(|(moving, body)| body.mass * moving.twist.velocity[1]).sum();
            of_bodies + mass * state.wall.unwrap().velocity
        };
        let mut last = 0.0;
        for number in 0..100 {
            let report = step(&mut simulation).kkt_report.unwrap();
            assert!(report.smallest_gap > -1e-7, "step {number}: {report:?}");
            let state = simulation.whole_state();
            let floor: f64 = crate::friction::on_wall(&state, 1, 1.0).iter().sum();
            let now = momentum(&state);
            assert!((now - last - dt * (floor - force)).abs() < 1e-9, "step {number}: {now} after {last}, {floor}");
            last = now;
        }
        assert!((wall(&simulation).force[1] - force).abs() < 0.5 * force, "{:?}", wall(&simulation));
    }
}

/// On two disks of the floor whose centres are `2 s` apart the normals are aslant by `sin a = s / 2`: they stand from `mu = tan(a / 2)` on.
fn a_disk_that_is_fixed_to_the_wall_presses_two_apart_or_stands_on_them(session: &Session) {
    let half = 1.2_f64;
    let angle = (half / 2.0).asin();
    let height = 2.0 + 2.0 * angle.cos();
    let bodies = [
        ball([10.0 - half, 1.0], [0.0; 2], SVector::zeros()),
        ball([10.0 + half, 1.0], [0.0; 2], SVector::zeros()),
        fixed(1.0, [10.0, height - 1.0]),
    ];
    for part in [0.99, 1.01] {
        let domain = Domain { size: [20.0, height].into(), ..channel::<2>(20.0) };
        let friction = part * (angle / 2.0).tan();
        let mut simulation = start(session, domain, &bodies, load::<2>(2.0, 3.0, &[2]), (friction, 0.01, Scheme::Euler));
        steps(&mut simulation, 20);
        let (state, wall) = (simulation.whole_state(), wall(&simulation));
        let carried = state.bodies[2].center[1] - (height - 1.0);
        assert!((carried - (wall.position - height)).abs() < 1e-12 && state.bodies[2].center[0] == 10.0, "{carried} {wall:?}");
        if part < 1.0 {
            assert!(wall.velocity < -1e-4, "slides: {wall:?}");
        } else {
            assert!(wall.velocity.abs() < 1e-9 && (wall.force[1] - 2.0).abs() < 1e-6, "stands: {wall:?}");
            // how they share it is not decided: the wall cannot tilt
            let floor: f64 = crate::friction::on_wall(&state, 1, 1.0).iter().sum();
            assert!((floor - 2.0).abs() < 1e-6, "{floor}");
        }
    }
}

fn rolls<const D: usize>(session: &Session) {
    let mut domain = channel::<D>(10.0);
    domain.size[D - 1] = 2.0;
    let upper = SVector::from_fn(|axis, _| if axis == 0 { 3.0 } else { 0.0 });
    domain.axes[D - 1] = turbid::geometry::Axis::Walls { lower: SVector::zeros(), upper };
    let center = std::array::from_fn(|axis| if axis + 1 == D { 1.0 } else { 5.0 });
    let mut simulation =
        start(session, domain, &[ball(center, [0.0; D], SVector::zeros())], load::<D>(4.0, 2.0, &[]), (0.3, 0.05, Scheme::Euler));
    step(&mut simulation);
    // it rolls on the floor, and slips under the wall
    let force = wall(&simulation).force;
    assert!((force[0] + 0.3 * 4.0).abs() < 1e-9 && (force[D - 1] - 4.0).abs() < 1e-9, "{D}D: {force}");
    steps(&mut simulation, 200);
    let (state, wall) = (simulation.whole_state(), wall(&simulation));
    let (speed, spin) = (state.bodies[0].twist.velocity[0], components(&state.bodies[0].twist.spin));
    assert!((speed - 1.5).abs() < 1e-9 && (spin.iter().map(|part| part * part).sum::<f64>().sqrt() - 1.5).abs() < 1e-9, "{speed} {spin:?}");
    assert!(wall.force[0].abs() < 1e-9 && (wall.position - 2.0).abs() < 1e-9, "{wall:?}");
}

fn a_ball_under_a_wall_that_slides_rolls_at_half_its_speed(session: &Session) {
    rolls::<2>(session);
    rolls::<3>(session);
}

/// Disks between rough walls, the upper one of which a load presses and which slides, in units of length, time and mass.
fn sheared(session: &Session, [length, time, mass]: [f64; 3]) -> Simulation<2> {
    let at_wall = |height: f64| (0..6).map(move |number| fixed(length, [length * (1.0 + 2.1 * f64::from(number)), length * height]));
    let upper = SVector::from([2.0 * length / time, 0.0]);
    let free = |number: usize| {
        let place = [2.3 * (number % 5) as f64 + 1.2 + 0.2 * noise(number), 3.2 + 2.1 * (number / 5) as f64];
        let disk = sized(length * (0.9 + 0.1 * noise(50 + number)), place.map(|place| length * place), [0.0; 2], SVector::zeros());
        let mass = mass / (length * length);
        GranularBody { mass: disk.mass * mass, inertia: disk.inertia * mass, ..disk }
    };
    let mut bodies: Vec<GranularBody<2>> = at_wall(1.0).chain((0..20).map(free)).collect();
    bodies.extend(at_wall(12.5).map(|body| GranularBody { twist: turbid::body::Twist { velocity: upper, ..body.twist }, ..body }));
    let mut domain = Domain { size: [12.6 * length, 13.5 * length].into(), ..channel::<2>(1.0) };
    domain.axes[1] = turbid::geometry::Axis::Walls { lower: SVector::zeros(), upper };
    let load = load::<2>(12.0 * mass * length / (time * time), 20.0 * mass, &(26..32).collect::<Vec<_>>());
    start(session, domain, &bodies, load, (0.5, 0.05 * time, Scheme::TwoStep))
}

fn a_layer_is_sheared_alike_on_any_number_of_ranks(session: &Session) {
    let mut simulation = sheared(session, [1.0; 3]);
    for number in 0..100 {
        let report = step(&mut simulation).kkt_report.unwrap();
        let friction = report.friction.unwrap();
        assert!(friction.residual < FrictionReport::TOLERANCE && report.smallest_gap > -1e-7, "step {number}: {report:?}");
    }
    let state = simulation.whole_state();
    // on any number of ranks
    let (sum, wall) = (state.bodies.iter().map(|body| body.center[0]).sum::<f64>(), state.wall.unwrap());
    assert!((wall.position - 10.552_161).abs() < 1e-5 && (sum - 275.106_849).abs() < 1e-3, "{} {sum}", wall.position);
    let moved = state.bodies[26].center - SVector::from([1.0, 12.5]);
    assert!((moved - SVector::from([10.0, wall.position - 13.5])).norm() < 1e-12, "{moved}");
}

fn a_restart_under_the_wall_repeats_a_run(session: &Session) {
    let mut whole = sheared(session, [1.0; 3]);
    steps(&mut whole, 60);
    let mut first = sheared(session, [1.0; 3]);
    steps(&mut first, 35);
    let state = first.whole_state().into_owned();
    let mut second = sheared(session, [1.0; 3]);
    second.restore(state, History::default()).unwrap();
    steps(&mut second, 25);
    assert!(*whole.whole_state() == *second.whole_state(), "a run that was interrupted is another one");
}

fn units_do_not_matter_under_the_wall(session: &Session) {
    let (length, time) = (2.0, 3.0);
    let (mut plain, mut scaled) = (sheared(session, [1.0; 3]), sheared(session, [length, time, 5.0]));
    steps(&mut plain, 40);
    steps(&mut scaled, 40);
    let [one, other] = [wall(&plain), wall(&scaled)];
    assert!((one.position - other.position / length).abs() < 1e-6, "{one:?} {other:?}");
    for (body, there) in plain.whole_state().bodies.iter().zip(&scaled.whole_state().bodies) {
        assert!((body.center - there.center / length).norm() < 1e-6, "{} {}", body.center, there.center);
    }
}
