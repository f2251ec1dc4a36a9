//! Laws of contact in dry runs: what all of them keep, and the exact solutions of gluey contacts (REFERENCE 5.2).

use nalgebra::{SMatrix, SVector, Vector2};
use turbid::{
    body::Twist,
    contact::Partner,
    geometry::{Axis, Domain},
    interaction::{Gluey, Inelastic, Interaction, Interactions, Repulsion, Touch},
    motion::{GranularBody, GranularSetup, Simulation},
    petsc::Session,
    scene::{Scheme, Step, TimeSection},
};

use crate::Test;
use crate::dry::smallest_gap;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(every_law_keeps_the_momentum_and_the_symmetry_of_a_head_on_pair_wherever_it_is),
        Test::of(a_repulsion_gives_back_what_it_takes),
        Test::of(an_automatic_step_is_no_longer_than_a_repulsion_is_stable_with),
        Test::of(a_ball_pressed_to_the_floor_takes_off_when_it_was_pulled_as_much),
        Test::of(lubricated_balls_tend_to_the_gluey_one),
        Test::of(a_ball_that_lands_without_a_force_stays_for_ever),
        Test::of(a_row_pressed_and_pulled_at_its_ends_lets_go_of_them_at_twice_the_time),
        Test::of(an_impact_on_a_gluey_row_is_remembered_by_each_contact),
        Test::of(a_rough_contact_lets_go_after_what_it_remembers),
        Test::of(a_cluster_with_more_contacts_than_it_needs_turns_as_one),
    ]
}

const GLUEY: Gluey = Gluey { least: f64::NEG_INFINITY };
const REPULSION: Repulsion = Repulsion { touch: 40.0, range: 0.2 };
const SCHEMES: [Scheme; 2] = [Scheme::TwoStep, Scheme::Euler];

/// A disk of radius 0.5 and mass 1.
fn disk(center: [f64; 2], velocity: [f64; 2], acceleration: [f64; 2]) -> GranularBody<2> {
    let twist = Twist { velocity: velocity.into(), spin: SMatrix::zeros() };
    let acceleration = acceleration.into();
    GranularBody { radius: 0.5, center: center.into(), twist, mass: 1.0, inertia: 0.125, acceleration, spin_up: SMatrix::zeros() }
}

fn channel(size: [f64; 2]) -> Domain<2> {
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    Domain { size: size.into(), axes: [Axis::Periodic, wall] }
}

fn fixed(step: f64, scheme: Scheme) -> TimeSection {
    TimeSection { step: Step::Fixed(step), end: 100.0, scheme, travel: 0.1, error: 1e-3, until: None }
}

fn start(
    session: &Session,
    size: [f64; 2],
    contact: impl Interaction<2> + 'static,
    bodies: Vec<GranularBody<2>>,
    time: TimeSection,
) -> Simulation<2> {
    Simulation::granular(
        session,
        GranularSetup {
            domain: channel(size),
            bodies,
            trajectories: Default::default(),
            interactions: Interactions::default().with(contact),
            load: None,
        },
        time,
    )
}

/// The same bodies where they are by now, under other forces.
fn under(
    session: &Session,
    simulation: &Simulation<2>,
    bodies: Vec<GranularBody<2>>,
    contact: impl Interaction<2> + 'static,
    time: TimeSection,
) -> Simulation<2> {
    let setup = GranularSetup {
        domain: simulation.domain().clone(),
        bodies,
        trajectories: Default::default(),
        interactions: Interactions::default().with(contact),
        load: None,
    };
    let mut other = Simulation::granular(session, setup, time);
    other.restore(simulation.whole_state().into_owned(), turbid::mechanics::History::default()).unwrap();
    other
}

fn step(simulation: &mut Simulation<2>) {
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap();
}

fn momentum(simulation: &Simulation<2>) -> Vector2<f64> {
    simulation.whole_state().bodies.iter().map(|body| body.twist.velocity).sum()
}

/// Two disks that meet, with their middle at a place that may lie on the seam: centres relative to it after the impact.
fn head_on<Law: Interaction<2> + Copy + 'static>(session: &Session, law: Law, middle: Vector2<f64>) -> Vec<Vector2<f64>> {
    let offset = Vector2::new(0.8, 0.3);
    let towards = -offset.normalize();
    let bodies = [1.0, -1.0].map(|side| disk((middle + offset * side).into(), (towards * side).into(), [0.0; 2]));
    let mut simulation = start(session, [8.0, 6.0], law, bodies.to_vec(), fixed(0.01, Scheme::TwoStep));
    while simulation.whole_state().time < 1.0 {
        step(&mut simulation);
        assert!(momentum(&simulation).norm() < 1e-12, "{law:?}: {}", momentum(&simulation));
        let [one, two] = [0, 1].map(|body| simulation.whole_state().bodies[body].center - middle);
        assert!((one + two).norm() < 1e-12, "{law:?}: {one} and {two} have lost their symmetry");
        assert!(one.perp(&offset).abs() < 1e-12, "{law:?}: {one} has left the line of centres");
    }
    simulation.whole_state().bodies.iter().map(|body| body.center - middle).collect()
}

fn every_law_keeps_the_momentum_and_the_symmetry_of_a_head_on_pair_wherever_it_is(session: &Session) {
    keeps_momentum_and_symmetry(session, Inelastic);
    keeps_momentum_and_symmetry(session, GLUEY);
    keeps_momentum_and_symmetry(session, REPULSION);
}

fn keeps_momentum_and_symmetry<Law: Interaction<2> + Copy + 'static>(session: &Session, law: Law) {
    let inside = head_on(session, law, Vector2::new(4.0, 3.0));
    let gap = (inside[0] - inside[1]).norm() - 1.0;
    match law.contact().touch {
        // they have met at 0.354 and bounced
        Some(Touch::Soft { .. }) => assert!(gap > 0.4, "{gap}"),
        _ => assert!(gap.abs() < 1e-12, "{law:?}: gap {gap:e}"),
    }
    for seam in [Vector2::new(0.0, 3.0), Vector2::new(8.1, 2.7)] {
        let across = head_on(session, law, seam);
        let distance = inside.iter().zip(&across).map(|(one, two)| (one - two).norm()).fold(0.0, f64::max);
        assert!(distance < 1e-12, "{law:?}: {distance:e} at {seam}");
    }
}

/// Speeds after a bounce differ from those before by the order of the rule; so does the energy on the way.
fn a_repulsion_gives_back_what_it_takes(session: &Session) {
    let loss = |step_length: f64| {
        let bodies = vec![disk([2.0, 3.0], [1.0, 0.0], [0.0; 2]), disk([4.0, 3.0], [-1.0, 0.0], [0.0; 2])];
        let mut simulation = start(session, [8.0, 6.0], REPULSION, bodies, fixed(step_length, Scheme::TwoStep));
        while simulation.whole_state().time < 1.5 {
            step(&mut simulation);
        }
        // bounced and apart
        assert!(simulation.whole_state().bodies[0].twist.velocity[0] < 0.0 && smallest_gap(&simulation) > 0.1);
        (simulation.whole_state().bodies[0].twist.velocity[0] + 1.0).abs()
    };
    let losses = [0.01, 0.005, 0.0025].map(loss);
    assert!(losses[0] < 2e-2 && losses[2] < losses[0] / 4.0, "{losses:?}");
}

fn an_automatic_step_is_no_longer_than_a_repulsion_is_stable_with(session: &Session) {
    let setup = GranularSetup {
        domain: channel([8.0, 6.0]),
        bodies: vec![disk([2.0, 3.0], [0.1, 0.0], [0.0; 2]), disk([4.0, 3.0], [-0.1, 0.0], [0.0; 2])],
        trajectories: Default::default(),
        interactions: Interactions::default().with(REPULSION),
        load: None,
    };
    // 0.4 sqrt(m / k), with k = 2 touch / (range radius)
    let longest = 0.4 * (1.0 / 800.0_f64).sqrt();
    assert!((setup.longest_step() - longest).abs() < 1e-15);
    let time = TimeSection { step: Step::Auto, end: 1.0, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None };
    let mut simulation = Simulation::granular(session, setup, time);
    let mut steps = Vec::new();
    while !simulation.over() {
        step(&mut simulation);
        steps.push(simulation.whole_state().last_step);
    }
    let (last, others) = steps.split_last().unwrap();
    assert!(*last <= longest * (1.0 + 1e-12) && others.iter().all(|step| (step / longest - 1.0).abs() < 1e-12), "{steps:?}");
}

/// Height of the gap and memory of the contact of a ball above a floor.
fn above_the_floor(simulation: &Simulation<2>) -> (f64, f64) {
    let adhesive_contacts = &simulation.whole_state().adhesive_contacts;
    assert!(
        adhesive_contacts.len() <= 1 && adhesive_contacts.iter().all(|contact| contact.partner == Partner::Wall { axis: 1, upper: false }),
        "{adhesive_contacts:?}"
    );
    (simulation.whole_state().bodies[0].center[1] - 0.5, adhesive_contacts.first().map_or(0.0, |contact| contact.gamma))
}

/// G2: a force of -2 until the time 2, then of 1; the gap is 1 at rest. All gaps and memories in steps of a given length.
fn pressed_and_pulled(session: &Session, length: f64, scheme: Scheme) -> Vec<(f64, f64, f64)> {
    let ball = |force: f64| vec![disk([1.0, 1.5], [0.0; 2], [0.0, force])];
    let mut simulation = start(session, [2.0, 10.0], GLUEY, ball(-2.0), fixed(length, scheme));
    let mut observed = Vec::new();
    let steps = |time: f64| (time / length).round() as usize;
    for number in 0..steps(8.0) {
        if number == steps(2.0) {
            simulation = under(session, &simulation, ball(1.0), GLUEY, fixed(length, scheme));
        }
        step(&mut simulation);
        let (gap, gamma) = above_the_floor(&simulation);
        observed.push((simulation.whole_state().time, gap, gamma));
    }
    observed
}

fn gap_at(observed: &[(f64, f64, f64)], time: f64) -> f64 {
    observed.iter().min_by(|one, two| (one.0 - time).abs().total_cmp(&(two.0 - time).abs())).unwrap().1
}

fn time_of(observed: &[(f64, f64, f64)], gap: f64) -> f64 {
    let after = observed.iter().position(|observed| observed.0 > 6.0 && observed.1 >= gap).unwrap();
    let [(before, low, _), (time, high, _)] = [observed[after - 1], observed[after]];
    before + (time - before) * (gap - low) / (high - low)
}

fn a_ball_pressed_to_the_floor_takes_off_when_it_was_pulled_as_much(session: &Session) {
    for scheme in SCHEMES {
        for length in [0.02, 0.01] {
            let observed = pressed_and_pulled(session, length, scheme);
            for &(time, gap, gamma) in &observed {
                let exact = match time {
                    time if time < 1.0 => (1.0 - time * time, 0.0),
                    time if time < 2.0 => (0.0, -2.0 * time),
                    time if time < 6.0 => (0.0, time - 6.0),
                    time => (0.5 * (time - 6.0).powi(2), 0.0),
                };
                // forces act half a step or a step off, are at most 2, and carry for 2 after take-off; a landing takes two steps
                let slack = 4.0 * length;
                if (time - 1.0).abs() < 2.0 * length {
                    continue;
                }
                assert!((gap - exact.0).abs() <= slack && (gamma - exact.1).abs() <= slack, "{scheme:?}: {gap}, {gamma} at {time}");
                assert!(gap.abs() < 1e-12 || gamma == 0.0, "{scheme:?}: it sticks with {gamma} at a gap of {gap:e}");
            }
            // take-off at 6, and a free flight of 2 from there
            assert!((gap_at(&observed, 8.0) - 2.0).abs() < 4.0 * length, "{scheme:?}: {}", gap_at(&observed, 8.0));
            assert!((time_of(&observed, 0.5) - 7.0).abs() < 2.0 * length, "{scheme:?}: {}", time_of(&observed, 0.5));
        }
    }
}

/// The lubricated ball `q'' = -e q'/q + f` of G2 (REFERENCE 5.2): e, q(0.5), time of q = 0.5 after take-off, q(8).
const LUBRICATED: [[f64; 4]; 6] = [
    [0.5, 0.771057505, 6.2085958, 2.34797189],
    [0.2, 0.758787108, 6.6135996, 2.27235691],
    [0.1, 0.754457380, 6.7845039, 2.17733169],
    [0.05, 0.752244957, 6.8835032, 2.10380120],
    [0.02, 0.750901928, 6.9501958, 2.04664067],
    [0.01, 0.750451625, 6.9743239, 2.02446572],
];

/// All of them were integrated elsewhere: the differences to this program's limit fall with the viscosity, to those of its step.
fn lubricated_balls_tend_to_the_gluey_one(session: &Session) {
    let observed = pressed_and_pulled(session, 1e-3, Scheme::TwoStep);
    let limit = [gap_at(&observed, 0.5), time_of(&observed, 0.5), gap_at(&observed, 8.0)];
    let differences = LUBRICATED.map(|[_, numbers @ ..]| std::array::from_fn::<f64, 3, _>(|place| (numbers[place] - limit[place]).abs()));
    for pair in differences.windows(2) {
        assert!((0..3).all(|place| pair[1][place] < pair[0][place]), "{differences:?}");
    }
    // of order e, with a logarithm
    assert!((0..3).all(|place| differences[5][place] < 0.1 * differences[0][place]), "{differences:?}");
}

/// G1: the gap 1 closes at the speed 1, and nothing ever pulls.
fn a_ball_that_lands_without_a_force_stays_for_ever(session: &Session) {
    for length in [0.03, 0.25] {
        let mut simulation =
            start(session, [2.0, 10.0], GLUEY, vec![disk([1.0, 1.5], [0.0, -1.0], [0.0; 2])], fixed(length, Scheme::TwoStep));
        while simulation.whole_state().time < 3.0 {
            step(&mut simulation);
            let (time, (gap, gamma)) = (simulation.whole_state().time, above_the_floor(&simulation));
            assert!((gap - (1.0 - time).max(0.0)).abs() < 1e-12, "{gap} at {time}");
            // the step in which it lands takes part of its speed, the next one the rest
            let landed = time > 1.0 + 1.5 * length;
            assert!(if landed { (gamma + 1.0).abs() < 1e-12 } else { (-1.0 - 1e-12..=0.0).contains(&gamma) }, "{gamma} at {time}");
        }
    }
}

/// A row of touching disks between forces on its ends that press it for a time and then pull: each of its contacts bears the whole
/// force, so that all let go together, after as long again. Those in the middle then rest, the ends fly apart.
fn a_row_pressed_and_pulled_at_its_ends_lets_go_of_them_at_twice_the_time(session: &Session) {
    for count in [2, 3, 5] {
        let row = |force: f64| {
            let acceleration = |place: usize| {
                if place == 0 {
                    force
                } else if place + 1 == count {
                    -force
                } else {
                    0.0
                }
            };
            let place = |place: usize| disk([7.5 + place as f64, 3.0], [0.0; 2], [acceleration(place), 0.0]);
            (0..count).map(place).collect::<Vec<_>>()
        };
        let length = 0.02;
        // across the boundary
        let mut simulation = start(session, [9.0, 6.0], GLUEY, row(1.5), fixed(length, Scheme::Euler));
        let (pressed, all) = (50_usize, 150);
        for number in 1..=all {
            step(&mut simulation);
            let state = simulation.whole_state();
            assert!(momentum(&simulation).norm() < 1e-12, "{}", momentum(&simulation));
            let middle = 0.5 * (state.bodies[0].center[0] + state.bodies[count - 1].center[0]);
            for body in 0..count {
                let mirrored = 2.0 * middle - state.bodies[count - 1 - body].center[0];
                assert!((state.bodies[body].center[0] - mirrored).abs() < 1e-11, "step {number} of {count}: body {body}");
            }
            if number < 2 * pressed {
                let held = 1.5 * length * number.min(2 * pressed - number) as f64;
                // over half the mass of a disk
                assert!(
                    state.adhesive_contacts.iter().all(|contact| (contact.gamma + 2.0 * held).abs() < 1e-11),
                    "step {number}: {:?}",
                    state.adhesive_contacts
                );
                assert_eq!(state.adhesive_contacts.len(), count - 1, "step {number}");
            } else {
                let flight = (number - 2 * pressed) as f64;
                // Euler's steps, the first of which is as long as it can be
                let exact = 1.5 * length * length * 0.5 * flight * (flight + 1.0);
                let gap = state.bodies[1].center[0] - state.bodies[0].center[0] - 1.0;
                let both = if count == 2 { 2.0 } else { 1.0 };
                assert!((gap - both * exact).abs() < 1e-10, "step {number} of {count}: gap {gap} instead of {exact}");
            }
            if number == pressed {
                simulation = under(session, &simulation, row(-1.5), GLUEY, fixed(length, Scheme::Euler));
            }
        }
        assert!(simulation.whole_state().adhesive_contacts.is_empty());
    }
}

/// All go on with the mean velocity; contact number `k` has passed on what the disks behind it gained.
fn an_impact_on_a_gluey_row_is_remembered_by_each_contact(session: &Session) {
    let count = 4;
    let disks = (0..count).map(|place| disk([1.5 + place as f64, 3.0], [if place == 0 { 1.0 } else { 0.0 }, 0.0], [0.0; 2]));
    let mut simulation = start(session, [20.0, 6.0], GLUEY, disks.collect(), fixed(0.1, Scheme::TwoStep));
    for _ in 0..5 {
        step(&mut simulation);
        let state = simulation.whole_state();
        assert!(state.bodies.iter().all(|body| (body.twist.velocity - Vector2::new(0.25, 0.0)).norm() < 1e-12));
        for (number, contact) in (1..count).zip(&state.adhesive_contacts) {
            let passed = 0.25 * (count - number) as f64;
            assert!((contact.gamma + 2.0 * passed).abs() < 1e-11, "contact {number} remembers {}", contact.gamma);
        }
        assert_eq!(state.adhesive_contacts.len(), count - 1);
    }
}

/// Pressed for a time 2 with 1, remembered 0.5: a pull of 1 takes it off after 0.5.
fn a_rough_contact_lets_go_after_what_it_remembers(session: &Session) {
    let (length, law) = (0.01, Gluey { least: -0.5 });
    let ball = |force: f64| vec![disk([1.0, 0.5], [0.0; 2], [0.0, force])];
    let mut simulation = start(session, [2.0, 10.0], law, ball(-1.0), fixed(length, Scheme::Euler));
    for number in 1..=300 {
        step(&mut simulation);
        let (gap, gamma) = above_the_floor(&simulation);
        let pulled = f64::from(number - 200) * length;
        if number <= 200 {
            assert!((gamma - (-length * f64::from(number)).max(-0.5)).abs() < 1e-12 && gap.abs() < 1e-13, "{gamma} at step {number}");
        } else if pulled < 0.5 - 1e-9 {
            assert!((gamma - (pulled - 0.5)).abs() < 1e-12 && gap.abs() < 1e-13, "{gamma} at step {number}");
        } else {
            let flight = pulled - 0.5;
            assert!(gamma == 0.0 && (gap - 0.5 * flight * (flight + length)).abs() < 1e-11, "{gap} at step {number}");
        }
        if number == 200 {
            simulation = under(session, &simulation, ball(1.0), law, fixed(length, Scheme::Euler));
        }
    }
}

/// Seven disks in a hexagon have twelve contacts, one more than rigidity needs. Pressed and set spinning they stay together and
/// touch, though their linear equations contradict each other by the square of each turn.
fn a_cluster_with_more_contacts_than_it_needs_turns_as_one(session: &Session) {
    let middle = Vector2::new(10.0, 10.0);
    let around = |corner: usize| {
        let angle = std::f64::consts::FRAC_PI_3 * corner as f64;
        let outward = Vector2::new(angle.cos(), angle.sin());
        let velocity = Vector2::new(-outward[1], outward[0]) * 0.3 - outward * 2.0;
        disk((middle + outward).into(), velocity.into(), [0.0; 2])
    };
    let bodies = std::iter::once(disk(middle.into(), [0.0; 2], [0.0; 2])).chain((0..6).map(around)).collect();
    let mut simulation = start(session, [20.0, 20.0], GLUEY, bodies, fixed(0.05, Scheme::TwoStep));
    for number in 0..60 {
        step(&mut simulation);
        let state = simulation.whole_state();
        assert!(momentum(&simulation).norm() < 1e-11, "{}", momentum(&simulation));
        assert!(smallest_gap(&simulation) > -1e-9, "{}", smallest_gap(&simulation));
        for body in &state.bodies[1..] {
            let distance = (body.center - state.bodies[0].center).norm();
            // each step may open what the next one closes: half the square of a turn of 0.3 times the step
            assert!(distance < 1.0 + 3e-4, "step {number}: {distance}");
        }
    }
    let turned = simulation.whole_state().bodies[1].center - simulation.whole_state().bodies[0].center;
    let angle = turned[1].atan2(turned[0]);
    assert!((angle - 0.9).abs() < 0.05, "it has turned by {angle}");
    assert!(simulation.whole_state().adhesive_contacts.len() >= 6, "{} stick", simulation.whole_state().adhesive_contacts.len());
}
