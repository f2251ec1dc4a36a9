//! Pressure gradients and body forces that change with time: the flow of the moment without inertia, the oscillating flow of a channel with it.

use std::{f64::consts::TAU, path::Path};

use nalgebra::Complex;
use turbid::{geometry::Protocol, motion::Simulation, petsc::Session, scene::Scene};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(stokes_flow_is_that_of_the_gradient_of_the_moment),
        Test::only_on(1, a_channel_with_inertia_has_its_oscillating_flow),
        Test::of(a_gradient_and_a_force_that_change_alike_drive_alike),
    ]
}

/// Time and mean velocity along x at each instant of a run.
fn flow(session: &Session, text: &str) -> Vec<(f64, f64)> {
    let scene = Scene::parse("drive", Path::new("."), text, &[]).unwrap();
    let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
    let mut found = Vec::new();
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        found.push((simulation.state().time, observation.solution.as_ref().unwrap().mean_velocity[0]));
        if simulation.over() {
            return found;
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

fn stokes_flow_is_that_of_the_gradient_of_the_moment(session: &Session) {
    let (height, viscosity) = (2.0, 0.5);
    let steps = Protocol::steps(&[(0.5, 1.0), (1.0, 0.0), (f64::INFINITY, -2.0)]);
    let oscillation = Protocol::Oscillation { amplitude: 1.5 / (TAU * 0.7), frequency: 0.7 };
    let written =
        ["[{ until = 0.5, value = 1.0 }, { until = 1.0, value = 0.0 }, { value = -2.0 }]", "{ amplitude = 1.5, frequency = 0.7 }"];
    for bodies in ["", "bodies = [{ radius = 0.4, centers = [[0.9, 0.8]], motion = \"fixed\" }]\n"] {
        let text = |factor: &str| {
            format!(
                "domain = {{ size = [4.0, {height:?}], y = \"walls\" }}\nresolution.spacing = 0.125\nmethod.tolerance = 1e-10\n{bodies}\
                 time = {{ end = 1.5, step = 0.11 }}\n\
                 flow = {{ viscosity = {viscosity:?}, drive = {{ pressure_gradient = [-3.0, 0.0], factor = {factor} }} }}\n"
            )
        };
        let steady = flow(session, &text("1.0"))[0].1;
        let poiseuille = 3.0 * height * height / (12.0 * viscosity);
        assert!(!bodies.is_empty() || (steady / poiseuille - 1.0).abs() < 5e-3, "{steady}, not {poiseuille}");
        for (factor, written) in [steps, oscillation].iter().zip(written) {
            let found = flow(session, &text(written));
            for (time, velocity) in &found {
                let expected = steady * factor.rate(*time);
                assert!((velocity - expected).abs() < 1e-8 * steady, "{velocity} at {time}, not {expected}: {written}");
            }
            let reached = |jump: f64| found.iter().any(|(time, _)| (time - jump).abs() < 1e-12);
            assert!(written.starts_with('{') || reached(0.5) && reached(1.0), "steps end where the gradient jumps: {found:?}");
        }
    }
}

/// The flow of a plane channel under `cos`: Landau and Lifshitz, Fluid Mechanics, section 24.
fn a_channel_with_inertia_has_its_oscillating_flow(session: &Session) {
    let (height, density, viscosity, frequency, steps, cycles) = (2.0, 1.5, 0.75, 0.5, 128, 6);
    let text = format!(
        "domain = {{ size = [0.5, {height:?}], y = \"walls\" }}\nresolution.spacing = 0.0625\n\
         time = {{ end = {:?}, step = {:?} }}\n\
         flow = {{ model = \"navier-stokes\", density = {density:?}, viscosity = {viscosity:?}, drive = {{ pressure_gradient = [-1.0, 0.0], \
         factor = {{ amplitude = 0.1, frequency = {frequency:?} }} }} }}\n",
        f64::from(cycles) / frequency,
        1.0 / (frequency * f64::from(steps))
    );
    let angular = TAU * frequency;
    let all = flow(session, &text);
    let last = &all[all.len() - steps as usize..];
    let found: Complex<f64> =
        last.iter().map(|(time, velocity)| Complex::from_polar(2.0 * velocity / f64::from(steps), -angular * time)).sum();
    let layers = (Complex::i() * (angular * density / viscosity)).sqrt() * (0.5 * height);
    let exact = 0.1 / (Complex::i() * (angular * density)) * (1.0 - layers.tanh() / layers);
    let (amplitude, phase) = (found.norm() / exact.norm() - 1.0, (found / exact).arg());
    assert!(amplitude.abs() < 5e-3 && phase.abs() < 5e-3, "amplitude {amplitude:e}, phase {phase:e}");
}

/// A force on the fluid alone, where there are no bodies, is a gradient of the other sign; micrometres and milliseconds change nothing.
fn a_gradient_and_a_force_that_change_alike_drive_alike(session: &Session) {
    let text = |[length, time]: [f64; 2], key: &str, sign: f64| {
        let stress = 1.0 / time;
        format!(
            "domain = {{ size = [{:?}, {:?}], y = \"walls\" }}\nresolution.spacing = {:?}\ntime = {{ end = {:?}, step = {:?} }}\n\
             flow = {{ model = \"navier-stokes\", density = {:?}, viscosity = 1.0, drive = {{ {key} = [{:?}, 0.0], \
             factor = {{ amplitude = 2.0, frequency = {:?} }} }} }}\n",
            length,
            2.0 * length,
            0.125 * length,
            0.5 * time,
            0.025 * time,
            time / (length * length),
            sign * stress / length,
            1.0 / time
        )
    };
    let end = |units: [f64; 2], key: &str, sign: f64| flow(session, &text(units, key, sign)).last().unwrap().1;
    let gradient = end([1.0, 1.0], "pressure_gradient", -1.0);
    assert!(gradient.abs() > 1e-2 && (end([1.0, 1.0], "body_force", 1.0) / gradient - 1.0).abs() < 1e-9);
    let scaled = end([1e-6, 1e-3], "pressure_gradient", -1.0) * 1e-3 / 1e-6;
    assert!((scaled / gradient - 1.0).abs() < 1e-7, "{scaled} {gradient}");
}
