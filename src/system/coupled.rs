//! The coupled linear system of fluid, multipliers, mean-flow constraint and contacts, with its block preconditioner.
//!
//! ```text
//! [ K   -C   -e   .  ] [ u, p ]   [ 0 ]
//! [ J    E    T  -N' ] [ c    ] = [ v ]      rows of rigid modes of free bodies: the net force, c - N' f = given
//! [ m    F    .   .  ] [ g    ]   [ 0 ]      g: unknowns of the mean-flow constraint
//! [ N J  N E  N T .  ] [ f    ]   [ r ]      f: forces of contacts, r: rates at which their gaps grow
//! ```
//!
//! The preconditioner is block triangular: the fluid by its approximate inverse, then contacts and bodies. Where the fluid's
//! inverse is exact, [`SchurComplement`](super::schur_complement::SchurComplement) is the same system with the fluid eliminated.

use super::surfaces::SurfaceOperators;
use crate::{
    error::Result,
    flow::{Stokes, StokesInverse},
    petsc::{Stage, System, Vector},
    system::work::{SolvedUnknowns, Watch, WorkVectors},
};

/// A linear system whose solution is a flow around bodies.
pub trait Operator: System {
    /// The unknowns that a solver's vector stands for: the one to which the system was applied last.
    fn unknowns(&mut self, vector: &Vector) -> Result<SolvedUnknowns>;
}

/// What the linear systems are made of.
pub struct SystemParts<'a, const D: usize> {
    /// Fluid.
    pub stokes: &'a Stokes<D>,
    /// Its inverse, approximate or exact.
    pub inverse: &'a mut dyn StokesInverse<D>,
    /// All the rest.
    pub surfaces: SurfaceOperators<'a, D>,
    /// Work space.
    pub work: &'a mut WorkVectors,
}

/// The coupled system; vectors hold the fluid, multipliers, and the global unknowns.
pub struct Coupled<'a, const D: usize>(pub SystemParts<'a, D>);

impl<const D: usize> System for Coupled<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let SystemParts { stokes, surfaces, work, .. } = &mut self.0;
        let global_unknowns = work.split(surfaces.world, input)?;
        let watch = Watch::start(Stage::Matrices);
        stokes.multiply(&work.fluid_in, &mut work.fluid_out)?;
        watch.stop(&mut work.stages.matrices);
        let watch = Watch::start(Stage::Bodies);
        surfaces.spread(-1.0, &work.multipliers_in, &global_unknowns, &mut work.fluid_out)?;
        surfaces.mean_flow.add_forces(-1.0, &global_unknowns, &mut work.fluid_out)?;
        stokes.balance(&mut work.fluid_out)?;
        let mut rows = surfaces.rows(&work.fluid_in, &work.multipliers_in, &global_unknowns, &mut work.multipliers_out)?;
        let means = surfaces.mean_flow.mean_velocities(surfaces.world, &work.fluid_in)?;
        rows[..means.len()].copy_from_slice(&means);
        watch.stop(&mut work.stages.bodies);
        work.join(&rows, output)
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let SystemParts { stokes, inverse, surfaces, work } = &mut self.0;
        let rows = work.split(surfaces.world, input)?;
        let watch = Watch::start(Stage::Inverse);
        inverse.precondition(stokes, &work.fluid_in, &mut work.fluid_out)?;
        watch.stop(&mut work.stages.inverse);
        let watch = Watch::start(Stage::Bodies);
        let forces = surfaces.mean_flow.correct_mean_velocities(surfaces.world, &rows, &mut work.fluid_out)?;
        surfaces.blocks.interpolate(&work.fluid_out, &mut work.multipliers_out.local_mut()?)?;
        let mut global_unknowns = surfaces.precondition(&mut work.multipliers_in, &rows, &mut work.multipliers_out)?;
        global_unknowns[..forces.len()].copy_from_slice(&forces);
        watch.stop(&mut work.stages.bodies);
        work.join(&global_unknowns, output)
    }
}

impl<const D: usize> Operator for Coupled<'_, D> {
    fn unknowns(&mut self, vector: &Vector) -> Result<SolvedUnknowns> {
        let SystemParts { surfaces, work, .. } = &mut self.0;
        let global_unknowns = work.split(surfaces.world, vector)?;
        surfaces.velocity(&work.fluid_in, &work.multipliers_in, &global_unknowns, &mut work.multipliers_out)?;
        work.unknowns(global_unknowns)
    }
}
