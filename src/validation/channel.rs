//! A fixed disk in a channel with inflow and outflow: the benchmark of Schaefer and Turek (1996).

use super::follow::{ComparisonRow, follow};
use crate::{error::Result, mechanics::FlowSolver, petsc::Session, surface::Shape};

/// The channel of Schaefer and Turek (1996) with its disk.
fn channel(cells: usize, speed: f64, time: &str) -> String {
    format!(
        "domain = {{ size = [2.2, 0.41], x = {{ inflow = {speed} }}, y = \"walls\" }}\n\
         flow = {{ model = \"navier-stokes\", viscosity = 1e-3, density = 1.0 }}\n\
         resolution = {{ cells_per_radius = {cells}, modes = {cells} }}\n\
         bodies = [{{ radius = 0.05, centers = [[0.2, 0.2]], motion = \"fixed\" }}]\ntime = {{ {time} }}\n"
    )
}

const CHANNEL: &str = "spectral elements: DFG benchmark, Schaefer and Turek (1996)";

/// Re 20: a steady flow.
pub fn cylinder(session: &Session, cells: usize) -> Result<(usize, Vec<ComparisonRow>)> {
    // a number of equal steps: a shorter last one would change the force by some 1e-4
    let text = channel(cells, 0.3, &format!("end = 10.0, step = {}", 10.0 / (10.0 * cells as f64 / 0.06).ceil()));
    let mut last = [0.0; 2];
    let steps = follow::<2>(session, &text, |simulation, observation| {
        if let (true, Some(flow), Some(solution)) = (simulation.over(), simulation.suspension(), &observation.solution) {
            last = [solution.bodies[0].force[0] / (0.5 * 0.2 * 0.2 * 0.1), pressure_drop(flow)];
        }
        Ok(())
    })?;
    let row = |case: &str, reference, found| ComparisonRow {
        case: format!("fixed disk in a channel, Re 20: {case}"),
        resolution: format!("{cells} cells a radius, {cells} modes"),
        reference: Some(reference),
        found,
        source: CHANNEL,
    };
    Ok((steps, vec![row("drag coefficient", 5.579_535, last[0]), row("pressure drop", 0.117_520_2, last[1])]))
}

/// From the front of the first body to its back: inside the pressure is uniform, and jumps by the normal traction.
fn pressure_drop(flow: &dyn FlowSolver<2>) -> f64 {
    let body = &flow.setup().bodies[0];
    let modes = body.body.ball.modes(body.order);
    let multipliers = &flow.evolution_on_grid().expect("it has inertia").levels()[0].multipliers[0];
    let outside = |normal: [f64; 2]| {
        let mut tractions = vec![0.0; modes.count() * 2];
        modes.traction(&normal, &mut tractions);
        let along = tractions.chunks(2).map(|traction| traction[0] * normal[0] + traction[1] * normal[1]);
        along.zip(multipliers).map(|(traction, multiplier)| traction * multiplier).sum::<f64>()
    };
    flow.setup().viscosity * (outside([-1.0, 0.0]) - outside([1.0, 0.0]))
}

/// Re 100: vortices, with the largest drag and lift and the Strouhal number over the last periods.
pub fn vortices(session: &Session, cells: usize) -> Result<(usize, Vec<ComparisonRow>)> {
    let text = channel(cells, 1.5, &format!("end = 6.0, step = {}", 0.0096 / cells as f64));
    let mut series: Vec<[f64; 3]> = Vec::new();
    let steps = follow::<2>(session, &text, |simulation, observation| {
        if let (true, Some(solution)) = (simulation.state().time > 4.5, &observation.solution) {
            let force = solution.bodies[0].force / (0.5 * 0.1);
            series.push([simulation.state().time, force[0], force[1]]);
        }
        Ok(())
    })?;
    let largest = |place: usize| series.iter().map(|row| row[place]).fold(f64::NEG_INFINITY, f64::max);
    let rises = series.windows(2).filter(|pair| pair[0][2] < 0.0 && pair[1][2] >= 0.0);
    let crossings: Vec<f64> = rises.map(|pair| pair[0][0] - pair[0][2] * (pair[1][0] - pair[0][0]) / (pair[1][2] - pair[0][2])).collect();
    let periods = crossings.len().saturating_sub(1) as f64;
    let frequency = crossings.first().zip(crossings.last()).map_or(f64::NAN, |(first, last)| periods / (last - first));
    let row = |case: &str, reference, found| ComparisonRow {
        case: format!("fixed disk in a channel, Re 100: {case}"),
        resolution: format!("{cells} cells a radius, {cells} modes"),
        reference: Some(reference),
        found,
        source: CHANNEL,
    };
    Ok((
        steps,
        vec![
            row("Strouhal number", 0.3019, frequency * 0.1),
            row("largest drag coefficient", 3.2275, largest(1)),
            row("largest lift coefficient", 0.9864, largest(2)),
        ],
    ))
}
