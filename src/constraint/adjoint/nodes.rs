//! Lattice points that the rows of a body take, each once.

use std::collections::HashMap;

use nalgebra::SVector;

use crate::{
    constraint::{
        places::{Entries, EntriesMut, Places},
        unknowns::Unknowns,
    },
    grid::{Grid, Index},
};

/// The values that the rows of a body take.
pub struct AdjointNodes<const D: usize> {
    /// Indices in vectors.
    unknowns: Vec<usize>,
    /// Once planned, their places when values are taken, and when they are added to.
    places: [Vec<u32>; 2],
    /// Their components.
    pub components: Vec<u8>,
    /// Where they are, from the centre of the body.
    pub offsets: Vec<SVector<f64, D>>,
}

/// Collects the nodes of a body around a centre.
pub struct Collector<'a, const D: usize> {
    grid: &'a Grid<D>,
    unknowns: Unknowns,
    center: SVector<f64, D>,
    known: HashMap<usize, u32>,
    /// What is collected.
    pub nodes: AdjointNodes<D>,
}

impl<'a, const D: usize> Collector<'a, D> {
    /// Nothing yet.
    pub fn new(grid: &'a Grid<D>, unknowns: Unknowns, center: SVector<f64, D>) -> Self {
        let nodes = AdjointNodes { unknowns: Vec::new(), places: Default::default(), components: Vec::new(), offsets: Vec::new() };
        Collector { grid, unknowns, center, known: HashMap::new(), nodes }
    }

    /// The number of the node at an index of a component's lattice; nothing on a wall, where the velocity is known.
    pub fn node(&mut self, component: usize, index: Index<D>) -> Option<u32> {
        let (unknown, lattice) = (self.unknowns.at(self.grid, component, index)?, self.unknowns.lattice::<D>(component));
        let nodes = &mut self.nodes;
        Some(*self.known.entry(unknown).or_insert_with(|| {
            nodes.unknowns.push(unknown);
            nodes.components.push(component as u8);
            nodes.offsets.push(self.grid.position(lattice, index) - self.center);
            nodes.unknowns.len() as u32 - 1
        }))
    }
}

/// Whether an index of a component's lattice lies between the walls or on them.
pub fn within_walls<const D: usize>(grid: &Grid<D>, component: usize, index: Index<D>) -> bool {
    (0..D).all(|axis| grid.between_walls(component, axis, index[axis]))
}

impl<const D: usize> AdjointNodes<D> {
    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.unknowns.len()
    }

    /// Their indices in vectors.
    pub fn unknowns(&self) -> &[usize] {
        &self.unknowns
    }

    /// Finds the places of the unknowns among those that are read and those that are added to.
    pub fn plan(&mut self, read: &mut Places, spread: &mut Places) {
        self.places = [read, spread].map(|places| places.each(&self.unknowns));
    }

    /// The values at the nodes.
    pub fn values(&self, u: Entries) -> Vec<f64> {
        self.places[0].iter().map(|&place| u.from(place)[0]).collect()
    }

    /// Adds values at the nodes, times `factor`.
    pub fn add(&self, factor: f64, values: &[f64], rows: &mut EntriesMut) {
        self.places[1].iter().zip(values).for_each(|(&place, value)| *rows.at(place) += factor * value);
    }
}
