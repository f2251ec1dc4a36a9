//! Flows with inertia in which something happens at once: order in time after a sudden start, and what an impact does to bodies that meet.

use std::{f64::consts::PI, path::Path};

use turbid::{
    motion::{Observation, Simulation},
    observe::EnergyRates,
    petsc::Session,
    scene::Scene,
};

use crate::Test;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_disk_that_starts_at_once_goes_its_way_at_second_order),
        Test::of(a_second_step_twice_as_long_makes_up_for_a_start_too),
        Test::of(steps_too_short_for_a_light_disk_end_the_run),
        Test::of(layers_are_no_thicker_than_viscosity_has_reached),
        Test::of(disks_that_have_met_go_on_together_with_the_energy_that_is_left),
    ]
}

/// Runs a scene to its end and tells of each state with what is solved there.
fn run(session: &Session, text: &str, mut see: impl FnMut(&Simulation<2>, &Observation<2>)) {
    let scene = Scene::parse("scene", Path::new("."), text, &[]).unwrap();
    let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        see(&simulation, &observation);
        if simulation.over() {
            return;
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

/// Place and velocity along x at the end of a disk that starts at a velocity, with steps of a word of a scene.
fn started_at_once(session: &Session, (velocity, step, end): (f64, &str, f64), lengths: &mut Vec<f64>) -> [f64; 2] {
    let mut found = [0.0; 2];
    let text = format!(
        "domain = {{ size = [4.0, 4.0], x = \"periodic\", y = \"walls\" }}\nflow = {{ model = \"navier-stokes\", viscosity = 0.1, density = 1.0 }}\n\
         resolution.cells_per_radius = 4\nmethod = {{ inverse = \"transform\", tolerance = 1e-9 }}\n\
         bodies = [{{ radius = 0.5, centers = [[2.013, 2.007]], density = 2.0, velocity = [{velocity}, 0.0] }}]\ntime = {{ step = {step}, end = {end} }}\n"
    );
    run(session, &text, |simulation, observation| {
        found = [simulation.whole_state().bodies[0].center[0], observation.twists[0].velocity[0]];
        lengths.push(simulation.state().last_step);
    });
    found
}

/// At once it shares its momentum with the fluid that it pushes aside; a first step at the velocity of the start made places wrong by a sixth of a step of it: ratio 2.2.
fn a_disk_that_starts_at_once_goes_its_way_at_second_order(session: &Session) {
    let at_end = |step| started_at_once(session, (0.1, step, 0.4), &mut Vec::new());
    let found = ["0.08", "0.04", "0.02"].map(at_end);
    for (quantity, largest) in ["place", "velocity"].into_iter().zip([2e-5, 2e-5]) {
        let place = usize::from(quantity == "velocity");
        let [coarse, fine] = [0, 1].map(|pair| (found[pair][place] - found[pair + 1][place]).abs());
        assert!(coarse > 3.0 * fine && fine < largest, "{quantity}: {coarse:.2e}, {fine:.2e}");
    }
}

/// Where the second step took velocities to go along straight lines from the start, the place was wrong by half as much again as the first step: by -0.0202.
fn a_second_step_twice_as_long_makes_up_for_a_start_too(session: &Session) {
    let mut lengths = Vec::new();
    let automatic = started_at_once(session, (0.4, "\"auto\"", 0.6), &mut lengths);
    assert_eq!(lengths[2], 2.0 * lengths[1], "{lengths:?}");
    let short = started_at_once(session, (0.4, "0.02", 0.6), &mut Vec::new());
    // four steps: their error is of second order
    assert!((automatic[0] - short[0]).abs() < 1.5e-3, "{} and {}", automatic[0], short[0]);
}

/// A disk that a force pushes in a fluid of little viscosity, for two steps.
fn pushed(density: f64) -> Scene {
    let text = format!(
        "domain = {{ size = [4.0, 4.0], x = \"walls\", y = \"walls\" }}\nflow = {{ model = \"navier-stokes\", viscosity = 1e-3, density = 1.0 }}\n\
         resolution.cells_per_radius = 4\nbodies = [{{ radius = 0.5, centers = [[2.0, 2.0]], density = {density}, force = [0.01, 0.0] }}]\n\
         time = {{ step = 0.01, end = 0.03 }}\n"
    );
    Scene::parse("scene", Path::new("."), &text, &[]).unwrap()
}

/// They moved against the force and faster and faster, and the run went on.
fn steps_too_short_for_a_light_disk_end_the_run(session: &Session) {
    let mut simulation = Simulation::<2>::new(session, &pushed(0.1)).unwrap();
    let ended = (0..4).find_map(|_| {
        let observation = simulation.evaluate(&mut |_, _| {});
        observation.and_then(|observation| simulation.step(&observation, &mut |_, _| {})).err()
    });
    let text = ended.expect("steps this short lead nowhere").to_string();
    assert!(text.contains("too short for bodies lighter than the fluid"), "{text}");
}

/// Where the grid does not see a layer its slope says nothing: it told of 23 cells where viscosity had reached a fiftieth of one.
fn layers_are_no_thicker_than_viscosity_has_reached(session: &Session) {
    let mut simulation = Simulation::<2>::new(session, &pushed(1.0)).unwrap();
    for _ in 0..2 {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    simulation.evaluate(&mut |_, _| {}).unwrap();
    let time = simulation.state().time;
    let layer = simulation.suspension().unwrap().evolution_on_grid().unwrap().thinnest_layer().unwrap().unwrap();
    let reached = (PI * 1e-3 * time).sqrt() / 0.125;
    assert!(layer > 0.0 && layer <= reached * (1.0 + 1e-12), "{layer} cells where {reached} were reached");
}

/// Where contact forces acted as other forces do, they parted at a tenth of their speed and more, and contacts took a quarter more energy than there was to lose.
fn disks_that_have_met_go_on_together_with_the_energy_that_is_left(session: &Session) {
    let text = "domain = { size = [4.0, 2.0], x = \"periodic\", y = \"walls\" }\nflow = { model = \"navier-stokes\", viscosity = 0.01, density = 1.0 }\n\
                resolution.cells_per_radius = 4\nmethod = { inverse = \"transform\", tolerance = 1e-8 }\ncontact.model = \"inelastic\"\n\
                time = { step = 0.04, end = 1.0 }\n\
                [[bodies]]\nradius = 0.4\ncenters = [[1.013, 1.007]]\ndensity = 100.0\nvelocity = [1.0, 0.0]\n\
                [[bodies]]\nradius = 0.4\ncenters = [[2.213, 1.007]]\ndensity = 50.0\n";
    let (mut lost, mut velocities) = (0.0, [0.0; 2]);
    run(session, text, |simulation, observation| {
        let (solver, solution) = (simulation.suspension().unwrap(), observation.solution.as_ref().unwrap());
        lost += EnergyRates::of(solver, solution, &observation.contacts, None).unwrap().unwrap().lost_in_contacts;
        velocities = [0, 1].map(|body| observation.twists[body].velocity[0]);
    });
    // the fluid takes 2 % of the momentum, and slows the disks by 3 % before they meet
    let [mass, other] = [100.0, 50.0].map(|density| density * PI * 0.16);
    assert!((velocities[0] - velocities[1]).abs() < 0.01, "{velocities:?}");
    let momentum = (mass * velocities[0] + other * velocities[1]) / mass;
    assert!((0.95..1.0).contains(&momentum), "{momentum}");
    let loss = 0.5 * mass * other / (mass + other);
    assert!((lost / loss - 0.91).abs() < 0.03, "{lost} of {loss}");
}
