//! What one body adds, whatever its rows.

use std::rc::Rc;

use nalgebra::{SMatrix, SVector};

use super::{
    equations::{Equations, FreeInverse},
    nodes::Nodes,
};
use crate::{constraint::places::Places, linalg::SparseRows};

/// A body whose multipliers act where its rows look.
pub struct AdjointBody<const D: usize> {
    /// Its number.
    pub body: usize,
    /// Its centre, for which it was assembled.
    pub center: SVector<f64, D>,
    /// Lattice points near it.
    pub(super) nodes: Nodes<D>,
    /// Values of the fluid over the nodes.
    pub(super) rows: SparseRows,
    /// What moving walls add to the values; empty if no wall is near.
    pub(super) wall_values: Vec<f64>,
    /// Equations of the values.
    pub(super) equations: Equations<D>,
    /// Volume that belongs to a node.
    pub(super) cell: f64,
}

impl<const D: usize> AdjointBody<D> {
    /// Number of its multipliers, those of rigid motions first.
    pub fn count(&self) -> usize {
        self.equations.count()
    }

    /// Approximate inverse of the diagonal block in the rows that are not rigid, unless the rows are those of surface modes.
    pub fn free_inverse(&self) -> Option<Rc<FreeInverse>> {
        match &self.equations {
            Equations::Surface { .. } => None,
            Equations::Rows(rows) => Some(rows.inverse.clone()),
        }
    }

    /// Finds the places of the nodes.
    pub fn plan(&mut self, places: &mut Places) {
        self.nodes.plan(places);
    }

    /// Adds `factor * C c` to entries of this rank and of others.
    pub fn spread(&self, factor: f64, c: &[f64], own: &mut [f64], others: &mut [f64]) {
        self.nodes.add(factor, &self.forces(c), own, others);
    }

    /// `out = J u`.
    pub fn sample(&self, own: &[f64], others: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&self.equations.apply(self.rows.apply(&self.nodes.values(own, others))));
    }

    /// Adds what moving walls contribute to `J u`.
    pub fn add_walls(&self, out: &mut [f64]) {
        if !self.wall_values.is_empty() {
            let added = self.equations.apply(self.wall_values.clone());
            out.iter_mut().zip(added).for_each(|(out, added)| *out += added);
        }
    }

    /// `out += E c`.
    pub fn add_compliance(&self, c: &[f64], out: &mut [f64]) {
        if let Equations::Rows(rows) = &self.equations {
            let others = out[rows.rigid..].iter_mut().zip(&c[rows.rigid..]);
            others.zip(&rows.compliance).for_each(|((out, c), compliance)| *out += compliance * c);
        }
    }

    /// What the rows make of a velocity known at each offset from the centre.
    pub fn coefficients(&self, known: impl Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        let nodes = self.nodes.components.iter().zip(&self.nodes.offsets);
        let values: Vec<f64> = nodes.map(|(&component, offset)| known(offset)[component as usize]).collect();
        self.equations.apply(self.rows.apply(&values))
    }

    /// First moment `sum of F_i r_j` of the forces at the nodes.
    pub fn first_moment(&self, c: &[f64]) -> SMatrix<f64, D, D> {
        let mut moment = SMatrix::zeros();
        for ((&component, offset), force) in self.nodes.components.iter().zip(&self.nodes.offsets).zip(self.forces(c)) {
            (0..D).for_each(|axis| moment[(component as usize, axis)] += self.cell * force * offset[axis]);
        }
        moment
    }

    /// Forces per volume at the nodes.
    fn forces(&self, c: &[f64]) -> Vec<f64> {
        self.rows.apply_transpose(&self.equations.forces(c), self.nodes.count())
    }
}
