//! Rigid clusters: balls that are welded together and move as one body.
//!
//! Each ball but the first of a cluster is tied to the nearest of those before it, at the distance `r`, by rows without compliance:
//!
//! ```text
//! v_j - v_i - w_i x r = 0          a (w_j - w_i) = 0          a: radius of the first ball
//! ```
//!
//! Their forces and torques are the internal ones of the cluster, unknowns of the coupled system. Balls of a cluster neither touch nor lubricate each
//! other, as nothing between them moves.

use std::rc::Rc;

use nalgebra::{SMatrix, SVector};

use super::{Cluster, Groups, Interaction, Ties};
use crate::body::{RigidFunctional, Row, planes, skew};

/// All clusters.
#[derive(Debug, Clone, PartialEq)]
pub struct Welds<const D: usize> {
    clusters: Rc<Vec<Cluster<D>>>,
    /// For each body the number of its cluster, from 1 on; 0 for a ball of its own.
    cluster_of: Rc<Vec<usize>>,
}

impl<const D: usize> Welds<D> {
    /// The welds of some clusters of so many bodies.
    pub fn new(clusters: Vec<Cluster<D>>, bodies: usize) -> Welds<D> {
        let mut cluster_of = vec![0; bodies];
        clusters.iter().zip(1..).for_each(|(cluster, number)| cluster_of[cluster.bodies.clone()].fill(number));
        Welds { clusters: Rc::new(clusters), cluster_of: Rc::new(cluster_of) }
    }
}

impl<const D: usize> Interaction<D> for Welds<D> {
    fn name(&self) -> &'static str {
        "clusters"
    }

    fn describe(&self) -> String {
        let rows: usize = self.clusters.iter().map(|cluster| (cluster.bodies.len() - 1) * (D + planes::<D>().len())).sum();
        format!(
            "{} rigid clusters of {} balls, each with one motion (in a fluid {rows} rows of the coupled system)",
            self.clusters.len(),
            self.cluster_of.iter().filter(|&&of| of > 0).count()
        )
    }

    fn ties(&self) -> Option<&dyn Ties<D>> {
        Some(self)
    }
}

impl<const D: usize> Ties<D> for Welds<D> {
    fn groups(&self) -> Groups<'_, D> {
        Groups { clusters: &self.clusters, cluster_of: &self.cluster_of, turns: true, ..Groups::default() }
    }

    fn welds(&self, centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
        self.clusters.iter().flat_map(|cluster| cluster.pairs().flat_map(|pair| rows(pair, cluster.radius, centers))).collect()
    }

    fn bonds(&self) -> Vec<[usize; 2]> {
        self.clusters.iter().flat_map(Cluster::pairs).collect()
    }
}

/// The rows of a ball that is tied to another, the first radius being such.
fn rows<const D: usize>([ball, to]: [usize; 2], radius: f64, centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
    let arm = centers[ball] - centers[to];
    let row = |own: RigidFunctional<D>, other: RigidFunctional<D>| Row::new(vec![(to, other), (ball, own)], 0.0, 0.0);
    let along = |axis: usize| {
        let direction: SVector<f64, D> = SVector::from_fn(|other, _| f64::from(other == axis));
        let turn = direction * arm.transpose() - arm * direction.transpose();
        row(RigidFunctional { direction, turn: SMatrix::zeros() }, RigidFunctional { direction: -direction, turn: -turn })
    };
    let about = |plane: usize| {
        let unit: Vec<f64> = (0..planes::<D>().len()).map(|other| if other == plane { radius } else { 0.0 }).collect();
        let [own, other] = [1.0, -1.0].map(|sign| RigidFunctional { direction: SVector::zeros(), turn: skew(&unit) * sign });
        row(own, other)
    };
    (0..D).map(along).chain((0..planes::<D>().len()).map(about)).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::{body::Twist, geometry::Ball};

    /// Rows vanish for rigid motions and for no others, and their forces have neither a net force nor a net torque.
    #[test]
    fn rows_see_all_motions_but_rigid_ones() {
        let balls: Vec<Ball<3>> = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.9, 0.3], [0.4, 0.2, -1.1]]
            .map(|center| Ball { center: Vector3::from(center), radius: 0.5 })
            .to_vec();
        let centers: Vec<Vector3<f64>> = balls.iter().map(|ball| ball.center).collect();
        let rows = Welds::new(vec![Cluster::new(0, &balls)], 4).welds(&centers);
        assert_eq!(rows.len(), 18);
        let (velocity, spin) = (Vector3::new(0.3, -0.2, 0.5), skew(&[0.7, 0.1, -0.4]));
        let rigid: Vec<Twist<3>> = centers.iter().map(|center| Twist { velocity: velocity + spin * center, spin }).collect();
        let rate = |row: &Row<3>| row.ends.iter().map(|(body, side)| side.rate(&rigid[*body])).sum::<f64>();
        assert!(rows.iter().all(|row| rate(row).abs() < 1e-15));
        for row in &rows {
            let stress = row.stress(1.0, &centers);
            assert!(row.ends.iter().map(|(_, push)| push.direction).sum::<Vector3<f64>>().norm() < 1e-15);
            assert!((stress - stress.transpose()).norm() < 1e-15, "{stress}");
        }
    }
}
