//! Dry friction: cases with exact answers, conservation, restarts, and what may not matter. Radius, density and gravity are 1 but where it is said.

use std::f64::consts::PI;

use nalgebra::{SMatrix, SVector, Vector2};
use turbid::{
    body::{Twist, components, skew},
    contact::{FrictionReport, Partner},
    friction::{FrictionLaw, SurfaceFriction},
    geometry::{Axis, Domain},
    interaction::{Friction, Inelastic, Interactions, UnequalFriction},
    motion::{GranularBody, GranularSetup, Simulation},
    petsc::Session,
    scene::{Scheme, Step, TimeSection},
    setup::{Moving, State},
};

use crate::{Test, dry::smallest_gap};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_ball_on_an_incline_rolls_up_to_the_limit_and_slides_above_it),
        Test::of(the_smoother_surface_of_a_contact_counts),
        Test::of(a_ball_that_slides_rolls_after_the_exact_time_at_the_exact_speed),
        Test::of(a_floor_that_moves_takes_a_disk_along_until_it_rolls),
        Test::of(the_work_of_contacts_is_what_bodies_gain_or_lose),
        Test::of(the_forces_of_a_tower_are_the_weights_above),
        Test::of(a_couple_turns_a_disk_in_a_corner_just_above_the_limit),
        Test::of(a_pyramid_stands_just_above_the_limit),
        Test::of(a_wedge_holds_a_disk_by_forces_between_the_bounds),
        Test::of(disks_that_tumble_never_gain_energy_and_never_overlap),
        Test::of(disks_fall_to_rest_on_any_number_of_ranks),
        Test::of(a_restart_repeats_a_run),
        Test::of(units_places_mirrors_and_the_order_of_bodies_do_not_matter),
    ]
}

/// A ball of density 1.
pub fn ball<const D: usize>(center: [f64; D], velocity: [f64; D], gravity: SVector<f64, D>) -> GranularBody<D> {
    sized(1.0, center, velocity, gravity)
}

/// A ball of this radius and density 1.
pub fn sized<const D: usize>(radius: f64, center: [f64; D], velocity: [f64; D], gravity: SVector<f64, D>) -> GranularBody<D> {
    let [volume, part] = if D == 2 { [PI, 0.5] } else { [4.0 / 3.0 * PI, 0.4] };
    let mass = volume * radius.powi(D as i32);
    let (center, twist) = (center.into(), Twist { velocity: velocity.into(), spin: SMatrix::zeros() });
    GranularBody { radius, center, twist, mass, inertia: part * mass * radius * radius, acceleration: gravity, spin_up: SMatrix::zeros() }
}

/// A ball that does not move.
pub fn fixed<const D: usize>(radius: f64, center: [f64; D]) -> GranularBody<D> {
    let given = sized(radius, center, [0.0; D], SVector::zeros());
    GranularBody { mass: f64::INFINITY, inertia: f64::INFINITY, ..given }
}

/// Gravity along the last axis.
pub fn down<const D: usize>() -> SVector<f64, D> {
    SVector::from_fn(|axis, _| if axis + 1 == D { -1.0 } else { 0.0 })
}

/// A box with walls across the last axis, periodic along the others.
pub fn channel<const D: usize>(size: f64) -> Domain<D> {
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    Domain { size: [size; D].into(), axes: std::array::from_fn(|axis| if axis + 1 == D { wall } else { Axis::Periodic }) }
}

/// A box with walls on all sides.
pub fn closed(size: [f64; 2]) -> Domain<2> {
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    Domain { size: size.into(), axes: [wall; 2] }
}

fn start<const D: usize>(session: &Session, domain: Domain<D>, bodies: &[GranularBody<D>], friction: f64, step: f64) -> Simulation<D> {
    let interactions = Interactions::default().with(Inelastic).with(Friction::new(friction, 0.0));
    start_with(session, (domain, interactions), bodies, step)
}

/// A simulation by Euler steps with these interactions.
pub fn start_with<const D: usize>(
    session: &Session,
    (domain, interactions): (Domain<D>, Interactions<D>),
    bodies: &[GranularBody<D>],
    step: f64,
) -> Simulation<D> {
    let setup = GranularSetup { domain, bodies: bodies.to_vec(), trajectories: Default::default(), interactions, load: None };
    let time = TimeSection { step: Step::Fixed(step), end: 1e6 * step, scheme: Scheme::Euler, travel: 0.1, error: 1e-3, until: None };
    Simulation::granular(session, setup, time)
}

/// One step, and how friction was kept in it.
pub fn step<const D: usize>(simulation: &mut Simulation<D>) -> FrictionReport {
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap().kkt_report.unwrap().friction.unwrap()
}

/// Some steps, and the largest residual.
pub fn steps<const D: usize>(simulation: &mut Simulation<D>, count: usize) -> f64 {
    (0..count).map(|_| step(simulation).residual).fold(0.0, f64::max)
}

/// The largest speed.
pub fn fastest<const D: usize>(simulation: &Simulation<D>) -> f64 {
    simulation.whole_state().bodies.iter().map(|body| body.twist.velocity.norm()).fold(0.0, f64::max)
}

/// Kinetic energy of free bodies, and their energy of place.
pub fn energy<const D: usize>(simulation: &Simulation<D>, bodies: &[GranularBody<D>]) -> f64 {
    let of_body = |(moving, body): (&turbid::setup::Moving<D>, &GranularBody<D>)| {
        let turning = 0.5 * body.inertia * moving.twist.spin.norm_squared();
        0.5 * (body.mass * moving.twist.velocity.norm_squared() + turning) - body.mass * body.acceleration.dot(&moving.center)
    };
    simulation.whole_state().bodies.iter().zip(bodies).filter(|(_, body)| body.mass.is_finite()).map(of_body).sum()
}

/// Normal forces of contacts with the lower wall along an axis, over a unit.
pub fn on_wall<const D: usize>(state: &State<D>, wall: usize, unit: f64) -> Vec<f64> {
    let of_wall = |partner: Partner| matches!(partner, Partner::Wall { axis, upper: false } if axis == wall);
    let mut forces: Vec<_> = state
        .contact_history
        .iter()
        .filter(|contact| of_wall(contact.partner))
        .map(|contact| (contact.body, contact.force / unit))
        .collect();
    forces.sort_by_key(|force| force.0);
    forces.into_iter().map(|(_, force)| force).collect()
}

/// Acceleration along an incline by friction at parts of the limit `tan = factor mu`: rolling, `roll g sin`, or sliding, `g (sin - mu cos)`.
fn incline<const D: usize>(session: &Session, factor: f64, roll: f64) {
    let mu = 0.2_f64;
    for part in [0.5, 0.99, 1.01, 2.0] {
        let angle = (part * factor * mu).atan();
        let mut gravity = down::<D>() * angle.cos();
        gravity[0] = angle.sin();
        let center = std::array::from_fn(|axis| if axis + 1 == D { 1.0 } else { 5.0 });
        let mut simulation = start(session, channel(10.0), &[ball(center, [0.0; D], gravity)], mu, 0.02);
        steps(&mut simulation, 50);
        let found = simulation.whole_state().bodies[0].twist.velocity[0];
        let exact = if part < 1.0 { roll * angle.sin() } else { angle.sin() - mu * angle.cos() };
        assert!((found - exact).abs() < 1e-10, "{D}D at {part} of the limit: {found} for {exact}");
    }
}

fn a_ball_on_an_incline_rolls_up_to_the_limit_and_slides_above_it(session: &Session) {
    incline::<2>(session, 3.0, 2.0 / 3.0);
    incline::<3>(session, 3.5, 5.0 / 7.0);
}

fn slides_between<const D: usize>(session: &Session, [of_ball, of_wall]: [f64; 2]) {
    let (mu, angle) = (of_ball.min(of_wall), 0.8_f64.atan());
    let mut gravity = down::<D>() * angle.cos();
    gravity[0] = angle.sin();
    let center = std::array::from_fn(|axis| if axis + 1 == D { 1.0 } else { 5.0 });
    let (friction, surfaces) =
        (Friction::new(of_ball.max(of_wall), 0.0), SurfaceFriction::new(vec![FrictionLaw::plain(of_ball)], FrictionLaw::plain(of_wall)));
    let unequal = Interactions::default().with(Inelastic).with(UnequalFriction { friction, surfaces });
    let mut simulation = start_with(session, (channel(10.0), unequal), &[ball(center, [0.0; D], gravity)], 0.02);
    let residual = steps(&mut simulation, 50);
    let twist = simulation.whole_state().bodies[0].twist;
    let (found, exact) = (twist.velocity[0], angle.sin() - mu * angle.cos());
    assert!((found - exact).abs() < 1e-10 && residual < 1e-9, "{D}D, {of_ball} on {of_wall}: {found} for {exact}");
    assert_eq!(mu == 0.0, twist.spin.norm() == 0.0);
}

fn the_smoother_surface_of_a_contact_counts(session: &Session) {
    for both in [[0.7, 0.1], [0.1, 0.7], [0.5, 0.0]] {
        slides_between::<2>(session, both);
        slides_between::<3>(session, both);
    }
}

/// The point of contact of a ball on the floor moves so along the first axis.
fn sliding<const D: usize>(simulation: &Simulation<D>) -> f64 {
    let arm = down::<D>();
    simulation.whole_state().bodies[0].twist.at(&arm)[0]
}

fn slide_to_roll<const D: usize>(session: &Session, share: f64, end: f64) {
    let (mu, speed) = (0.3, 2.0);
    let dt = speed * share / mu / 100.5;
    let center: [f64; D] = std::array::from_fn(|axis| if axis + 1 == D { 1.0 } else { 5.0 });
    let velocity: [f64; D] = std::array::from_fn(|axis| if axis == 0 { speed } else { 0.0 });
    let mut simulation = start(session, channel(50.0), &[ball(center, velocity, down())], mu, dt);
    steps(&mut simulation, 100);
    assert!(sliding(&simulation) > 1e-3, "{}", sliding(&simulation));
    steps(&mut simulation, 1);
    let rolling = simulation.whole_state().bodies[0].twist.velocity[0];
    assert!(sliding(&simulation).abs() < 1e-12 && (rolling - end * speed).abs() < 1e-12, "{rolling} {:e}", sliding(&simulation));
}

fn a_ball_that_slides_rolls_after_the_exact_time_at_the_exact_speed(session: &Session) {
    slide_to_roll::<2>(session, 1.0 / 3.0, 2.0 / 3.0);
    slide_to_roll::<3>(session, 2.0 / 7.0, 5.0 / 7.0);
}

/// A disk at rest on a belt of speed `U` is as fast as `U / 3` when it rolls, after `U / (3 mu g)`.
fn a_floor_that_moves_takes_a_disk_along_until_it_rolls(session: &Session) {
    let (mu, belt) = (0.25, 1.5);
    let mut domain = channel::<2>(50.0);
    domain.axes[1] = Axis::Walls { lower: [belt, 0.0].into(), upper: [0.0; 2].into() };
    let dt = belt / (3.0 * mu) / 20.5;
    let mut simulation = start(session, domain, &[ball([5.0, 1.0], [0.0; 2], down())], mu, dt);
    steps(&mut simulation, 10);
    assert!((simulation.whole_state().bodies[0].twist.velocity[0] - mu * 10.0 * dt).abs() < 1e-12);
    let mut work = 0.0;
    (0..20).for_each(|_| work += step(&mut simulation).work);
    let twist = simulation.whole_state().bodies[0].twist;
    assert!((twist.velocity[0] - belt / 3.0).abs() < 1e-12 && (components(&twist.spin)[0] - belt * 2.0 / 3.0).abs() < 1e-12);
    assert!(work > 0.0, "the belt works on the disk: {work}");
}

/// A disk that slides to a stop of its slip: what contacts do is the change of the kinetic energy in every step, though gravity presses; and nothing at rest.
fn the_work_of_contacts_is_what_bodies_gain_or_lose(session: &Session) {
    for velocity in [0.0, 1.0] {
        let bodies = [ball::<2>([5.0, 1.0], [velocity, 0.0], down())];
        let mut simulation = start(session, channel::<2>(20.0), &bodies, 0.3, 0.1);
        let (first, mut work) = (energy(&simulation, &bodies), 0.0);
        for number in 0..30 {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            work += simulation.step(&observation, &mut |_, _| {}).unwrap().kkt_report.unwrap().friction.unwrap().work;
            let gained = energy(&simulation, &bodies) - first;
            assert!((work - gained).abs() < 1e-9, "velocity {velocity}, step {number}: {work} for {gained}");
        }
        assert!(if velocity > 0.0 { work < -0.3 } else { work.abs() < 1e-12 }, "{work}");
    }
}

fn the_forces_of_a_tower_are_the_weights_above(session: &Session) {
    let bodies: Vec<_> = (0..10).map(|level| ball([10.0, 1.0 + 2.0 * f64::from(level)], [0.0; 2], down())).collect();
    let mut simulation = start(session, channel(30.0), &bodies, 0.5, 0.05);
    steps(&mut simulation, 20);
    assert!(fastest(&simulation) < 1e-10, "{:e}", fastest(&simulation));
    for contact in &simulation.whole_state().contact_history {
        let above = if let Partner::Body(_) = contact.partner { 9 - contact.body } else { 10 };
        assert!((contact.force / PI - above as f64).abs() < 1e-9, "{} {}", contact.force / PI, above);
    }
}

/// Both contacts slip from the couple `W a mu (1 + mu) / (1 + mu^2)` on; then the floor bears `W / (1 + mu^2)` and the wall `mu` of it.
fn a_couple_turns_a_disk_in_a_corner_just_above_the_limit(session: &Session) {
    let mu = 0.4;
    for part in [0.999, 1.001] {
        let couple = part * PI * mu * (1.0 + mu) / (1.0 + mu * mu);
        let disk = ball([1.0, 1.0], [0.0; 2], down());
        let turned = GranularBody { spin_up: skew(&[couple / disk.inertia]), ..disk };
        let mut simulation = start(session, closed([10.0, 10.0]), &[turned], mu, 0.05);
        steps(&mut simulation, 20);
        let state = simulation.whole_state();
        let spin = components(&state.bodies[0].twist.spin)[0];
        if part < 1.0 {
            assert!(spin.abs() < 1e-9, "{spin:e}");
            continue;
        }
        assert!(spin > 1e-4, "{spin:e}");
        for (axis, exact) in [(1, 1.0 / (1.0 + mu * mu)), (0, mu / (1.0 + mu * mu))] {
            let force = on_wall(&state, axis, PI)[0];
            assert!((force - exact).abs() < 1e-7, "{force} for {exact}");
        }
    }
}

/// What a pyramid does at a part of the limit of friction: its fastest ball and the forces on the floor, over a weight, after ten steps.
fn pyramid<const D: usize>(session: &Session, centers: &[[f64; D]], mu: f64) -> (f64, Vec<f64>) {
    let bodies: Vec<_> = centers.iter().map(|&center| ball(center, [0.0; D], down())).collect();
    let mut simulation = start(session, channel(20.0), &bodies, mu, 0.01);
    steps(&mut simulation, 10);
    (fastest(&simulation), on_wall(&simulation.whole_state(), D - 1, bodies[0].mass))
}

/// How far a pile has moved after some steps with a coefficient, and its forces.
type Standing<'a> = &'a dyn Fn(&Session, f64) -> (f64, Vec<f64>);

/// One disk on two whose centres are 2 and 2.4 apart, one sphere on three.
fn a_pyramid_stands_just_above_the_limit(session: &Session) {
    let flat = |half: f64| {
        let angle = (half / 2.0).asin();
        let centers = [[10.0 - half, 1.0], [10.0 + half, 1.0], [10.0, 1.0 + 2.0 * angle.cos()]];
        ((angle / 2.0).tan(), move |session: &Session, mu: f64| pyramid(session, &centers, mu), vec![1.5, 1.5])
    };
    let check = |limit: f64, found: Standing, forces: &[f64]| {
        let (fastest, _) = found(session, 0.99 * limit);
        assert!(fastest > 1e-5, "moves below the limit {limit}: {fastest:e}");
        let (fastest, floor) = found(session, 1.01 * limit);
        assert!(fastest < 1e-9, "rests above the limit {limit}: {fastest:e}");
        assert!(floor.len() == forces.len() && floor.iter().zip(forces).all(|(found, exact)| (found - exact).abs() < 1e-6), "{floor:?}");
    };
    for half in [1.0, 1.2] {
        let (limit, found, forces) = flat(half);
        check(limit, &found, &forces);
    }
    let (ring, angle) = (2.0 / 3f64.sqrt(), (1.0 / 3f64.sqrt()).asin());
    let around = |place: f64| [10.0 + ring * (2.0 * PI / 3.0 * place).cos(), 10.0 + ring * (2.0 * PI / 3.0 * place).sin(), 1.0];
    let centers = [around(0.0), around(1.0), around(2.0), [10.0, 10.0, 1.0 + 2.0 * angle.cos()]];
    check((angle / 2.0).tan(), &|session, mu| pyramid(session, &centers, mu), &[4.0 / 3.0; 3]);
}

/// Normals at `alpha` from the horizontal: the force of each is at least `W / (2 (sin + mu cos))`, and at most `W / (2 (sin - mu cos))` where that is positive.
fn a_wedge_holds_a_disk_by_forces_between_the_bounds(session: &Session) {
    let alpha = 0.3_f64;
    for part in [0.98, 1.02] {
        let mu = part * alpha.tan();
        let place = |side: f64| [10.0 + side * 4.0 * alpha.cos(), 10.0 - 4.0 * alpha.sin()];
        let bodies = [fixed(3.0, place(-1.0)), fixed(3.0, place(1.0)), ball([10.0, 10.0], [0.0; 2], down())];
        let mut simulation = start(session, channel(20.0), &bodies, mu, 0.01);
        steps(&mut simulation, 10);
        assert!(fastest(&simulation) < 1e-9, "{:e}", fastest(&simulation));
        let least = 1.0 / (2.0 * (alpha.sin() + mu * alpha.cos()));
        let most = 1.0 / (2.0 * (alpha.sin() - mu * alpha.cos())).max(0.0);
        for contact in &simulation.whole_state().contact_history {
            let force = contact.force / PI;
            assert!(force > least - 1e-7 && force < most + 1e-7, "{force} between {least} and {most}");
        }
    }
}

/// Numbers between -1 and 1 that look random.
pub fn noise(seed: usize) -> f64 {
    let number = (seed as f64 * 12.9898).sin() * 43758.5453;
    2.0 * (number - number.floor()) - 1.0
}

/// 36 disks without gravity, 500 steps.
fn disks_that_tumble_never_gain_energy_and_never_overlap(session: &Session) {
    let tumbling = |number: usize| {
        let place = [2.3 * (number % 6) as f64 + 1.2, 2.3 * (number / 6) as f64 + 1.2];
        let disk = ball(place, [noise(2 * number), noise(2 * number + 1)], Vector2::zeros());
        GranularBody { twist: Twist { spin: skew(&[noise(1000 + number)]), ..disk.twist }, ..disk }
    };
    let bodies: Vec<_> = (0..36).map(tumbling).collect();
    let mut simulation = start(session, closed([13.9, 13.9]), &bodies, 0.5, 0.01);
    let first = energy(&simulation, &bodies);
    let (mut last, mut gap) = (first, 0.0f64);
    for number in 0..500 {
        let report = step(&mut simulation);
        assert!(report.residual < FrictionReport::TOLERANCE, "step {number}: {report:?}");
        let now = energy(&simulation, &bodies);
        assert!(now - last < 1e-12 * first, "step {number} gains {:e}", (now - last) / first);
        assert!((now - last - report.work).abs() < 1e-10 * first, "step {number}: {:e} {:e}", now - last, report.work);
        (last, gap) = (now, gap.min(smallest_gap(&simulation)));
    }
    assert!(gap > -1e-7 && last < 0.9 * first, "{gap:e}, {} of the energy", last / first);
}

/// Disks of several sizes above a floor between walls.
pub fn heap(count: usize) -> Vec<GranularBody<2>> {
    let disk = |number: usize| {
        let (column, row) = (number % 10, number / 10);
        let place = [2.1 * column as f64 + 1.2 + 0.4 * (row % 2) as f64, 2.05 * row as f64 + 1.05];
        sized(0.9 + 0.1 * noise(number), place, [0.2 * noise(500 + number), 0.0], down())
    };
    (0..count).map(disk).collect()
}

fn falling(session: &Session, count: usize) -> Simulation<2> {
    start(session, closed([22.0, 60.0]), &heap(count), 0.5, 0.05)
}

/// By how much tangential forces exceed the largest that normal ones allow, over the largest of all; they do not, however well friction was solved.
fn outside_cone<const D: usize>(state: &State<D>, friction: f64) -> f64 {
    let largest = state.contact_history.iter().map(|contact| contact.force).fold(0.0, f64::max);
    let excess = state.contact_history.iter().map(|contact| contact.tangential.norm() - friction * contact.force);
    excess.fold(0.0, f64::max) / largest.max(f64::MIN_POSITIVE)
}

/// The energy of disks that fall for so many steps, at the start and at the end, and the number of steps whose friction was not solved to the tolerance. No step
/// gains energy, and nothing overlaps; besides what is seen of each step.
pub fn settle(
    simulation: &mut Simulation<2>,
    bodies: &[GranularBody<2>],
    steps: usize,
    mut see: impl FnMut(usize, &Simulation<2>),
) -> ([f64; 2], usize) {
    let first = energy(simulation, bodies);
    let (mut last, mut missed) = (first, 0);
    for number in 0..steps {
        let report = step(simulation);
        missed += usize::from(report.residual > FrictionReport::TOLERANCE);
        assert!(report.residual < 1e-3, "step {number}: {report:?}");
        let now = energy(simulation, bodies);
        assert!(now - last < 1e-9 * last.abs(), "step {number} gains {:e}", (now - last) / last);
        assert!(smallest_gap(simulation) > -1e-7, "step {number}: {:e}", smallest_gap(simulation));
        see(number, simulation);
        last = now;
    }
    ([first, last], missed)
}

fn disks_fall_to_rest_on_any_number_of_ranks(session: &Session) {
    let bodies = heap(100);
    let mut simulation = falling(session, 100);
    let ([first, last], missed) = settle(&mut simulation, &bodies, 160, |number, simulation| {
        let outside = outside_cone(&simulation.whole_state(), 0.5);
        assert!(outside < 1e-12, "step {number}: {outside:e}");
    });
    let height = simulation.whole_state().bodies.iter().map(|body| body.center[1]).sum::<f64>() / 100.0;
    // on any number of ranks
    assert!((height - 7.540_086).abs() < 1e-5 && missed <= 2, "{height}, {missed} steps missed");
    let state = simulation.whole_state();
    let of_motion = |(body, moving): (&GranularBody<2>, &Moving<2>)| {
        0.5 * (body.mass * moving.twist.velocity.norm_squared() + body.inertia * moving.twist.spin[(1, 0)].powi(2))
    };
    let mut kinetic: Vec<f64> = bodies.iter().zip(&state.bodies).map(of_motion).collect();
    kinetic.sort_by(f64::total_cmp);
    // one disk may still roll
    let (rolls, rest) = (kinetic[99], kinetic[..99].iter().sum::<f64>());
    assert!(rest < 1e-3 * (first - last) && rolls < 2e-3 * (first - last), "of {} that was lost {rest} and {rolls} are left", first - last);
}

fn a_restart_repeats_a_run(session: &Session) {
    let mut whole = falling(session, 40);
    steps(&mut whole, 60);
    let mut first = falling(session, 40);
    steps(&mut first, 35);
    let state = first.whole_state().into_owned();
    let mut second = falling(session, 40);
    second.restore(state, turbid::mechanics::History::default()).unwrap();
    steps(&mut second, 25);
    let (one, two) = (whole.whole_state(), second.whole_state());
    assert!(
        !one.contact_history.iter().all(|contact| contact.tangential == SVector::<f64, 2>::zeros()) && *one == *two,
        "a run that was interrupted is another one"
    );
}

/// Places and spins of disks that fall for 30 steps.
fn fall(session: &Session, domain: Domain<2>, bodies: &[GranularBody<2>], step: f64) -> Vec<(Vector2<f64>, f64)> {
    let mut simulation = start(session, domain, bodies, 0.4, step);
    steps(&mut simulation, 30);
    simulation.whole_state().bodies.iter().map(|body| (body.center, components(&body.twist.spin)[0])).collect()
}

fn units_places_mirrors_and_the_order_of_bodies_do_not_matter(session: &Session) {
    let bodies = heap(30);
    let (width, height, dt) = (22.0, 30.0, 0.05);
    let open = |size: [f64; 2]| Domain { axes: [Axis::Periodic, closed(size).axes[1]], ..closed(size) };
    let plain = fall(session, open([width, height]), &bodies, dt);
    let close = |what: &str, changed: &dyn Fn(usize) -> (Vector2<f64>, f64)| {
        for (number, (center, spin)) in plain.iter().enumerate() {
            let (there, turned) = changed(number);
            assert!(
                (center - there).norm() < 1e-6 && (spin - turned).abs() < 1e-5,
                "{what}: {number} at {there}, not {center}; {turned} {spin}"
            );
        }
    };
    let (length, time, mass) = (2.0, 3.0, 5.0);
    let in_units = |body: &GranularBody<2>| GranularBody {
        radius: body.radius * length,
        center: body.center * length,
        twist: Twist { velocity: body.twist.velocity * (length / time), spin: body.twist.spin / time },
        mass: body.mass * mass,
        inertia: body.inertia * (mass * length * length),
        acceleration: body.acceleration * (length / (time * time)),
        spin_up: body.spin_up,
    };
    let found = fall(session, open([width * length, height * length]), &bodies.iter().map(in_units).collect::<Vec<_>>(), dt * time);
    close("units", &|number| (found[number].0 / length, found[number].1 * time));
    let moved = |body: &GranularBody<2>| GranularBody { center: body.center + Vector2::new(3.0, 0.0), ..*body };
    let found = fall(session, open([width, height]), &bodies.iter().map(moved).collect::<Vec<_>>(), dt);
    close("place", &|number| (found[number].0 - Vector2::new(3.0, 0.0), found[number].1));
    let flip = |vector: Vector2<f64>| Vector2::new(-vector[0], vector[1]);
    let mirrored = |body: &GranularBody<2>| {
        let twist = Twist { velocity: flip(body.twist.velocity), spin: -body.twist.spin };
        GranularBody { center: flip(body.center) + Vector2::new(width, 0.0), twist, ..*body }
    };
    let found = fall(session, open([width, height]), &bodies.iter().map(mirrored).collect::<Vec<_>>(), dt);
    close("mirror", &|number| (flip(found[number].0 - Vector2::new(width, 0.0)), -found[number].1));
    let backwards: Vec<_> = bodies.iter().rev().copied().collect();
    let found = fall(session, open([width, height]), &backwards, dt);
    close("order", &|number| found[bodies.len() - 1 - number]);
}
