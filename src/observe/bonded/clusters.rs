//! How rigid clusters lie.

use nalgebra::{SMatrix, SVector};

use crate::{
    interaction::{Cluster, Interactions},
    mechanics::State,
    parallel::World,
};

/// The mean of `p p` over all clusters, `p` being the unit vector along the longest axis of each; of one cluster it is the orientation itself. Nothing
/// without clusters. Collective.
pub fn mean_orientation<const D: usize>(world: &World, interactions: &Interactions<D>, state: &State<D>) -> Option<SMatrix<f64, D, D>> {
    let clusters = interactions.clusters();
    if clusters.is_empty() {
        return None;
    }
    let square = |cluster: &Cluster<D>| {
        let axis = state.bodies[state.place(cluster.bodies.start)?].rotation * longest_axis(cluster);
        Some(axis * axis.transpose())
    };
    let mut sum: SMatrix<f64, D, D> = clusters.iter().filter_map(square).sum();
    state.peers(world).sum(sum.as_mut_slice());
    Some(sum / clusters.len() as f64)
}

/// The direction from its first ball to the farthest from that, at the start.
fn longest_axis<const D: usize>(cluster: &Cluster<D>) -> SVector<f64, D> {
    let arms = cluster.offsets.iter().map(|offset| offset - cluster.offsets[0]);
    arms.max_by(|one, other| one.norm().total_cmp(&other.norm())).map_or(SVector::zeros(), |arm| arm.normalize())
}
