//! Flow along a box that does not change along it: two Poisson problems on a cross-section.

use crate::{
    grid::{
        Grid,
        stencil::{Site, laplacian, left_beside_walls},
    },
    linalg::{SparseRows, dot},
};

/// Residual, relative to the right-hand side, of the profiles.
const EXACT: f64 = 1e-13;

/// Profiles of the velocity along an axis, over the points of a cross-section.
pub struct CrossSection {
    /// Velocity that a unit gradient of the pressure drives, over its mean.
    pub profile: Vec<f64>,
    /// That mean: the permeability.
    pub permeability: f64,
    /// Velocity that a unit force at every point drives: the weights of a force in the mean velocity.
    pub weights: Vec<f64>,
}

impl CrossSection {
    /// The cross-section of a box normal to an axis, for minus the Laplacian and a shift; nothing if no wall holds the flow along it.
    pub fn new<const D: usize>(grid: &Grid<D>, axis: usize, shift: f64) -> Option<CrossSection> {
        if (0..D).all(|across| across == axis || grid.domain().periodic(across)) {
            return None;
        }
        let points: usize = (0..D).filter(|&across| across != axis).map(|across| grid.cells()[across]).product();
        let mut minus_laplacian = SparseRows::default();
        let load: Vec<f64> = (0..points).map(|point| push_row(grid, axis, shift, point, &mut minus_laplacian)).collect();
        let (flow, weights) = (solve(&minus_laplacian, &load), solve(&minus_laplacian, &vec![1.0; points]));
        let permeability = mean(&flow);
        Some(CrossSection { profile: flow.iter().map(|velocity| velocity / permeability).collect(), permeability, weights })
    }

    /// Mean over the cross-section of the profile, weighed as a force.
    pub fn inertia(&self) -> f64 {
        dot(&self.profile, &self.weights) / self.profile.len() as f64
    }

    /// The point at which an index of the lattice lies.
    pub fn point<const D: usize>(grid: &Grid<D>, axis: usize, index: &[usize; D]) -> usize {
        (0..D).filter(|&across| across != axis).fold(0, |point, across| point * grid.cells()[across] + index[across])
    }
}

/// Adds the row of a point; returns what a unit gradient of the pressure is there.
fn push_row<const D: usize>(grid: &Grid<D>, axis: usize, shift: f64, mut point: usize, rows: &mut SparseRows) -> f64 {
    let own = point;
    // no wall across the axis is near face 1
    let mut index = [1; D];
    for across in (0..D).rev().filter(|&across| across != axis) {
        index[across] = (point % grid.cells()[across]) as isize;
        point /= grid.cells()[across];
    }
    let (mut row, mut centre) = (Vec::new(), shift);
    laplacian(grid, axis, index, |term| match term.site {
        Site::Lattice { index: neighbour, .. } if neighbour[axis] != index[axis] => {}
        Site::Lattice { index: neighbour, .. } => {
            centre += term.weight;
            row.push((CrossSection::point(grid, axis, &grid.wrapped(neighbour)) as u32, -term.weight));
        }
        Site::Wall { .. } => centre += term.weight,
    });
    row.push((own as u32, centre));
    rows.push(row);
    left_beside_walls(grid, axis, index)
}

/// Conjugate gradients: the matrix is symmetric and positive definite, and small.
fn solve(rows: &SparseRows, rhs: &[f64]) -> Vec<f64> {
    let (mut x, mut residual, mut direction) = (vec![0.0; rhs.len()], rhs.to_vec(), rhs.to_vec());
    let (mut square, enough) = (dot(rhs, rhs), EXACT * EXACT * dot(rhs, rhs));
    for _ in 0..10 * rhs.len() {
        if square <= enough {
            break;
        }
        let image = rows.apply(&direction);
        let step = square / dot(&direction, &image);
        x.iter_mut().zip(&direction).for_each(|(x, direction)| *x += step * direction);
        residual.iter_mut().zip(&image).for_each(|(residual, image)| *residual -= step * image);
        let next = dot(&residual, &residual);
        direction.iter_mut().zip(&residual).for_each(|(direction, residual)| *direction = residual + next / square * *direction);
        square = next;
    }
    x
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, Domain};
    use nalgebra::SVector;

    fn section<const D: usize>(size: [f64; D], walls: [bool; D]) -> Option<CrossSection> {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let domain = Domain { size: size.into(), axes: walls.map(|walled| if walled { wall } else { Axis::Periodic }) };
        CrossSection::new(&Grid::new(&domain, 1.0 / 16.0, 1, 0).unwrap(), 0, 0.0)
    }

    #[test]
    fn permeabilities_are_those_of_slots_and_ducts() {
        let slot = section([8.0, 1.0], [false, true]).unwrap();
        assert!((slot.permeability * 12.0 - 1.0).abs() < 2e-3, "{}", slot.permeability);
        let wide = section([8.0, 1.0, 2.0], [true, true, false]).unwrap();
        assert!((wide.permeability - slot.permeability).abs() < 1e-12, "a slot in 3D");
        // the square duct: 0.035144 (White, Viscous fluid flow)
        let duct = section([8.0, 1.0, 1.0], [true, true, true]).unwrap();
        assert!((duct.permeability / 0.035144 - 1.0).abs() < 1e-2, "{}", duct.permeability);
        assert!((mean(&duct.profile) - 1.0).abs() < 1e-12);
        assert!(section([8.0, 1.0], [true, false]).is_none(), "nothing holds the flow");
    }
}
