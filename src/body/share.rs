//! Shares of many bodies: which of them a rank moves, what it must know of the others, and sums that do not depend on the number of ranks.
//!
//! Bodies come in blocks of fixed size. A rank has whole blocks, one after the other; sums are over the bodies of a block in order, then
//! over all blocks in order.

use std::ops::Range;

use nalgebra::SVector;

use crate::parallel::{Peers, Routes, share};

/// Bodies of a block; fewer are not worth messages.
pub(super) const BLOCK: usize = 1 << 14;

/// The bodies that a rank moves.
pub(super) struct BodyShare<'a> {
    /// The ranks that share the bodies.
    pub peers: Peers<'a>,
    /// Where the share of each rank starts, and the number of all bodies.
    starts: Vec<usize>,
    /// The bodies of this rank.
    pub own: Range<usize>,
}

impl<'a> BodyShare<'a> {
    /// The share of this rank in so many bodies: all of them if there is not more than one block.
    pub fn new(peers: Peers<'a>, count: usize) -> Self {
        let blocks = count.div_ceil(BLOCK);
        let peers = if blocks > 1 { peers } else { Peers::Alone };
        let starts: Vec<usize> = (0..=peers.count()).map(|rank| (share(blocks, rank, peers.count()).start * BLOCK).min(count)).collect();
        Self { peers, own: starts[peers.rank()]..starts[peers.rank() + 1], starts }
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
        add(self.peers.gather(blocks.as_flattened()).as_chunks().0.iter().copied())
    }

    /// The sum of a whole number over the ranks; collective.
    pub fn count(&self, own: usize) -> usize {
        self.peers.gather(&[own as u64]).into_iter().sum::<u64>() as usize
    }

    /// Makes the centres of all bodies known, of which each rank knows those of its own; collective.
    pub fn gather<const D: usize>(&self, centers: &mut [SVector<f64, D>]) {
        if self.peers.count() == 1 {
            return;
        }
        let own: Vec<f64> = centers[self.own.clone()].iter().flat_map(|center| center.iter().copied()).collect();
        for (center, numbers) in centers.iter_mut().zip(self.peers.gather(&own).chunks_exact(D)) {
            center.copy_from_slice(numbers);
        }
    }
}

fn add<const K: usize>(terms: impl Iterator<Item = [f64; K]>) -> [f64; K] {
    terms.fold([0.0; K], |sums, terms| std::array::from_fn(|k| sums[k] + terms[k]))
}

/// Centres of other ranks' bodies that a rank must know, and centres that others must know of it.
pub(super) struct NeededCenters {
    bodies: Vec<usize>,
    routes: Routes,
}

impl NeededCenters {
    /// For a rank that must know bodies of others, sorted; collective.
    pub fn new(share: &BodyShare, bodies: Vec<usize>) -> Self {
        let place = |start: usize| bodies.partition_point(|&body| body < start);
        let wanted: Vec<Vec<usize>> = share.starts.windows(2).map(|ends| bodies[place(ends[0])..place(ends[1])].to_vec()).collect();
        Self { routes: Routes::asking(share.peers, &wanted), bodies }
    }

    /// Makes the centres that this rank must know those that they are; collective.
    pub fn update<const D: usize>(&self, share: &BodyShare, centers: &mut [SVector<f64, D>]) {
        let known = self.routes.copies::<D>(share.peers, |body| centers[body].into());
        self.bodies.iter().zip(known).for_each(|(&body, center)| centers[body] = center.into());
    }
}
