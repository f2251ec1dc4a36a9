//! The factors of `I + A^T W A` for any weights `W >= 0` of the constraints of a program, again and again with one analysis.
//!
//! The matrix couples bodies that share a constraint. Bodies are eliminated in the order of the least degree, several at once: the
//! columns of such a group and the rows that they reach are a dense matrix, the front; what elimination leaves of it is added to the front of
//! the group that is next to touch it (multifrontal method, Duff and Reid 1983, doi:10.1145/356044.356047). Constraints
//! enter the front of the first of their bodies to go, whole.

mod dense;
mod fronts;
mod order;

use self::{
    dense::{eliminate, subtract},
    fronts::Element,
};
pub use self::{
    fronts::{Front, fronts},
    order::Order,
};
use super::program::Program;
use crate::linalg::dot;

/// The factors, and where they go.
pub(super) struct Cholesky<'a> {
    program: &'a Program<'a>,
    /// Bodies in the order of elimination.
    order: Vec<usize>,
    fronts: Vec<Front>,
    /// The factored columns of all fronts, column by column.
    panels: Vec<f64>,
    /// Memory of what elimination leaves, to be used again.
    spare: Vec<Vec<f64>>,
}

impl<'a> Cholesky<'a> {
    /// Analyses a program; nothing is factored yet.
    pub fn new(program: &'a Program<'a>) -> Self {
        let touches: Vec<[usize; 2]> = (0..program.offsets.len()).map(|constraint| program.bodies(constraint)).collect();
        let order = Order::new(program.transposed.m / program.width, &touches);
        let fronts = fronts(&order, &touches, program.width);
        let size = fronts.last().map_or(0, |front| front.panel.end);
        Self { program, order: order.bodies, fronts, panels: vec![0.0; size], spare: Vec::new() }
    }

    /// Factors the matrix of these weights.
    pub fn factor(&mut self, weights: &[f64]) {
        match self.program.width {
            2 => self.factor_blocks::<2>(weights),
            3 => self.factor_blocks::<3>(weights),
            width => panic!("bodies move along 2 or 3 axes, not {width}"),
        }
    }

    fn factor_blocks<const D: usize>(&mut self, weights: &[f64]) {
        let Self { program, fronts, panels, spare, .. } = self;
        let mut left = vec![Vec::new(); fronts.len()];
        for (number, front) in fronts.iter().enumerate() {
            let mut rest = spare.pop().unwrap_or_default();
            rest.clear();
            rest.resize(front.below * front.below, 0.0);
            let mut sum = Sum::<D> { front, panel: &mut panels[front.panel.clone()], rest: &mut rest };
            sum.start();
            for element in &front.elements {
                let entries = program.values(element.constraint).as_chunks().0;
                sum.add_element(element, entries, weights[element.constraint]);
            }
            for &child in &front.children {
                let update = std::mem::take(&mut left[child]);
                sum.add_front(&fronts[child], &update);
                spare.push(update);
            }
            let height = front.width + front.below;
            eliminate(sum.panel, height, front.width);
            subtract(sum.panel, height, front.width, sum.rest);
            left[number] = rest;
        }
        spare.extend(left.into_iter().filter(|rest| rest.capacity() > 0));
    }

    /// Turns a right-hand side into the solution.
    pub fn solve(&self, vector: &mut [f64]) {
        let width = self.program.width;
        let mut sorted = Vec::with_capacity(vector.len());
        self.order.iter().for_each(|&body| sorted.extend_from_slice(&vector[body * width..(body + 1) * width]));
        let mut below = Vec::new();
        for front in &self.fronts {
            self.forward(front, &mut sorted, &mut below);
        }
        for front in self.fronts.iter().rev() {
            self.backward(front, &mut sorted, &mut below);
        }
        for (place, &body) in self.order.iter().enumerate() {
            vector[body * width..(body + 1) * width].copy_from_slice(&sorted[place * width..(place + 1) * width]);
        }
    }

    fn forward(&self, front: &Front, vector: &mut [f64], below: &mut Vec<f64>) {
        let start = front.columns.start * self.program.width;
        below.clear();
        below.resize(front.below, 0.0);
        for (column, entries) in self.panels[front.panel.clone()].chunks_exact(front.width + front.below).enumerate() {
            let own = &mut vector[start..start + front.width];
            let value = own[column] / entries[column];
            own[column] = value;
            own[column + 1..].iter_mut().zip(&entries[column + 1..]).for_each(|(own, entry)| *own -= value * entry);
            below.iter_mut().zip(&entries[front.width..]).for_each(|(below, entry)| *below += value * entry);
        }
        for (&row, below) in front.rows.iter().zip(below.chunks_exact(self.program.width)) {
            vector[row * self.program.width..].iter_mut().zip(below).for_each(|(entry, below)| *entry -= below);
        }
    }

    fn backward(&self, front: &Front, vector: &mut [f64], below: &mut Vec<f64>) {
        let start = front.columns.start * self.program.width;
        below.clear();
        front.rows.iter().for_each(|row| below.extend_from_slice(&vector[row * self.program.width..(row + 1) * self.program.width]));
        let own = &mut vector[start..start + front.width];
        for (column, entries) in self.panels[front.panel.clone()].chunks_exact(front.width + front.below).enumerate().rev() {
            let known = dot(&entries[front.width..], below) + dot(&entries[column + 1..front.width], &own[column + 1..]);
            own[column] = (own[column] - known) / entries[column];
        }
    }
}

/// The lower half of a front, with blocks of `D` rows and columns.
struct Sum<'a, const D: usize> {
    front: &'a Front,
    /// The columns to eliminate, of full height.
    panel: &'a mut [f64],
    /// All others, below the rows of the first.
    rest: &'a mut [f64],
}

impl<const D: usize> Sum<'_, D> {
    /// The unit matrix in the columns to eliminate.
    fn start(&mut self) {
        let height = self.front.width + self.front.below;
        self.panel.fill(0.0);
        self.panel.iter_mut().step_by(height + 1).take(self.front.width).for_each(|diagonal| *diagonal = 1.0);
    }

    /// The part of a column from a block row on down.
    fn column(&mut self, column: usize, row: usize) -> &mut [f64] {
        let Front { width, below, .. } = *self.front;
        if column < width {
            &mut self.panel[column * (width + below)..][row * D..width + below]
        } else {
            &mut self.rest[(column - width) * below..][row * D - width..below]
        }
    }

    /// A constraint times its weight.
    fn add_element(&mut self, element: &Element, entries: &[[f64; D]], weight: f64) {
        let places = element.places();
        for (column, ours) in places.iter().zip(entries) {
            for (row, theirs) in places.iter().zip(entries).filter(|(row, _)| *row >= column) {
                for (axis, entry) in ours.iter().enumerate() {
                    let factor = weight * entry;
                    let target = self.column(column * D + axis, *row);
                    target[..D].iter_mut().zip(theirs).for_each(|(target, entry)| *target += factor * entry);
                }
            }
        }
    }

    /// What the elimination of another front left.
    fn add_front(&mut self, child: &Front, update: &[f64]) {
        for (number, source) in update.chunks_exact(child.below).enumerate() {
            let (place, axis) = (number / D, number % D);
            let first = child.relative[place];
            let target = self.column(first * D + axis, first);
            let mut start = place;
            for &end in &child.runs[child.runs.partition_point(|&end| end <= place)..] {
                let target = &mut target[(child.relative[start] - first) * D..];
                target.iter_mut().zip(&source[start * D..end * D]).for_each(|(target, value)| *target += value);
                start = end;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use clarabel::algebra::CscMatrix;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Constraints of one body or two, some of them twice, on a random graph.
    fn program(bodies: usize, width: usize, seed: u64) -> Program<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for _ in 0..3 * bodies {
            let mut ends = [(); 2].map(|()| random.random_range(0..bodies));
            ends.sort_unstable();
            let touched = if ends[0] == ends[1] { &ends[..1] } else { &ends[..] };
            for body in touched {
                rows.extend(body * width..(body + 1) * width);
                values.extend((0..width).map(|_| random.random::<f64>() - 0.5));
            }
            starts.push(rows.len());
        }
        let count = starts.len() - 1;
        Program { transposed: CscMatrix::new(bodies * width, count, starts, rows, values), width, offsets: vec![0.0; count], sharing: None }
    }

    #[test]
    fn a_solution_gives_its_right_hand_side_back() {
        for (bodies, width, seed) in [(1, 2, 0), (2, 3, 1), (40, 2, 2), (40, 3, 3), (300, 2, 4), (300, 3, 5)] {
            let program = program(bodies, width, seed);
            let mut factors = Cholesky::new(&program);
            // the second time over what the first left
            for power in [0, 4] {
                let weights: Vec<f64> = (0..program.offsets.len()).map(|row| (row % 3) as f64 * 10f64.powi(power)).collect();
                let expected: Vec<f64> = (0..bodies * width).map(|place| (place % 7) as f64 - 3.0).collect();
                let (mut changes, mut vector) = (vec![0.0; weights.len()], vec![0.0; expected.len()]);
                program.apply(&expected, &mut changes);
                changes.iter_mut().zip(&weights).for_each(|(change, weight)| *change *= weight);
                program.apply_transpose(&changes, &mut vector);
                vector.iter_mut().zip(&expected).for_each(|(entry, expected)| *entry += expected);
                factors.factor(&weights);
                factors.solve(&mut vector);
                let error = vector.iter().zip(&expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
                assert!(error < 1e-9, "{bodies} bodies along {width} axes, weights to 1e{power}: {error:e}");
            }
        }
    }
}
