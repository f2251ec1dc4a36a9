//! Momentum of flows with inertia on coarse grids: forces by tractions are what the flow on the grid gives away, wherever a body lies.

use std::{f64::consts::PI, path::Path};

use turbid::{motion::Simulation, petsc::Session, scene::Scene};

use crate::Test;

pub fn tests() -> Vec<Test> {
    vec![
        Test::only_on(1, the_drag_of_a_square_array_hardly_knows_the_place_of_its_disk),
        Test::only_on(1, the_drag_of_a_square_array_knows_neither_modes_nor_steps),
        Test::of(fixed_bodies_take_the_momentum_that_the_grid_loses),
        Test::of(a_spinning_disk_that_a_stream_carries_is_hardly_pushed_sideways),
    ]
}

/// The last of a run: body velocity of the first body, forces on all, pressure gradient, largest momentum residual, boundary layer.
struct Last<const D: usize> {
    velocity: [f64; D],
    force: [f64; D],
    gradient: f64,
    residual: f64,
    layer: Option<f64>,
}

fn last<const D: usize>(session: &Session, text: &str) -> Last<D> {
    let scene = Scene::parse("scene", Path::new("."), text, &[]).unwrap();
    let mut simulation = Simulation::<D>::new(session, &scene).unwrap();
    let mut residual = 0.0_f64;
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let flow = simulation.suspension().unwrap().evolution_on_grid().unwrap();
        residual = residual.max(flow.momentum_residual());
        if simulation.over() {
            let solution = observation.solution.as_ref().unwrap();
            let force: nalgebra::SVector<f64, D> = solution.bodies.iter().map(|body| body.force).sum();
            return Last {
                velocity: solution.bodies[0].twist.velocity.into(),
                force: force.into(),
                gradient: solution.pressure_gradient.norm(),
                residual,
                layer: flow.thinnest_layer().unwrap(),
            };
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

/// Pressure gradient over viscosity of a square array of disks of fraction 0.2 at a Reynolds number, and its boundary layer.
fn array(session: &Session, reynolds: f64, cells: usize, [x, y]: [f64; 2], (modes, end): (&str, &str)) -> (f64, f64) {
    let radius = (0.2 / PI).sqrt();
    let (viscosity, spacing) = (2.0 * radius / reynolds, radius / cells as f64);
    let found = last::<2>(
        session,
        &format!(
            "domain.size = [1.0, 1.0]\nflow = {{ model = \"navier-stokes\", viscosity = {viscosity:?}, density = 1.0, \
             drive = {{ mean_velocity = [1.0, 0.0] }} }}\nresolution = {{ spacing = {spacing:?}{modes} }}\n\
             method = {{ inverse = \"transform\", tolerance = 1e-7 }}\n\
             bodies = [{{ radius = {radius:?}, centers = [[{x}, {y}]], motion = \"fixed\" }}]\ntime = {{ {end} }}\n"
        ),
    );
    (found.gradient / viscosity, found.layer.unwrap())
}

/// Exact: 64.463 at Re 50. Before momentum was kept, 61.0 to 67.1.
fn the_drag_of_a_square_array_hardly_knows_the_place_of_its_disk(session: &Session) {
    let places = [[0.531, 0.5], [0.5, 0.5], [0.51, 0.52], [0.521, 0.5104]];
    let found = places.map(|place| array(session, 50.0, 6, place, ("", "end = 4.0")));
    let errors = found.map(|(drag, _)| drag / 64.463 - 1.0);
    let [least, most] = [f64::min, f64::max].map(|of: fn(f64, f64) -> f64| errors.into_iter().reduce(of).unwrap());
    assert!(least > 0.0 && most < 0.014 && most - least < 0.009, "{errors:?}");
    assert!(found.iter().all(|(_, layer)| (0.8..1.4).contains(layer)), "{found:?}");
}

fn the_drag_of_a_square_array_knows_neither_modes_nor_steps(session: &Session) {
    let drag = |modes: &str, step: &str| array(session, 50.0, 6, [0.531, 0.5], (modes, step)).0 / 64.463 - 1.0;
    let by_modes = [", modes = 4", ", modes = 8"].map(|modes| drag(modes, "end = 3.0"));
    assert!(by_modes.iter().all(|error| error.abs() < 0.014), "{by_modes:?}");
    let by_steps = ["0.01", "0.005"].map(|step| drag("", &format!("end = 3.0, step = {step}")));
    assert!((by_steps[0] - by_steps[1]).abs() < 1e-3, "{by_steps:?}");
}

/// In 2D and 3D, among walls, where it flows in, between images, several bodies within two cells.
fn fixed_bodies_take_the_momentum_that_the_grid_loses(session: &Session) {
    let flow = "model = \"navier-stokes\", viscosity = 0.05, density = 1.0";
    let rest = "resolution = { cells_per_radius = 4 }\nmethod = { tolerance = 1e-9 }\ntime = { end = 0.3, step = 0.03 }\n";
    let proof = |name: &str, found: [f64; 2]| {
        let [residual, force] = found;
        assert!(residual <= 1e-9 * force && force > 0.0, "{name}: {residual:e} of {force} is lost");
    };
    let plane = |domain: &str, drive: &str| {
        let found = last::<2>(
            session,
            &format!(
                "domain = {{ {domain} }}\nflow = {{ {flow}{drive} }}\n{rest}\
                 bodies = [{{ radius = 0.5, centers = [[2.5, 1.2], [2.6, 2.32], [4.0, 1.7]], motion = \"fixed\" }}]\n"
            ),
        );
        [found.residual, found.force[0].hypot(found.force[1])]
    };
    let mean = ", drive = { mean_velocity = [1.0, 0.1] }";
    proof("a periodic box", plane("size = [6.0, 4.0]", mean));
    proof("a channel", plane("size = [6.0, 4.0], y = \"walls\"", ", drive = { mean_velocity = [1.0, 0.0] }"));
    proof("an inflow", plane("size = [6.0, 4.0], y = \"walls\", x = { inflow = 1.0 }", ""));
    let space = last::<3>(
        session,
        &format!(
            "domain = {{ size = [3.0, 2.5, 2.5] }}\nflow = {{ {flow}, drive = {{ mean_velocity = [1.0, 0.0, 0.2] }} }}\n{rest}\
             bodies = [{{ radius = 0.5, centers = [[1.1, 1.2, 1.3], [2.2, 1.3, 1.1]], motion = \"fixed\" }}]\n"
        ),
    );
    proof("space", [space.residual, space.force[0]]);
}

/// Exact: not at all. Before momentum was kept, by -0.010 to -0.027.
fn a_spinning_disk_that_a_stream_carries_is_hardly_pushed_sideways(session: &Session) {
    let places = [[4.0, 4.0], [4.0625, 4.0], [4.125, 4.0], [4.1875, 4.0], [4.05, 4.08], [4.13, 4.21]];
    let sideways = places.map(|[x, y]| {
        let text = format!(
            "domain.size = [8.0, 8.0]\nflow = {{ model = \"navier-stokes\", viscosity = 0.05, density = 1.0, \
             drive = {{ mean_velocity = [1.0, 0.0] }} }}\nresolution = {{ cells_per_radius = 4 }}\n\
             method = {{ inverse = \"transform\", tolerance = 1e-7 }}\n\
             bodies = [{{ radius = 1.0, centers = [[{x}, {y}]], density = 2.0, velocity = [1.0, 0.0], spin = 1.0 }}]\ntime = {{ end = 0.5 }}\n"
        );
        last::<2>(session, &text).velocity[1]
    });
    let mean = sideways.iter().sum::<f64>() / sideways.len() as f64;
    assert!(mean.abs() <= 0.003 && sideways.iter().all(|speed| speed.abs() <= 0.008), "{mean}: {sideways:?}");
}
