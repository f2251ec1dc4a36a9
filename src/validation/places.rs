//! Drag on a disk, which is not to depend on where it lies between the points of the grid.

use std::f64::consts::PI;

use super::follow::{ComparisonRow, follow};
use crate::{error::Result, petsc::Session};

/// Radius of a disk that takes up a fifth of a unit cell.
const RADIUS: f64 = 0.252_313_25;

/// Reynolds numbers of the square array, and pressure gradient over viscosity and mean velocity.
pub const ARRAY: [(f64, f64); 3] = [(20.0, 58.914), (50.0, 64.463), (100.0, 68.59)];

/// Places of the disk: four with a history, and eight that fill a cell of the coarsest grid evenly.
fn centers() -> Vec<[f64; 2]> {
    // of the plastic number: the sequence that fills squares most evenly
    const RATIOS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    let drawn = (1..=8).map(|place| RATIOS.map(|ratio| 0.5 + 0.25 * RADIUS * (f64::from(place) * ratio).fract()));
    [[0.531, 0.5], [0.5, 0.5], [0.51, 0.52], [0.521, 0.5104]].into_iter().chain(drawn).collect()
}

/// The fixed disk of a square array at twelve places, by a method's word.
pub fn array(session: &Session, word: &'static str, cells: usize, reynolds: f64, reference: f64) -> Result<(usize, Vec<ComparisonRow>)> {
    let (viscosity, spacing) = (2.0 * RADIUS / reynolds, RADIUS / cells as f64);
    let (mut steps, mut found) = (0, Vec::new());
    for center in centers() {
        let text = format!(
            "domain.size = [1.0, 1.0]\n\
             flow = {{ model = \"navier-stokes\", viscosity = {viscosity}, density = 1.0, drive = {{ mean_velocity = [1.0, 0.0] }} }}\n\
             resolution.spacing = {spacing}\nmethod = {{ constraint = \"{word}\", inverse = \"transform\", tolerance = 1e-7 }}\n\
             bodies = [{{ radius = {RADIUS}, centers = [{center:?}], motion = \"fixed\" }}]\ntime.end = 4.0\n"
        );
        steps += follow::<2>(session, &text, |simulation, observation| {
            if let (true, Some(solution)) = (simulation.over(), &observation.solution) {
                found.push(solution.pressure_gradient[0].abs() / viscosity);
            }
            Ok(())
        })?;
    }
    let row = |which: &str, found: f64| ComparisonRow {
        case: format!("fixed disk in a square array, Re {reynolds}, 12 places: {which} gradient over viscosity"),
        resolution: format!("`{word}`, {cells} cells a radius"),
        reference: Some(reference),
        found,
        source: "spectral elements, 4 digits",
    };
    let extreme = |better: fn(f64, f64) -> f64| found.iter().copied().reduce(better).unwrap_or(f64::NAN);
    let mean = found.iter().sum::<f64>() / found.len() as f64;
    Ok((steps, vec![row("smallest", extreme(f64::min)), row("mean", mean), row("largest", extreme(f64::max))]))
}

/// Coefficient of drag of a disk that settles at Re 10 in the middle of a channel four diameters wide.
const SETTLING_DRAG: f64 = 5.750_557;

/// Four disks of diameter and settling velocity 1 that start a quarter of a cell apart along the channel.
pub fn settling_drag(session: &Session, cells: usize) -> Result<(usize, Vec<ComparisonRow>)> {
    let gravity = 0.5 * SETTLING_DRAG / (0.25 * PI);
    let (mut steps, mut rows) = (0, Vec::new());
    for place in 0..4 {
        let height = 12.0 + f64::from(place) * 0.125 / cells as f64;
        let text = format!(
            "gravity = [0.0, -{gravity}]\ndomain = {{ size = [4.0, 24.0], x = \"walls\" }}\n\
             flow = {{ model = \"navier-stokes\", viscosity = 0.1, density = 1.0, drive = {{ mean_velocity = [0.0, 0.0] }} }}\n\
             resolution.cells_per_radius = {cells}\nmethod.inverse = \"transform\"\n\
             bodies = [{{ radius = 0.5, centers = [[2.0, {height}]], density = 2.0 }}]\ntime.end = 30.0\n"
        );
        let mut way = [[0.0; 2]; 2];
        steps += follow::<2>(session, &text, |simulation, _| {
            let state = simulation.whole_state();
            let now = [state.time, state.bodies[0].center[1]];
            way[usize::from(state.time > 22.0)] = now;
            Ok(())
        })?;
        let velocity = (way[1][1] - way[0][1]) / (way[1][0] - way[0][0]);
        rows.push(ComparisonRow {
            case: format!("disk that settles in a channel, Re 10, place {}: coefficient of drag", place + 1),
            resolution: format!("{cells} cells a radius"),
            reference: Some(SETTLING_DRAG),
            found: 0.5 * PI * gravity / (velocity * velocity),
            source: "mesh that fits the disk, 6 digits",
        });
    }
    Ok((steps, rows))
}
