//! Lattice points that the rows of a body take, each once.

use std::collections::HashMap;

use nalgebra::SVector;

use crate::{
    constraint::places::{Places, from},
    geometry::Axis,
    grid::{Grid, Index, Node},
};

/// The velocities that the rows of a body take.
pub struct Nodes<const D: usize> {
    /// Indices in fluid vectors.
    unknowns: Vec<u32>,
    /// Once planned, their places.
    places: Vec<u32>,
    /// Components of the velocity.
    pub components: Vec<u8>,
    /// Where they are, from the centre of the body.
    pub offsets: Vec<SVector<f64, D>>,
}

/// Collects the nodes of a body around a centre.
pub struct Collector<'a, const D: usize> {
    grid: &'a Grid<D>,
    center: SVector<f64, D>,
    known: HashMap<u32, u32>,
    /// What is collected.
    pub nodes: Nodes<D>,
}

impl<'a, const D: usize> Collector<'a, D> {
    /// Nothing yet.
    pub fn new(grid: &'a Grid<D>, center: SVector<f64, D>) -> Self {
        let nodes = Nodes { unknowns: Vec::new(), places: Vec::new(), components: Vec::new(), offsets: Vec::new() };
        Collector { grid, center, known: HashMap::new(), nodes }
    }

    /// The number of the node at an index of a component's lattice; nothing on a wall, where the velocity is known.
    pub fn node(&mut self, component: usize, index: Index<D>) -> Option<u32> {
        let Node::Unknown(unknown) = self.grid.fluid_node(component, index) else { return None };
        let nodes = &mut self.nodes;
        Some(*self.known.entry(unknown as u32).or_insert_with(|| {
            nodes.unknowns.push(unknown as u32);
            nodes.components.push(component as u8);
            nodes.offsets.push(self.grid.position(component, index) - self.center);
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

    /// Finds the places of the unknowns.
    pub fn plan(&mut self, places: &mut Places) {
        self.places = self.unknowns.iter().map(|&unknown| places.of(unknown as usize, 1)).collect();
    }

    /// The values at the nodes, from this rank's entries and those of others.
    pub fn values(&self, own: &[f64], others: &[f64]) -> Vec<f64> {
        self.places.iter().map(|&place| from(own, others, place)[0]).collect()
    }

    /// Adds values at the nodes, times `factor`, to entries of this rank and of others.
    pub fn add(&self, factor: f64, values: &[f64], own: &mut [f64], others: &mut [f64]) {
        for (place, value) in self.places.iter().zip(values) {
            let place = *place as usize;
            let entry = if place < own.len() { &mut own[place] } else { &mut others[place - own.len()] };
            *entry += factor * value;
        }
    }
}
