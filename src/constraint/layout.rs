//! Who holds which multipliers.

use nalgebra::SVector;

use crate::grid::Grid;

/// Numbering of the multipliers: each rank holds those of the bodies whose centres lie in its cells, in body order.
#[derive(Debug, Clone, PartialEq)]
pub struct MultiplierLayout {
    /// This rank's bodies.
    pub local_bodies: Vec<usize>,
    /// For each of all bodies: the index of its first multiplier in the owner's part and on all ranks, their number, and its own.
    places: Vec<BodyPlace>,
    local_unknowns: usize,
    unknowns: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct BodyPlace {
    local: usize,
    global: usize,
    count: usize,
    number: usize,
    owner: usize,
}

impl MultiplierLayout {
    /// Shares out bodies with the given centres (in the box) and numbers of multipliers, seen from `rank`.
    pub fn new<const D: usize>(grid: &Grid<D>, centers: &[SVector<f64, D>], counts: &[usize], rank: usize) -> MultiplierLayout {
        let owners: Vec<usize> = centers.iter().map(|center| grid.owner(center)).collect();
        let mut places = vec![BodyPlace { local: 0, global: 0, count: 0, number: 0, owner: 0 }; centers.len()];
        let (mut unknowns, mut local_unknowns, mut number) = (0, 0, 0);
        for owner in 0..grid.partition().blocks() {
            let start = unknowns;
            for body in (0..centers.len()).filter(|&body| owners[body] == owner) {
                places[body] = BodyPlace { local: unknowns - start, global: unknowns, count: counts[body], number, owner };
                (unknowns, number) = (unknowns + counts[body], number + 1);
            }
            if owner == rank {
                local_unknowns = unknowns - start;
            }
        }
        let local_bodies = (0..centers.len()).filter(|&body| owners[body] == rank).collect();
        MultiplierLayout { local_bodies, places, local_unknowns, unknowns }
    }

    /// Whether this rank holds a body.
    pub fn holds(&self, body: usize) -> bool {
        self.local_bodies.binary_search(&body).is_ok()
    }

    /// Whether this rank holds one of some bodies.
    pub fn holds_any(&self, bodies: impl IntoIterator<Item = usize>) -> bool {
        bodies.into_iter().any(|body| self.holds(body))
    }

    /// Index of a body's first multiplier in its owner's part.
    pub fn local(&self, body: usize) -> usize {
        self.places[body].local
    }

    /// Number of a body's multipliers.
    pub fn count(&self, body: usize) -> usize {
        self.places[body].count
    }

    /// Index of a body's first multiplier on all ranks.
    pub fn global(&self, body: usize) -> usize {
        self.places[body].global
    }

    /// The place of a body among all: those of the first rank come first.
    pub fn number(&self, body: usize) -> usize {
        self.places[body].number
    }

    /// The rank that holds a body.
    pub fn owner(&self, body: usize) -> usize {
        self.places[body].owner
    }

    /// Number of bodies on all ranks.
    pub fn bodies(&self) -> usize {
        self.places.len()
    }

    /// Number of multipliers on this rank.
    pub fn local_unknowns(&self) -> usize {
        self.local_unknowns
    }

    /// Number of multipliers on all ranks.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }
}
