//! The Krylov solver with its vectors, kept from solve to solve.

use super::{bodies::Bodies, extrapolation::InitialGuess, fixed_operators::FixedOperators, pair_constraints::iterated};
use crate::{
    constraint::Given,
    error::Result,
    petsc::{Krylov, KrylovMethod, KrylovSettings, Vector},
    system::{
        Snapshot,
        work::{Sizes, WorkVectors},
    },
};

/// Iterations allowed for the coupled system.
const MOST_ITERATIONS: usize = 1000;

/// Iterations before a restart: after 50 it stalls where bodies crowd. PETSc clears two squares of this size beforehand.
const RESTART: usize = 400;

/// Vectors that are kept at least before a restart.
const FEWEST_VECTORS: usize = 30;

/// When a solve ends.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    /// Residual wanted, relative to the right-hand side.
    pub tolerance: f64,
    /// Norm of a right-hand side that is nothing but rounding in this scene.
    pub rounding: f64,
}

/// What solves of one size share.
pub struct KrylovWorkspace {
    pub krylov: Krylov,
    pub work: WorkVectors,
    pub rhs: Vector,
    pub x: Vector,
}

impl KrylovWorkspace {
    /// The workspace at hand if it has the right sizes on every rank, or else a new one.
    pub fn fitting<const D: usize>(at_hand: Option<KrylovWorkspace>, fixed: &FixedOperators<D>, sizes: Sizes) -> Result<KrylovWorkspace> {
        let fits = at_hand.as_ref().is_some_and(|workspace| workspace.work.sizes() == sizes);
        match at_hand.filter(|_| fixed.session.world().max(if fits { 0.0 } else { 1.0 }) == 0.0) {
            Some(mut workspace) => {
                workspace.work.renew(&fixed.stokes)?;
                Ok(workspace)
            }
            None => KrylovWorkspace::new(fixed, sizes),
        }
    }

    fn new<const D: usize>(fixed: &FixedOperators<D>, sizes: Sizes) -> Result<KrylovWorkspace> {
        let work = WorkVectors::new(&fixed.stokes, sizes)?;
        let rhs = work.solver_vector(&fixed.session)?;
        let mut unknowns = [rhs.local()?.len() as f64];
        fixed.session.world().sum(&mut unknowns);
        let bodies = fixed.setup.bodies.len();
        let flexible = fixed.body_types.given() == Given::Motions && iterated(D * (D + 1) / 2, bodies);
        let settings = krylov_settings(fixed.setup.tolerance.at_an_instant(), unknowns[0] as usize, flexible);
        let krylov = Krylov::new(&fixed.session, rhs.local()?.len(), c"coupled_", settings)?;
        Ok(KrylovWorkspace { krylov, work, x: rhs.like()?, rhs })
    }

    /// Sets the unknowns to a guess, or to zero; `contacts` are those of this rank.
    pub fn start<const D: usize>(&mut self, bodies: &Bodies<D>, guess: Option<&InitialGuess<D>>, contacts: Vec<f64>) -> Result<()> {
        let mut x = self.x.local_mut()?;
        x.fill(0.0);
        let Some(InitialGuess { extrapolated: Snapshot { fluid, multipliers, mean_flow, .. }, .. }) = guess else { return Ok(()) };
        let (of_fluid, others) = x.split_at_mut(self.work.sizes().fluid);
        if let Some(fluid) = fluid {
            of_fluid.copy_from_slice(&fluid.local()?);
        }
        let (others, constraints) = others.split_at_mut(others.len() - self.work.sizes().constraints);
        let parts = [&bodies.local_multipliers(multipliers), &mean_flow[..]].concat();
        // only rank 0 holds the mean-flow constraint
        others.iter_mut().zip(parts).for_each(|(x, guess)| *x = guess);
        constraints.iter_mut().zip(contacts).for_each(|(x, guess)| *x = guess);
        Ok(())
    }
}

fn krylov_settings(tolerance: f64, unknowns: usize, flexible: bool) -> KrylovSettings {
    let restart = unknowns.clamp(FEWEST_VECTORS, RESTART);
    let method = if flexible { KrylovMethod::FlexibleGmres { restart } } else { KrylovMethod::Gmres { restart } };
    KrylovSettings { method, tolerance, most_iterations: MOST_ITERATIONS }
}
