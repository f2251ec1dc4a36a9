//! How chains lie: their length from end to end, how far they are spread, how bent they are, along what they lie, and the energy in their bonds.

use std::{collections::HashSet, ops::Range};

use nalgebra::{Matrix3, SMatrix, SVector};

use super::tied::{Form, tied};
use crate::interaction::{Interactions, Measure, Spring};

/// Chains at an instant; means are over all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainNumbers<const D: usize> {
    /// Energy of all bonds that can give way.
    pub bond_energy: f64,
    /// Mean distance from the first to the last bead of those with ends; nothing where all are rings and cells.
    pub end_to_end: Option<f64>,
    /// Mean radius of gyration: root of the mean square distance of beads from the middle of their chain.
    pub gyration: f64,
    /// Root of the mean square, over all beads between two others of lines, rings and outlines, of the angle by which the chain turns there, over the mean
    /// length of the two bonds; not a number where only membranes are.
    pub curvature: f64,
    /// Mean of `p p`, `p` being the unit vector along which the beads of a chain are spread most.
    pub orientation: SMatrix<f64, D, D>,
}

impl<const D: usize> ChainNumbers<D> {
    /// Those of all bodies with these centres; nothing without chains.
    pub fn of(interactions: &Interactions<D>, centers: &[SVector<f64, D>]) -> Option<ChainNumbers<D>> {
        let chains = interactions.chains();
        if chains.is_empty() {
            return None;
        }
        let center = |body: usize| centers[body];
        let energy = |chain: &Range<usize>| interactions.springs_of(chain, &center).iter().map(Spring::energy).sum::<f64>();
        let count = chains.len() as f64;
        let length = |chain: &Range<usize>| (centers[chain.end - 1] - centers[chain.start]).norm();
        let lines: Vec<f64> = lines(interactions).map(|line| length(&line)).collect();
        let spreads: Vec<SMatrix<f64, D, D>> = chains.iter().map(|chain| gyration_tensor(&centers[chain.clone()])).collect();
        Some(ChainNumbers {
            bond_energy: chains.iter().map(energy).sum(),
            end_to_end: (!lines.is_empty()).then(|| lines.iter().sum::<f64>() / lines.len() as f64),
            gyration: spreads.iter().map(|spread| spread.trace().sqrt()).sum::<f64>() / count,
            curvature: curvature(interactions, centers),
            orientation: spreads.iter().map(orientation).sum::<SMatrix<f64, D, D>>() / count,
        })
    }
}

/// The chains with ends.
fn lines<const D: usize>(interactions: &Interactions<D>) -> impl Iterator<Item = Range<usize>> {
    tied(interactions).into_iter().filter(|tied| tied.form == Form::Line).map(|tied| tied.beads)
}

/// See [`ChainNumbers::curvature`].
fn curvature<const D: usize>(interactions: &Interactions<D>, centers: &[SVector<f64, D>]) -> f64 {
    let membranes: HashSet<usize> = interactions
        .conserved()
        .iter()
        .filter(|conserved| matches!(conserved.measure, Measure::Volume(_) | Measure::Surface(_)))
        .map(|conserved| conserved.bodies.start)
        .collect();
    let lines = interactions.chains().into_iter().filter(|chain| !membranes.contains(&chain.start));
    let (mut squares, mut count) = (0.0, 0);
    for beads in lines.flat_map(|chain| centers[chain].windows(3)) {
        let (first, second) = (beads[1] - beads[0], beads[2] - beads[1]);
        squares += (first.angle(&second) / (0.5 * (first.norm() + second.norm()))).powi(2);
        count += 1;
    }
    (squares / f64::from(count)).sqrt()
}

/// The mean of `x x` over all beads of a chain, `x` being their places from its middle.
pub(super) fn gyration_tensor<const D: usize>(beads: &[SVector<f64, D>]) -> SMatrix<f64, D, D> {
    let middle = beads.iter().sum::<SVector<f64, D>>() / beads.len() as f64;
    beads.iter().map(|bead| (bead - middle) * (bead - middle).transpose()).sum::<SMatrix<f64, D, D>>() / beads.len() as f64
}

/// A matrix with zeros along the third axis in 2D.
pub(super) fn in_space<const D: usize>(matrix: &SMatrix<f64, D, D>) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| if row.max(column) < D { matrix[(row, column)] } else { 0.0 })
}

/// `p p` for the direction `p` in which beads are spread most.
fn orientation<const D: usize>(spread: &SMatrix<f64, D, D>) -> SMatrix<f64, D, D> {
    let eigen = in_space(spread).symmetric_eigen();
    let axis = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    SMatrix::from_fn(|row, column| axis[row] * axis[column])
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Vector2};

    use super::*;

    #[test]
    fn beads_along_a_line_lie_along_it() {
        let beads: Vec<Vector2<f64>> = (0..5).map(|bead| Vector2::new(3.0, 4.0) * f64::from(bead)).collect();
        assert!((orientation(&gyration_tensor(&beads)) - Matrix2::new(0.36, 0.48, 0.48, 0.64)).norm() < 1e-12);
    }
}
