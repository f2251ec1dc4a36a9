//! Dry friction against rolling and twisting, and friction above a critical load: cases with exact answers. Radius, density and gravity are 1 but where it is said.

use std::f64::consts::PI;

use nalgebra::{SMatrix, SVector, Vector2};
use turbid::{
    body::{Twist, components, skew},
    contact::FrictionReport,
    friction::{FrictionLaw, SurfaceFriction},
    geometry::Domain,
    interaction::{Friction, Inelastic, Interactions, UnequalFriction},
    motion::{GranularBody, Simulation},
    petsc::Session,
};

use crate::{
    Test,
    dry::smallest_gap,
    friction::{ball, channel, closed, down, energy, fastest, fixed, heap, noise, settle, sized, start_with, step, steps},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_ball_on_an_incline_rests_rolls_or_slides),
        Test::of(a_hoop_on_an_incline_rests_rolls_or_slides),
        Test::of(a_ball_on_another_rests_up_to_the_limit),
        Test::of(a_spin_about_the_normal_is_stopped_after_the_exact_time),
        Test::of(a_ball_rubs_above_the_critical_load),
        Test::of(of_two_balls_the_heavier_one_rubs),
        Test::of(disks_that_tumble_never_gain_energy),
        Test::of(disks_with_rolling_friction_settle_on_any_number_of_ranks),
        Test::of(a_restart_repeats_a_run),
    ]
}

/// Bodies of which all surfaces rub by a law.
fn start<const D: usize>(session: &Session, domain: Domain<D>, bodies: &[GranularBody<D>], law: FrictionLaw, step: f64) -> Simulation<D> {
    start_between(session, domain, bodies, (vec![law; bodies.len()], law), step)
}

fn start_between<const D: usize>(
    session: &Session,
    domain: Domain<D>,
    bodies: &[GranularBody<D>],
    (of_bodies, of_walls): (Vec<FrictionLaw>, FrictionLaw),
    step: f64,
) -> Simulation<D> {
    let surfaces = SurfaceFriction::new(of_bodies, of_walls);
    let friction = Friction::new(surfaces.largest().coefficient, 0.0);
    start_with(session, (domain, Interactions::default().with(Inelastic).with(UnequalFriction { friction, surfaces })), bodies, step)
}

/// Gravity on a slope of this tangent, which falls along the axes across the last one as a vector says.
fn slope<const D: usize>(tangent: f64, along: [f64; D]) -> SVector<f64, D> {
    let angle = tangent.atan();
    down::<D>() * angle.cos() + SVector::from(along) * angle.sin()
}

fn above_floor<const D: usize>(radius: f64) -> [f64; D] {
    std::array::from_fn(|axis| if axis + 1 == D { radius } else { 5.0 })
}

/// A body whose moment of inertia is `part` of `m a^2` rests up to `tan = k`, then rolls with `g (sin - k cos) / (1 + part)` up to
/// `tan = mu + (mu - k) / part`, and then slides with `g (sin - mu cos)`.
fn incline<const D: usize>(session: &Session, part: f64, law: FrictionLaw, along: [f64; D]) {
    let FrictionLaw { coefficient: mu, rolling, .. } = law;
    let limits = [rolling, mu + (mu - rolling) / part];
    for (tangent, regime) in [(0.99 * limits[0], 0), (1.01 * limits[0], 1), (0.99 * limits[1], 1), (1.01 * limits[1], 2)] {
        let gravity = slope(tangent, along);
        let plain = ball(above_floor(1.0), [0.0; D], gravity);
        let body = GranularBody { inertia: part * plain.mass, ..plain };
        let mut simulation = start(session, channel(10.0), &[body], law, 0.02);
        let residual = steps(&mut simulation, 50);
        let (sine, cosine) = (tangent.atan().sin(), tangent.atan().cos());
        let exact = [0.0, (sine - rolling * cosine) / (1.0 + part), sine - mu * cosine][regime];
        let found = simulation.whole_state().bodies[0].twist.velocity;
        let away = (found - SVector::from(along) * exact).norm();
        assert!(away < 1e-9 && residual < 1e-9, "{D}D, tangent {tangent}: {found} for {exact}, residual {residual:e}");
    }
}

fn a_ball_on_an_incline_rests_rolls_or_slides(session: &Session) {
    let law = FrictionLaw { rolling: 0.1, twisting: 0.05, ..FrictionLaw::plain(0.5) };
    incline::<2>(session, 0.5, FrictionLaw { twisting: 0.0, ..law }, [1.0, 0.0]);
    incline::<3>(session, 0.4, law, [1.0, 0.0, 0.0]);
    incline::<3>(session, 0.4, law, [0.6, -0.8, 0.0]);
}

fn a_hoop_on_an_incline_rests_rolls_or_slides(session: &Session) {
    incline::<2>(session, 1.0, FrictionLaw { rolling: 0.15, ..FrictionLaw::plain(0.4) }, [1.0, 0.0]);
    incline::<3>(session, 2.0 / 3.0, FrictionLaw { rolling: 0.05, twisting: 0.3, ..FrictionLaw::plain(0.3) }, [-0.28, 0.96, 0.0]);
}

/// A ball of radius 1 rests on one of radius `R` that is fixed, at an angle from its top, up to `tan = k R / (1 + R)`: the couple is `k` times the reduced
/// radius and the normal force.
fn on_another<const D: usize>(session: &Session, large: f64) {
    let law = FrictionLaw { rolling: 0.2, ..FrictionLaw::plain(0.8) };
    let limit = law.rolling * large / (1.0 + large);
    for part in [0.99, 1.01] {
        let angle = (part * limit).atan();
        let mut center = [10.0; D];
        center[0] += (1.0 + large) * angle.sin();
        center[D - 1] += (1.0 + large) * angle.cos();
        let bodies = [fixed(large, [10.0; D]), ball(center, [0.0; D], down())];
        let mut simulation = start(session, channel(30.0), &bodies, law, 0.01);
        let residual = steps(&mut simulation, 20);
        assert!(residual < 1e-9 && (fastest(&simulation) < 1e-9) == (part < 1.0), "{D}D, {part}: {:e}", fastest(&simulation));
    }
}

fn a_ball_on_another_rests_up_to_the_limit(session: &Session) {
    on_another::<2>(session, 3.0);
    on_another::<2>(session, 0.5);
    on_another::<3>(session, 3.0);
}

/// The spin `w` about the normal falls as `w - 5/2 k g t / a`, and stops.
fn a_spin_about_the_normal_is_stopped_after_the_exact_time(session: &Session) {
    let law = FrictionLaw { twisting: 0.05, rolling: 0.1, ..FrictionLaw::plain(0.5) };
    for radius in [1.0, 0.4] {
        let still = sized(radius, above_floor(radius), [0.0; 3], down());
        let spinning = GranularBody { twist: Twist { spin: skew(&[0.0, 0.0, 1.0]), ..still.twist }, ..still };
        let rate = 2.5 * law.twisting / radius;
        let mut simulation = start(session, channel(10.0), &[spinning], law, 0.1 / (2.5 * law.twisting) / 4.05);
        let dt = 0.1 / (2.5 * law.twisting) / 4.05;
        steps(&mut simulation, 10);
        let spin = components(&simulation.whole_state().bodies[0].twist.spin)[2];
        assert!((spin - (1.0 - rate * 10.0 * dt).max(0.0)).abs() < 1e-10, "radius {radius}: {spin}");
        steps(&mut simulation, (1.0 / (rate * dt)) as usize - 10);
        assert!(components(&simulation.whole_state().bodies[0].twist.spin)[2] > 1e-3);
        steps(&mut simulation, 1);
        assert!(simulation.whole_state().bodies[0].twist.spin.norm() < 1e-10);
    }
}

/// On a slope with a normal force `W cos` a ball slides with `g (sin - mu (cos - c / W))` where the critical load is below, and freely where it is above; it
/// rolls where friction is enough for that.
fn above_load<const D: usize>(session: &Session, roll: f64) {
    let (mu, tangent) = (0.5, 0.8_f64);
    let weight = if D == 2 { PI } else { 4.0 / 3.0 * PI };
    let (sine, cosine) = (tangent.atan().sin(), tangent.atan().cos());
    let bound = |part: f64| mu * cosine * (1.0 - part).max(0.0);
    for part in [0.1, 0.9, 0.999, 1.001, 2.0] {
        let law = FrictionLaw { critical_load: part * weight * cosine, ..FrictionLaw::plain(mu) };
        let mut along = [0.0; D];
        along[0] = 1.0;
        let body = ball(above_floor(1.0), [0.0; D], slope(tangent, along));
        let mut simulation = start(session, channel(10.0), &[body], law, 0.02);
        let residual = steps(&mut simulation, 50);
        let twist = simulation.whole_state().bodies[0].twist;
        let exact = if bound(part) >= (1.0 - roll) * sine { roll * sine } else { sine - bound(part) };
        let away = (twist.velocity[0] - exact).abs();
        assert!(away < 1e-9 && residual < 1e-9, "{D}D, {part}: {} for {exact}, residual {residual:e}", twist.velocity[0]);
        assert!(part < 1.0 || twist.spin.norm() < 1e-9, "{}", twist.spin);
    }
}

fn a_ball_rubs_above_the_critical_load(session: &Session) {
    above_load::<2>(session, 2.0 / 3.0);
    above_load::<3>(session, 5.0 / 7.0);
}

/// The smaller one of two critical loads counts, which the weight of one of two disks exceeds.
fn of_two_balls_the_heavier_one_rubs(session: &Session) {
    let (mu, tangent) = (0.2, 2.0);
    let gravity = slope(tangent, [1.0, 0.0]);
    let bodies = [sized(1.0, [5.0, 1.0], [0.0; 2], gravity), sized(0.5, [12.0, 0.5], [0.0; 2], gravity)];
    let load = 0.5 * PI * tangent.atan().cos();
    let law = |critical_load: f64| FrictionLaw { critical_load, ..FrictionLaw::plain(mu) };
    for (of_balls, of_wall) in [(load, 3.0 * load), (3.0 * load, load)] {
        let mut simulation = start_between(session, channel(40.0), &bodies, (vec![law(of_balls); 2], law(of_wall)), 0.02);
        steps(&mut simulation, 50);
        let state = simulation.whole_state();
        let (sine, cosine) = (tangent.atan().sin(), tangent.atan().cos());
        let exact = [sine - mu * 0.5 * cosine, sine];
        for (body, exact) in state.bodies.iter().zip(exact) {
            assert!((body.twist.velocity[0] - exact).abs() < 1e-9, "{} for {exact}", body.twist.velocity[0]);
        }
        assert!(state.bodies[0].twist.spin.norm() > 0.1 && state.bodies[1].twist.spin.norm() < 1e-9);
    }
}

/// 36 disks without gravity, with all that resists.
fn disks_that_tumble_never_gain_energy(session: &Session) {
    let tumbling = |number: usize| {
        let place = [2.3 * (number % 6) as f64 + 1.2, 2.3 * (number / 6) as f64 + 1.2];
        let disk = ball(place, [noise(2 * number), noise(2 * number + 1)], Vector2::zeros());
        GranularBody { twist: Twist { spin: skew(&[noise(1000 + number)]), ..disk.twist }, ..disk }
    };
    let bodies: Vec<_> = (0..36).map(tumbling).collect();
    let law = FrictionLaw { rolling: 0.2, critical_load: 10.0, ..FrictionLaw::plain(0.5) };
    let mut simulation = start(session, closed([13.9, 13.9]), &bodies, law, 0.01);
    let first = energy(&simulation, &bodies);
    let (mut last, mut gap) = (first, 0.0f64);
    for number in 0..200 {
        let report = step(&mut simulation);
        assert!(report.residual < FrictionReport::TOLERANCE, "step {number}: {report:?}");
        let now = energy(&simulation, &bodies);
        assert!(now - last < 1e-12 * first, "step {number} gains {:e}", (now - last) / first);
        assert!((now - last - report.work).abs() < 1e-10 * first, "step {number}: {:e} {:e}", now - last, report.work);
        (last, gap) = (now, gap.min(smallest_gap(&simulation)));
    }
    assert!(gap > -1e-7 && last < 0.9 * first, "{gap:e}, {} of the energy", last / first);
}

fn falling(session: &Session, count: usize) -> Simulation<2> {
    start(session, closed([22.0, 60.0]), &heap(count), FrictionLaw { rolling: 0.1, ..FrictionLaw::plain(0.5) }, 0.05)
}

fn disks_with_rolling_friction_settle_on_any_number_of_ranks(session: &Session) {
    let bodies = heap(40);
    let mut simulation = falling(session, 40);
    let ([first, last], missed) = settle(&mut simulation, &bodies, 240, |_, _| {});
    let state = simulation.whole_state();
    let kinetic: f64 = state.bodies.iter().zip(&bodies).map(|(moving, body)| body.mass * moving.twist.velocity.norm_squared()).sum();
    let height = state.bodies.iter().map(|body| body.center[1]).sum::<f64>() / 40.0;
    assert!(kinetic < 1e-3 * (first - last) && missed == 0, "{kinetic:e} of {:e}, {missed} missed", first - last);
    // on any number of ranks
    assert!((height - 3.139_424_94).abs() < 1e-5, "{height}");
}

fn a_restart_repeats_a_run(session: &Session) {
    let mut whole = falling(session, 30);
    steps(&mut whole, 60);
    let mut first = falling(session, 30);
    steps(&mut first, 35);
    let state = first.whole_state().into_owned();
    let mut second = falling(session, 30);
    second.restore(state, turbid::mechanics::History::default()).unwrap();
    steps(&mut second, 25);
    let (one, two) = (whole.whole_state(), second.whole_state());
    assert!(
        one.bodies.iter().any(|body| body.twist.spin != SMatrix::<f64, 2, 2>::zeros()) && *one == *two,
        "a run that was interrupted is another one"
    );
}
