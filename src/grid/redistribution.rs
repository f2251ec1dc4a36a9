//! Moving lattice values from one way of sharing them out over the ranks to another.

use std::ops::Range;

use mpi::traits::Equivalence;

use super::partition::Block;
use crate::parallel::{Shares, World};

/// A block of a lattice for every rank; no index belongs to two.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockLayout<const D: usize>(pub Vec<Block<D>>);

impl<const D: usize> BlockLayout<D> {
    /// Most indices that a rank has.
    pub fn largest(&self) -> usize {
        self.0.iter().map(Block::len).max().unwrap_or(0)
    }
}

/// A plan that moves several fields at once between two layouts, there and back.
///
/// In this rank's part of a layout the fields lie one after the other, each in the order of the block.
pub struct Redistribution {
    from: TransferSide,
    to: TransferSide,
}

/// What this rank exchanges of its part of one layout.
struct TransferSide {
    fields: usize,
    /// Indices of the block.
    extent: usize,
    /// For each rank the places in the block of what is exchanged with it.
    runs: Vec<Vec<Range<usize>>>,
    shares: Shares,
}

/// What is under way between ranks.
#[derive(Default)]
pub struct Exchange<T> {
    sent: Vec<T>,
    received: Vec<T>,
}

impl Redistribution {
    /// Plans the way of `fields` fields as seen from `rank`; nothing where nothing has to move.
    pub fn new<const D: usize>(from: &BlockLayout<D>, to: &BlockLayout<D>, rank: usize, fields: usize) -> Option<Redistribution> {
        (from != to)
            .then(|| Redistribution { from: TransferSide::new(from, to, rank, fields), to: TransferSide::new(to, from, rank, fields) })
    }

    /// Moves values from the first layout to the second.
    pub fn forward<T: Equivalence + Copy>(&self, world: &World, values: &mut [T], exchange: &mut Exchange<T>) {
        exchange.run(world, &self.from, &self.to, values);
    }

    /// Moves values from the second layout to the first.
    pub fn backward<T: Equivalence + Copy>(&self, world: &World, values: &mut [T], exchange: &mut Exchange<T>) {
        exchange.run(world, &self.to, &self.from, values);
    }
}

impl TransferSide {
    fn new<const D: usize>(own: &BlockLayout<D>, other: &BlockLayout<D>, rank: usize, fields: usize) -> TransferSide {
        let block = own.0[rank];
        let runs: Vec<Vec<Range<usize>>> = other.0.iter().map(|other| block.runs(block.intersection(other))).collect();
        let count = |runs: &Vec<Range<usize>>| (fields * runs.iter().map(Range::len).sum::<usize>()) as i32;
        let shares = Shares::new(runs.iter().map(count).collect());
        TransferSide { fields, extent: block.len(), runs, shares }
    }

    /// The places in this rank's part of what is exchanged, rank by rank, field by field.
    fn places(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let place = |field: usize, run: &Range<usize>| field * self.extent + run.start..field * self.extent + run.end;
        self.runs.iter().flat_map(move |runs| (0..self.fields).flat_map(move |field| runs.iter().map(move |run| place(field, run))))
    }
}

impl<T: Equivalence + Copy> Exchange<T> {
    /// Buffers for the plans given, to be filled with `value` first.
    pub fn new<'a>(plans: impl IntoIterator<Item = &'a Redistribution>, value: T) -> Exchange<T> {
        let most = |plan: &Redistribution| plan.from.shares.total().max(plan.to.shares.total());
        let size = plans.into_iter().map(most).max().unwrap_or(0);
        Exchange { sent: vec![value; size], received: vec![value; size] }
    }

    fn run(&mut self, world: &World, from: &TransferSide, to: &TransferSide, values: &mut [T]) {
        let mut start = 0;
        for place in from.places() {
            let end = start + place.len();
            self.sent[start..end].copy_from_slice(&values[place]);
            start = end;
        }
        world.exchange(&self.sent, &from.shares, &mut self.received, &to.shares);
        start = 0;
        for place in to.places() {
            let end = start + place.len();
            values[place.clone()].copy_from_slice(&self.received[start..end]);
            start = end;
        }
    }
}
