//! A disk that moves far to and fro, whose drag is rough as it passes points of the grid.

use super::follow::{ComparisonRow, follow, interpolated};
use crate::{error::Result, petsc::Session};

/// Cells a radius of the run that counts as smooth and true.
const FINEST: usize = 24;

/// Times between which drags are compared, of a period of 5.
const SPAN: [f64; 2] = [0.15, 1.5];

/// Times and coefficients of drag at Re 100 and Keulegan-Carpenter number 5.
fn drag(session: &Session, cells: usize) -> Result<(usize, Vec<(f64, f64)>)> {
    let text = format!(
        "domain.size = [4.0, 4.0]\nflow = {{ model = \"navier-stokes\", viscosity = 0.01, density = 1.0 }}\n\
         resolution.cells_per_radius = {cells}\nmethod = {{ inverse = \"transform\", tolerance = 1e-7 }}\n\
         bodies = [{{ radius = 0.5, centers = [[2.03, 2.01]], motion = {{ amplitude = [0.79577, 0.0], frequency = 0.2, phase = 1.5707963 }} }}]\n\
         time = {{ step = {}, end = {} }}\n",
        0.175 / cells as f64,
        SPAN[1] + 0.1
    );
    let mut curve = Vec::new();
    let steps = follow::<2>(session, &text, |simulation, observation| {
        let force = observation.solution.as_ref().map_or(f64::NAN, |solution| solution.bodies[0].force[0]);
        curve.push((simulation.state().time, 2.0 * force));
        Ok(())
    })?;
    Ok((steps, curve))
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    f64::sqrt(sum / count)
}

/// What fourth differences say of noise from step to step.
fn roughness(curve: &[(f64, f64)]) -> f64 {
    let fourth = curve.windows(5).map(|at| at[0].1 - 4.0 * at[1].1 + 6.0 * at[2].1 - 4.0 * at[3].1 + at[4].1);
    root_mean_square(fourth) / 70.0_f64.sqrt()
}

/// Drags on these grids, compared with those on the finest.
pub fn strokes(session: &Session) -> Result<(usize, Vec<ComparisonRow>)> {
    let within = |curve: &[(f64, f64)]| curve.iter().copied().filter(|(time, _)| (SPAN[0]..SPAN[1]).contains(time)).collect::<Vec<_>>();
    let largest = |curve: &[(f64, f64)]| curve.iter().map(|(_, drag)| drag.abs()).fold(0.0, f64::max);
    let row = |cells: usize, case: &str, reference, found| ComparisonRow {
        case: format!("disk that moves to and fro, Re 100, KC 5: {case}"),
        resolution: format!("{cells} cells a radius"),
        reference,
        found,
        source: "the run with 24 cells a radius",
    };
    let (mut steps, finest) = drag(session, FINEST)?;
    let mut rows = vec![row(FINEST, "rough part of its coefficient of drag", None, roughness(&within(&finest)))];
    for cells in [4, 8, 12] {
        let (more, curve) = drag(session, cells)?;
        steps += more;
        let curve = within(&curve);
        let difference = root_mean_square(curve.iter().map(|&(time, drag)| drag - interpolated(&finest, time)));
        rows.push(row(cells, "largest coefficient of drag", Some(largest(&within(&finest))), largest(&curve)));
        rows.push(row(cells, "root mean square of the difference", None, difference));
        rows.push(row(cells, "rough part of its coefficient of drag", None, roughness(&curve)));
    }
    Ok((steps, rows))
}
