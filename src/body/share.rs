//! Shares of many bodies: which of them a rank moves, what it must know of the others, and sums that do not depend on the number of ranks.
//!
//! Bodies come in blocks of fixed size. A rank has whole blocks, one after the other; sums are over the bodies of a block in order, then
//! over all blocks in order.

use std::ops::Range;

use nalgebra::SVector;

use crate::parallel::{Shares, World};

/// Bodies of a block; fewer are not worth messages.
pub(super) const BLOCK: usize = 1 << 14;

/// The bodies that a rank moves.
pub(super) struct Share<'a> {
    /// The ranks, if several share the bodies.
    world: Option<&'a World>,
    /// Where the share of each rank starts, and the number of all bodies.
    starts: Vec<usize>,
    /// The bodies of this rank.
    pub own: Range<usize>,
}

impl<'a> Share<'a> {
    /// The share of this rank in so many bodies: all of them if there are no ranks, or not more than one block.
    pub fn new(world: Option<&'a World>, count: usize) -> Self {
        let blocks = count.div_ceil(BLOCK);
        let world = world.filter(|world| world.size() > 1 && blocks > 1);
        let (rank, size) = world.map_or((0, 1), |world| (world.rank(), world.size()));
        let starts: Vec<usize> = (0..=size).map(|rank| (blocks * rank / size * BLOCK).min(count)).collect();
        Self { world, own: starts[rank]..starts[rank + 1], starts }
    }

    /// The place of a body among those of this rank, if it is one.
    pub fn place(&self, body: usize) -> Option<usize> {
        self.own.contains(&body).then(|| body - self.own.start)
    }

    /// How many blocks this rank has.
    pub fn blocks(&self) -> usize {
        self.own.len().div_ceil(BLOCK)
    }

    /// The sum of terms over all bodies, from those of this rank's bodies by their places; collective.
    pub fn sum<const K: usize>(&self, terms: impl Fn(usize) -> [f64; K]) -> [f64; K] {
        let block = |block: usize| add((BLOCK * block..(BLOCK * (block + 1)).min(self.own.len())).map(&terms));
        let blocks: Vec<[f64; K]> = (0..self.blocks()).map(block).collect();
        self.sum_of_blocks(&blocks)
    }

    /// The sum over all blocks, from those of this rank; collective.
    pub fn sum_of_blocks<const K: usize>(&self, blocks: &[[f64; K]]) -> [f64; K] {
        match self.world {
            None => add(blocks.iter().copied()),
            Some(world) => add(world.gather(blocks.as_flattened()).chunks_exact(K).map(|sums| std::array::from_fn(|k| sums[k]))),
        }
    }

    /// The sum of a whole number over the ranks; collective.
    pub fn count(&self, own: usize) -> usize {
        self.world.map_or(own, |world| world.gather(&[own as u64]).into_iter().sum::<u64>() as usize)
    }

    /// Makes the centres of all bodies known, of which each rank knows those of its own; collective.
    pub fn gather<const D: usize>(&self, centers: &mut [SVector<f64, D>]) {
        let Some(world) = self.world else { return };
        let own: Vec<f64> = centers[self.own.clone()].iter().flat_map(|center| center.iter().copied()).collect();
        for (center, numbers) in centers.iter_mut().zip(world.gather(&own).chunks_exact(D)) {
            center.copy_from_slice(numbers);
        }
    }
}

fn add<const K: usize>(terms: impl Iterator<Item = [f64; K]>) -> [f64; K] {
    terms.fold([0.0; K], |sums, terms| std::array::from_fn(|k| sums[k] + terms[k]))
}

/// Centres of other ranks' bodies that a rank must know, and centres that others must know of it.
pub(super) struct Halo {
    sent: Vec<usize>,
    sent_counts: Vec<i32>,
    received: Vec<usize>,
    received_counts: Vec<i32>,
}

impl Halo {
    /// For a rank that must know bodies of others, sorted; collective.
    pub fn new(share: &Share, needed: Vec<usize>) -> Self {
        let place = |start: &usize| needed.partition_point(|body| body < start);
        let received_counts: Vec<i32> = share.starts.windows(2).map(|ends| (place(&ends[1]) - place(&ends[0])) as i32).collect();
        let Some(world) = share.world else {
            return Self { sent: Vec::new(), sent_counts: Vec::new(), received: Vec::new(), received_counts };
        };
        let one_each = || Shares::new(vec![1; world.size()]);
        let mut sent_counts = vec![0; world.size()];
        world.exchange(&received_counts, &one_each(), &mut sent_counts, &one_each());
        let asked: Vec<u64> = needed.iter().map(|&body| body as u64).collect();
        let shares = Shares::new(sent_counts.clone());
        let mut sent = vec![0; shares.total()];
        world.exchange(&asked, &Shares::new(received_counts.clone()), &mut sent, &shares);
        Self { sent: sent.into_iter().map(|body: u64| body as usize).collect(), sent_counts, received: needed, received_counts }
    }

    /// Makes the centres that this rank must know those that they are; collective.
    pub fn update<const D: usize>(&self, share: &Share, centers: &mut [SVector<f64, D>]) {
        let Some(world) = share.world else { return };
        let sent: Vec<f64> = self.sent.iter().flat_map(|&body| centers[body].iter().copied()).collect();
        let shares = |counts: &[i32]| Shares::new(counts.iter().map(|count| count * D as i32).collect());
        let mut received = vec![0.0; D * self.received.len()];
        world.exchange(&sent, &shares(&self.sent_counts), &mut received, &shares(&self.received_counts));
        for (&body, numbers) in self.received.iter().zip(received.chunks_exact(D)) {
            centers[body].copy_from_slice(numbers);
        }
    }
}
