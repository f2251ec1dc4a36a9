//! The interior point of the exact law, without a shift: two pairs of each contact follow a path on which their products are the same,
//!
//! `n s = k` (normal impulse and velocity) and `b o e = (k, 0)` (`b = (mu n, r_T)` and `e = (l, u_T)`, both in the second-order cone; `l` becomes
//! `|u_T|`), as proposed by Howell et al. 2022 (arXiv:2203.00806). `b o e = (b . e, b_0 e_T + e_0 b_T)`. Newton's method on the products as they
//! are, predicted and corrected (Mehrotra 1992, doi:10.1137/0802028); an iteration factors `1 + A^T C A` once, where `C` is a small matrix, not
//! symmetric, of each contact. The path may turn back: then it stops, and what it has found is told with its residual.

use super::{
    bordered::Border,
    pairs::{Newton, Pairs, Products},
};
use crate::{
    contact::{
        FRICTION_TOLERANCE,
        solver::block_lu::{BlockLu, Blocks},
    },
    friction::{
        bounds::Limit,
        program::FrictionProgram,
        row_block::{NONE, RowBlock},
        secant::dot,
    },
};

/// Iterations at most: where sweeps may follow, and where a medium leaves none.
const ITERATIONS: [usize; 2] = [40, 80];
/// Part of the way to the nearest bound that is gone.
const PART: f64 = 0.99;
/// No product falls below this part of their mean; a step is shortened by this factor, so often, until none does.
const NEAR: f64 = 1e-3;
const SHORTER: f64 = 0.8;
const SHORTENED: usize = 10;
/// After steps shorter than these the products aimed at are no smaller than these parts of what they are.
const CAREFUL: [(f64, f64); 2] = [(0.1, 1.0), (0.5, 0.5)];
/// Part of the residual that an iteration leaves where it stops below the tolerance.
const SLOW: f64 = 0.1;
/// Steps shorter than the first lead nowhere, and where sweeps may follow so many one after the other that are shorter than the second: the path turns back.
const SHORTEST: f64 = 1e-9;
const SHORT: (usize, f64) = (3, 0.1);

/// Where a path ends: the best impulses on it.
pub struct PathEnd<const D: usize> {
    pub forces: Vec<[f64; D]>,
    pub residual: f64,
    pub iterations: usize,
}

/// A change of all that the method follows.
struct Direction<const D: usize, const W: usize> {
    motion: Vec<[f64; W]>,
    amplitudes: Vec<f64>,
    pairs: Vec<Pairs<D>>,
}

/// Where the method stands, in units of the largest component of `q`.
struct Iterate<'a, const D: usize, const W: usize> {
    program: &'a FrictionProgram<D, W>,
    motion: Vec<[f64; W]>,
    /// Of what corrects the mobility of contacts.
    amplitudes: Vec<f64>,
    pairs: Vec<Pairs<D>>,
    /// Length of the last step.
    last: f64,
}

/// Follows the path from impulses near which it starts, with products of the square of `start`, until the residual is below an aim, or below the tolerance of
/// all methods and falls no more.
pub fn follow<const D: usize, const W: usize>(program: &FrictionProgram<D, W>, guess: &[[f64; D]], start: f64, aim: f64) -> PathEnd<D> {
    let mut best = PathEnd { forces: guess.to_vec(), residual: f64::INFINITY, iterations: 0 };
    let mut point = Iterate::new(program, guess, start);
    let touches = [program.touches(), program.medium.touches()].concat();
    let mut factors = BlockLu::new(program.bodies, W, &touches);
    let mut short = 0;
    while best.iterations < ITERATIONS[usize::from(program.medium.resists())] {
        best.iterations += 1;
        let goes_on = point.step(&mut factors);
        let forces = point.forces();
        let residual = program.residual(&forces);
        short = if point.last < SHORT.1 { short + 1 } else { 0 };
        let turns_back = short == SHORT.0 && !program.medium.resists();
        // digits no longer double: rounding
        let ends = best.residual <= FRICTION_TOLERANCE && residual > SLOW * best.residual;
        if residual < best.residual {
            (best.forces, best.residual) = (forces, residual);
        }
        if best.residual <= aim || ends || turns_back || !goes_on || !residual.is_finite() {
            break;
        }
    }
    best
}

impl<'a, const D: usize, const W: usize> Iterate<'a, D, W> {
    fn new(program: &'a FrictionProgram<D, W>, guess: &[[f64; D]], start: f64) -> Self {
        let guess: Vec<[f64; D]> = guess.iter().map(|force| force.map(|component| component / program.unit)).collect();
        let motion = program.motion(&guess);
        let mut point = Iterate { program, motion, amplitudes: program.amplitudes(&guess), pairs: Vec::new(), last: 1.0 };
        let near = |(place, velocity): (usize, [f64; D])| {
            let normal = guess[program.leader(place)][0];
            let force = std::array::from_fn(|axis| if axis == 0 { normal } else { guess[place][axis] });
            Pairs::near(&force, &velocity, point.limit(place), start)
        };
        point.pairs = point.velocities().into_iter().enumerate().map(near).collect();
        let impulses = point.impulses();
        (point.motion, point.amplitudes) = (program.motion(&impulses), program.amplitudes(&impulses));
        point
    }

    /// `u` in these units.
    fn velocities(&self) -> Vec<[f64; D]> {
        let velocity = |row_block: &RowBlock<D, W>| {
            let rates = row_block.rates(&self.motion);
            std::array::from_fn(|axis| rates[axis] + row_block.offset[axis] / self.program.unit)
        };
        let alone = self.program.row_blocks.iter().map(velocity).collect();
        self.program.with_modes(alone, &self.amplitudes)
    }

    fn impulses(&self) -> Vec<[f64; D]> {
        self.pairs.iter().enumerate().map(|(place, pairs)| self.alone(place, pairs.impulse())).collect()
    }

    /// What bounds the tangential impulse of a row block in these units.
    fn limit(&self, place: usize) -> Limit {
        let limit = self.program.limit(place);
        Limit { load: limit.load / self.program.unit, ..limit }
    }

    /// The impulse that a row block has itself: of one that turns a contact the pair has the normal impulse of that.
    fn alone(&self, place: usize, mut impulse: [f64; D]) -> [f64; D] {
        if self.program.follows(place) {
            impulse[0] = 0.0;
        }
        impulse
    }

    /// The impulses in the cones that are next to those of the point.
    fn forces(&self) -> Vec<[f64; D]> {
        let scaled: Vec<[f64; D]> = self.pairs.iter().map(|pairs| pairs.impulse().map(|component| component * self.program.unit)).collect();
        self.program.within(&scaled)
    }

    /// One iteration; whether it led anywhere.
    fn step(&mut self, factors: &mut BlockLu) -> bool {
        let mean = mean(&self.pairs);
        let contacts = self.pairs.iter().zip(self.velocities()).enumerate();
        let newton: Vec<Newton<D>> =
            contacts.map(|(place, (pairs, velocity))| Newton::of(pairs, &velocity, self.limit(place), mean)).collect();
        let count = newton.len();
        let of_both = |place: usize| match place.checked_sub(count) {
            Some(row) => self.program.medium.blocks(row),
            None => self.blocks(place, &newton[place]),
        };
        if !factors.factor(of_both) {
            return false;
        }
        let border = Border::new(self.program, factors, &newton);
        let products: Vec<Products<D>> = self.pairs.iter().map(Pairs::products).collect();
        let predicted = self.direction(factors, border.as_ref(), &newton, &products);
        let after = mean_after(&self.pairs, &predicted.pairs, self.room(&predicted).min(1.0));
        let least = CAREFUL.iter().find(|(length, _)| self.last < *length).map_or(0.0, |(_, part)| *part);
        let aim = (after / mean).powi(3).min(1.0).max(least) * mean;
        let corrected = |(products, change): (&Products<D>, &Pairs<D>)| {
            let more = change.products();
            let mut tangential: [f64; D] = std::array::from_fn(|axis| products.tangential[axis] + more.tangential[axis]);
            tangential[0] -= aim;
            Products { normal: products.normal + more.normal - aim, tangential }
        };
        let products: Vec<Products<D>> = products.iter().zip(&predicted.pairs).map(corrected).collect();
        let direction = self.direction(factors, border.as_ref(), &newton, &products);
        self.walk(&direction)
    }

    /// The blocks `A^T C A` of a contact.
    fn blocks(&self, contact: usize, newton: &Newton<D>) -> Blocks {
        let row_block = &self.program.row_blocks[contact];
        let count = if row_block.ends[1] == NONE { 1 } else { 2 };
        let first = usize::from(self.program.follows(contact));
        let mut blocks = vec![0.0; count * count * W * W];
        for (number, block) in blocks.chunks_exact_mut(W * W).enumerate() {
            let (row, column) = (&row_block.rows[number / count], &row_block.rows[number % count]);
            for (from, along) in row.iter().enumerate().skip(first) {
                for (to, across) in column.iter().enumerate() {
                    let factor = newton.matrix[from][to];
                    for (entries, one) in block.chunks_exact_mut(W).zip(along) {
                        entries.iter_mut().zip(across).for_each(|(entry, other)| *entry += factor * one * other);
                    }
                }
            }
        }
        blocks
    }

    /// The change that takes away these products and what is wrong with rows and motions.
    fn direction(&self, factors: &BlockLu, border: Option<&Border<W>>, newton: &[Newton<D>], products: &[Products<D>]) -> Direction<D, W> {
        let first: Vec<[f64; D]> = newton.iter().zip(products).map(|(newton, products)| newton.first(products)).collect();
        let forces: Vec<[f64; D]> = self
            .pairs
            .iter()
            .zip(&first)
            .enumerate()
            .map(|(place, (pairs, first))| {
                let now = pairs.impulse();
                self.alone(place, std::array::from_fn(|axis| now[axis] + first[axis]))
            })
            .collect();
        let mut motion = self.program.pushes(&forces);
        let resisted = self.program.medium.forces(&self.motion);
        motion.iter_mut().zip(&resisted).for_each(|(change, now)| change.iter_mut().zip(now).for_each(|(change, now)| *change -= now));
        factors.solve(motion.as_flattened_mut());
        let modes = self.program.modes.iter().zip(&self.amplitudes);
        let wanted: Vec<f64> = modes.map(|(mode, now)| dot(&mode.rates, &forces) - now / mode.gain).collect();
        let amplitudes = border.map_or_else(Vec::new, |border| border.amplitudes(self.program, newton, &wanted, &mut motion));
        let rates = self.program.row_blocks.iter().map(|row_block| row_block.rates(&motion)).collect();
        let contacts = newton.iter().zip(self.program.with_modes(rates, &amplitudes)).zip(first.iter().zip(products));
        let pairs = contacts.map(|((newton, rates), (first, products))| newton.change(first, &rates, products)).collect();
        Direction { motion, amplitudes, pairs }
    }

    /// How far a direction leads before a pair leaves its cones.
    fn room(&self, direction: &Direction<D, W>) -> f64 {
        self.pairs.iter().zip(&direction.pairs).map(|(pairs, change)| pairs.room(change)).fold(f64::INFINITY, f64::min)
    }

    fn walk(&mut self, direction: &Direction<D, W>) -> bool {
        let mut length = (PART * self.room(direction)).min(1.0);
        for _ in 0..SHORTENED {
            let after = || self.pairs.iter().zip(&direction.pairs).flat_map(|(pairs, change)| pairs.after(change, length).means());
            let mean = after().sum::<f64>() / (2 * self.pairs.len()) as f64;
            if after().fold(f64::INFINITY, f64::min) >= NEAR * mean {
                break;
            }
            length *= SHORTER;
        }
        for (now, change) in self.motion.iter_mut().zip(&direction.motion) {
            now.iter_mut().zip(change).for_each(|(now, change)| *now += length * change);
        }
        self.amplitudes.iter_mut().zip(&direction.amplitudes).for_each(|(now, change)| *now += length * change);
        self.pairs.iter_mut().zip(&direction.pairs).for_each(|(pairs, change)| *pairs = pairs.after(change, length));
        self.last = length;
        length > SHORTEST
    }
}

fn mean<const D: usize>(pairs: &[Pairs<D>]) -> f64 {
    pairs.iter().flat_map(Pairs::means).sum::<f64>() / (2 * pairs.len()) as f64
}

fn mean_after<const D: usize>(pairs: &[Pairs<D>], change: &[Pairs<D>], length: f64) -> f64 {
    let after = pairs.iter().zip(change).flat_map(|(pairs, change)| pairs.after(change, length).means());
    after.sum::<f64>() / (2 * pairs.len()) as f64
}
