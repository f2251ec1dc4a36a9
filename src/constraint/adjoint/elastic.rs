//! An approximate inverse for the extra stresses in a body: an elastic body of the same stiffness in vacuum.
//!
//! Stresses in equilibrium move nothing, so that `B K^-1 B^T` (`B`: strains without trace) alone sees them not at all, and
//! the small compliance of a stiff inside has to tell them apart: without this inverse iterations grow like the cells of a
//! radius (82 to 548 from 5 to 40 of them; now about 20). With the nodes of the body alone,
//!
//! ```text
//! B K^-1 B^T  ~  B (2 B^T B + g D^T D)^+ B^T         D: divergence, g large
//! ```
//!
//! where both sides vanish on the same stresses and the left one is at most a few times smaller elsewhere; a shift of the fluid's operator
//! is added to `2 B^T B`, as masses of the nodes. Its sum with the compliance
//! `k` is inverted by `k^-1 - k^-1 B (2 B^T B + g D^T D + B^T k^-1 B)^-1 B^T k^-1`.

use super::nodes::AdjointNodes;
use crate::linalg::{Skyline, SparseRows};

/// Resistance `g` of the body to changes of volume; 18 iterations at 1e3 as at 1e6, 35 at 10.
const INCOMPRESSIBILITY: f64 = 1e3;

/// Least compliance that is taken as it is: below it iterations stay the same, and rounding would be felt.
const LEAST_COMPLIANCE: f64 = 1e-4;

/// Stiffness against rigid motions, which no stress drives.
const HOLD: f64 = 1e-8;

/// The inverse.
pub struct ElasticInverse {
    strains: SparseRows,
    stiffness: Vec<f64>,
    factor: Skyline,
    /// Place of each node in the factor.
    order: Vec<usize>,
}

impl ElasticInverse {
    /// For strains and divergences over the nodes of a body, the compliance of each strain, and the shift of the fluid's operator.
    pub fn new<const D: usize>(
        nodes: &AdjointNodes<D>,
        strains: SparseRows,
        divergences: &SparseRows,
        compliances: &[f64],
        shift: f64,
    ) -> ElasticInverse {
        let stiffness: Vec<f64> = compliances.iter().map(|compliance| 1.0 / compliance.max(LEAST_COMPLIANCE)).collect();
        let order = order(nodes);
        let weighted = || {
            let strains = strains.iter().zip(&stiffness).map(|(row, stiffness)| (row, 2.0 + stiffness));
            strains.chain(divergences.iter().map(|row| (row, INCOMPRESSIBILITY)))
        };
        let mut firsts: Vec<usize> = (0..nodes.count()).collect();
        let (mut largest, places) =
            (0.0_f64, |row: &[(u32, f64)]| row.iter().map(|&(node, weight)| (order[node as usize], weight)).collect::<Vec<_>>());
        for (row, _) in weighted() {
            let places = places(row);
            let first = places.iter().map(|&(place, _)| place).min().unwrap_or(0);
            places.iter().for_each(|&(place, weight)| {
                firsts[place] = firsts[place].min(first);
                largest = largest.max(weight * weight);
            });
        }
        let mut matrix = Skyline::new(firsts);
        for (row, factor) in weighted() {
            let places = places(row);
            for &(place, weight) in &places {
                places
                    .iter()
                    .filter(|(other, _)| *other <= place)
                    .for_each(|(other, of_other)| matrix.add(place, *other, factor * weight * of_other));
            }
        }
        (0..nodes.count()).for_each(|place| matrix.add(place, place, HOLD * largest + shift));
        ElasticInverse { strains, stiffness, factor: matrix.factor(), order }
    }

    /// The stresses of given strains.
    pub fn apply(&self, strains: &[f64]) -> Vec<f64> {
        let mut stresses: Vec<f64> = strains.iter().zip(&self.stiffness).map(|(strain, stiffness)| stiffness * strain).collect();
        let forces = self.strains.apply_transpose(&stresses, self.order.len());
        let mut moved = vec![0.0; forces.len()];
        self.order.iter().zip(forces).for_each(|(&place, force)| moved[place] = force);
        self.factor.solve(&mut moved);
        let moved: Vec<f64> = self.order.iter().map(|&place| moved[place]).collect();
        let relieved = self.strains.apply(&moved);
        stresses.iter_mut().zip(relieved).zip(&self.stiffness).for_each(|((stress, strain), stiffness)| *stress -= stiffness * strain);
        stresses
    }
}

/// The place of each node when they are taken plane by plane, which keeps neighbours close.
fn order<const D: usize>(nodes: &AdjointNodes<D>) -> Vec<usize> {
    let mut sorted: Vec<usize> = (0..nodes.count()).collect();
    let along = |&node: &usize, axis: usize| nodes.offsets[node][axis];
    sorted.sort_by(|one, other| {
        let axes = (0..D).map(|axis| along(one, axis).total_cmp(&along(other, axis)));
        axes.fold(std::cmp::Ordering::Equal, |known, next| known.then(next))
    });
    let mut order = vec![0; sorted.len()];
    sorted.into_iter().enumerate().for_each(|(place, node)| order[node] = place);
    order
}
