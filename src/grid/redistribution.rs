//! Moving lattice values from one way of sharing them out over the ranks to another.

use std::ops::Range;

use mpi::traits::Equivalence;

use super::partition::Block;
use crate::parallel::World;

/// A block of a lattice for every rank; no index belongs to two.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockLayout<const D: usize>(pub Vec<Block<D>>);

impl<const D: usize> BlockLayout<D> {
    /// Most indices that a rank has.
    pub fn largest(&self) -> usize {
        self.0.iter().map(Block::len).max().unwrap_or(0)
    }

    /// Messages to other ranks, and indices in all of them, on the way to another layout: those of the rank that has most.
    pub fn sent_to(&self, other: &BlockLayout<D>) -> (usize, usize) {
        let busiest = (0..self.0.len()).max_by_key(|&rank| self.0[rank].len()).unwrap_or(0);
        let others = (0..other.0.len()).filter(|&rank| rank != busiest);
        let common = others.map(|rank| self.0[busiest].intersection(&other.0[rank]).len()).filter(|&common| common > 0);
        common.fold((0, 0), |(messages, indices), common| (messages + 1, indices + common))
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
    rank: usize,
    /// With each rank that has a part of it in the other layout, this one included.
    shares: Vec<GridShare>,
}

/// What is exchanged with one rank.
struct GridShare {
    rank: usize,
    /// Its places in the block.
    runs: Vec<Range<usize>>,
    /// Its place in buffers.
    buffer: Range<usize>,
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
        let mut shares = Vec::new();
        let mut start = 0;
        for (other, its) in other.0.iter().enumerate() {
            let runs = block.runs(block.intersection(its));
            let end = start + fields * runs.iter().map(Range::len).sum::<usize>();
            if end > start {
                shares.push(GridShare { rank: other, runs, buffer: start..end });
            }
            start = end;
        }
        TransferSide { fields, extent: block.len(), rank, shares }
    }

    /// Values exchanged.
    fn total(&self) -> usize {
        self.shares.last().map_or(0, |share| share.buffer.end)
    }

    /// The places of a share in this rank's part, field by field.
    fn places<'a>(&'a self, share: &'a GridShare) -> impl Iterator<Item = Range<usize>> + 'a {
        (0..self.fields)
            .flat_map(move |field| share.runs.iter().map(move |run| field * self.extent + run.start..field * self.extent + run.end))
    }

    /// What is sent to other ranks out of a buffer.
    fn outgoing<'a, T>(&self, buffer: &'a [T]) -> Vec<(usize, &'a [T])> {
        let others = self.shares.iter().filter(|share| share.rank != self.rank);
        others.map(|share| (share.rank, &buffer[share.buffer.clone()])).collect()
    }

    /// Where in a buffer goes what comes from other ranks.
    fn incoming<'a, T>(&self, mut buffer: &'a mut [T]) -> Vec<(usize, &'a mut [T])> {
        let mut places = Vec::new();
        for share in &self.shares {
            let (place, rest) = buffer.split_at_mut(share.buffer.len());
            buffer = rest;
            if share.rank != self.rank {
                places.push((share.rank, place));
            }
        }
        places
    }

    /// What this rank keeps, in a buffer.
    fn kept<'a, T>(&self, buffer: &'a [T]) -> &'a [T] {
        let kept = self.shares.iter().find(|share| share.rank == self.rank);
        kept.map_or(&[], |share| &buffer[share.buffer.clone()])
    }
}

impl<T: Equivalence + Copy> Exchange<T> {
    /// Buffers for the plans given, to be filled with `value` first.
    pub fn new<'a>(plans: impl IntoIterator<Item = &'a Redistribution>, value: T) -> Exchange<T> {
        let most = |plan: &Redistribution| plan.from.total().max(plan.to.total());
        let size = plans.into_iter().map(most).max().unwrap_or(0);
        Exchange { sent: vec![value; size], received: vec![value; size] }
    }

    fn run(&mut self, world: &World, from: &TransferSide, to: &TransferSide, values: &mut [T]) {
        let mut start = 0;
        for place in from.shares.iter().flat_map(|share| from.places(share)) {
            let end = start + place.len();
            self.sent[start..end].copy_from_slice(&values[place]);
            start = end;
        }
        world.transfer(&from.outgoing(&self.sent), to.incoming(&mut self.received));
        for share in &to.shares {
            let mut come = if share.rank == to.rank { from.kept(&self.sent) } else { &self.received[share.buffer.clone()] };
            for place in to.places(share) {
                let (here, rest) = come.split_at(place.len());
                values[place].copy_from_slice(here);
                come = rest;
            }
        }
    }
}
