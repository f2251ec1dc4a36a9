//! Shears whose rate changes with time: start-up, reversal, rest and oscillation, of sheared boxes and between walls.

use std::{f64::consts::TAU, path::Path};

use nalgebra::{Complex, SVector};
use turbid::{
    mechanics::FlowSolver,
    motion::{Observation, Simulation},
    observe::{self, Viscosity, statistics::harmonics},
    petsc::Session,
    plan::flow_solver,
    scene::Scene,
    setup::Setup,
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::only_on(1, bodies_that_do_not_touch_go_back_as_they_came),
        Test::of(just_after_a_reversal_contacts_bear_nothing),
        Test::of(a_tiny_oscillation_measures_the_viscosity_of_an_instant),
        Test::of(a_stress_decides_the_rate),
        Test::of(a_stress_that_jumps_decides_the_rate_from_there_on),
        Test::only_on(1, the_structure_knows_the_strain_not_the_time),
        Test::only_on(1, an_oscillating_box_comes_back),
        Test::only_on(1, a_layer_of_fluid_is_carried_along_by_oscillating_walls),
        Test::only_on(1, walls_driven_at_one_rate_are_walls_of_two_velocities),
    ]
}

fn parsed(text: &str) -> Scene {
    Scene::parse("protocol", Path::new("."), text, &[]).unwrap()
}

fn simulation<const D: usize>(session: &Session, text: &str) -> Simulation<D> {
    Simulation::new(session, &parsed(text)).unwrap()
}

fn viscosity<const D: usize>(flow: &dyn FlowSolver<D>, observation: &Observation<D>) -> Viscosity {
    observe::viscosity(flow.setup(), flow.grid(), observation.solution.as_ref().unwrap(), &observation.contacts).unwrap().unwrap()
}

/// What is seen at each instant of a run, and where bodies are at its end.
fn run<const D: usize>(session: &Session, text: &str, mut see: impl FnMut(&Simulation<D>, &Observation<D>)) -> Vec<SVector<f64, D>> {
    let mut simulation = simulation::<D>(session, text);
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        see(&simulation, &observation);
        if simulation.over() {
            return simulation.whole_state().centers();
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

fn farthest<const D: usize>(from: &[[f64; D]], to: &[SVector<f64, D>]) -> f64 {
    from.iter().zip(to).map(|(from, to)| (to - SVector::from(*from)).norm()).fold(0.0, f64::max)
}

/// Two disks in a box, sheared there and back with a rest between.
fn there_and_back(box_and_drive: &str, start: &[[f64; 2]], contact: &str, step: f64) -> String {
    format!(
        "{box_and_drive}\n[resolution]\nspacing = 0.25\n[[bodies]]\nradius = 1.0\ncenters = {start:?}\n[contact]\n{contact}\n\
         [time]\nend = 6.25\nstep = {step}\n"
    )
}

const STEPS: &str = "[{ until = 3.0, rate = 1.0 }, { until = 3.25, rate = 0.0 }, { rate = -1.0 }]";

fn bodies_that_do_not_touch_go_back_as_they_came(session: &Session) {
    let start = [[2.0, 3.9], [4.5, 3.1]];
    let sheared = format!("domain.size = [8.0, 8.0]\nflow.drive = {{ shear_rate = {STEPS}, periodic = \"sheared\" }}");
    let walls = format!("domain = {{ size = [8.0, 8.0], y = \"walls\" }}\nflow.drive.shear_rate = {STEPS}");
    for drive in [&sheared, &walls] {
        let missed = |contact: &str, step: f64| {
            let end = run::<2>(session, &there_and_back(drive, &start, contact, step), |_, _| {});
            farthest(&start, &end)
        };
        // of second order
        let [coarse, fine] = [0.0625, 0.03125].map(|step| missed("model = \"none\"", step));
        assert!(fine < 3e-4 && fine < 0.4 * coarse, "{coarse:e} {fine:e}");
        let touching = missed("model = \"inelastic\"\nfriction = 0.5\nroughness = 0.1", 0.03125);
        assert!(touching > 1e-2, "{touching:e}");
    }
}

/// Stokes flow is linear: what was pushed apart is not pulled together.
fn just_after_a_reversal_contacts_bear_nothing(session: &Session) {
    let text = "seed = 2\ndomain.size = [10.0, 10.0]\n\
                flow.drive = { shear_rate = [{ until = 1.0, rate = 1.0 }, { rate = -1.0 }], periodic = \"sheared\" }\n\
                resolution.cells_per_radius = 4\nmethod.tolerance = 1e-8\nlubrication = { model = \"pairwise\", roughness = 0.02 }\n\
                contact = { model = \"inelastic\", friction = 0.5 }\nbodies = [{ radius = 1.0, fraction = 0.62 }]\ntime = { end = 1.05, step = 0.05 }\n";
    let (mut before, mut reversed) = (None, None);
    run::<2>(session, text, |simulation, observation| {
        let (flow, time) = (simulation.suspension().unwrap(), simulation.state().time);
        let found = viscosity(flow, observation);
        if time < 1.0 - 1e-6 {
            before = Some(found);
        } else if reversed.is_none() {
            let setup = flow.setup();
            let mut bodies = setup.bodies.clone();
            bodies
                .iter_mut()
                .zip(&observation.solution.as_ref().unwrap().bodies)
                .for_each(|(own, state)| own.body.ball.center = state.center);
            let alone = Setup { bodies, ..setup.clone() };
            let mut suspension = flow_solver(session, alone).unwrap();
            let solution = suspension.solve(&mut |_, _| {}).unwrap();
            let without = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap();
            reversed = Some((found, without));
        }
    });
    let (before, (after, without)) = (before.unwrap(), reversed.unwrap());
    let contacts = |viscosity: &Viscosity| viscosity.parts.get(observe::Part::Contact).unwrap();
    assert!(contacts(&before) > 0.15 * before.relative(), "{before:?}");
    assert!(contacts(&after).abs() < 1e-6, "{after:?}");
    assert!((after.relative() / without.relative() - 1.0).abs() < 1e-6, "{} {}", after.relative(), without.relative());
    assert!(after.shear_stress < 0.0 && after.rate == 1.0);
}

fn a_tiny_oscillation_measures_the_viscosity_of_an_instant(session: &Session) {
    let scene_text = |drive: &str, time: &str| {
        format!(
            "seed = 3\ndomain = {{ size = [6.0, 6.0], y = \"walls\" }}\nflow = {{ viscosity = 2.0, drive = {{ shear_rate = {drive} }} }}\n\
             resolution.cells_per_radius = 4\nmethod.tolerance = 1e-9\nbodies = [{{ radius = 1.0, count = 3 }}]\n{time}\n"
        )
    };
    let setup = Setup::<2>::of(&parsed(&scene_text("1.0", ""))).unwrap();
    let mut suspension = flow_solver(session, setup).unwrap();
    let solution = suspension.solve(&mut |_, _| {}).unwrap();
    let expected = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap().relative();
    let (amplitude, frequency, mut stress) = (1e-7, 0.5, Vec::new());
    let drive = format!("{{ amplitude = {amplitude:?}, frequency = {frequency:?} }}");
    run::<2>(session, &scene_text(&drive, "time.end = 2.0"), |simulation, observation| {
        let flow = simulation.suspension().unwrap();
        stress.push((simulation.state().time, viscosity(flow, observation).shear_stress));
    });
    let found = harmonics(&stress, frequency).unwrap();
    let [[(storage, _), (loss, _)], ..] = found.parts[..] else { panic!("{found:?}") };
    let unit = amplitude * 2.0 * TAU * frequency;
    assert!((loss / unit / expected - 1.0).abs() < 1e-6, "{} {expected}", loss / unit);
    assert!((storage / loss).abs() < 1e-6, "{storage:e} {loss:e}");
}

fn an_oscillating_box_comes_back(session: &Session) {
    let start = [[2.0, 3.0], [4.5, 4.6], [1.0, 7.5]];
    let text = format!(
        "domain.size = [8.0, 8.0]\nflow.drive = {{ shear_rate = {{ amplitude = 0.5, frequency = 1.0 }}, periodic = \"sheared\" }}\n\
         resolution.cells_per_radius = 6\nbodies = [{{ radius = 1.0, centers = {start:?} }}]\ncontact.model = \"none\"\n\
         time = {{ end = 1.0, error = 1e-4 }}\n"
    );
    let mut most = 0.0f64;
    let end = run::<2>(session, &text, |simulation, observation| {
        let found = viscosity(simulation.suspension().unwrap(), observation);
        // what goes along with the box does so to the end of each step
        most = most.max(simulation.domain().shift().abs());
        assert!(found.at_rest || (1.3..1.5).contains(&found.relative()), "{found:?}");
    });
    assert!((most - 4.0).abs() < 1e-9, "{most}");
    let missed = farthest(&start, &end);
    assert!(missed < 1e-3, "{missed:e}");
}

/// Of a fluid between walls that oscillate oppositely: `(k H / 2) coth(k H / 2)` times the viscosity, with `k^2 = i w density / viscosity`.
fn a_layer_of_fluid_is_carried_along_by_oscillating_walls(session: &Session) {
    let (height, density, fluid, frequency, amplitude) = (4.0, 1.5, 0.75, 0.5, 0.1);
    let text = format!(
        "domain = {{ size = [1.0, {height:?}], y = \"walls\" }}\nresolution.spacing = 0.0625\ntime.end = 6.0\n\
         flow = {{ model = \"navier-stokes\", density = {density:?}, viscosity = {fluid:?}, drive = {{ shear_rate = {{ amplitude = {amplitude:?}, \
         frequency = {frequency:?} }} }} }}\n"
    );
    let mut stress = Vec::new();
    run::<2>(session, &text, |simulation, observation| {
        let flow = simulation.suspension().unwrap();
        stress.push((simulation.state().time, viscosity(flow, observation).wall_stress.unwrap()));
    });
    let found = harmonics(&stress, frequency).unwrap();
    let [[(storage, _), (loss, _)], ..] = found.parts[..] else { panic!("{found:?}") };
    let measured = Complex::new(loss, -storage) / (amplitude * TAU * frequency * fluid);
    let layers = (Complex::i() * (TAU * frequency * density / fluid)).sqrt() * (height / 2.0);
    let exact = layers / layers.tanh();
    assert!((measured / exact - 1.0).norm() < 5e-3, "{measured} {exact}");
}

fn walls_driven_at_one_rate_are_walls_of_two_velocities(session: &Session) {
    let bodies = "resolution.cells_per_radius = 4\nbodies = [{ radius = 1.0, centers = [[2.0, 2.0]] }]\ntime = { end = 0.5, step = 0.1 }\n";
    let end = |domain: &str| run::<2>(session, &format!("{domain}\n{bodies}"), |_, _| {})[0];
    let driven = end("domain = { size = [6.0, 6.0], y = \"walls\" }\nflow.drive.shear_rate = 0.5");
    let given = end("domain = { size = [6.0, 6.0], y = { lower = [-1.5, 0.0], upper = [1.5, 0.0] } }");
    assert_eq!(driven, given);
}

/// A dense suspension with friction in a shear.
fn pushed(domain: &str, drive: &str, end: f64) -> String {
    format!(
        "seed = 3\n{domain}\nflow = {{ viscosity = 0.5, drive = {{ {drive} }} }}\nresolution.cells_per_radius = 4\n\
         lubrication = {{ model = \"pairwise\", roughness = 0.02 }}\ncontact = {{ model = \"inelastic\", friction = 0.5 }}\n\
         bodies = [{{ radius = 1.0, fraction = 0.62 }}]\ntime.end = {end:?}\n"
    )
}

const WALLED: &str = "domain = { size = [9.0, 8.0], y = \"walls\" }";

fn a_stress_decides_the_rate(session: &Session) {
    let boxes = [("domain.size = [8.0, 8.0]", "shear_stress = 5.0, periodic = \"sheared\""), (WALLED, "shear_stress = -5.0")];
    for (domain, drive) in boxes {
        let (mut slid, mut last, mut rates, mut contact_count) = (0.0, 0.0, Vec::new(), 0);
        run::<2>(session, &pushed(domain, drive, 0.6), |simulation, observation| {
            let flow = simulation.suspension().unwrap();
            let (found, setup) = (viscosity(flow, observation), flow.setup());
            let wanted = if domain == WALLED { -5.0 } else { 5.0 };
            assert!((found.shear_stress / wanted - 1.0).abs() < 4e-5, "{}", found.shear_stress);
            // what is measured is what was asked for, on the walls too
            assert!(found.wall_stress.is_none_or(|stress| (stress / wanted - 1.0).abs() < 1e-4), "{:?}", found.wall_stress);
            let protocol = setup.domain.protocol().unwrap();
            assert!((protocol.rate(0.0) * found.relative() * 0.5 / wanted - 1.0).abs() < 4e-5);
            contact_count += observation.contacts.iter().filter(|contact| contact.force > 0.0).count();
            (slid, last) = (simulation.state().shear.strain, simulation.state().time);
            rates.push(protocol.rate(0.0).abs());
            assert!((simulation.domain().shift() - if domain == WALLED { 0.0 } else { 8.0 * slid }).abs() < 1e-9);
        });
        assert!(contact_count > 0);
        let [low, high] = [f64::min, f64::max].map(|most| rates.iter().copied().reduce(most).unwrap());
        assert!(slid.abs() > low * last && slid.abs() < high * last && high > 1.01 * low, "{slid} {low} {high}");
    }
}

/// One stress after the other: twice the stress shears twice as fast where no force is of its own, a step ends where the stress jumps, and one that turns
/// round shears back.
fn a_stress_that_jumps_decides_the_rate_from_there_on(session: &Session) {
    let boxes = [("domain.size = [8.0, 8.0]", ", periodic = \"sheared\""), (WALLED, "")];
    for (domain, periodic) in boxes {
        let stresses = "[{ until = 0.1, stress = 2.5 }, { until = 0.2, stress = 5.0 }, { stress = -5.0 }]";
        let drive = format!("shear_stress = {stresses}{periodic}");
        let text = pushed(domain, &drive, 0.3).replace("contact =", "#").replace(", roughness = 0.02", "");
        let mut instants = Vec::new();
        run::<2>(session, &text, |simulation, observation| {
            let (time, flow) = (simulation.state().time, simulation.suspension().unwrap());
            let wanted = [2.5, 5.0, -5.0][[0.1, 0.2].iter().filter(|jump| time >= **jump - 1e-12).count()];
            let found = viscosity(flow, observation);
            assert!((found.shear_stress / wanted - 1.0).abs() < 4e-5, "{time}: {}", found.shear_stress);
            let (rate, strain) = (flow.setup().domain.protocol().unwrap().rate(0.0), simulation.state().shear.strain);
            instants.push((time, rate, strain, found.relative()));
        });
        // Stokes flow is linear: the viscosity does not know of the jump
        for (jump, ratio) in [(0.1, 2.0), (0.2, -1.0)] {
            let place = instants.iter().position(|instant| (instant.0 - jump).abs() < 1e-9).expect("a step ends at the jump");
            let [before, after] = [place - 1, place].map(|place| instants[place]);
            assert!((after.3 / before.3 - 1.0).abs() < 0.04, "{before:?} {after:?}");
            assert!((after.1 / before.1 / ratio - 1.0).abs() < 0.04, "{before:?} {after:?}");
        }
        // by a half and a whole forth, then back
        let turned = instants.iter().find(|instant| instant.0 > 0.2 - 1e-9).unwrap();
        assert!((turned.2 / (0.1 * instants[0].1) / 3.0 - 1.0).abs() < 0.05, "{turned:?}");
        assert!(instants.last().unwrap().2 < turned.2);
    }
}

/// Without other forces bodies go as far as the strain takes them, however fast.
fn the_structure_knows_the_strain_not_the_time(session: &Session) {
    let pushed = |drive: &str, end: f64| pushed(WALLED, drive, end) + "time.error = 3e-5\n";
    let mut strain = 0.0;
    let by_stress = run::<2>(session, &pushed("shear_stress = 5.0", 0.4), |simulation, _| strain = simulation.state().shear.strain);
    let by_rate = run::<2>(session, &pushed("shear_rate = 1.0", strain), |_, _| {});
    let apart = by_stress.iter().zip(&by_rate).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    // 7e-4, and 3e-4 with a tenth of the error
    assert!(apart < 1e-3, "{apart:e} at a strain of {strain}");
}
