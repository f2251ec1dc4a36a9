//! How evenly ranks share the work of a run, and what they send.

use serde::{Deserialize, Serialize};

use crate::{
    parallel::{World, peak_memory_bytes},
    petsc::Traffic,
};

/// A quantity of which each rank has its own amount.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Over the ranks.
    pub least: f64,
    /// Over the ranks.
    pub most: f64,
    /// Over the ranks.
    pub mean: f64,
}

/// The ranks of a run; traffic is that of the whole run until the summary was made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ParallelSummary {
    /// Bodies whose centres lie in the part of the box that is a rank's.
    pub bodies: Spread,
    /// Cells of the grid; zero without a fluid.
    pub cells: Spread,
    /// Messages sent to single ranks; hypre's are not counted.
    pub messages: Spread,
    /// Bytes sent by PETSc, and contributed to this program's own collectives; hypre's are not counted.
    pub bytes: Spread,
    /// Reductions, gatherings, broadcasts and barriers; hypre's are not counted.
    pub collectives: Spread,
    /// Bytes that came in gatherings.
    pub gathered: Spread,
    /// Peak memory.
    pub memory_bytes: Spread,
}

impl Spread {
    /// Of amounts, one for each rank; all zero if there are none.
    pub fn of(amounts: impl IntoIterator<Item = f64>) -> Spread {
        let amounts: Vec<f64> = amounts.into_iter().collect();
        let Some(&first) = amounts.first() else { return Spread::default() };
        Spread {
            least: amounts.iter().copied().fold(first, f64::min),
            most: amounts.iter().copied().fold(first, f64::max),
            mean: amounts.iter().sum::<f64>() / amounts.len() as f64,
        }
    }

    /// The largest amount over the mean; 1 is even.
    pub fn imbalance(&self) -> f64 {
        if self.mean > 0.0 { self.most / self.mean } else { 1.0 }
    }
}

impl ParallelSummary {
    /// Of ranks that hold so many bodies and cells, this one's given; collective.
    pub(super) fn new(world: &World, bodies: usize, cells: usize) -> ParallelSummary {
        let Traffic { messages, bytes, collectives, gathered } = Traffic::local_so_far();
        let local = [bodies as f64, cells as f64, messages, bytes, collectives, gathered, peak_memory_bytes()];
        let all = world.gather(&local);
        let [bodies, cells, messages, bytes, collectives, gathered, memory_bytes] =
            std::array::from_fn(|column| Spread::of(all.chunks(local.len()).map(|rank| rank[column])));
        ParallelSummary { bodies, cells, messages, bytes, collectives, gathered, memory_bytes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_imbalance_is_the_largest_share_over_the_mean() {
        let spread = Spread::of([1.0, 2.0, 6.0]);
        assert_eq!((spread.least, spread.most, spread.mean, spread.imbalance()), (1.0, 6.0, 3.0, 2.0));
        assert_eq!(Spread::of([]).imbalance(), 1.0);
    }
}
