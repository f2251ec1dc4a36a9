//! Entries of a distributed vector as one rank sees them: its own, then copies of those of other ranks that it asks for.

use std::{collections::BTreeMap, ops::Range};

use crate::{
    error::Result,
    petsc::{Scatter, Vector},
};

/// Collects the entries that this rank asks for: its own keep their place in its part, others come behind it.
pub struct Places {
    own: Range<usize>,
    others: Vec<usize>,
    /// Those that are to be asked for once, by the number of the first.
    shared: BTreeMap<usize, u32>,
}

/// Entries to read.
#[derive(Clone, Copy)]
pub struct Entries<'a> {
    /// This rank's part.
    pub own: &'a [f64],
    /// Those of other ranks that were asked for.
    pub others: &'a [f64],
}

/// Entries to add to.
pub struct EntriesMut<'a> {
    /// This rank's part.
    pub own: &'a mut [f64],
    /// Those of other ranks that were asked for.
    pub others: &'a mut [f64],
}

impl Places {
    /// Nothing asked for yet of vectors shaped like `vector`.
    pub fn new(vector: &Vector) -> Result<Places> {
        Ok(Places { own: vector.range()?, others: Vec::new(), shared: BTreeMap::new() })
    }

    /// The place of the first of `length` entries that follow each other on one rank, from the number of it on all ranks.
    pub fn of(&mut self, first: usize, length: usize) -> u32 {
        if self.own.contains(&first) {
            return (first - self.own.start) as u32;
        }
        let place = self.own.len() + self.others.len();
        self.others.extend(first..first + length);
        place as u32
    }

    /// The same of entries that several ask for in this way: they come once.
    pub fn of_shared(&mut self, first: usize, length: usize) -> u32 {
        if let Some(&place) = self.shared.get(&first) {
            return place;
        }
        let place = self.of(first, length);
        self.shared.insert(first, place);
        place
    }

    /// The places of single entries.
    pub fn each(&mut self, unknowns: &[usize]) -> Vec<u32> {
        unknowns.iter().map(|&unknown| self.of(unknown, 1)).collect()
    }

    /// What brings the entries of other ranks.
    pub fn scatter(&self, vector: &Vector) -> Result<Scatter> {
        Scatter::new(vector, &self.others)
    }
}

impl<'a> Entries<'a> {
    /// The entries from a place on: in this rank's own part, or among those of others.
    #[inline]
    pub fn from(self, place: u32) -> &'a [f64] {
        let place = place as usize;
        if place < self.own.len() { &self.own[place..] } else { &self.others[place - self.own.len()..] }
    }
}

impl EntriesMut<'_> {
    /// The entries from a place on: in this rank's own part, or among those of others.
    pub fn from(&mut self, place: u32) -> &mut [f64] {
        let place = place as usize;
        if place < self.own.len() { &mut self.own[place..] } else { &mut self.others[place - self.own.len()..] }
    }

    /// The entry at a place.
    #[inline]
    pub fn at(&mut self, place: u32) -> &mut f64 {
        let place = place as usize;
        if place < self.own.len() { &mut self.own[place] } else { &mut self.others[place - self.own.len()] }
    }
}
