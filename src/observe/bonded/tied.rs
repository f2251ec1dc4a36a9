//! Which beads are lines, rings and cells.

use std::{
    collections::{HashMap, HashSet},
    ops::Range,
};

use crate::interaction::{Interactions, Measure};

/// Beads that are tied one to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Tied {
    /// Its number among chains, cells and clusters, as frames have it.
    pub number: usize,
    /// The bodies.
    pub beads: Range<usize>,
    /// What they make.
    pub form: Form,
}

/// What beads make.
#[derive(Debug, Clone, PartialEq)]
pub enum Form {
    /// A chain with two ends.
    Line,
    /// A chain whose ends are tied to each other.
    Ring,
    /// A cell, which keeps what it encloses.
    Cell(Measure),
}

/// All of them, in the order of their numbers.
pub fn tied<const D: usize>(interactions: &Interactions<D>) -> Vec<Tied> {
    let mut cells = HashMap::new();
    // of a cell in space volume and surface have the same triangles
    interactions.conserved().into_iter().for_each(|conserved| drop(cells.insert(conserved.bodies.start, conserved.measure)));
    let bonds: HashSet<[usize; 2]> = interactions.bonds().into_iter().map(|[one, other]| [one.min(other), one.max(other)]).collect();
    let form = |beads: &Range<usize>| match cells.remove(&beads.start) {
        Some(measure) => Form::Cell(measure),
        None if beads.len() > 2 && bonds.contains(&[beads.start, beads.end - 1]) => Form::Ring,
        None => Form::Line,
    };
    let forms: Vec<Form> = interactions.chains().iter().map(form).collect();
    (0..).zip(interactions.chains()).zip(forms).map(|((number, beads), form)| Tied { number, beads, form }).collect()
}
