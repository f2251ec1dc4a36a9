//! Contact after contact the impulse that solves its own problem, until none changes (Jean 1999, doi:10.1016/S0045-7825(98)00383-1). Rows of norm 1 make the
//! problem of a contact explicit. The order is shuffled for each sweep, always in the same way: a fixed order can run into a cycle.

use rand::{SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

use crate::friction::{
    bounds::shortened,
    cone::{project, tangential_size},
    program::FrictionProgram,
    row_block::{NONE, RowBlock},
};

/// Sweeps after which the residual is looked at, and later the part of all sweeps so far.
const EVERY: usize = 10;
const LATER: usize = 10;

/// Part of a tolerance by which an impulse must change for its neighbours to be looked at again.
const PASSED_ON: f64 = 0.1;

/// Where the sweeps stand.
pub struct Sweeps<'a, const D: usize, const W: usize> {
    program: &'a FrictionProgram<D, W>,
    /// The impulses.
    pub forces: Vec<[f64; D]>,
    /// `A^T r`: sweeps know of no medium. One body more than there are, which no impulse moves, is the second of contacts that have one.
    motion: Vec<[f64; W]>,
    order: Vec<u32>,
    random: ChaCha8Rng,
    /// How many there were.
    pub count: usize,
    /// The residual when it was looked at last.
    pub residual: f64,
}

impl<'a, const D: usize, const W: usize> Sweeps<'a, D, W> {
    /// None yet, from a guess.
    pub fn new(program: &'a FrictionProgram<D, W>, guess: Vec<[f64; D]>) -> Self {
        let order = (0..guess.len() as u32).collect();
        let (motion, random) = (Vec::new(), ChaCha8Rng::seed_from_u64(0));
        let mut sweeps = Sweeps { program, forces: guess, motion, order, random, count: 0, residual: 0.0 };
        sweeps.look();
        sweeps
    }

    /// Goes on from other impulses.
    pub fn go_on(&mut self, forces: Vec<[f64; D]>) {
        self.forces = forces;
        self.look();
    }

    /// Sweeps over the contacts alone that miss their law by more than a tolerance, and over those that meet what these change, until there are none or that has
    /// cost as many contacts as some sweeps of all. From the impulses of an earlier step few contacts miss it.
    pub fn settle(&mut self, tolerance: f64, most: usize) {
        if self.residual <= tolerance || self.residual.is_nan() {
            return;
        }
        let (program, count) = (self.program, self.forces.len());
        let velocities = program.velocities(&self.motion);
        let misses = |place: &usize| program.miss(*place, &self.forces, &velocities[*place]) > tolerance * program.unit;
        let mut active: Vec<usize> = (0..count).filter(misses).collect();
        let at_body = program.row_blocks_at_bodies();
        let (mut waits, mut visited) = (vec![false; count], 0);
        while !active.is_empty() && visited < most * count {
            visited += active.len();
            active.shuffle(&mut self.random);
            let mut next = Vec::new();
            for place in active {
                let before = self.forces[place];
                self.visit(place);
                let change = before.iter().zip(&self.forces[place]).map(|(before, after)| (after - before).abs()).fold(0.0, f64::max);
                if change > PASSED_ON * tolerance * program.unit {
                    for other in program.row_blocks[place].sides().flat_map(|(body, _)| &at_body[body]) {
                        if !std::mem::replace(&mut waits[*other], true) {
                            next.push(*other);
                        }
                    }
                }
            }
            next.iter().for_each(|&place| waits[place] = false);
            active = next;
        }
        self.count += visited.div_ceil(count);
        self.look();
    }

    /// Sweeps until the residual is below a tolerance, or there were so many.
    pub fn run(&mut self, tolerance: f64, most: usize) {
        while self.residual > tolerance && self.count < most {
            // a contact alone is solved by the first
            let next = if self.count == 0 { 1 } else { EVERY.max(self.count / LATER).min(most - self.count) };
            (0..next).for_each(|_| self.sweep());
            self.look();
        }
    }

    /// The motion of the impulses, without the rounding of all changes, and the residual.
    fn look(&mut self) {
        self.motion = self.program.motion(&self.forces);
        self.residual = self.program.residual_of(&self.forces, &self.motion);
        self.motion.push([0.0; W]);
    }

    fn sweep(&mut self) {
        self.count += 1;
        self.order.shuffle(&mut self.random);
        let order = std::mem::take(&mut self.order);
        order.iter().for_each(|&place| self.visit(place as usize));
        self.order = order;
    }

    /// Gives a contact the impulse that solves its own problem.
    #[inline]
    fn visit(&mut self, place: usize) {
        if self.program.bounds.is_empty() {
            let row_block = &self.program.row_blocks[place];
            alone(row_block, &mut self.forces[place], &mut self.motion, |without| {
                if row_block.dilation > 0.0 { projection(without, row_block.friction) } else { solution(without, row_block.friction) }
            });
        } else {
            // what turns a contact takes its normal impulse as it is
            let (limit, leader) = (self.program.limit(place), self.program.leader(place));
            let of_leader = self.forces[leader][0];
            alone(&self.program.row_blocks[place], &mut self.forces[place], &mut self.motion, |without| {
                if limit.dilation > 0.0 {
                    return projection(without, limit.friction);
                }
                let normal = if leader == place { (-without[0]).max(0.0) } else { of_leader };
                let mut next = shortened(&without.map(|velocity| -velocity), limit.at(normal));
                next[0] = if leader == place { normal } else { 0.0 };
                next
            });
        }
    }
}

/// Gives a contact the impulse that solves its problem while all others stay. Without branches: what a contact does is as good as random.
#[inline]
fn alone<const D: usize, const W: usize>(
    row_block: &RowBlock<D, W>,
    force: &mut [f64; D],
    motion: &mut [[f64; W]],
    solution: impl Fn(&[f64; D]) -> [f64; D],
) {
    let nobody = motion.len() - 1;
    let ends = [row_block.ends[0], if row_block.ends[1] == NONE { nobody } else { row_block.ends[1] }];
    let (one, two) = (motion[ends[0]], motion[ends[1]]);
    let mut without = row_block.offset;
    for (axis, without) in without.iter_mut().enumerate() {
        *without -= force[axis];
        let entries = row_block.rows[0][axis].iter().zip(&row_block.rows[1][axis]).zip(one.iter().zip(&two));
        entries.for_each(|((row, other), (one, two))| *without += row * one + other * two);
    }
    let next = solution(&without);
    for (end, rows) in ends.into_iter().zip(&row_block.rows) {
        for (axis, row) in rows.iter().enumerate() {
            let change = next[axis] - force[axis];
            motion[end].iter_mut().zip(row).for_each(|(moved, entry)| *moved += entry * change);
        }
    }
    *force = next;
}

/// The impulse of a contact that moves so without one, by the convex law.
fn projection<const D: usize>(without: &[f64; D], friction: f64) -> [f64; D] {
    project(without.map(|velocity| -velocity), friction)
}

/// The impulse of a contact that moves so without one.
#[inline]
fn solution<const D: usize>(without: &[f64; D], friction: f64) -> [f64; D] {
    let normal = (-without[0]).max(0.0);
    let most = friction * normal;
    let mut next = [normal; D];
    if D == 2 {
        next[1] = (-without[1]).clamp(-most, most);
        return next;
    }
    let factor = (most / tangential_size(without).max(f64::MIN_POSITIVE)).min(1.0);
    next[1..].iter_mut().zip(&without[1..]).for_each(|(next, without)| *next = -factor * without);
    next
}
