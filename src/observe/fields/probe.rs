//! The flow, or the scalar in its place, on a lattice of points that does not depend on the grid: what solutions on several grids are
//! compared by.
//!
//! Next to a surface the interpolation from a grid reaches across the kink there, so the mean error of samples falls as `h^(3/2)` at best. What was found on
//! a fitted mesh is taken from the triangle that holds the point.

use nalgebra::{SVector, Vector2};

use super::sample::{scalars, velocities};
use crate::{
    error::Result,
    geometry::Domain,
    grid::Grid,
    mechanics::{FlowSolver, ScalarSetup, ScalarSolution},
    system::Solution,
};

/// Values at points.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe<const D: usize> {
    /// The points.
    pub points: Vec<SVector<f64, D>>,
    /// Names of the values of a point.
    pub names: Vec<&'static str>,
    /// The values of each point.
    pub values: Vec<Vec<f64>>,
}

/// The velocity of a solution, background included, on `per_axis^D` points; collective, and the same on every rank.
pub fn velocity_probe<const D: usize>(suspension: &dyn FlowSolver<D>, solution: &Solution<D>, per_axis: usize) -> Result<Probe<D>> {
    let setup = suspension.setup();
    let points = lattice(&setup.domain, per_axis);
    let disturbance = match &solution.on_mesh {
        Some(on_mesh) => {
            on_mesh.at(points.iter().map(flat))?.iter().map(|velocity| SVector::from_column_slice(velocity.as_slice())).collect()
        }
        None => velocities(suspension.grid(), &solution.fluid, &points)?,
    };
    let total = points.iter().zip(disturbance).map(|(point, velocity)| velocity + setup.drive.background(point));
    let values = total.map(|velocity| velocity.as_slice().to_vec()).collect();
    Ok(Probe { points, names: ["u", "v", "w"][..D].to_vec(), values })
}

/// The scalar of a solution, mean gradient included, on `per_axis^D` points; collective, and the same on every rank.
pub fn scalar_probe<const D: usize>(
    setup: &ScalarSetup<D>,
    grid: &Grid<D>,
    solution: &ScalarSolution<D>,
    per_axis: usize,
) -> Result<Probe<D>> {
    let points = lattice(&setup.domain, per_axis);
    let gradient = setup.gradient.unwrap_or_else(SVector::zeros);
    let disturbance = match &solution.on_mesh {
        Some(on_mesh) => on_mesh.at(points.iter().map(flat))?,
        None => scalars(grid, &solution.field, &points)?,
    };
    let values = points.iter().zip(disturbance).map(|(point, value)| vec![value + gradient.dot(point)]).collect();
    Ok(Probe { points, names: vec!["value"], values })
}

/// A point of a mesh, which there is in 2D only.
fn flat<const D: usize>(point: &SVector<f64, D>) -> Vector2<f64> {
    Vector2::new(point[0], point[1])
}

/// The centres of equal parts of the box, the first axis fastest.
fn lattice<const D: usize>(domain: &Domain<D>, per_axis: usize) -> Vec<SVector<f64, D>> {
    let place = |number: usize, axis: usize| number / per_axis.pow(axis as u32) % per_axis;
    let point = |number| SVector::from_fn(|axis, _| (place(number, axis) as f64 + 0.5) * domain.size[axis] / per_axis as f64);
    (0..per_axis.pow(D as u32)).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    #[test]
    fn the_lattice_fills_the_box_and_the_first_axis_is_fastest() {
        let domain = Domain::<2> { size: SVector::from([4.0, 2.0]), axes: [Axis::Periodic; 2] };
        let points: Vec<[f64; 2]> = lattice(&domain, 2).iter().map(|point| [point[0], point[1]]).collect();
        assert_eq!(points, [[1.0, 0.5], [3.0, 0.5], [1.0, 1.5], [3.0, 1.5]]);
    }
}
