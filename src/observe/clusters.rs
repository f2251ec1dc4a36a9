//! How rigid clusters lie.

use nalgebra::{SMatrix, SVector};

use crate::{
    interaction::Cluster,
    simulation::{Setup, State},
};

/// The mean of `p p` over all clusters, `p` being the unit vector along the longest axis of each; of one cluster it is the orientation itself. Nothing
/// without clusters. The state must hold all bodies.
pub fn mean_orientation<const D: usize>(setup: &Setup<D>, state: &State<D>) -> Option<SMatrix<f64, D, D>> {
    let squares: Vec<SMatrix<f64, D, D>> = setup
        .interactions
        .clusters()
        .iter()
        .map(|cluster| {
            let axis = state.bodies[cluster.bodies.start].rotation * longest_axis(cluster);
            axis * axis.transpose()
        })
        .collect();
    (!squares.is_empty()).then(|| squares.iter().sum::<SMatrix<f64, D, D>>() / squares.len() as f64)
}

/// The direction from its first ball to the farthest from that, at the start.
fn longest_axis<const D: usize>(cluster: &Cluster<D>) -> SVector<f64, D> {
    let ways = cluster.offsets.iter().map(|offset| offset - cluster.offsets[0]);
    ways.max_by(|one, other| one.norm().total_cmp(&other.norm())).map_or(SVector::zeros(), |way| way.normalize())
}
