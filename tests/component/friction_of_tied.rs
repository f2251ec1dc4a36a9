//! Dry friction of rigid clusters, chains and cells: cases with exact answers, energy, ranks, restarts. Radius, density and gravity are 1 but where it is said.

use std::path::Path;

use nalgebra::{Matrix2, Vector2};
use turbid::{body::components, contact::FrictionReport, mechanics::History, motion::Simulation, petsc::Session, scene::Scene};

use crate::{
    Test,
    dry::smallest_gap,
    friction::{fastest, step, steps},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_rod_that_lies_on_an_incline_rests_or_slides),
        Test::of(a_rod_on_one_end_starts_to_roll_over_as_a_rigid_body_does),
        Test::of(a_rod_on_one_contact_obeys_the_law_below_and_above_the_limit_of_painleve),
        Test::of(clusters_and_chains_settle_and_never_gain_energy),
        Test::of(clusters_in_space_obey_the_law),
        Test::of(cells_obey_the_law),
        Test::of(a_restart_repeats_a_run),
    ]
}

fn scene<const D: usize>(session: &Session, text: &str) -> Simulation<D> {
    Simulation::new(session, &Scene::parse("tied", Path::new("."), text, &[]).unwrap()).unwrap()
}

/// A rod of two balls whose centres are 4 apart, at an angle from the floor, which moves.
fn rod(session: &Session, [center, height, angle]: [f64; 3], belt: f64, (gravity, friction): ([f64; 2], f64), step: f64) -> Simulation<2> {
    let text = format!(
        "gravity = [{}, {}]\ndomain = {{ size = [60.0, 12.0], y = {{ lower = [{belt}, 0.0], upper = [0.0, 0.0] }} }}\nflow = {{ model = \"none\" }}\n\
         clusters = [{{ shape = \"rod\", beads = 2, spacing = 2.0, radius = 1.0, density = 1.0, centers = [[{center}, {height}]], rotation = {angle} }}]\n\
         contact = {{ model = \"inelastic\", friction = {friction} }}\ntime = {{ end = 100.0, step = {step}, scheme = \"euler\" }}\n",
        gravity[0], gravity[1]
    );
    scene(session, &text)
}

/// It does not roll: it slides where the slope is steeper than friction.
fn a_rod_that_lies_on_an_incline_rests_or_slides(session: &Session) {
    let angle = 0.5_f64.atan();
    let (sine, cosine) = angle.sin_cos();
    for friction in [0.2, 0.495, 0.505] {
        let mut simulation = rod(session, [10.0, 1.0, 0.0], 0.0, ([sine, -cosine], friction), 0.02);
        let residual = steps(&mut simulation, 50);
        let exact = (sine - friction * cosine).max(0.0);
        for body in &simulation.whole_state().bodies {
            let (found, spin) = (body.twist.velocity[0], components(&body.twist.spin)[0]);
            assert!((found - exact).abs() < 1e-9 && spin.abs() < 1e-9 && residual < 1e-8, "{found} for {exact}, {spin}, {residual:e}");
        }
    }
}

/// Moment of inertia over mass of the rod, and the arm from its middle to its contact with the floor.
fn of_rod(angle: f64) -> (f64, Vector2<f64>) {
    (0.5 + 4.0, Vector2::new(-2.0 * angle.cos(), -2.0 * angle.sin() - 1.0))
}

/// How a unit impulse along the normal and along the floor moves the contact, over the mass.
fn mobility(angle: f64) -> Matrix2<f64> {
    let (inertia, arm) = of_rod(angle);
    let (normal, tangent) = (arm[0], -arm[1]);
    Matrix2::new(1.0 + normal * normal / inertia, normal * tangent / inertia, normal * tangent / inertia, 1.0 + tangent * tangent / inertia)
}

/// Without slip, from rest, in a step so short that it does not turn.
fn a_rod_on_one_end_starts_to_roll_over_as_a_rigid_body_does(session: &Session) {
    for angle in [0.7, 1.2] {
        let dt = 1e-4;
        let mut simulation = rod(session, [10.0, 1.0 + 2.0 * f64::sin(angle), angle], 0.0, ([0.0, -1.0], 3.0), dt);
        steps(&mut simulation, 1);
        let (inertia, arm) = of_rod(angle);
        let impulse = mobility(angle).lu().solve(&Vector2::new(dt, 0.0)).unwrap();
        let spin = (arm[0] * impulse[0] - arm[1] * impulse[1]) / inertia;
        let middle = Vector2::new(impulse[1], impulse[0] - dt);
        let bodies = &simulation.whole_state().bodies;
        let found = (bodies[0].twist.velocity + bodies[1].twist.velocity) * 0.5;
        let turned = components(&bodies[0].twist.spin)[0];
        assert!((found - middle).norm() < 1e-6 * dt && (turned - spin).abs() < 1e-6 * dt, "{found} {middle} {turned:e} {spin:e}");
    }
}

/// The contact slides on a belt. From `mu = W_NN / |W_NT|` on a force that holds it may not exist, or not be the only one; the impulse of a step does.
fn a_rod_on_one_contact_obeys_the_law_below_and_above_the_limit_of_painleve(session: &Session) {
    for angle in [0.6, 1.1] {
        let mobility = mobility(angle);
        let limit = mobility[(0, 0)] / mobility[(0, 1)].abs();
        for (part, belt) in [0.9, 1.1, 2.0].into_iter().flat_map(|part| [(part, 1.0), (part, -1.0)]) {
            let (dt, mu) = (1e-3, part * limit);
            let mut simulation = rod(session, [10.0, 1.0 + 2.0 * f64::sin(angle), angle], belt, ([0.0, -1.0], mu), dt);
            let report = step(&mut simulation);
            assert!(report.residual < 1e-7 && smallest_gap(&simulation) > -1e-9, "{angle}, {part}, {belt}: {report:?}");
            assert_eq!(report.sticking + report.slipping, 1, "{angle}, {part}, {belt}: {report:?}");
            // the belt slides from under the rod along its own way: that much along the normal closes the contact, or opens it
            let along = mobility[(0, 0)] + belt * mu * mobility[(0, 1)];
            if part < 1.0 && report.slipping == 1 {
                let contact = simulation.whole_state().contact_history[0];
                let exact = 2.0 * std::f64::consts::PI / along;
                assert!((contact.force / exact - 1.0).abs() < 1e-2, "{} for {exact}", contact.force);
            }
        }
    }
}

/// A box in which what falls comes to rest.
pub const HEAP: &str = "seed = 1\ngravity = [0.0, -1.0]\ndomain = { size = [14.0, 12.0], x = \"walls\", y = \"walls\" }\nflow = { model = \"none\" }\n\
                    contact = { model = \"inelastic\", friction = 0.5 }\ntime = { end = 100.0, step = 0.05, scheme = \"euler\" }\n";
/// Rigid clusters.
pub const RODS: &str = "clusters = [{ count = 6, shape = \"rod\", beads = 3, spacing = 1.1, radius = 0.5, density = 1.0 }]\n";
/// Chains of rigid length.
pub const CHAINS: &str = "chains = [{ count = 5, beads = 4, stretch = \"rigid\", radius = 0.5, density = 1.0 }]\n";

/// Kinetic energy and that of place of balls of radius 1/2 and density 1.
pub fn energy(simulation: &Simulation<2>) -> f64 {
    let mass = 0.25 * std::f64::consts::PI;
    let of_ball = |body: &turbid::setup::Moving<2>| {
        let spin = components(&body.twist.spin)[0];
        mass * (0.5 * body.twist.velocity.norm_squared() + 0.0625 * spin * spin + body.center[1])
    };
    simulation.whole_state().bodies.iter().map(of_ball).sum()
}

/// Rigid clusters turn in a step, contacts act as if they did so slowly: that may gain what is of second order in the step.
fn clusters_and_chains_settle_and_never_gain_energy(session: &Session) {
    // heights on any number of ranks
    for (groups, gain, height) in [(RODS, 1e-6, 20.371_8), (CHAINS, 1e-9, 16.059_5)] {
        let mut simulation = scene::<2>(session, &format!("{HEAP}{groups}"));
        let (first, mut last, mut rubbed) = (energy(&simulation), energy(&simulation), 0);
        for number in 0..160 {
            let report = step(&mut simulation);
            assert!(report.residual < 1e-3, "step {number}: {report:?}");
            assert!(smallest_gap(&simulation) > -1e-7, "step {number}: {:e}", smallest_gap(&simulation));
            let now = energy(&simulation);
            assert!(now - last < gain * first, "step {number} gains {:e}", (now - last) / first);
            (last, rubbed) = (now, rubbed + report.sticking + report.slipping);
        }
        let found = simulation.whole_state().bodies.iter().map(|body| body.center[1]).sum::<f64>();
        assert!(rubbed > 1000 && last < 0.3 * first && fastest(&simulation) < 0.4, "{rubbed} contacts, {last} of {first}");
        assert!((found - height).abs() < 1e-3, "{groups}: {found}");
    }
}

fn clusters_in_space_obey_the_law(session: &Session) {
    let text = "seed = 1\ngravity = [0.0, 0.0, -1.0]\ndomain = { size = [5.0, 5.0, 7.0], z = \"walls\" }\nflow = { model = \"none\" }\n\
                clusters = [{ count = 4, shape = \"tetrahedron\", spacing = 1.1, radius = 0.5, density = 1.0 }]\n\
                contact = { model = \"inelastic\", friction = { coefficient = 0.5, rolling = 0.1, twisting = 0.1 } }\n\
                time = { end = 100.0, step = 0.05, scheme = \"euler\" }\n";
    let mut simulation = scene::<3>(session, text);
    let mut rubbed = 0;
    for number in 0..80 {
        let report = step(&mut simulation);
        assert!(report.residual < 1e-6 && report.work < 1e-9, "step {number}: {report:?}");
        rubbed += report.sticking + report.slipping;
    }
    assert!(rubbed > 50 && smallest_gap(&simulation) > -1e-7, "{rubbed}");
}

fn cells_obey_the_law(session: &Session) {
    let text = "seed = 1\ngravity = [0.0, -1.0]\ndomain = { size = [12.0, 8.0], y = \"walls\" }\nflow = { model = \"none\" }\n\
                cells = [{ count = 1, beads = 24, radius = 0.3, stretch = 2000.0, bend = 5.0, density = 1.0 }]\n\
                contact = { model = \"inelastic\", friction = 0.5 }\ntime = { end = 100.0, step = 0.02, scheme = \"euler\" }\n";
    let mut simulation = scene::<2>(session, text);
    let mut rubbed = 0;
    for number in 0..150 {
        let report = step(&mut simulation);
        assert!(report.residual < 1e-5, "step {number}: {report:?}");
        rubbed += report.sticking + report.slipping;
    }
    assert!(rubbed > 10, "{rubbed}");
}

fn a_restart_repeats_a_run(session: &Session) {
    let text = format!("{HEAP}{CHAINS}");
    let start = || scene::<2>(session, &text);
    let mut whole = start();
    steps(&mut whole, 70);
    let mut first = start();
    steps(&mut first, 50);
    let state = first.whole_state().into_owned();
    let mut second = start();
    second.restore(state, History::default()).unwrap();
    let residual = steps(&mut second, 20);
    assert!(residual < FrictionReport::TOLERANCE_IN_FLOW);
    let (one, two) = (whole.whole_state(), second.whole_state());
    assert!(!one.contact_history.is_empty() && *one == *two, "a run that was interrupted is another one");
}
