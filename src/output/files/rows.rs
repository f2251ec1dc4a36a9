//! Rows of numbers that belong to bodies, held by ranks in any shares, in the order of the bodies: each rank gets one block of them to write.

use std::ops::Range;

use crate::parallel::{Peers, World};

/// Parts in which rows go from rank to rank, so that they are not in memory twice.
const PARTS: usize = 16;

/// A block of rows.
pub struct Rows {
    /// Numbers of a row.
    width: usize,
    /// Rows of all ranks, and those of the ranks before.
    total: usize,
    start: usize,
    values: Vec<f64>,
}

impl Rows {
    /// Rows of `width` numbers, the first of which is that of the body, one of so many. A rank hands in its rows in the order of these numbers,
    /// and all rows of a body are on one rank, in an order of their own that stays. Collective.
    pub fn in_order(world: &World, bodies: usize, width: usize, values: Vec<f64>) -> Rows {
        let values = if world.size() == 1 { values } else { sorted(width, exchanged(world, bodies, width, values)) };
        let counts: Vec<u64> = world.gather(&[(values.len() / width) as u64]);
        let sum = |counts: &[u64]| counts.iter().sum::<u64>() as usize;
        Rows { width, total: sum(&counts), start: sum(&counts[..world.rank()]), values }
    }

    /// Rows of all ranks.
    pub fn total(&self) -> usize {
        self.total
    }

    /// The places of this rank's rows among all of them.
    pub fn places(&self) -> Range<usize> {
        self.start..self.start + self.values.len() / self.width
    }

    /// Some of the numbers of each row, one row after the other.
    pub fn columns<T>(&self, columns: Range<usize>, number: impl Fn(f64) -> T) -> Vec<T> {
        let mut values = Vec::with_capacity(self.places().len() * columns.len());
        self.values.chunks_exact(self.width).for_each(|row| values.extend(row[columns.clone()].iter().map(|&value| number(value))));
        values
    }
}

/// The rows of the bodies of which this rank gets the block. They go in parts, the last first, and leave as they go.
fn exchanged(world: &World, bodies: usize, width: usize, mut values: Vec<f64>) -> Vec<f64> {
    let (peers, mut gathered) = (Peers::All(world), Vec::new());
    for part in (0..PARTS).rev() {
        let mut first = values.len() / width * part / (part + 1) * width;
        // rows of a body go together, so that they come in their order
        while first > 0 && first < values.len() && values[first] == values[first - width] {
            first -= width;
        }
        let mut letters = vec![0; world.size()];
        values[first..].chunks_exact(width).for_each(|row| letters[owner(row[0] as usize, bodies, world.size())] += width);
        gathered.extend(peers.send(&values[first..], &letters).0);
        values.truncate(first);
        values.shrink_to_fit();
    }
    gathered
}

/// The rank to whose share a body belongs, as [`World::share`] has it.
fn owner(body: usize, bodies: usize, ranks: usize) -> usize {
    ((body + 1) * ranks - 1) / bodies
}

/// Rows by the numbers of their bodies; those of a body stay as they are.
fn sorted(width: usize, mut values: Vec<f64>) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len() / width).collect();
    order.sort_by_key(|&row| values[row * width] as usize);
    // from cycle to cycle, without a second copy of all
    for start in 0..order.len() {
        let first = values[start * width..(start + 1) * width].to_vec();
        let mut place = start;
        while order[place] != place {
            let from = std::mem::replace(&mut order[place], place);
            if from == start {
                values[place * width..(place + 1) * width].copy_from_slice(&first);
            } else {
                values.copy_within(from * width..(from + 1) * width, place * width);
                place = from;
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_belongs_to_the_rank_whose_share_it_is_in() {
        for (bodies, ranks) in [(1, 1), (1, 3), (7, 3), (12, 4), (1000, 7)] {
            for rank in 0..ranks {
                for body in crate::parallel::share(bodies, rank, ranks) {
                    assert_eq!(owner(body, bodies, ranks), rank, "body {body} of {bodies} on {ranks} ranks");
                }
            }
        }
    }

    #[test]
    fn rows_of_a_body_keep_their_order() {
        let values = vec![3.0, 1.0, 1.0, 2.0, 3.0, 0.0, 0.0, 9.0];
        assert_eq!(sorted(2, values), [0.0, 9.0, 1.0, 2.0, 3.0, 1.0, 3.0, 0.0]);
        let rows: Vec<[f64; 2]> = (0..200).map(|row| [f64::from(row * 37 % 61), f64::from(row)]).collect();
        let mut expected = rows.clone();
        expected.sort_by(|one, two| one[0].total_cmp(&two[0]));
        assert_eq!(sorted(2, rows.into_flattened()), expected.into_flattened());
    }
}
