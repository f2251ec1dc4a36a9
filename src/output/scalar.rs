//! The numbers of a scalar around inclusions.

use serde::Serialize;

use super::{Summary, summary::SolverSummary};
use crate::{
    grid::Grid,
    parallel::World,
    simulation::{Cost, InclusionState, ScalarSetup, ScalarSolution},
};

/// The scalar problem.
#[derive(Debug, Clone, Serialize)]
pub struct ScalarSummary {
    /// Source per volume outside the inclusions.
    pub source: f64,
    /// Least value of `1/2 integral |grad u|^2 - integral of source u` outside the inclusions.
    pub energy: f64,
    /// The inclusions.
    pub inclusions: Vec<InclusionSummary>,
}

/// One inclusion.
#[derive(Debug, Clone, Serialize)]
pub struct InclusionSummary {
    /// Its centre.
    pub center: Vec<f64>,
    /// Its radius.
    pub radius: f64,
    /// The scalar in it.
    pub value: f64,
    /// Net flux out of it.
    pub flux: f64,
}

impl Summary {
    /// The numbers of a scalar problem; collective. `named` is the scene's name and title, `solver` the word for what inverted the matrix
    /// and what that cost.
    pub fn of_scalar<const D: usize>(
        named: (&str, &str),
        (setup, grid): (&ScalarSetup<D>, &Grid<D>),
        (solution, solver): (&ScalarSolution<D>, (&'static str, &Cost)),
        world: &World,
    ) -> Summary {
        let held = solution.inclusions.iter().filter(|inclusion| grid.owner(&inclusion.center) == world.rank()).count();
        let scalar = ScalarSummary {
            source: setup.source,
            energy: solution.energy,
            inclusions: solution.inclusions.iter().map(InclusionSummary::new).collect(),
        };
        Summary {
            scalar: Some(scalar),
            solver: Some(SolverSummary::of_cost(solver.0, solver.1, world)),
            ..Summary::of_bodies(named, (Vec::new(), setup.fraction()), (held, grid.local_unknowns(D)), world)
        }
    }
}

impl InclusionSummary {
    fn new<const D: usize>(state: &InclusionState<D>) -> InclusionSummary {
        let InclusionState { center, radius, value, flux } = *state;
        InclusionSummary { center: center.as_slice().to_vec(), radius, value, flux }
    }
}
