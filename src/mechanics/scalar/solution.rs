//! What a solve of the scalar problem finds.

use nalgebra::SVector;

use super::{setup::ScalarSetup, uzawa::Uzawa};
use crate::{fitted::MeshScalar, grid::Grid, petsc::Vector, system::Cost};

/// An inclusion and what is found for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InclusionState<const D: usize> {
    /// Its centre, in the box.
    pub center: SVector<f64, D>,
    /// Its radius.
    pub radius: f64,
    /// The scalar in it: its mean over the surface, or over its cells.
    pub value: f64,
    /// Net flux out of it, zero up to the tolerance.
    pub flux: f64,
}

/// A scalar problem with its solution.
#[derive(Clone, Copy)]
pub struct SolvedScalar<'a, const D: usize> {
    /// What was solved.
    pub setup: &'a ScalarSetup<D>,
    /// The grid on which the scalar is given.
    pub grid: &'a Grid<D>,
    /// The solution.
    pub solution: &'a ScalarSolution<D>,
    /// The word for what inverted the matrix.
    pub inverse: &'static str,
    /// What that cost.
    pub cost: &'a Cost,
}

/// The solution of the scalar problem.
pub struct ScalarSolution<const D: usize> {
    /// All inclusions, on every rank.
    pub inclusions: Vec<InclusionState<D>>,
    /// The scalar at cell centres, this rank's part; with a mean gradient, what it has besides, which is periodic.
    pub field: Vector,
    /// The scalar on the mesh, if it was found on one.
    pub on_mesh: Option<MeshScalar>,
    /// The least value of the functional that it minimises.
    pub energy: f64,
    /// With a mean gradient, the mean of what flows down the scalar, turned round: in an empty box, the gradient itself.
    pub mean_flux: Option<SVector<f64, D>>,
    /// How Uzawa's iteration went, if it was it.
    pub uzawa: Option<Uzawa>,
}
