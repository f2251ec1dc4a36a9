//! How rigid clusters lie.

use nalgebra::{SMatrix, SVector};

use super::chains::in_space;
use crate::{
    interaction::{Cluster, Interactions},
    parallel::World,
    setup::State,
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
pub fn longest_axis<const D: usize>(cluster: &Cluster<D>) -> SVector<f64, D> {
    let arms = cluster.offsets.iter().map(|offset| offset - cluster.offsets[0]);
    arms.max_by(|one, other| one.norm().total_cmp(&other.norm())).map_or(SVector::zeros(), |arm| arm.normalize())
}

/// The longest over the shortest axis of the ellipse or ellipsoid whose second moments are those of the balls of a cluster, which weigh alike.
pub fn aspect_ratio<const D: usize>(cluster: &Cluster<D>) -> f64 {
    let count = cluster.offsets.len() as f64;
    let spread = cluster.offsets.iter().map(|offset| offset * offset.transpose()).sum::<SMatrix<f64, D, D>>() / count;
    let mut squares: Vec<f64> = in_space(&spread).symmetric_eigenvalues().iter().map(|square| square.max(0.0)).collect();
    squares.sort_by(|one, other| other.total_cmp(one));
    // the mean square of a coordinate over a disk or a ball
    let of_ball = cluster.radius.powi(2) / (D + 2) as f64;
    ((squares[0] + of_ball) / (squares[D - 1] + of_ball)).sqrt()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::*;
    use crate::geometry::Ball;

    #[test]
    fn the_aspect_ratio_is_that_of_second_moments() {
        for radius in [1.0, 1e-6] {
            // disks at -1 and 1 radii: 1 + 1/4 over 1/4
            let flat = [-1.0, 1.0].map(|place| Ball { center: Vector2::new(0.6, 0.8) * (radius * place), radius });
            assert!((aspect_ratio(&Cluster::new(0, &flat)) - 5.0_f64.sqrt()).abs() < 1e-7);
            // balls: 1 + 1/5 over 1/5
            let in_space = [-1.0, 1.0].map(|place| Ball { center: Vector3::z() * (radius * place), radius });
            assert!((aspect_ratio(&Cluster::new(0, &in_space)) - 6.0_f64.sqrt()).abs() < 1e-7);
        }
    }
}
