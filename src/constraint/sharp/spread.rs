//! The block C: stencils that cross a surface, corrected for the jumps there.

use nalgebra::SVector;

use super::{Placed, jumps::Jumps, nodes::Nodes};
use crate::{
    constraint::{conservation::conserve_momentum, rows::Rows},
    grid::{
        Grid,
        stencil::{self, Site, Term},
    },
};

/// Most terms of a Laplacian besides its centre.
const MOST_TERMS: usize = 6;

/// The rows of C of one body, under way: first which jumps they take, then their values.
pub struct Spreading<'a, const D: usize> {
    grid: &'a Grid<D>,
    placed: &'a Placed<D>,
    nodes: &'a [Nodes<D>],
    /// Unknown of each row, and its offset from the centre.
    unknowns: Vec<u32>,
    offsets: Vec<SVector<f64, D>>,
    /// For each field, where its rows end.
    field_ends: Vec<usize>,
    /// For each row, where its groups end.
    row_ends: Vec<usize>,
    /// Terms from one field: the field, and where they end.
    groups: Vec<(usize, usize)>,
    /// Row of the jumps, and factor.
    terms: Vec<(u32, f64)>,
}

impl<'a, const D: usize> Spreading<'a, D> {
    /// Finds the rows that reach across the surface and asks for the jumps that they take.
    pub fn new(grid: &'a Grid<D>, placed: &'a Placed<D>, nodes: &'a [Nodes<D>], jumps: &mut [Jumps]) -> Self {
        let (unknowns, offsets, field_ends, row_ends) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut spreading =
            Spreading { grid, placed, nodes, unknowns, offsets, field_ends, row_ends, groups: Vec::new(), terms: Vec::new() };
        for field in 0..=D {
            spreading.find_rows(field, jumps);
            spreading.field_ends.push(spreading.unknowns.len());
        }
        spreading
    }

    fn find_rows(&mut self, field: usize, jumps: &mut [Jumps]) {
        let (radius, reach) = (self.placed.surface.modes.radius(), self.grid.spacing().max());
        let near = (radius - reach).max(0.0).powi(2)..=(radius + reach).powi(2);
        let nodes = &self.nodes[field];
        nodes.runs(
            self.grid,
            |row| row,
            |first, length, unknown| {
                for along in (0..length).filter(|along| near.contains(&nodes.squares[first + along])) {
                    self.find_row(field, first + along, jumps);
                    if self.groups.len() > self.row_ends.last().map_or(0, |&end| end) {
                        self.row_ends.push(self.groups.len());
                        self.unknowns.push((unknown + along) as u32);
                        self.offsets.push(nodes.position(first + along) - self.placed.center);
                    }
                }
            },
        );
    }

    /// Collects the corrections of a momentum row (along axis `field`) or of a continuity row.
    fn find_row(&mut self, field: usize, place: usize, jumps: &mut [Jumps]) {
        let (grid, nodes) = (self.grid, &self.nodes[field]);
        let (index, outside) = (nodes.patch.index(place), nodes.outside[place]);
        let side = if outside { 1.0 } else { -1.0 };
        if field == D {
            for axis in 0..D {
                self.group(axis, (outside, -side), stencil::divergence(grid, axis, index), jumps);
            }
            return;
        }
        let mut terms = [None; MOST_TERMS];
        let mut free = terms.iter_mut();
        stencil::laplacian(grid, field, index, |term| *free.next().expect("two terms an axis") = Some(term));
        self.group(field, (outside, side), terms.into_iter().flatten(), jumps);
        self.group(D, (outside, -side), stencil::gradient(grid, field, index), jumps);
    }

    /// Collects those terms, all of one field, that reach across the surface from a centre that lies `outside` or not.
    fn group(&mut self, field: usize, (outside, factor): (bool, f64), terms: impl IntoIterator<Item = Term<D>>, jumps: &mut [Jumps]) {
        let (nodes, before) = (&self.nodes[field], self.terms.len());
        for term in terms {
            let (Site::Lattice { index, .. } | Site::Wall { index, .. }) = term.site;
            let place = nodes.patch.place(index);
            if nodes.outside[place] != outside {
                self.terms.push((jumps[field].choose(place), factor * term.weight));
            }
        }
        if self.terms.len() > before {
            self.groups.push((field, self.terms.len()));
        }
    }

    /// All rows, from evaluated jumps; `values` is memory to use again.
    pub fn rows(self, jumps: &[Jumps], mut values: Vec<f64>) -> Rows {
        let count = self.placed.surface.modes.count();
        values.clear();
        values.reserve(self.unknowns.len() * count);
        let mut row = vec![0.0; jumps[D].stride()];
        let (mut group, mut term) = (0, 0);
        for &row_end in &self.row_ends {
            row.fill(0.0);
            for &(field, end) in &self.groups[group..row_end] {
                jumps[field].add(&self.terms[term..end], &mut row);
                term = end;
            }
            values.extend_from_slice(&row[..count]);
            group = row_end;
        }
        let mut start = 0;
        for (component, &end) in self.field_ends[..D].iter().enumerate() {
            let (offsets, values) = (&self.offsets[start..end], &mut values[start * count..end * count]);
            conserve_momentum(component, &self.placed.surface, self.grid.spacing().product(), offsets, values);
            start = end;
        }
        Rows::new(self.unknowns, values)
    }
}
