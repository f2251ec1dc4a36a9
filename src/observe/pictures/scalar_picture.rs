//! The picture of a scalar: its value, or with a mean gradient the strength of its flux, as colour, and the lines along which it flows.

use nalgebra::SVector;

use super::plane::{CutPlane, Disk, Picture};
use crate::{error::Result, geometry::Ball, mechanics::SolvedScalar, observe::fields::sample::scalars, scene::Scene};

/// Cuts a solution; collective, and the same on every rank.
pub fn scalar_picture<const D: usize>(scene: &Scene, solved: &SolvedScalar<D>) -> Result<Picture> {
    let SolvedScalar { setup, grid, solution, .. } = *solved;
    let plane = CutPlane::of(scene, &setup.domain, grid);
    let values = scalars(grid, &solution.field, &plane.points())?;
    let flux = fluxes(&plane, &values, setup.gradient.unwrap_or_else(SVector::zeros));
    let (quantity, coloured) = match setup.gradient {
        Some(gradient) => ("flux |q| / mean gradient", flux.iter().map(|flux| flux[0].hypot(flux[1]) / gradient.norm()).collect()),
        None => coloured_by_value(&values, setup.source),
    };
    let bodies = solution.inclusions.iter().zip(&setup.inclusions).filter_map(|(state, &(ball, _))| {
        let (center, radius) = plane.cut(&Ball { center: state.center, ..ball })?;
        Some(Disk { center, radius, velocity: [0.0; 2], group: None })
    });
    Ok(Picture {
        title: scene.shown_title().to_owned(),
        subtitle: plane.place().unwrap_or_default(),
        axes: plane.names(),
        size: plane.size,
        periodic: plane.periodic,
        walls: plane.walls,
        shift: plane.shift,
        slide: 0.0,
        bodies: bodies.collect(),
        bonds: Vec::new(),
        contacts: Vec::new(),
        legend: Vec::new(),
        samples: plane.samples,
        velocity: flux,
        quantity: quantity.to_owned(),
        least: 0.0,
        least_speed: 0.0,
        coloured,
        signed: false,
    })
}

/// The name and the values of a scalar with a source, positive where the source makes it grow.
fn coloured_by_value(values: &[f64], source: f64) -> (&'static str, Vec<f64>) {
    let sign = if source < 0.0 { -1.0 } else { 1.0 };
    let name = if sign < 0.0 { "minus the scalar u (units of the scene)" } else { "scalar u (units of the scene)" };
    (name, values.iter().map(|value| sign * value).collect())
}

/// Minus the gradient at the samples, by differences between those beside them; one-sided at walls.
fn fluxes<const D: usize>(plane: &CutPlane<D>, values: &[f64], gradient: SVector<f64, D>) -> Vec<[f64; 2]> {
    let [columns, rows] = plane.samples;
    let slope = |place: [usize; 2], axis: usize| {
        let count = plane.samples[axis];
        let at = |index: usize| {
            let mut place = place;
            place[axis] = index;
            values[place[1] * columns + place[0]]
        };
        let (here, step) = (place[axis], plane.size[axis] / count as f64);
        let (before, after, steps) = match plane.periodic[axis] {
            true => ((here + count - 1) % count, (here + 1) % count, 2.0),
            false if here == 0 => (0, 1, 1.0),
            false if here + 1 == count => (here - 1, here, 1.0),
            false => (here - 1, here + 1, 2.0),
        };
        -gradient[plane.axes[axis]] - (at(after) - at(before)) / (steps * step)
    };
    (0..columns * rows).map(|place| [0, 1].map(|axis| slope([place % columns, place / columns], axis))).collect()
}
