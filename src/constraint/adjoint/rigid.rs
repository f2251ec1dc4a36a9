//! The rigid motion of a body, read from velocities at nodes by weighted least squares.

use nalgebra::{DMatrix, SVector};

use super::nodes::AdjointNodes;
use crate::linalg::SparseRows;
use crate::{body::skew, surface::SurfaceTable};

/// The velocities at nodes of a body's rigid motions of unit coefficient: nodes down, motions across.
pub fn motions<const D: usize>(surface: &SurfaceTable<D>, nodes: &AdjointNodes<D>) -> DMatrix<f64> {
    let (rigid, modes) = (surface.modes.rigid_count(), &surface.modes);
    let lever = modes.torque_factor() / modes.force_factor();
    let turns: Vec<_> = (D..rigid).map(|turn| skew::<D>(&unit(turn - D, rigid - D, 1.0 / lever))).collect();
    DMatrix::from_fn(nodes.count(), rigid, |node, motion| {
        let component = nodes.components[node] as usize;
        let velocity: SVector<f64, D> = if motion < D {
            SVector::from_fn(|axis, _| f64::from(u8::from(axis == motion)))
        } else {
            turns[motion - D] * nodes.offsets[node]
        };
        velocity[component]
    })
}

fn unit(place: usize, length: usize, value: f64) -> Vec<f64> {
    (0..length).map(|index| if index == place { value } else { 0.0 }).collect()
}

/// Adds the rows that read the coefficients of the rigid motion nearest to the velocities at nodes of the given weights.
///
/// Their adjoint spreads forces as the weights are spread, with exactly the net force and torque that multiply it.
pub fn push_readings(motions: &DMatrix<f64>, weights: &[f64], rows: &mut SparseRows) {
    let weighted = DMatrix::from_fn(motions.nrows(), motions.ncols(), |node, motion| weights[node] * motions[(node, motion)]);
    let gram = motions.tr_mul(&weighted);
    let readings = weighted * gram.try_inverse().expect("the nodes of a body of some cells are not in line");
    for reading in readings.column_iter() {
        rows.push(reading.iter().enumerate().filter(|(_, weight)| **weight != 0.0).map(|(node, &weight)| (node as u32, weight)));
    }
}
