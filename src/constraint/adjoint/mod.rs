//! Methods that spread by the adjoint of their sampling: `C = J^T S`, with strengths `S` on the diagonal.
//!
//! The fluid has to fulfil rows of a body, linear in the velocities at lattice points near it; what makes it do so are forces
//! at the same points. A method says which rows: [`penalty`], [`distributed`] or [`mean_value`]. The matrices of the box stay
//! as they are, as with every method, and so does their inverse.

mod body;
mod distributed;
mod elastic;
mod equations;
mod mean_value;
mod nodes;
mod penalty;
mod rigid;
mod strains;

use nalgebra::{SMatrix, SVector};

use super::{Layout, places::Places};
use super::{Method, Placed};
use crate::{
    error::Result,
    petsc::{Scatter, Vector},
};
use crate::{geometry::Ball, grid::Grid};
pub use body::AdjointBody;
pub use equations::FreeInverse;

/// The blocks of one body by one of these methods.
///
/// # Panics
/// For the sharp method, which is none of them.
pub fn assemble<const D: usize>(method: Method, grid: &Grid<D>, body: (usize, &Placed<D>)) -> AdjointBody<D> {
    match method {
        Method::MeanValue => mean_value::assemble(grid, body),
        Method::Distributed => distributed::assemble(grid, body),
        Method::Penalty { epsilon } => penalty::assemble(grid, body, epsilon),
        Method::Sharp => panic!("the sharp method spreads corrected stencils"),
    }
}

/// Number of multipliers of a body by one of the methods that has them at lattice points, besides those of rigid motions.
///
/// # Panics
/// For the methods with surface modes.
pub fn count<const D: usize>(method: Method, grid: &Grid<D>, ball: &Ball<D>) -> usize {
    match method {
        Method::Distributed => distributed::layer(grid, ball).count(),
        Method::Penalty { .. } => strains::Strains::of(grid, ball).strains.len(),
        Method::Sharp | Method::MeanValue => panic!("surface modes are counted by their order"),
    }
}

/// The blocks of this rank's bodies.
pub struct AdjointBlocks<const D: usize> {
    bodies: Vec<AdjointBody<D>>,
    /// For each of them, the index of its first multiplier in this rank's part.
    firsts: Vec<usize>,
    /// Entries of fluid vectors of other ranks.
    nodes: Scatter,
}

impl<const D: usize> AdjointBlocks<D> {
    /// Joins this rank's bodies, in the order of the layout; `fluid` is any fluid vector.
    pub fn new(fluid: &Vector, layout: &Layout, mut bodies: Vec<AdjointBody<D>>) -> Result<AdjointBlocks<D>> {
        let mut places = Places::new(fluid)?;
        bodies.iter_mut().for_each(|body| body.plan(&mut places));
        let firsts = layout.local_bodies.iter().map(|&body| layout.local(body)).collect();
        Ok(AdjointBlocks { bodies, firsts, nodes: places.scatter(fluid)? })
    }

    /// The bodies, one by one.
    pub fn into_bodies(self) -> Vec<AdjointBody<D>> {
        self.bodies
    }

    /// One of the bodies.
    pub fn body(&self, local: usize) -> &AdjointBody<D> {
        &self.bodies[local]
    }

    fn placed(&self) -> impl Iterator<Item = (&AdjointBody<D>, std::ops::Range<usize>)> {
        self.bodies.iter().zip(&self.firsts).map(|(body, &first)| (body, first..first + body.count()))
    }

    /// `rows += factor * C c`, with this rank's multipliers `c`.
    pub fn spread(&mut self, factor: f64, c: &[f64], rows: &mut Vector) -> Result<()> {
        {
            let (mut own, mut others) = (rows.local_mut()?, self.nodes.places()?);
            for (body, &first) in self.bodies.iter().zip(&self.firsts) {
                body.spread(factor, &c[first..first + body.count()], &mut own, &mut others);
            }
        }
        self.nodes.add_back(rows)
    }

    /// `out = J u`, this rank's multipliers, for the velocity of a fluid vector (zero on walls).
    pub fn sample(&mut self, fluid: &Vector, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.nodes.fetch(fluid)?, fluid.local()?);
        for (body, &first) in self.bodies.iter().zip(&self.firsts) {
            body.sample(&own, &others, &mut out[first..first + body.count()]);
        }
        Ok(())
    }

    /// As [`sample`](Self::sample), for a velocity that is that of the moving walls there.
    pub fn sample_with_walls(&mut self, fluid: &Vector, out: &mut [f64]) -> Result<()> {
        self.sample(fluid, out)?;
        self.placed().for_each(|(body, range)| body.add_walls(&mut out[range]));
        Ok(())
    }

    /// `out += E c`.
    pub fn add_local(&self, c: &[f64], out: &mut [f64]) -> Result<()> {
        self.placed().for_each(|(body, range)| body.add_compliance(&c[range.clone()], &mut out[range]));
        Ok(())
    }

    /// What the rows of one of the bodies make of a velocity known at each offset from its centre.
    pub fn coefficients(&self, local: usize, known: impl Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        self.bodies[local].coefficients(known)
    }

    /// First moment of what one of the bodies does to the fluid.
    pub fn first_moment(&self, local: usize, multipliers: &[f64]) -> SMatrix<f64, D, D> {
        self.bodies[local].first_moment(multipliers)
    }
}
