//! Joints of chains: beads that turn with the line of their chain, as fibres do, where beads on free joints turn on their own.
//!
//! Rows without compliance, with `c` from the neighbour before a bead to that after it (from itself at an end) and `n` across it:
//!
//! ```text
//! n . (v_after - v_before - w_i x c) = 0          a t . (w_j - w_i) = 0 in 3D, t along the bond from bead i to bead j
//! ```
//!
//! The first keep a bead's axis along the chain, the second keep neighbours from turning about it against each other. A chain of rods that does not bend
//! then moves as a rigid cluster of its beads.

use std::{ops::Range, rc::Rc};

use nalgebra::{SMatrix, SVector};

use super::{Groups, Interaction, Ties};
use crate::body::{RigidFunctional, Row, skew};

/// The beads of a chain on fixed joints.
#[derive(Debug, Clone, PartialEq)]
pub struct JointedChain {
    /// One after the other.
    pub beads: Range<usize>,
    /// Whether the last one is tied to the first; in 2D.
    pub ring: bool,
}

/// The joints of all chains that have fixed ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Joints {
    /// The chains.
    pub chains: Rc<Vec<JointedChain>>,
}

impl<const D: usize> Interaction<D> for Joints {
    fn name(&self) -> &'static str {
        "joints"
    }

    fn describe(&self) -> String {
        let beads: usize = self.chains.iter().map(|chain| chain.beads.len()).sum();
        let twists = if D == 3 { beads - self.chains.len() } else { 0 };
        format!("{beads} beads that turn with the line of their chain: {} rows of the coupled system", beads * (D - 1) + twists)
    }

    fn ties(&self) -> Option<&dyn Ties<D>> {
        Some(self)
    }
}

impl<const D: usize> Ties<D> for Joints {
    fn groups(&self) -> Groups<'_, D> {
        Groups { turns: true, ..Groups::default() }
    }

    fn welds(&self, centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
        self.chains.iter().flat_map(|chain| chain.rows(centers)).collect()
    }
}

impl JointedChain {
    fn rows<const D: usize>(&self, centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
        let Range { start, end } = self.beads;
        let count = end - start;
        let along = self.beads.clone().flat_map(|bead| {
            let [before, after] = match self.ring {
                true => [start + (bead - start + count - 1) % count, start + (bead - start + 1) % count],
                false => [bead.saturating_sub(1).max(start), (bead + 1).min(end - 1)],
            };
            let chord = centers[after] - centers[before];
            across(&chord).into_iter().map(move |normal| of_axis(bead, [before, after], &normal, &chord))
        });
        let bonds = if D == 3 { start + 1..end } else { 0..0 };
        along.chain(bonds.map(|bead| of_twist([bead - 1, bead], centers))).collect()
    }
}

fn row<const D: usize>(ends: Vec<(usize, RigidFunctional<D>)>) -> Row<D> {
    Row::new(ends, 0.0, 0.0)
}

/// How a chord turns to a side across it, less how a bead turns to it.
fn of_axis<const D: usize>(bead: usize, [before, after]: [usize; 2], normal: &SVector<f64, D>, chord: &SVector<f64, D>) -> Row<D> {
    let none = RigidFunctional { direction: SVector::zeros(), turn: SMatrix::zeros() };
    let mut ends = vec![(before, RigidFunctional { direction: -normal, ..none }), (after, RigidFunctional { direction: *normal, ..none })];
    let turn = chord * normal.transpose() - normal * chord.transpose();
    match ends.iter_mut().find(|(end, _)| *end == bead) {
        Some((_, end)) => end.turn = turn,
        None => ends.push((bead, RigidFunctional { turn, ..none })),
    }
    row(ends)
}

/// How the second of two beads turns about their bond, less how the first does; times half their distance.
fn of_twist<const D: usize>([one, other]: [usize; 2], centers: &[SVector<f64, D>]) -> Row<D> {
    let bond = (centers[other] - centers[one]) * 0.5;
    let side = |sign: f64| RigidFunctional { direction: SVector::zeros(), turn: skew::<D>(bond.as_slice()) * sign };
    row(vec![(one, side(-1.0)), (other, side(1.0))])
}

/// Unit vectors across another vector and each other.
fn across<const D: usize>(chord: &SVector<f64, D>) -> Vec<SVector<f64, D>> {
    let mut found = vec![chord.normalize()];
    while found.len() < D {
        let length = |axis: usize| found.iter().map(|unit| unit[axis] * unit[axis]).sum::<f64>();
        let axis = (0..D).min_by(|&one, &other| length(one).total_cmp(&length(other))).unwrap_or(0);
        let mut next = SVector::<f64, D>::zeros();
        next[axis] = 1.0;
        found.iter().for_each(|unit| next -= unit * unit[axis]);
        found.push(next.normalize());
    }
    found.split_off(1)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::*;
    use crate::body::Twist;

    fn proof<const D: usize>(centers: &[SVector<f64, D>], ring: bool, spin: SMatrix<f64, D, D>, count: usize) {
        let joints = Joints { chains: Rc::new(vec![JointedChain { beads: 0..centers.len(), ring }]) };
        let rows = joints.welds(centers);
        assert_eq!(rows.len(), count);
        let velocity = SVector::from_fn(|axis, _| 0.3 - 0.4 * axis as f64);
        let rate = |row: &Row<D>, twists: &[Twist<D>]| row.ends.iter().map(|(body, side)| side.rate(&twists[*body])).sum::<f64>();
        let mut twists: Vec<Twist<D>> = centers.iter().map(|center| Twist { velocity: velocity + spin * center, spin }).collect();
        for row in &rows {
            let stress = row.stress(1.0, centers);
            assert!(rate(row, &twists).abs() < 1e-14, "{row:?}");
            assert!(row.ends.iter().map(|(_, push)| push.direction).sum::<SVector<f64, D>>().norm() < 1e-14);
            assert!((stress - stress.transpose()).norm() < 1e-14, "{stress}");
        }
        for bead in 0..centers.len() {
            twists[bead].spin *= 2.0;
            assert!(rows.iter().any(|row| rate(row, &twists).abs() > 1e-2), "{bead} turns on its own");
            twists[bead].spin = spin;
        }
    }

    /// Rows vanish where a chain moves as one and nowhere else, and their forces have neither a net force nor a net torque.
    #[test]
    fn beads_turn_with_their_chain_and_rows_push_and_turn_nothing_as_a_whole() {
        let plane = [[0.1, 0.0], [1.0, 0.4], [2.1, 0.2], [1.5, 1.4]].map(Vector2::from);
        proof(&plane, false, skew(&[0.7]), 4);
        proof(&plane, true, skew(&[0.7]), 4);
        let space = [[0.1, 0.0, 0.2], [1.0, 0.4, -0.3], [2.1, 0.2, 0.1], [2.5, 1.4, 0.7]].map(Vector3::from);
        proof(&space, false, skew(&[0.7, 0.1, -0.4]), 11);
    }
}
