//! The coupled linear system of fluid, multipliers, closure and contacts, with its block preconditioner.
//!
//! ```text
//! [ K   -C   -e   .  ] [ u, p ]   [ 0 ]
//! [ J    E    T  -N' ] [ c    ] = [ v ]      rows of rigid modes of free bodies: the net force, c - N' f = given
//! [ m    F    .   .  ] [ g    ]   [ 0 ]      g: unknowns of the closure
//! [ N J  N E  N T .  ] [ f    ]   [ r ]      f: forces of contacts, r: rates at which their gaps grow
//! ```
//!
//! The preconditioner is block triangular: the fluid by its approximate inverse, then contacts and bodies. Where the fluid's
//! inverse is exact, [`Condensed`](super::condensed::Condensed) is the same system with the fluid eliminated.

use super::{
    surfaces::Surfaces,
    work::{Unknowns, Watch, Work},
};
use crate::{
    error::Result,
    flow::{Stokes, StokesInverse},
    petsc::{Stage, System, Vector},
};

/// A linear system whose solution is a flow around bodies.
pub trait BodiesInFluid: System {
    /// The unknowns that a solver's vector stands for: the one to which the system was applied last.
    fn unknowns(&mut self, vector: &Vector) -> Result<Unknowns>;
}

/// What the linear systems are made of.
pub struct Parts<'a, const D: usize> {
    /// Fluid.
    pub stokes: &'a Stokes<D>,
    /// Its inverse, approximate or exact.
    pub inverse: &'a mut dyn StokesInverse<D>,
    /// All the rest.
    pub surfaces: Surfaces<'a, D>,
    /// Work space.
    pub work: &'a mut Work,
}

/// The coupled system; vectors hold the fluid, multipliers, and the tail.
pub struct Coupled<'a, const D: usize>(pub Parts<'a, D>);

impl<const D: usize> System for Coupled<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let Parts { stokes, surfaces, work, .. } = &mut self.0;
        let tail = work.split(surfaces.world, input)?;
        let watch = Watch::start(Stage::Matrices);
        stokes.multiply(&work.fluid_in, &mut work.fluid_out)?;
        watch.stop(&mut work.stages.matrices);
        let watch = Watch::start(Stage::Bodies);
        surfaces.blocks.spread(-1.0, &work.multipliers_in.local()?, &mut work.fluid_out)?;
        surfaces.closure.add_forces(-1.0, &tail, &mut work.fluid_out)?;
        stokes.balance(&mut work.fluid_out)?;
        let mut rows = surfaces.rows(&work.fluid_in, (&work.multipliers_in, &tail), &mut work.multipliers_out)?;
        let means = surfaces.closure.mean_velocities(surfaces.world, &work.fluid_in)?;
        rows[..means.len()].copy_from_slice(&means);
        watch.stop(&mut work.stages.bodies);
        work.join(&rows, output)
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let Parts { stokes, inverse, surfaces, work } = &mut self.0;
        let rows = work.split(surfaces.world, input)?;
        let watch = Watch::start(Stage::Inverse);
        inverse.precondition(stokes, &work.fluid_in, &mut work.fluid_out)?;
        watch.stop(&mut work.stages.inverse);
        let watch = Watch::start(Stage::Bodies);
        let forces = surfaces.closure.correct_mean_velocities(surfaces.world, &rows, &mut work.fluid_out)?;
        surfaces.blocks.sample(&work.fluid_out, &mut work.multipliers_out.local_mut()?)?;
        let mut tail = surfaces.precondition(&mut work.multipliers_in, &rows, &mut work.multipliers_out)?;
        tail[..forces.len()].copy_from_slice(&forces);
        watch.stop(&mut work.stages.bodies);
        work.join(&tail, output)
    }
}

impl<const D: usize> BodiesInFluid for Coupled<'_, D> {
    fn unknowns(&mut self, vector: &Vector) -> Result<Unknowns> {
        let Parts { surfaces, work, .. } = &mut self.0;
        let tail = work.split(surfaces.world, vector)?;
        surfaces.velocity(&work.fluid_in, (&work.multipliers_in, &tail), &mut work.multipliers_out)?;
        work.unknowns(tail)
    }
}
