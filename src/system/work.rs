//! Vectors that a linear system needs while it is applied, and how the solver's vectors are laid out.

use std::time::Instant;

use crate::{
    error::Result,
    flow::Stokes,
    parallel::World,
    petsc::{Session, Stage, StageGuard, Vector, enter},
};

/// Seconds spent in the parts of a solve.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stages {
    /// Operator: box matrices.
    pub matrices: f64,
    /// Operator and preconditioner: blocks of the bodies.
    pub bodies: f64,
    /// Inverse of the fluid.
    pub inverse: f64,
}

/// A stopwatch for a stage of the solve, which PETSc's log sees too.
pub struct Watch {
    start: Instant,
    _stage: StageGuard,
}

impl Watch {
    /// Begins a stage.
    pub fn start(stage: Stage) -> Watch {
        Watch { start: Instant::now(), _stage: enter(stage) }
    }

    /// Ends it and adds its seconds.
    pub fn stop(self, seconds: &mut f64) {
        *seconds += self.start.elapsed().as_secs_f64();
    }
}

/// What a solver's vector stands for: this rank's parts, and the global unknowns.
pub struct SolvedUnknowns {
    /// Disturbance of the flow without bodies.
    pub fluid: Vector,
    /// Multipliers.
    pub multipliers: Vec<f64>,
    /// Velocities on the surfaces, tested with all modes.
    pub velocities: Vec<f64>,
    /// Unknowns of mean-flow constraint and contacts.
    pub global_unknowns: Vec<f64>,
}

/// Work space. The solver's vectors hold, on each rank, a fluid part (unless the fluid is eliminated), multipliers, and on
/// rank 0 the unknowns of the mean-flow constraint, then those of the rank's own pair constraints.
pub struct WorkVectors {
    /// Unknowns of the fluid; where it is eliminated, its rows are turned into them in place. Empty from the end of a solve, which gives it away, to the next one.
    pub fluid_in: Vector,
    /// Rows of the fluid; empty where it is eliminated.
    pub fluid_out: Vector,
    /// Vectors of the multipliers: unknowns and rows.
    pub multipliers_in: Vector,
    /// See `multipliers_in`.
    pub multipliers_out: Vector,
    /// Seconds so far.
    pub stages: Stages,
    sizes: Sizes,
    given_away: bool,
}

/// This rank's numbers of unknowns in the solver's vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Of the fluid; 0 if it is eliminated.
    pub fluid: usize,
    /// On surfaces.
    pub multipliers: usize,
    /// Of the mean-flow constraint, on all ranks alike, though only rank 0 holds them.
    pub mean_flow: usize,
    /// Places for pair constraints that belong to this rank.
    pub constraints: usize,
}

impl WorkVectors {
    /// Work space of the given sizes.
    pub fn new<const D: usize>(stokes: &Stokes<D>, sizes: Sizes) -> Result<WorkVectors> {
        let vector = || Vector::new(stokes.session(), sizes.multipliers);
        Ok(WorkVectors {
            fluid_in: stokes.vector()?,
            fluid_out: if sizes.fluid > 0 { stokes.vector()? } else { Vector::new(stokes.session(), 0)? },
            multipliers_in: vector()?,
            multipliers_out: vector()?,
            stages: Stages::default(),
            sizes,
            given_away: false,
        })
    }

    /// The sizes it was made for.
    pub fn sizes(&self) -> Sizes {
        self.sizes
    }

    /// A vector of zeros for the solver.
    pub fn solver_vector(&self, session: &Session) -> Result<Vector> {
        let mean_flow = if session.world().rank() == 0 { self.sizes.mean_flow } else { 0 };
        Vector::new(session, self.sizes.fluid + self.sizes.multipliers + mean_flow + self.sizes.constraints)
    }

    /// Takes a solver's vector apart into `fluid_in`, `multipliers_in` and the global unknowns: those of the mean-flow constraint, which all ranks
    /// then know, and those of the pair constraints.
    pub fn split(&mut self, world: &World, input: &Vector) -> Result<Vec<f64>> {
        let input = input.local()?;
        let (fluid, rest) = input.split_at(self.sizes.fluid);
        let (multipliers, global_unknowns) = rest.split_at(self.sizes.multipliers);
        if !fluid.is_empty() {
            self.fluid_in.local_mut()?.copy_from_slice(fluid);
        }
        self.multipliers_in.local_mut()?.copy_from_slice(multipliers);
        let (mean_flow, constraints) = global_unknowns.split_at(global_unknowns.len() - self.sizes.constraints);
        let mut shared = vec![0.0; self.sizes.mean_flow];
        shared[..mean_flow.len()].copy_from_slice(mean_flow);
        if !shared.is_empty() {
            world.sum(&mut shared);
        }
        shared.extend_from_slice(constraints);
        Ok(shared)
    }

    /// Makes room for the fluid where the last solve gave it away.
    pub fn renew<const D: usize>(&mut self, stokes: &Stokes<D>) -> Result<()> {
        if self.given_away {
            self.fluid_in = stokes.vector()?;
            self.given_away = false;
        }
        Ok(())
    }

    /// Gives away what was split, with the velocities on surfaces in `multipliers_out`.
    pub fn unknowns(&mut self, global_unknowns: Vec<f64>) -> Result<SolvedUnknowns> {
        let none = Vector::new(self.fluid_in.session(), 0)?;
        let fluid = std::mem::replace(&mut self.fluid_in, none);
        self.given_away = true;
        let (multipliers, velocities) = (self.multipliers_in.local()?.to_vec(), self.multipliers_out.local()?.to_vec());
        Ok(SolvedUnknowns { fluid, multipliers, velocities, global_unknowns })
    }

    /// Puts `fluid_out`, `multipliers_out` and global unknowns together.
    pub fn join(&self, global_unknowns: &[f64], output: &mut Vector) -> Result<()> {
        let mut output = output.local_mut()?;
        let (fluid, rest) = output.split_at_mut(self.sizes.fluid);
        let (multipliers, own_tail) = rest.split_at_mut(self.sizes.multipliers);
        if !fluid.is_empty() {
            fluid.copy_from_slice(&self.fluid_out.local()?);
        }
        multipliers.copy_from_slice(&self.multipliers_out.local()?);
        own_tail.copy_from_slice(&global_unknowns[global_unknowns.len() - own_tail.len()..]);
        Ok(())
    }
}
