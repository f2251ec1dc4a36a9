//! Rows of C of one body: dense in its multipliers.

use super::{dense::dot, places::Places};

/// Rows, each with the unknown of the fluid to which it belongs.
#[derive(Default)]
pub struct Rows {
    /// Indices in fluid vectors; once planned, places.
    pub unknowns: Vec<u32>,
    /// Values, multipliers running fastest.
    pub values: Vec<f64>,
}

impl Rows {
    /// Turns the unknowns into places.
    pub fn plan(&mut self, places: &mut Places) {
        self.unknowns.iter_mut().for_each(|unknown| *unknown = places.of(*unknown as usize, 1));
    }

    /// Adds `factor * C c` to the rows of this rank and of others, with the multipliers `c` of the body.
    pub fn add(&self, factor: f64, c: &[f64], own: &mut [f64], others: &mut [f64]) {
        for (place, values) in self.unknowns.iter().zip(self.values.chunks_exact(c.len())) {
            let place = *place as usize;
            let row = if place < own.len() { &mut own[place] } else { &mut others[place - own.len()] };
            *row += factor * dot(values, c);
        }
    }
}
