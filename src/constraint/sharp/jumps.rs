//! Jump functions of all modes of a body at chosen nodes.

use super::nodes::JumpNodes;
use crate::{
    constraint::placed::Placed,
    linalg::{add_rows, padded},
};

const EMPTY: u32 = u32::MAX;

/// Jump functions on the lattice of one field, at those nodes for which they were asked.
#[derive(Default)]
pub struct Jumps {
    /// Length of a row of `values`.
    stride: usize,
    /// For each node, its row in `values`.
    rows: Vec<u32>,
    chosen: Vec<u32>,
    values: Vec<f64>,
}

impl Jumps {
    /// Turns to another body and other nodes, and forgets those asked for.
    pub fn turn_to<const D: usize>(&mut self, placed: &Placed<D>, nodes: &JumpNodes<D>) {
        self.stride = padded(placed.surface.modes.jump_count());
        self.chosen.drain(..).for_each(|place| self.rows[place as usize] = EMPTY);
        self.rows.resize(nodes.indices.len(), EMPTY);
    }

    /// Asks for the node at a place; returns its row.
    pub fn choose(&mut self, place: usize) -> u32 {
        if self.rows[place] == EMPTY {
            self.rows[place] = self.chosen.len() as u32;
            self.chosen.push(place as u32);
        }
        self.rows[place]
    }

    /// The row of a node; senseless if it was not asked for.
    pub fn row(&self, place: usize) -> u32 {
        self.rows[place]
    }

    /// Whether a node was asked for.
    pub fn has(&self, place: usize) -> bool {
        self.rows[place] != EMPTY
    }

    /// Whether no node was asked for.
    pub fn is_empty(&self) -> bool {
        self.chosen.is_empty()
    }

    /// Length of a row: one value a mode, and some more.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Evaluates the jump functions of a body; all but pressures are zero within `core` of its centre.
    pub fn evaluate<const D: usize>(&mut self, nodes: &JumpNodes<D>, placed: &Placed<D>, core: f64) {
        let positions = self.chosen.iter().map(|&place| nodes.position(place as usize) - placed.center);
        let offsets: Vec<f64> = positions.flat_map(|offset| offset.data.0[0]).collect();
        let length = self.chosen.len() * self.stride;
        if self.values.len() < length {
            self.values.resize(length, 0.0);
        }
        let values = &mut self.values[..length];
        placed.surface.modes.jumps(&offsets, nodes.field, values);
        if nodes.field == placed.surface.modes.components() {
            return;
        }
        for (offset, values) in offsets.chunks_exact(D).zip(values.chunks_exact_mut(self.stride)) {
            if offset.iter().map(|x| x * x).sum::<f64>() <= core * core {
                values.fill(0.0);
            }
        }
    }

    /// Adds to `out`, a row, a weighted sum of evaluated rows.
    pub fn add(&self, terms: &[(u32, f64)], out: &mut [f64]) {
        add_rows(terms, &self.values, out);
    }
}
