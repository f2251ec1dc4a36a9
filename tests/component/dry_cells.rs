//! Dry cells: what they enclose stays while they fall, strike the floor and each other, and come to rest.

use std::path::Path;

use nalgebra::SVector;
use turbid::{motion::Simulation, observe::ChainNumbers, petsc::Session, scene::Scene};

use crate::{Test, dry::smallest_gap};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_cell_on_rods_falls_on_the_floor_and_comes_to_rest),
        Test::of(a_cell_on_soft_springs_falls_on_the_floor_and_comes_to_rest),
        Test::of(a_cell_in_space_falls_on_the_floor_and_keeps_its_volume),
        Test::of(cells_that_fall_on_each_other_keep_their_areas),
    ]
}

/// What was seen of a run in which gravity 1 acts along the last axis.
#[derive(Debug)]
struct Observed {
    /// Energy of motion, of height and of bonds, halfway through each step, where velocities live.
    energies: Vec<f64>,
    /// The largest part by which a measure of a membrane is off.
    missed: f64,
    /// In radii.
    smallest_gap: f64,
    /// Of any bead at the end.
    fastest: f64,
}

/// Runs a dry scene of bodies whose mass is `pi r^2` (2D) or `4/3 pi r^3`, with fixed steps.
fn run<const D: usize>(session: &Session, text: &str) -> Observed {
    let scene = Scene::parse("cells", Path::new("."), text, &[]).unwrap();
    let mut simulation = Simulation::<D>::new(session, &scene).unwrap();
    let mut observed = Observed { energies: Vec::new(), missed: 0.0, smallest_gap: f64::INFINITY, fastest: 0.0 };
    let mut before = stored(&simulation);
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
        let after = stored(&simulation);
        let state = simulation.whole_state().into_owned();
        let speeds = state.bodies.iter().zip(masses(&simulation)).map(|(body, mass)| 0.5 * mass * body.twist.velocity.norm_squared());
        observed.energies.push(speeds.sum::<f64>() + 0.5 * (before + after));
        before = after;
        for kept in simulation.interactions().conserved() {
            let found = kept.measured(&|body: usize| state.bodies[body].center);
            observed.missed = observed.missed.max((found / kept.value - 1.0).abs());
        }
        observed.smallest_gap = observed.smallest_gap.min(smallest_gap(&simulation));
        observed.fastest = state.bodies.iter().map(|body| body.twist.velocity.norm()).fold(0.0, f64::max);
    }
    observed
}

fn masses<const D: usize>(simulation: &Simulation<D>) -> Vec<f64> {
    let unit = if D == 2 { std::f64::consts::PI } else { 4.0 / 3.0 * std::f64::consts::PI };
    simulation.whole_balls().iter().map(|ball| unit * ball.radius.powi(D as i32)).collect()
}

/// Energy of height and of bonds.
fn stored<const D: usize>(simulation: &Simulation<D>) -> f64 {
    let centers: Vec<SVector<f64, D>> = simulation.whole_state().centers();
    let height: f64 = centers.iter().zip(masses(simulation)).map(|(center, mass)| mass * center[D - 1]).sum();
    height + ChainNumbers::of(simulation.interactions(), &centers).unwrap().bond_energy
}

impl Observed {
    /// Whether nothing overlaps, measures stay to a part, and no step gains more than a part of the energy.
    fn proof(&self, kept: f64, gain: f64) {
        assert!(self.smallest_gap > -1e-9 && self.missed < kept, "gap {:e}, missed {:e}", self.smallest_gap, self.missed);
        let gained = self.energies.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let whole = self.energies[0] - self.energies[self.energies.len() - 1];
        assert!(gained < gain * whole, "gained {gained:e} of {whole:e}");
    }
}

/// A cell of 24 disks above a floor, turned by 0.4: stiff enough not to go on swinging between its contacts, which alone take energy.
fn falling(stretch: &str, end: f64) -> String {
    format!(
        "gravity = [0.0, -1.0]\ndomain = {{ size = [8.0, 6.0], y = \"walls\" }}\nflow = {{ model = \"none\" }}\ncontact = {{ model = \"inelastic\" }}\n\
         cells = [{{ centers = [[4.0, 3.0]], rotation = 0.4, beads = 24, radius = 0.15, spacing = 1.05, stretch = {stretch}, bend = 3.15 }}]\n\
         time = {{ end = {end}, step = 0.02 }}\n"
    )
}

fn a_cell_on_rods_falls_on_the_floor_and_comes_to_rest(session: &Session) {
    let observed = run::<2>(session, &falling("\"rigid\"", 40.0));
    observed.proof(1e-7, 1e-3);
    assert!(observed.fastest < 1e-3, "{}", observed.fastest);
}

fn a_cell_on_soft_springs_falls_on_the_floor_and_comes_to_rest(session: &Session) {
    let observed = run::<2>(session, &falling("15.75", 40.0));
    observed.proof(1e-7, 1e-3);
    assert!(observed.fastest < 1e-3, "{}", observed.fastest);
}

fn a_cell_in_space_falls_on_the_floor_and_keeps_its_volume(session: &Session) {
    let text = "gravity = [0.0, 0.0, -1.0]\ndomain = { size = [8.0, 8.0, 8.0], z = \"walls\" }\nflow = { model = \"none\" }\ncontact = { model = \"inelastic\" }\n\
                cells = [{ centers = [[4.0, 4.0, 4.5]], rotation = [0.5, 0.2, 0.0], beads = 42, radius = 0.25, stretch = 46.2, bend = 1.732 }]\n\
                time = { end = 6.0, step = 0.02 }\n";
    let observed = run::<3>(session, text);
    observed.proof(1e-6, 1e-3);
}

fn cells_that_fall_on_each_other_keep_their_areas(session: &Session) {
    let text = "seed = 1\ngravity = [0.0, -1.0]\ndomain = { size = [5.0, 10.0], x = \"walls\", y = \"walls\" }\nflow = { model = \"none\" }\n\
                contact = { model = \"inelastic\" }\ntime = { end = 5.0, step = 0.02 }\n\
                cells = [{ count = 2, beads = 24, radius = 0.15, spacing = 1.05, stretch = \"rigid\", bend = 0.0315 }, \
                         { count = 1, beads = 24, radius = 0.15, spacing = 1.05, stretch = 15.75, bend = 0.0315 }]\n\
                bodies = [{ count = 4, radius = 0.3 }]\n";
    run::<2>(session, text).proof(1e-7, 1e-2);
}
