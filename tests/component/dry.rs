//! Dry bodies in motion: exact cases (REFERENCE 5.1), conservation laws, steps.

use std::path::Path;

use nalgebra::{SMatrix, SVector, Vector2};
use turbid::{
    body::{Twist, components, pack},
    error::Error,
    geometry::{Axis, Ball, Domain, near_pairs, near_walls},
    interaction::{Inelastic, Interactions},
    motion::{GranularBody, GranularSetup, Simulation, StepReport},
    petsc::Session,
    scene::{Scene, Scheme, Step, TimeSection},
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_falling_column_of_disks_stops_ball_by_ball_at_the_exact_times),
        Test::of(a_falling_column_of_spheres_stops_ball_by_ball_at_the_exact_times),
        Test::of(free_flight_under_a_constant_force_is_exact),
        Test::of(free_flight_by_euler_is_of_first_order),
        Test::of(an_impact_on_a_touching_row_is_shared_by_all),
        Test::of(a_ball_touches_the_floor_in_the_first_step_that_would_pass_it_and_stays),
        Test::of(the_impulse_of_the_floor_takes_the_momentum_that_gravity_gave),
        Test::of(a_column_at_rest_bears_its_weight_in_steps_of_any_length),
        Test::of(a_load_below_the_critical_one_rubs_in_no_step),
        Test::of(the_momentum_of_a_head_on_pair_is_kept),
        Test::of(colliding_disks_never_gain_energy_and_never_overlap_however_long_the_step),
        Test::of(a_body_whose_motion_is_given_pushes_a_free_one),
        Test::of(the_first_automatic_step_knows_bonds_and_paths_and_not_the_end),
        Test::of(a_torque_spins_a_free_ball_up_at_torque_over_inertia),
        Test::of(bodies_that_leave_the_box_without_a_contact_model_are_an_error_that_says_so),
        Test::of(no_free_flying_body_moves_more_than_its_travel_in_an_automatic_step),
        Test::of(automatic_steps_grow_by_a_quarter_at_most),
    ]
}

const GRAVITY: f64 = 9.81;
const SCHEMES: [Scheme; 2] = [Scheme::TwoStep, Scheme::Euler];

fn dry_body<const D: usize>(center: [f64; D], velocity: [f64; D], acceleration: SVector<f64, D>) -> GranularBody<D> {
    let twist = Twist { velocity: velocity.into(), spin: SMatrix::zeros() };
    GranularBody { radius: 0.1, center: center.into(), twist, mass: 1.0, inertia: 0.005, acceleration, spin_up: SMatrix::zeros() }
}

/// A box with walls across the last axis, periodic along the others.
fn channel<const D: usize>(size: [f64; D]) -> Domain<D> {
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    Domain { size: size.into(), axes: std::array::from_fn(|axis| if axis + 1 == D { wall } else { Axis::Periodic }) }
}

fn down<const D: usize>() -> SVector<f64, D> {
    SVector::from_fn(|axis, _| if axis + 1 == D { -GRAVITY } else { 0.0 })
}

fn start<const D: usize>(session: &Session, domain: Domain<D>, bodies: Vec<GranularBody<D>>, time: TimeSection) -> Simulation<D> {
    let setup = GranularSetup {
        domain,
        bodies,
        trajectories: Default::default(),
        interactions: Interactions::default().with(Inelastic),
        load: None,
    };
    Simulation::granular(session, setup, time)
}

fn fixed(step: f64, end: f64, scheme: Scheme) -> TimeSection {
    TimeSection { step: Step::Fixed(step), end, scheme, travel: 0.1, error: 1e-3, until: None }
}

fn step<const D: usize>(simulation: &mut Simulation<D>) -> StepReport {
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap()
}

/// Smallest gap in radii of the smaller body, or infinity if nothing is near.
pub fn smallest_gap<const D: usize>(simulation: &Simulation<D>) -> f64 {
    let balls = simulation.whole_balls();
    let pairs = near_pairs(simulation.domain(), &balls, 0.0)
        .into_iter()
        .map(|pair| pair.gap / balls[pair.first].radius.min(balls[pair.second].radius));
    let walls = near_walls(simulation.domain(), &balls, 0.0).into_iter().map(|pair| pair.gap / balls[pair.body].radius);
    pairs.chain(walls).fold(f64::INFINITY, f64::min)
}

/// Balls of radius 0.1 above a floor, with gaps 0.1 below each.
fn column<const D: usize>(session: &Session, size: [f64; D], scheme: Scheme) {
    let (count, dt) = (5, 1e-3);
    let height = |ball: usize| 0.1 + 0.1 * ball as f64 + 0.2 * (ball - 1) as f64;
    let rest = |ball: usize| 0.1 * (2 * ball - 1) as f64;
    let center = |ball: usize| std::array::from_fn(|axis| if axis + 1 == D { height(ball) } else { 0.5 });
    let bodies = (1..=count).map(|ball| dry_body(center(ball), [0.0; D], down())).collect();
    let mut simulation = start(session, channel(size), bodies, fixed(dt, 0.4, scheme));
    let mut stopped = vec![f64::INFINITY; count];
    while !simulation.over() {
        step(&mut simulation);
        assert!(smallest_gap(&simulation) > -1e-9, "{}", smallest_gap(&simulation));
        let time = simulation.whole_state().time;
        for (ball, body) in (1..).zip(simulation.whole_state().bodies.iter()) {
            // above it, a ball has not arrived; below, it has passed through
            if (body.center[D - 1] - rest(ball)).abs() < 1e-9 {
                stopped[ball - 1] = stopped[ball - 1].min(time);
            }
        }
    }
    let exact = [0.142784312, 0.201927511, 0.247309683, 0.285568625, 0.319275428];
    for (found, exact) in stopped.iter().zip(exact) {
        // within the step in which it lands; Euler's fall is ahead by half a step
        assert!((found - exact).abs() <= dt, "{scheme:?}: {stopped:?}");
    }
    for (ball, body) in (1..).zip(simulation.whole_state().bodies.iter()) {
        assert!((body.center[D - 1] - rest(ball)).abs() < 1e-9, "{scheme:?}: ball {ball} rests at {}", body.center[D - 1]);
    }
}

fn a_falling_column_of_disks_stops_ball_by_ball_at_the_exact_times(session: &Session) {
    SCHEMES.iter().for_each(|&scheme| column(session, [1.0, 3.0], scheme));
}

fn a_falling_column_of_spheres_stops_ball_by_ball_at_the_exact_times(session: &Session) {
    SCHEMES.iter().for_each(|&scheme| column(session, [1.0, 1.0, 3.0], scheme));
}

/// Distance of a thrown ball from its parabola at the time 0.4, in steps of a given length.
fn flight_error(session: &Session, step_length: f64, scheme: Scheme) -> f64 {
    let ball = dry_body([0.5, 1.0], [0.7, 2.0], Vector2::new(-0.3, -GRAVITY));
    let mut simulation = start(session, channel([50.0, 50.0]), vec![ball], fixed(step_length, 0.4, scheme));
    while !simulation.over() {
        step(&mut simulation);
    }
    let time = simulation.whole_state().time;
    let exact = ball.center + ball.twist.velocity * time + ball.acceleration * (0.5 * time * time);
    (simulation.whole_state().bodies[0].center - exact).norm()
}

fn free_flight_under_a_constant_force_is_exact(session: &Session) {
    // 0.07 does not divide the time: the last step is shorter
    for step_length in [0.4, 0.1, 0.07] {
        let error = flight_error(session, step_length, Scheme::TwoStep);
        assert!(error < 1e-14, "{error:e} with steps of {step_length}");
    }
}

/// The error is `g t dt / 2` exactly.
fn free_flight_by_euler_is_of_first_order(session: &Session) {
    for step_length in [0.1, 0.05] {
        let error = flight_error(session, step_length, Scheme::Euler);
        let exact = 0.5 * GRAVITY.hypot(0.3) * 0.4 * step_length;
        assert!((error - exact).abs() < 1e-13, "{error} with steps of {step_length}, expected {exact}");
    }
}

fn an_impact_on_a_touching_row_is_shared_by_all(session: &Session) {
    for count in [3, 5] {
        let velocity = |place: usize| [if place == 0 { 1.0 } else { 0.0 }, 0.0];
        let body = |place: usize| dry_body([0.3 + 0.2 * place as f64, 1.0], velocity(place), Vector2::zeros());
        let bodies = (0..count).map(body).collect();
        let mut simulation = start(session, channel([10.0, 2.0]), bodies, fixed(0.5, 2.0, Scheme::TwoStep));
        for _ in 0..2 {
            step(&mut simulation);
            for body in simulation.whole_state().bodies.iter() {
                let error = (body.twist.velocity - Vector2::new(1.0 / count as f64, 0.0)).norm();
                assert!(error < 1e-12, "row of {count}: off by {error:e}");
            }
        }
    }
}

/// A ball that falls freely from a height of 1.37 radii above the floor.
fn falling(session: &Session, step_length: f64, scheme: Scheme) -> Simulation<2> {
    start(session, channel([1.0, 1.0]), vec![dry_body([0.5, 0.237], [0.0, -0.4], down())], fixed(step_length, 0.3, scheme))
}

fn a_ball_touches_the_floor_in_the_first_step_that_would_pass_it_and_stays(session: &Session) {
    for scheme in SCHEMES {
        let mut simulation = falling(session, 0.013, scheme);
        let mut touched = false;
        while !simulation.over() {
            let (state, length) = (simulation.whole_state().into_owned(), 0.013_f64.min(0.3 - simulation.whole_state().time));
            let push = if scheme == Scheme::Euler { length } else { 0.5 * (state.last_step + length) };
            let free = state.bodies[0].center[1] + length * (state.bodies[0].twist.velocity[1] - GRAVITY * push);
            step(&mut simulation);
            let gap = simulation.whole_state().bodies[0].center[1] - 0.1;
            touched |= free < 0.1;
            let expected = if touched { 0.0 } else { free - 0.1 };
            // 1e-10 radii
            assert!((gap - expected).abs() < 1e-11, "{scheme:?} at {}: gap {gap:e} instead of {expected:e}", simulation.whole_state().time);
        }
        assert!(touched);
    }
}

/// `m |u_impact| + m g t_contact` is the momentum at the start and what gravity gave up to the last velocity, which
/// lives half a step before the last place in the default scheme.
fn the_impulse_of_the_floor_takes_the_momentum_that_gravity_gave(session: &Session) {
    let (length, steps) = (0.01, 30);
    for scheme in SCHEMES {
        let mut simulation = falling(session, length, scheme);
        let (mut impulse, mut before) = (0.0, 0.0);
        for _ in 0..steps {
            step(&mut simulation);
            // forces act from the middle of the step before to that of this one
            let duration = if scheme == Scheme::Euler { length } else { 0.5 * (before + length) };
            impulse += simulation.whole_state().contact_history.iter().map(|contact| contact.force * duration).sum::<f64>();
            before = length;
        }
        let pushed = length * f64::from(steps) - if scheme == Scheme::Euler { 0.0 } else { 0.5 * length };
        let expected = 0.4 + GRAVITY * pushed;
        // thirty interior-point solves, each to about 1e-12
        assert!((impulse / expected - 1.0).abs() < 1e-10, "{scheme:?}: {impulse} instead of {expected}");
    }
}

fn a_column_at_rest_bears_its_weight_in_steps_of_any_length(session: &Session) {
    let text = |contact: &str, bodies: &str| {
        format!(
            "gravity = [0.0, -1.0]\ndomain = {{ size = [8.0, 8.0], y = \"walls\" }}\nflow = {{ model = \"none\" }}\n\
             contact = {{ model = \"inelastic\"{contact} }}\ntime = {{ end = 0.23, step = 0.1 }}\n{bodies}\n"
        )
    };
    let disks = "bodies = [{ radius = 0.5, centers = [[3.0, 0.5], [3.0, 1.5]], density = 1.0 }]";
    let rod =
        "clusters = [{ shape = \"rod\", beads = 2, radius = 0.5, centers = [[3.0, 1.0]], rotation = 1.5707963267948966, density = 1.0 }]";
    let mass = 0.25 * std::f64::consts::PI;
    // what holds a cluster and contacts agree to 1e-7 of a radius in a step
    for (contact, bodies, forces, error) in [
        ("", disks, vec![1.0, 2.0], 1e-8),
        (", friction = 0.5", disks, vec![1.0, 2.0], 1e-8),
        ("", rod, vec![2.0], 1e-4),
        (", friction = 0.5", rod, vec![2.0], 1e-4),
    ] {
        let scene = Scene::parse("column", Path::new("."), &text(contact, bodies), &[]).unwrap();
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        let mut lengths = Vec::new();
        while !simulation.over() {
            lengths.push(step(&mut simulation).length);
            let mut found: Vec<f64> = simulation.whole_state().contact_history.iter().map(|contact| contact.force / mass).collect();
            found.sort_by(f64::total_cmp);
            let exact = found.len() == forces.len() && found.iter().zip(&forces).all(|(found, force)| (found / force - 1.0).abs() < error);
            assert!(exact, "{contact} {bodies}, steps {lengths:?}: {found:?}");
        }
        assert!(lengths.len() == 3 && lengths[2] < 0.05, "{lengths:?}");
    }
}

/// A disk on an incline whose weight across it is below the critical load slides freely, in steps that shrink too.
fn a_load_below_the_critical_one_rubs_in_no_step(session: &Session) {
    let angle = std::f64::consts::PI / 6.0;
    let weight = 0.25 * std::f64::consts::PI * angle.cos();
    for (load, rubs) in [(1.01, false), (0.97, true)] {
        let text = format!(
            "gravity = [0.5, {}]\ndomain = {{ size = [90.0, 6.0], y = \"walls\" }}\nflow = {{ model = \"none\" }}\ntime = {{ end = 4.0 }}\n\
             contact = {{ model = \"inelastic\", friction = {{ coefficient = 0.5, critical_load = {} }} }}\n\
             bodies = [{{ radius = 0.5, centers = [[2.0, 0.5]], density = 1.0 }}]\n",
            -angle.cos(),
            load * weight
        );
        let scene = Scene::parse("incline", Path::new("."), &text, &[]).unwrap();
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        while !simulation.over() {
            step(&mut simulation);
        }
        let way = simulation.whole_state().bodies[0].center[0] - 2.0;
        let exact = 4.0 - if rubs { 0.5 * 0.03 * angle.cos() * 8.0 } else { 0.0 };
        assert!((way - exact).abs() < 1e-9, "{load}: {way} for {exact}");
    }
}

fn the_momentum_of_a_head_on_pair_is_kept(session: &Session) {
    let light = dry_body([0.4, 0.5], [1.0, 0.0], Vector2::zeros());
    let heavy = GranularBody { mass: 3.0, ..dry_body([1.0, 0.5], [-0.7, 0.0], Vector2::zeros()) };
    let mut simulation = start(session, channel([10.0, 1.0]), vec![light, heavy], fixed(0.1, 1.0, Scheme::TwoStep));
    while !simulation.over() {
        step(&mut simulation);
        let bodies = &simulation.whole_state().bodies;
        let momentum = bodies[0].twist.velocity + bodies[1].twist.velocity * 3.0;
        // rounding of what is exchanged, 1.3
        assert!((momentum - Vector2::new(-1.1, 0.0)).norm() < 1e-14, "{momentum}");
    }
    // inelastic: they go on together
    for body in simulation.whole_state().bodies.iter() {
        assert!((body.twist.velocity[0] + 1.1 / 4.0).abs() < 1e-12, "{}", body.twist.velocity);
    }
}

/// Fifty disks at fraction 0.4, the fastest of which cover 8 radii in a step.
fn colliding_disks_never_gain_energy_and_never_overlap_however_long_the_step(session: &Session) {
    let count = 50;
    let size = (f64::from(count) * std::f64::consts::PI * 0.01 / 0.4).sqrt();
    let domain = Domain { size: Vector2::repeat(size), axes: [Axis::Periodic; 2] };
    let radii = vec![0.1; count as usize];
    let centers = pack(&domain, &[] as &[Ball<2>], &radii, 0.05, 1).unwrap();
    // all directions, speeds from 0.2 to 1
    let velocity = |angle: f64| [angle.cos(), angle.sin()].map(|part| part * (0.6 + 0.4 * (3.7 * angle).sin()));
    let bodies = (0..)
        .zip(centers)
        .map(|(number, center): (u32, Vector2<f64>)| dry_body(center.into(), velocity(2.399 * f64::from(number)), Vector2::zeros()));
    let mut simulation = start(session, domain, bodies.collect(), fixed(0.8, 16.0, Scheme::TwoStep));
    let energy =
        |simulation: &Simulation<2>| simulation.whole_state().bodies.iter().map(|body| body.twist.velocity.norm_squared()).sum::<f64>();
    let at_start = energy(&simulation);
    while !simulation.over() {
        let before = energy(&simulation);
        step(&mut simulation);
        assert!(energy(&simulation) <= before + 1e-12 * at_start, "{} after {before}", energy(&simulation));
        assert!(smallest_gap(&simulation) > -1e-6, "{}", smallest_gap(&simulation));
    }
    assert!(energy(&simulation) < 0.9 * at_start, "collisions cost energy: {} of {at_start} is left", energy(&simulation));
}

fn a_body_whose_motion_is_given_pushes_a_free_one(session: &Session) {
    let pusher = GranularBody { mass: f64::INFINITY, inertia: f64::INFINITY, ..dry_body([0.2, 0.5], [0.5, 0.0], Vector2::zeros()) };
    let pushed = dry_body([0.6, 0.5], [0.0, 0.0], Vector2::zeros());
    let mut simulation = start(session, channel([10.0, 1.0]), vec![pusher, pushed], fixed(0.13, 2.0, Scheme::TwoStep));
    while !simulation.over() {
        step(&mut simulation);
        let [pusher, pushed] = [0, 1].map(|body| simulation.whole_state().bodies[body].center[0]);
        assert!((pusher - 0.2 - 0.5 * simulation.whole_state().time).abs() < 1e-13, "{pusher}");
        // at rest until it is reached, from then on in touch
        assert!((pushed - (pusher + 0.2).max(0.6)).abs() < 1e-10, "{pushed} pushed by {pusher}");
    }
    assert!((simulation.whole_state().bodies[1].twist.velocity - Vector2::new(0.5, 0.0)).norm() < 1e-10);
}

/// The inertia of a homogeneous disk is `m r^2 / 2`, that of a sphere `2/5 m r^2`.
fn a_torque_spins_a_free_ball_up_at_torque_over_inertia(session: &Session) {
    let mass = [std::f64::consts::PI * 0.04 * 3.0, 4.0 / 3.0 * std::f64::consts::PI * 0.008 * 3.0];
    spin_up::<2>(session, "[4.0, 4.0]", "0.3", &[0.3 / (0.5 * mass[0] * 0.04)]);
    let unit = 1.0 / (0.4 * mass[1] * 0.04);
    spin_up::<3>(session, "[4.0, 4.0, 4.0]", "[0.3, 0.0, -0.1]", &[0.3 * unit, 0.0, -0.1 * unit]);
}

fn spin_up<const D: usize>(session: &Session, size: &str, torque: &str, expected: &[f64]) {
    let center = &size.replace("4.0", "2.0");
    let text = format!(
        "[domain]\nsize = {size}\n[flow]\nmodel = \"none\"\n\
         [[bodies]]\nradius = 0.2\ncenters = [{center}]\ndensity = 3.0\ntorque = {torque}\n\
         [time]\nstep = 0.01\nend = 0.1\n"
    );
    let scene = Scene::parse("spin", Path::new(""), &text, &[]).unwrap();
    let mut simulation = Simulation::<D>::new(session, &scene).unwrap();
    for _ in 0..10 {
        step(&mut simulation);
    }
    // velocities live half a step before places
    let lived = simulation.whole_state().time - 0.005;
    for (found, expected) in components(&simulation.whole_state().bodies[0].twist.spin).into_iter().zip(expected) {
        assert!((found - expected * lived).abs() <= 1e-12 * expected.abs(), "{found} instead of {}", expected * lived);
    }
}

/// A bond of stiffness 200 that is longer than at rest by 1.2 accelerates its beads by 240 over their mass: they go a tenth of their radius in the time in
/// which `a t^2` is that. A body that is led 3.0 along within 0.1 goes as far in a small part of that; both were passed in one step to any end.
fn the_first_automatic_step_knows_bonds_and_paths_and_not_the_end(session: &Session) {
    let first = |bodies: &str, end: f64| {
        let text = format!("domain.size = [8.0, 8.0]\nflow.model = \"none\"\ntime.end = {end}\n{bodies}");
        let scene = Scene::parse("first", Path::new(""), &text, &[]).unwrap();
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap().length
    };
    let bond = "[[chains]]\nradius = 0.5\nbeads = 2\nspacing = 1.3\nstretch = 200.0\ncenters = [[3.0, 4.0], [5.5, 4.0]]\n";
    let path = "[[bodies]]\nradius = 0.5\ncenters = [[2.0, 3.0]]\nmotion = { path = [[0.0, 0.0, 0.0], [0.1, 3.0, 0.0]] }\n";
    let mass = 0.25 * std::f64::consts::PI;
    let by_bond = (0.05 * mass / 240.0).sqrt();
    // 3 s^2 - 2 s^3 of the way, s being the part of the time
    let by_path = 0.1 * 0.075_f64;
    for (bodies, expected, tolerance) in [(bond, by_bond, 1e-6), (path, by_path, 0.03)] {
        let found = [0.1, 0.4].map(|end| first(bodies, end));
        assert!(found[0] == found[1] && (found[0] / expected - 1.0).abs() < tolerance, "{found:?}, {expected}");
    }
}

fn bodies_that_leave_the_box_without_a_contact_model_are_an_error_that_says_so(session: &Session) {
    let time = fixed(0.1, 5.0, Scheme::TwoStep);
    let bodies = vec![dry_body([0.5, 0.5], [1.0, 0.0], Vector2::zeros()), dry_body([0.5, 0.6], [0.0, 1.0], Vector2::zeros())];
    let setup = GranularSetup {
        domain: channel([1.0, 1.0]),
        bodies,
        trajectories: Default::default(),
        interactions: Interactions::default(),
        load: None,
    };
    let mut simulation = Simulation::granular(session, setup, time);
    let error = loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        assert!(simulation.whole_state().time < 1.0, "nobody noticed");
        if let Err(error) = simulation.step(&observation, &mut |_, _| {}) {
            break error;
        }
    };
    let Error::Diverged(text) = error else { panic!("{error:?}") };
    assert!(text.contains("body 1 has left the box along y; set contact.model = \"inelastic\" or an earlier time.end"), "{text}");
}

/// Steps and the distances, in radii, that a body flies in them.
fn automatic(session: &Session, body: GranularBody<2>, scheme: Scheme) -> Vec<(f64, f64)> {
    let time = TimeSection { step: Step::Auto, end: 2.0, scheme, travel: 0.2, error: 4e-3, until: None };
    let mut simulation = start(session, channel([100.0, 100.0]), vec![body], time);
    let mut steps = Vec::new();
    while !simulation.over() {
        let before = simulation.whole_state().bodies[0].center;
        let length = step(&mut simulation).length;
        steps.push((length, (simulation.whole_state().bodies[0].center - before).norm() / body.radius));
    }
    steps
}

fn no_free_flying_body_moves_more_than_its_travel_in_an_automatic_step(session: &Session) {
    // from rest, straight up and back, thrown aslant, against the force
    for velocity in [[0.0, 0.0], [0.0, 8.0], [3.0, 1.0], [-2.0, 6.0]] {
        for scheme in SCHEMES {
            let steps = automatic(session, dry_body([50.0, 50.0], velocity, down()), scheme);
            let furthest = steps.iter().map(|step| step.1).fold(0.0, f64::max);
            assert!(furthest <= 0.2 * (1.0 + 1e-9), "{scheme:?} from {velocity:?}: {furthest} radii in a step");
            // nor are steps much shorter than they need be
            assert!(furthest > 0.19, "{scheme:?} from {velocity:?}: {furthest} radii in a step");
        }
    }
}

fn automatic_steps_grow_by_a_quarter_at_most(session: &Session) {
    let steps = automatic(session, dry_body([50.0, 50.0], [0.0, 8.0], down()), Scheme::TwoStep);
    let growth = steps.windows(2).map(|pair| pair[1].0 / pair[0].0).fold(0.0, f64::max);
    assert!(growth <= 1.25 * (1.0 + 1e-12), "{growth}");
    // towards the highest point, the limit is what holds steps back
    assert!(growth > 1.2, "{growth}");
}
