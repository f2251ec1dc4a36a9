//! The factors of `I + sum A_c^T C_c A_c` where the small matrices `C_c` of the constraints are not symmetric: the pattern is, so that the fronts are those of
//! the symmetric [factors](super::cholesky). Without pivoting; a pivot that vanishes is told.

use super::cholesky::{Front, Order, fronts};

/// The blocks that a constraint adds: those of its first and second body, row by row, `width` rows and columns each, all four in the order
/// (1, 1), (1, 2), (2, 1), (2, 2). A constraint of one body has the first alone.
pub type Blocks = Vec<f64>;

/// The factors, and where they go.
pub struct BlockLu {
    width: usize,
    /// Bodies in the order of elimination.
    order: Vec<usize>,
    fronts: Vec<Front>,
    /// Of each front its eliminated columns, of full height, and its eliminated rows to the right of them.
    factors: Vec<[Vec<f64>; 2]>,
}

impl BlockLu {
    /// Analyses constraints between the two bodies that each touches, which may be the same, with so many unknowns each.
    pub fn new(bodies: usize, width: usize, touches: &[[usize; 2]]) -> BlockLu {
        let order = Order::new(bodies, touches);
        let fronts = fronts(&order, touches, width);
        BlockLu { width, order: order.bodies, factors: vec![[Vec::new(), Vec::new()]; fronts.len()], fronts }
    }

    /// Factors the matrix of these constraints; whether no pivot vanished.
    pub fn factor(&mut self, blocks: impl Fn(usize) -> Blocks) -> bool {
        let mut left: Vec<Vec<f64>> = vec![Vec::new(); self.fronts.len()];
        for number in 0..self.fronts.len() {
            let front = &self.fronts[number];
            let mut matrix = FrontMatrix::unit(front, self.width);
            front.elements.iter().for_each(|element| matrix.add_blocks(element.places(), &blocks(element.constraint)));
            for &child in &front.children {
                matrix.add_update(&self.fronts[child].relative, &std::mem::take(&mut left[child]));
            }
            if !matrix.eliminate(front.width) {
                return false;
            }
            left[number] = matrix.split(front.width, &mut self.factors[number]);
        }
        true
    }

    /// Turns a right-hand side into the solution.
    pub fn solve(&self, vector: &mut [f64]) {
        let width = self.width;
        let mut sorted: Vec<f64> = Vec::with_capacity(vector.len());
        self.order.iter().for_each(|&body| sorted.extend_from_slice(&vector[body * width..(body + 1) * width]));
        self.fronts.iter().zip(&self.factors).for_each(|(front, [lower, _])| self.forward(front, lower, &mut sorted));
        self.fronts.iter().zip(&self.factors).rev().for_each(|(front, factors)| self.backward(front, factors, &mut sorted));
        for (place, &body) in self.order.iter().enumerate() {
            vector[body * width..(body + 1) * width].copy_from_slice(&sorted[place * width..(place + 1) * width]);
        }
    }

    fn forward(&self, front: &Front, lower: &[f64], vector: &mut [f64]) {
        let start = front.columns.start * self.width;
        let mut below = vec![0.0; front.below];
        for (column, entries) in lower.chunks_exact(front.width + front.below).enumerate() {
            let value = vector[start + column];
            subtract(&mut vector[start + column + 1..start + front.width], &entries[column + 1..front.width], value);
            subtract(&mut below, &entries[front.width..], value);
        }
        for (&row, below) in front.rows.iter().zip(below.chunks_exact(self.width)) {
            vector[row * self.width..].iter_mut().zip(below).for_each(|(entry, below)| *entry += below);
        }
    }

    fn backward(&self, front: &Front, [lower, upper]: &[Vec<f64>; 2], vector: &mut [f64]) {
        let start = front.columns.start * self.width;
        let below: Vec<f64> = front.rows.iter().flat_map(|row| vector[row * self.width..(row + 1) * self.width].iter().copied()).collect();
        let own = &mut vector[start..start + front.width];
        upper.chunks_exact(front.width).zip(&below).for_each(|(entries, &value)| subtract(own, entries, value));
        for (column, entries) in lower.chunks_exact(front.width + front.below).enumerate().rev() {
            own[column] /= entries[column];
            let value = own[column];
            subtract(&mut own[..column], &entries[..column], value);
        }
    }
}

/// Takes a multiple of a vector from another.
fn subtract(target: &mut [f64], entries: &[f64], factor: f64) {
    target.iter_mut().zip(entries).for_each(|(target, entry)| *target -= factor * entry);
}

/// The dense matrix of a front, column by column.
struct FrontMatrix {
    width: usize,
    height: usize,
    entries: Vec<f64>,
}

impl FrontMatrix {
    /// Ones on the diagonal of what is eliminated.
    fn unit(front: &Front, width: usize) -> FrontMatrix {
        let height = front.width + front.below;
        let mut entries = vec![0.0; height * height];
        entries.iter_mut().step_by(height + 1).take(front.width).for_each(|diagonal| *diagonal = 1.0);
        FrontMatrix { width, height, entries }
    }

    fn add_blocks(&mut self, places: &[usize], blocks: &[f64]) {
        let width = self.width;
        let pairs = places.iter().flat_map(|&row| places.iter().map(move |&column| (row, column)));
        for ((row, column), block) in pairs.zip(blocks.chunks_exact(width * width)) {
            for (number, entry) in block.iter().enumerate() {
                self.entries[(column * width + number % width) * self.height + row * width + number / width] += entry;
            }
        }
    }

    /// Adds what is left of another front, whose bodies are at these places.
    fn add_update(&mut self, relative: &[usize], update: &[f64]) {
        let (width, height) = (self.width, relative.len() * self.width);
        for (number, source) in update.chunks_exact(height.max(1)).enumerate() {
            let target = &mut self.entries[(relative[number / width] * width + number % width) * self.height..][..self.height];
            for (&place, source) in relative.iter().zip(source.chunks_exact(width)) {
                target[place * width..].iter_mut().zip(source).for_each(|(target, value)| *target += value);
            }
        }
    }

    /// Eliminates the first columns.
    fn eliminate(&mut self, columns: usize) -> bool {
        for pivot in 0..columns {
            let (done, rest) = self.entries.split_at_mut((pivot + 1) * self.height);
            let own = &mut done[pivot * self.height + pivot..];
            if !(own[0].abs() > f64::MIN_POSITIVE && own[0].is_finite()) {
                return false;
            }
            let scale = 1.0 / own[0];
            own[1..].iter_mut().for_each(|entry| *entry *= scale);
            for column in rest.chunks_exact_mut(self.height) {
                let factor = column[pivot];
                if factor != 0.0 {
                    subtract(&mut column[pivot + 1..], &own[1..], factor);
                }
            }
        }
        true
    }

    /// Keeps the eliminated columns and rows, and gives what is left.
    fn split(self, columns: usize, [lower, upper]: &mut [Vec<f64>; 2]) -> Vec<f64> {
        lower.clear();
        lower.extend_from_slice(&self.entries[..columns * self.height]);
        upper.clear();
        let mut left = Vec::with_capacity((self.height - columns).pow(2));
        for column in self.entries[columns * self.height..].chunks_exact(self.height.max(1)) {
            upper.extend_from_slice(&column[..columns]);
            left.extend_from_slice(&column[columns..]);
        }
        left
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn a_solution_gives_its_right_hand_side_back() {
        for (bodies, width, seed) in [(1, 3, 0), (2, 6, 1), (40, 3, 2), (40, 6, 3), (200, 3, 4)] {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut touches = Vec::new();
            let mut blocks: Vec<Blocks> = Vec::new();
            for _ in 0..3 * bodies {
                let mut ends = [(); 2].map(|()| random.random_range(0..bodies));
                ends.sort_unstable();
                let size = if ends[0] == ends[1] { 1 } else { 4 };
                touches.push(ends);
                blocks.push((0..size * width * width).map(|_| 0.02 * (random.random::<f64>() - 0.5)).collect());
            }
            let expected: Vec<f64> = (0..bodies * width).map(|place| (place % 7) as f64 - 3.0).collect();
            let mut vector = expected.clone();
            for (ends, blocks) in touches.iter().zip(&blocks) {
                let ends = if ends[0] == ends[1] { &ends[..1] } else { &ends[..] };
                let pairs = ends.iter().flat_map(|&row| ends.iter().map(move |&column| (row, column)));
                for ((row, column), block) in pairs.zip(blocks.chunks(width * width)) {
                    for (number, entry) in block.iter().enumerate() {
                        vector[row * width + number / width] += entry * expected[column * width + number % width];
                    }
                }
            }
            let mut factors = BlockLu::new(bodies, width, &touches);
            // the second time over what the first left
            for _ in 0..2 {
                assert!(factors.factor(|constraint| blocks[constraint].clone()));
            }
            factors.solve(&mut vector);
            let error = vector.iter().zip(&expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
            assert!(error < 1e-11, "{bodies} bodies of {width} unknowns: {error:e}");
        }
    }
}
