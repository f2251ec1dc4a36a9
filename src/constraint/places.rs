//! Entries of a distributed vector as one rank sees them: its own, then copies of those of other ranks that it asks for.

use std::ops::Range;

use crate::{
    error::Result,
    petsc::{Scatter, Vector},
};

/// Collects the entries that this rank asks for: its own keep their place in its part, others come behind it.
pub struct Places {
    own: Range<usize>,
    others: Vec<i32>,
}

impl Places {
    /// Nothing asked for yet of vectors shaped like `vector`.
    pub fn new(vector: &Vector) -> Result<Places> {
        Ok(Places { own: vector.range()?, others: Vec::new() })
    }

    /// The place of the first of `length` entries that follow each other on one rank, from the number of it on all ranks.
    pub fn of(&mut self, first: usize, length: usize) -> u32 {
        if self.own.contains(&first) {
            return (first - self.own.start) as u32;
        }
        let place = self.own.len() + self.others.len();
        self.others.extend((first..first + length).map(|entry| entry as i32));
        place as u32
    }

    /// What brings the entries of other ranks.
    pub fn scatter(&self, vector: &Vector) -> Result<Scatter> {
        Scatter::new(vector, &self.others)
    }
}

/// The entries from a place on: in this rank's own part, or among those of others.
pub fn from<'a>(own: &'a [f64], others: &'a [f64], place: u32) -> &'a [f64] {
    let place = place as usize;
    if place < own.len() { &own[place..] } else { &others[place - own.len()..] }
}
