//! Rows of numbers that belong to bodies, held by ranks in any shares, in the order of the bodies: each rank gets one block of them to write.

use std::ops::Range;

use crate::parallel::{Shares, World};

/// A block of rows.
pub(super) struct Rows {
    /// Numbers of a row.
    width: usize,
    /// Rows of all ranks, and those of the ranks before.
    total: usize,
    start: usize,
    values: Vec<f64>,
}

impl Rows {
    /// Rows of `width` numbers, the first of which is that of the body, one of so many. A rank hands in its rows in the order of these numbers,
    /// and all rows of a body are on one rank. Collective; takes as much memory again as the rows of a rank.
    pub fn in_order(world: &World, bodies: usize, width: usize, values: Vec<f64>) -> Rows {
        let values = if world.size() == 1 { values } else { sorted(width, exchanged(world, bodies, width, &values)) };
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

/// The rows of the bodies of which this rank gets the block, one rank's after the other's.
fn exchanged(world: &World, bodies: usize, width: usize, values: &[f64]) -> Vec<f64> {
    let mut sent = vec![0; world.size()];
    values.chunks_exact(width).for_each(|row| sent[owner(row[0] as usize, bodies, world.size())] += width as i32);
    let mut received = vec![0; world.size()];
    let one_each = || Shares::new(vec![1; world.size()]);
    world.exchange(&sent, &one_each(), &mut received, &one_each());
    let (sent, received) = (Shares::new(sent), Shares::new(received));
    let mut gathered = vec![0.0; received.total()];
    world.exchange(values, &sent, &mut gathered, &received);
    gathered
}

/// The rank to whose share a body belongs, as [`World::share`] has it.
fn owner(body: usize, bodies: usize, ranks: usize) -> usize {
    ((body + 1) * ranks - 1) / bodies
}

/// Rows by the numbers of their bodies; those of a body stay as they are.
fn sorted(width: usize, values: Vec<f64>) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len() / width).collect();
    if order.is_sorted_by_key(|&row| values[row * width] as usize) {
        return values;
    }
    order.sort_by_key(|&row| values[row * width] as usize);
    order.into_iter().flat_map(|row| values[row * width..][..width].iter().copied()).collect()
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
    }
}
