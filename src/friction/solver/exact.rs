//! The impulses of an island by the exact law: sweeps first, an interior point from where they are, and more sweeps, from the better of both, if that ends
//! too soon.

use super::{interior_point::follow, sweeps::Sweeps};
use crate::friction::{cone::tangential_size, program::FrictionProgram, row_block::RowBlock};

/// What the interior point goes on to where that is near: its last iterations double the digits.
const AIM: f64 = 1e-11;

/// Residual from which the interior point starts, and what a later start is divided by.
const FIRST: f64 = 1e-3;
const NEXT: f64 = 0.1;

/// Residual of a guess up to which a few sweeps go on to the tolerance, and the interior point starts at it if they do not come there: that of bodies at rest.
const NEAR: f64 = 1e-6;
const FEW_SWEEPS: usize = 300;

/// Where its path starts, over the residual of sweeps.
const START: f64 = 10.0;

/// Largest impulse of the interior point over that of sweeps, or over the largest velocity without impulses, beyond which it is none: where bodies are wedged,
/// impulses that balance each other have no bound, and the path may lead to large ones.
const WEDGED: f64 = 100.0;

/// Residual of a guess beyond which none is better.
const USELESS: f64 = 1.0;

/// Normal velocity from which a contact without a force has long been open, over the largest without impulses.
const OPEN: f64 = 0.1;

/// Before all contacts are swept to a tolerance, those that miss their law are, and what they touch, up to as many contacts as so many sweeps have. The interior point
/// goes on from sweeps over all.
const LOCAL: usize = 100;

/// Contacts one after the other that sweeps are given: as many sweeps as that is, but no more than the second of these; to the first start no fewer than the
/// first of them.
const MOST_CONTACTS: usize = 800_000;
const MOST_SWEEPS: [usize; 2] = [1_000, 10_000];

/// The impulses of an island.
#[derive(Debug, Clone)]
pub struct Found<const D: usize> {
    /// One for each contact, in its rows.
    pub forces: Vec<[f64; D]>,
    /// How far from the law.
    pub residual: f64,
    /// Sweeps.
    pub sweeps: usize,
    /// Iterations of the interior point.
    pub iterations: usize,
}

/// The impulses to a residual, or the best that were found, from a guess.
pub fn solve_exactly<const D: usize, const W: usize>(program: &FrictionProgram<D, W>, guess: Vec<[f64; D]>, tolerance: f64) -> Found<D> {
    if program.row_blocks.iter().all(|row_block| opening(row_block, &row_block.offset) >= 0.0) {
        return Found { forces: vec![[0.0; D]; guess.len()], residual: 0.0, sweeps: 0, iterations: 0 };
    }
    let most = (MOST_CONTACTS / guess.len()).min(MOST_SWEEPS[1]);
    let mut sweeps = Sweeps::new(program, guess);
    if sweeps.residual.is_nan() || sweeps.residual > USELESS {
        sweeps = Sweeps::new(program, vec![[0.0; D]; program.row_blocks.len()]);
    }
    let (mut first, mut iterations) = (FIRST.max(tolerance), 0);
    if tolerance >= FIRST {
        sweeps.settle(first, LOCAL);
    }
    let mut best = Found { forces: sweeps.forces.clone(), residual: sweeps.residual, sweeps: 0, iterations: 0 };
    if best.residual > tolerance && best.residual <= NEAR {
        iterations += best.stay(program, &mut sweeps, tolerance);
    }
    loop {
        sweeps.run(first, if first >= FIRST { most.max(MOST_SWEEPS[0]) } else { most });
        best.take(&sweeps.forces, sweeps.residual);
        if best.residual > tolerance && sweeps.residual <= first {
            iterations += best.follow(program, &sweeps, first);
        }
        // velocities that are not finite are refused by who separates bodies
        if best.residual <= tolerance || sweeps.count >= most || !sweeps.residual.is_finite() {
            return Found { sweeps: sweeps.count, iterations, ..best };
        }
        if best.residual < sweeps.residual {
            sweeps.go_on(best.forces.clone());
        }
        first = (first * NEXT).max(tolerance);
    }
}

/// The impulses by the interior point from where sweeps are, and its iterations. Contacts that have long been open there stay so.
fn from_sweeps<const D: usize, const W: usize>(
    program: &FrictionProgram<D, W>,
    sweeps: &Sweeps<D, W>,
    start: f64,
) -> (Vec<[f64; D]>, usize) {
    let forces = &sweeps.forces;
    let velocities = program.velocities(&program.motion(forces));
    let stays = |place: &usize| {
        let leader = program.leader(*place);
        forces[leader] != [0.0; D] || opening(&program.row_blocks[leader], &velocities[leader]) < OPEN * program.unit
    };
    let near: Vec<usize> = (0..forces.len()).filter(stays).collect();
    let part = program.part(&near);
    let guess: Vec<[f64; D]> = near.iter().map(|&place| forces[place]).collect();
    let end = follow(&part, &guess, start, AIM);
    let mut found = forces.clone();
    near.iter().zip(end.forces).for_each(|(&place, force)| found[place] = force);
    (found, end.iterations)
}

/// How fast a contact opens beyond what its slip asks for.
fn opening<const D: usize, const W: usize>(row_block: &RowBlock<D, W>, velocity: &[f64; D]) -> f64 {
    velocity[0] - row_block.dilation * tangential_size(velocity)
}

fn largest<const D: usize>(forces: &[[f64; D]]) -> f64 {
    forces.iter().map(|force| force[0]).fold(0.0, f64::max)
}

impl<const D: usize> Found<D> {
    /// Takes impulses beside a near guess: they are not unique, and where little has changed they shall not. By a few sweeps, or by the interior point, whose
    /// iterations these are.
    fn stay<const W: usize>(&mut self, program: &FrictionProgram<D, W>, sweeps: &mut Sweeps<D, W>, tolerance: f64) -> usize {
        sweeps.run(tolerance, FEW_SWEEPS);
        self.take(&sweeps.forces, sweeps.residual);
        if self.residual <= tolerance {
            return 0;
        }
        let iterations = self.follow(program, sweeps, self.residual);
        if self.residual < sweeps.residual {
            sweeps.go_on(self.forces.clone());
        }
        iterations
    }

    /// Takes the impulses of the interior point from where sweeps have come to a residual, if they are better; its iterations.
    fn follow<const W: usize>(&mut self, program: &FrictionProgram<D, W>, sweeps: &Sweeps<D, W>, residual: f64) -> usize {
        let (forces, iterations) = from_sweeps(program, sweeps, START * residual);
        if largest(&forces) <= WEDGED * largest(&sweeps.forces).max(program.unit) {
            self.take(&forces, program.residual(&forces));
        }
        iterations
    }

    /// Takes better impulses.
    fn take(&mut self, forces: &[[f64; D]], residual: f64) {
        // a guess that is not finite has no residual
        if residual < self.residual || !self.residual.is_finite() {
            (self.forces, self.residual) = (forces.to_vec(), residual);
        }
    }
}
