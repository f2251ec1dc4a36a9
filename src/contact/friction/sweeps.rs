//! Contact after contact the impulse that solves its own problem, until none changes (Jean 1999, doi:10.1016/S0045-7825(98)00383-1). Rows of norm 1 make the
//! problem of a contact explicit. The order is shuffled for each sweep, always in the same way: a fixed order can run into a cycle.

use rand::{SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

use super::{cone::tangential_size, link::Link, program::FrictionProgram};

/// Sweeps after which the residual is looked at.
const EVERY: usize = 10;

/// Where the sweeps stand.
pub struct Sweeps<'a, const D: usize, const W: usize> {
    program: &'a FrictionProgram<D, W>,
    /// The impulses.
    pub forces: Vec<[f64; D]>,
    /// `A^T r`: sweeps know of no medium.
    motion: Vec<[f64; W]>,
    order: Vec<usize>,
    random: ChaCha8Rng,
    /// How many there were.
    pub count: usize,
    /// The residual when it was looked at last.
    pub residual: f64,
}

impl<'a, const D: usize, const W: usize> Sweeps<'a, D, W> {
    /// None yet, from a guess.
    pub fn new(program: &'a FrictionProgram<D, W>, guess: Vec<[f64; D]>) -> Self {
        let (motion, residual) = (program.motion(&guess), program.residual(&guess));
        let order = (0..guess.len()).collect();
        Sweeps { program, forces: guess, motion, order, random: ChaCha8Rng::seed_from_u64(0), count: 0, residual }
    }

    /// Sweeps until the residual is below a tolerance, or there were so many.
    pub fn run(&mut self, tolerance: f64, most: usize) {
        while self.residual > tolerance && self.count < most {
            // a contact alone is solved by the first
            let next = if self.count == 0 { 1 } else { EVERY.min(most - self.count) };
            (0..next).for_each(|_| self.sweep());
            self.motion = self.program.motion(&self.forces);
            self.residual = self.program.residual_of(&self.forces, &self.motion);
        }
    }

    fn sweep(&mut self) {
        self.count += 1;
        self.order.shuffle(&mut self.random);
        for &place in &self.order {
            let (link, force) = (&self.program.links[place], &mut self.forces[place]);
            let next = alone(link, force, &self.motion);
            let change = std::array::from_fn(|axis| next[axis] - force[axis]);
            link.push(&change, &mut self.motion);
            *force = next;
        }
    }
}

/// The impulse of a contact while all others stay.
fn alone<const D: usize, const W: usize>(link: &Link<D, W>, force: &[f64; D], motion: &[[f64; W]]) -> [f64; D] {
    let rates = link.rates(motion);
    let without: [f64; D] = std::array::from_fn(|axis| rates[axis] + link.offset[axis] - force[axis]);
    if without[0] >= 0.0 {
        return [0.0; D];
    }
    let (normal, size) = (-without[0], tangential_size(&without));
    let factor = if size <= link.friction * normal { 1.0 } else { link.friction * normal / size };
    std::array::from_fn(|axis| if axis == 0 { normal } else { -factor * without[axis] })
}
