//! What one body adds whose multipliers act where its rows look: `C = J^T S`.

use nalgebra::{SMatrix, SVector};

use super::{equations::Equations, nodes::AdjointNodes};
use crate::{
    constraint::{
        body::{BodyBlocks, BodyRows, InteriorBlocks, Plans, Walls},
        interior::InteriorForce,
        layout::MultiplierLayout,
        placed::Placed,
        places::{Entries, EntriesMut},
    },
    grid::Grid,
    linalg::SparseRows,
};

/// A body whose multipliers act where its rows look.
pub struct AdjointBody<const D: usize> {
    /// Lattice points near it.
    pub nodes: AdjointNodes<D>,
    /// Values of the grid over the nodes.
    pub rows: SparseRows,
    /// What moving walls add to the values; empty if no wall is near.
    pub wall_values: Vec<f64>,
    /// Equations of the values.
    pub equations: Equations<D>,
    /// Volume that belongs to a node.
    pub cell: f64,
    /// The force inside, if there is inertia.
    pub interior: Option<InteriorForce>,
}

impl<const D: usize> AdjointBody<D> {
    /// One whose multipliers are modes of its surface: rows are the values at the points of it, one a component, and `wall_values` what
    /// moving walls add to them.
    pub fn on_surface(
        grid: &Grid<D>,
        placed: &Placed<D>,
        nodes: AdjointNodes<D>,
        rows: SparseRows,
        wall_values: Vec<f64>,
    ) -> AdjointBody<D> {
        let cell = grid.spacing().product();
        let equations = Equations::Surface { surface: placed.surface.clone(), strength: placed.surface.area() / cell };
        AdjointBody { nodes, rows, wall_values, equations, cell, interior: None }
    }

    /// Forces per volume at the nodes.
    fn forces(&self, c: &[f64]) -> Vec<f64> {
        self.rows.apply_transpose(&self.equations.forces(c), self.nodes.count())
    }
}

impl<const D: usize> BodyBlocks<D> for AdjointBody<D> {
    fn count(&self) -> usize {
        self.equations.count()
    }

    fn plan(&mut self, _layout: &MultiplierLayout, plans: &mut Plans) {
        self.nodes.plan(&mut plans.read, &mut plans.spread);
        if let Some(interior) = &mut self.interior {
            interior.plan(&mut plans.spread);
        }
    }

    fn spread(&self, factor: f64, c: &[f64], _scratch: &mut Vec<f64>, rows: &mut EntriesMut) {
        self.nodes.add(factor, &self.forces(c), rows);
        if let Some(interior) = &self.interior {
            interior.add_of_rotations::<D>(factor, c, rows);
        }
    }

    fn read(&self, u: Entries, walls: Walls, _scratch: &mut Vec<f64>, out: &mut [f64]) {
        let mut values = self.rows.apply(&self.nodes.values(u));
        if walls == Walls::Moving {
            values.iter_mut().zip(&self.wall_values).for_each(|(value, wall)| *value += wall);
        }
        out.copy_from_slice(&match &self.equations {
            Equations::Surface { .. } => values,
            Equations::Rows(rows) => rows.without_motion(values),
        });
    }

    fn rows(&self) -> BodyRows<'_, D> {
        match &self.equations {
            Equations::Surface { surface, .. } => BodyRows::Surface(surface),
            Equations::Rows(rows) => BodyRows::Own(Some(&rows.inverse)),
        }
    }

    fn add_local(&self, own: &[f64], _all: Entries, out: &mut [f64]) {
        if let Equations::Rows(rows) = &self.equations {
            let others = out[rows.rigid..].iter_mut().zip(&own[rows.rigid..]);
            others.zip(&rows.compliance).for_each(|((out, c), compliance)| *out += compliance * c);
        }
    }

    fn interior(&self) -> Option<&dyn InteriorBlocks> {
        self.interior.as_ref().map(|interior| interior as &dyn InteriorBlocks)
    }

    fn coefficients(&self, known: &dyn Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        let nodes = self.nodes.components.iter().zip(&self.nodes.offsets);
        let values: Vec<f64> = nodes.map(|(&component, offset)| known(offset)[component as usize]).collect();
        self.equations.apply(self.rows.apply(&values))
    }

    fn first_moment(&self, c: &[f64]) -> SMatrix<f64, D, D> {
        let mut moment = SMatrix::zeros();
        for ((&component, offset), force) in self.nodes.components.iter().zip(&self.nodes.offsets).zip(self.forces(c)) {
            (0..D).for_each(|axis| moment[(component as usize, axis)] += self.cell * force * offset[axis]);
        }
        moment
    }
}
