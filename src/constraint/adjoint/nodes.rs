//! Lattice points that the rows of a body take, and the rows: sparse, each node of a body once.

use std::collections::HashMap;

use nalgebra::SVector;

use crate::{
    constraint::{
        places::{Places, Seen, SeenMut},
        unknowns::Unknowns,
    },
    geometry::Axis,
    grid::{Grid, Index},
};

/// The values that the rows of a body take.
pub struct Nodes<const D: usize> {
    /// Indices in vectors.
    unknowns: Vec<u32>,
    /// Once planned, their places when values are taken, and when they are added to.
    places: [Vec<u32>; 2],
    /// Their components.
    pub components: Vec<u8>,
    /// Where they are, from the centre of the body.
    pub offsets: Vec<SVector<f64, D>>,
}

/// Rows over the nodes.
#[derive(Default)]
pub struct SparseRows {
    ends: Vec<u32>,
    terms: Vec<(u32, f64)>,
}

/// Collects the nodes of a body around a centre.
pub struct Collector<'a, const D: usize> {
    grid: &'a Grid<D>,
    unknowns: Unknowns,
    center: SVector<f64, D>,
    known: HashMap<u32, u32>,
    /// What is collected.
    pub nodes: Nodes<D>,
}

impl<'a, const D: usize> Collector<'a, D> {
    /// Nothing yet.
    pub fn new(grid: &'a Grid<D>, unknowns: Unknowns, center: SVector<f64, D>) -> Self {
        let nodes = Nodes { unknowns: Vec::new(), places: Default::default(), components: Vec::new(), offsets: Vec::new() };
        Collector { grid, unknowns, center, known: HashMap::new(), nodes }
    }

    /// The number of the node at an index of a component's lattice; nothing on a wall, where the velocity is known.
    pub fn node(&mut self, component: usize, index: Index<D>) -> Option<u32> {
        let (unknown, lattice) = (self.unknowns.at(self.grid, component, index)?, self.unknowns.lattice::<D>(component));
        let nodes = &mut self.nodes;
        Some(*self.known.entry(unknown as u32).or_insert_with(|| {
            nodes.unknowns.push(unknown as u32);
            nodes.components.push(component as u8);
            nodes.offsets.push(self.grid.position(lattice, index) - self.center);
            nodes.unknowns.len() as u32 - 1
        }))
    }
}

/// Whether an index of a component's lattice lies between the walls or on them.
pub fn within_walls<const D: usize>(grid: &Grid<D>, component: usize, index: Index<D>) -> bool {
    (0..D).all(|axis| match grid.domain().axes[axis] {
        Axis::Periodic | Axis::Sheared(_) => true,
        Axis::Walls { .. } => (0..grid.cells()[axis] as isize + isize::from(component == axis)).contains(&index[axis]),
    })
}

impl<const D: usize> Nodes<D> {
    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.unknowns.len()
    }

    /// Their indices in vectors.
    pub fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    /// Finds the places of the unknowns among those that are read and those that are added to.
    pub fn plan(&mut self, read: &mut Places, spread: &mut Places) {
        self.places = [read, spread].map(|places| places.each(&self.unknowns));
    }

    /// The values at the nodes.
    pub fn values(&self, u: Seen) -> Vec<f64> {
        self.places[0].iter().map(|&place| u.from(place)[0]).collect()
    }

    /// Adds values at the nodes, times `factor`.
    pub fn add(&self, factor: f64, values: &[f64], rows: &mut SeenMut) {
        self.places[1].iter().zip(values).for_each(|(&place, value)| *rows.at(place) += factor * value);
    }
}

impl SparseRows {
    /// Adds a row.
    pub fn push(&mut self, terms: impl IntoIterator<Item = (u32, f64)>) {
        self.terms.extend(terms);
        self.ends.push(self.terms.len() as u32);
    }

    /// The rows, as nodes and weights.
    pub fn iter(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.terms[start as usize..end as usize])
    }

    /// The rows of values at the nodes.
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        self.iter().map(|row| row.iter().map(|&(node, weight)| weight * values[node as usize]).sum()).collect()
    }

    /// The adjoint: values at so many nodes.
    pub fn transposed(&self, rows: &[f64], nodes: usize) -> Vec<f64> {
        let mut values = vec![0.0; nodes];
        for (row, value) in self.iter().zip(rows) {
            row.iter().for_each(|&(node, weight)| values[node as usize] += weight * value);
        }
        values
    }
}
