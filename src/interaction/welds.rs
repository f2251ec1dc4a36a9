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

use std::{ops::Range, rc::Rc};

use nalgebra::{SMatrix, SVector};

use super::{BondRow, Interaction};
use crate::{
    body::{planes, skew},
    constraint::lubrication::RigidFunctional,
    geometry::Ball,
};

/// Balls that share one motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster<const D: usize> {
    /// The balls, all of one radius.
    pub bodies: Range<usize>,
    /// Their centres at the start, from their mean.
    pub offsets: Vec<SVector<f64, D>>,
    /// Which ball of those before it each is tied to; the first one to itself. Counted from the first.
    tied_to: Vec<usize>,
    /// Radius of its balls.
    pub radius: f64,
}

impl<const D: usize> Cluster<D> {
    /// The cluster of balls numbered from `first`, where they are at the start.
    ///
    /// # Panics
    /// If there is none.
    pub fn new(first: usize, balls: &[Ball<D>]) -> Cluster<D> {
        let middle = balls.iter().map(|ball| ball.center).sum::<SVector<f64, D>>() / balls.len() as f64;
        let offsets: Vec<SVector<f64, D>> = balls.iter().map(|ball| ball.center - middle).collect();
        let tied_to = (0..offsets.len()).map(|ball| nearest(&offsets[..ball], &offsets[ball])).collect();
        Cluster { bodies: first..first + balls.len(), offsets, tied_to, radius: balls[0].radius }
    }

    /// Distance of two of its balls; nothing if one is none of them.
    pub fn distance(&self, balls: [usize; 2]) -> Option<f64> {
        let offset = |ball: usize| self.bodies.contains(&ball).then(|| self.offsets[ball - self.bodies.start]);
        Some((offset(balls[0])? - offset(balls[1])?).norm())
    }

    /// The balls that each ball but the first is tied to.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        self.bodies.clone().zip(&self.tied_to).skip(1).map(|(ball, to)| [ball, self.bodies.start + to])
    }

    /// The rows of a ball that is tied to another.
    fn rows(&self, [ball, to]: [usize; 2], centers: &[SVector<f64, D>]) -> Vec<BondRow<D>> {
        let arm = centers[ball] - centers[to];
        let row = |own: RigidFunctional<D>, other: RigidFunctional<D>| BondRow {
            ends: vec![(to, other), (ball, own)],
            rate: 0.0,
            compliance: 0.0,
        };
        let along = |axis: usize| {
            let direction: SVector<f64, D> = SVector::from_fn(|other, _| f64::from(other == axis));
            let turn = direction * arm.transpose() - arm * direction.transpose();
            row(RigidFunctional { direction, turn: SMatrix::zeros() }, RigidFunctional { direction: -direction, turn: -turn })
        };
        let about = |plane: usize| {
            let unit: Vec<f64> = (0..planes::<D>().len()).map(|other| if other == plane { self.radius } else { 0.0 }).collect();
            let [own, other] = [1.0, -1.0].map(|sign| RigidFunctional { direction: SVector::zeros(), turn: skew(&unit) * sign });
            row(own, other)
        };
        (0..D).map(along).chain((0..planes::<D>().len()).map(about)).collect()
    }
}

/// The place of the nearest of some; 0 if there are none.
fn nearest<const D: usize>(places: &[SVector<f64, D>], to: &SVector<f64, D>) -> usize {
    let distance = |&place: &usize| (places[place] - to).norm();
    (0..places.len()).min_by(|one, other| distance(one).total_cmp(&distance(other))).unwrap_or(0)
}

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
            "{} rigid clusters of {} balls: {rows} rows of the coupled system",
            self.clusters.len(),
            self.cluster_of.iter().filter(|&&of| of > 0).count()
        )
    }

    fn welds(&self, centers: &[SVector<f64, D>]) -> Vec<BondRow<D>> {
        self.clusters.iter().flat_map(|cluster| cluster.pairs().flat_map(|pair| cluster.rows(pair, centers))).collect()
    }

    fn clusters(&self) -> &[Cluster<D>] {
        &self.clusters
    }

    fn cluster_of(&self) -> &[usize] {
        &self.cluster_of
    }

    fn bonds(&self) -> Vec<[usize; 2]> {
        self.clusters.iter().flat_map(Cluster::pairs).collect()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::body::Twist;

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
        let rate = |row: &BondRow<3>| row.ends.iter().map(|(body, side)| side.rate(&rigid[*body])).sum::<f64>();
        assert!(rows.iter().all(|row| rate(row).abs() < 1e-15));
        for row in &rows {
            let stress = row.stress(1.0, &centers);
            assert!(row.ends.iter().map(|(_, push)| push.direction).sum::<Vector3<f64>>().norm() < 1e-15);
            assert!((stress - stress.transpose()).norm() < 1e-15, "{stress}");
        }
    }
}
