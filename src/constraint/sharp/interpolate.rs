//! The blocks J and E: the velocity on a surface, interpolated from the inner extension.

use std::ops::Range;

use nalgebra::{DMatrix, DMatrixView, Dyn, SVector};

use super::{
    jumps::Jumps,
    nodes::{JumpNodes, reach},
};
use crate::{
    constraint::{
        dense::LocalBlock,
        interpolant::{Interpolant, NodeBox, NodeRun, PointWeights, row_offsets, row_weights},
        placed::{Neighbour, Placed},
        unknowns::Unknowns,
    },
    grid::{
        Grid,
        interpolation::{self, NODES},
        stencil::Site,
    },
    petsc::index,
};

/// Most nodes that interpolation takes at a point.
const MOST_NODES: usize = NODES * NODES * NODES;

/// The interpolation on one body's surface.
pub struct Interpolation<'a, const D: usize> {
    grid: &'a Grid<D>,
    placed: &'a Placed<D>,
    nodes: &'a [JumpNodes<D>],
    /// For each component, whether each node is met.
    met: Vec<Vec<bool>>,
    /// The block J.
    pub interpolant: Interpolant<D>,
}

/// Jumps interpolated at surface points: the rows (point and component) that meet any, and one value a mode for each.
#[derive(Default)]
pub struct Interpolated {
    /// Whether blocks that meet few points are left as values there, to be projected with what is interpolated.
    pub at_points: bool,
    rows: Vec<u32>,
    /// Length of a row of `values`.
    stride: usize,
    values: Vec<f64>,
}

impl<'a, const D: usize> Interpolation<'a, D> {
    /// Finds the nodes, and asks for the jumps of the body at those outside it.
    pub fn new(grid: &'a Grid<D>, placed: &'a Placed<D>, nodes: &'a [JumpNodes<D>], jumps: &mut [Jumps]) -> Self {
        let interpolant = Interpolant { boxes: Vec::new(), weights: PointWeights::Even(Vec::new()), wall_values: Vec::new() };
        let mut found = Interpolation { grid, placed, nodes, met: Vec::new(), interpolant };
        let corners = found.find_corners();
        for ((nodes, corners), jumps) in nodes.iter().zip(corners).zip(jumps) {
            let met = met(nodes, &corners);
            (0..met.len()).filter(|&place| met[place] && nodes.outside[place]).for_each(|place| {
                jumps.choose(place);
            });
            let runs = runs(grid, nodes, &met);
            let (length, strides) = (nodes.indices.len(), nodes.indices.strides());
            found.interpolant.boxes.push(NodeBox { lattice: nodes.lattice, length, strides, runs, corners });
            found.met.push(met);
        }
        found
    }

    /// The first node of each point, component by component; fills in weights and what walls add.
    fn find_corners(&mut self) -> Vec<Vec<u32>> {
        let unknowns = Unknowns::of(self.placed.surface.modes.as_ref());
        let points = self.placed.surface.points();
        let mut corners = vec![Vec::with_capacity(points); unknowns.components::<D>()];
        let (mut parts, mut weights, mut at_wall) = (Vec::with_capacity(points), Vec::new(), false);
        for (point, offset) in self.placed.surface.offsets().enumerate() {
            let position = self.placed.center + offset;
            let straight = self.grid.straightened(position);
            // the fields along the axis and the pressure have their points on faces and between them
            let lines: [_; D] =
                std::array::from_fn(|axis| [axis, D].map(|field| interpolation::line(self.grid, field, axis, straight[axis])));
            parts.push(lines.each_ref().map(|pair| pair.each_ref().map(|line| line.part)));
            weights.push(lines.each_ref().map(|pair| pair.each_ref().map(|line| line.weight)));
            at_wall |= lines.iter().flatten().any(|line| line.wall.is_some());
            for (component, corners) in corners.iter_mut().enumerate() {
                let lattice = self.nodes[component].lattice;
                let first = std::array::from_fn(|axis| lines[axis][usize::from(axis != lattice)].index[0]);
                corners.push(self.nodes[component].indices.place(first) as u32);
            }
            if unknowns == Unknowns::Fluid && lines.iter().flatten().any(|line| line.wall.is_some()) {
                self.add_walls(point, &position);
            }
        }
        self.interpolant.weights = if at_wall { PointWeights::AtWall(weights) } else { PointWeights::Even(parts) };
        corners
    }

    fn add_walls(&mut self, point: usize, position: &SVector<f64, D>) {
        let values = &mut self.interpolant.wall_values;
        values.resize(self.placed.surface.points() * D, 0.0);
        for component in 0..D {
            interpolation::velocity(self.grid, component, position, |term| {
                if let Site::Wall { value, .. } = term.site {
                    values[point * D + component] += term.weight * value;
                }
            });
        }
    }

    /// The transposed block of E of the body's own jumps.
    pub fn own_block(&self, body: usize, jumps: &[Jumps], interpolated: &mut Interpolated) -> Option<LocalBlock> {
        let met = |component: usize, place: usize| self.nodes[component].outside[place];
        self.interpolate(jumps, |_| true, met, interpolated);
        interpolated.block(self.placed, body, self.placed, -1.0)
    }

    /// The transposed block of E of a neighbour's jumps, zero in its core, if interpolation meets its inside.
    pub fn neighbour_block(
        &self,
        (body, neighbour): &Neighbour<D>,
        core: f64,
        jumps: &mut [Jumps],
        interpolated: &mut Interpolated,
    ) -> Option<LocalBlock> {
        for ((nodes, met), jumps) in self.nodes.iter().zip(&self.met).zip(&mut *jumps) {
            jumps.turn_to(neighbour, nodes);
            nodes.inside(neighbour, |place| {
                if met[place] {
                    jumps.choose(place);
                }
            });
            jumps.evaluate(nodes, neighbour, core);
        }
        let (radius, reach) = (neighbour.ball().radius, reach(self.grid));
        let near = |offset: &SVector<f64, D>| {
            let separation = self.placed.center + offset - neighbour.center;
            separation.norm_squared() < (radius + reach * (D as f64).sqrt()).powi(2) && separation.amax() < radius + reach
        };
        let met = |component: usize, place: usize| jumps[component].has(place);
        self.interpolate(jumps, near, met, interpolated);
        interpolated.block(self.placed, *body, neighbour, 1.0)
    }

    /// Interpolates jumps, at points that may be `near` them, over the nodes that are `met`.
    fn interpolate(
        &self,
        jumps: &[Jumps],
        near: impl Fn(&SVector<f64, D>) -> bool,
        met: impl Fn(usize, usize) -> bool,
        interpolated: &mut Interpolated,
    ) {
        interpolated.clear(jumps[0].stride());
        let components = self.interpolant.boxes.len();
        if jumps[..components].iter().all(Jumps::is_empty) {
            return;
        }
        let offsets: Vec<_> = self.interpolant.boxes.iter().map(|nodes| row_offsets(nodes.strides)).collect();
        let mut terms = [(0, 0.0); MOST_NODES];
        for (point, _) in self.placed.surface.offsets().enumerate().filter(|(_, offset)| near(offset)) {
            for component in (0..components).filter(|&component| !jumps[component].is_empty()) {
                let NodeBox { lattice, corners, .. } = &self.interpolant.boxes[component];
                let corner = corners[point] as usize;
                let weights = self.interpolant.weights.of(point, *lattice);
                let mut found = 0;
                for (offset, weight) in offsets[component].iter().zip(row_weights(&weights)).take(NODES.pow(D as u32 - 1)) {
                    for (along, last) in weights[D - 1].iter().enumerate() {
                        let place = corner + offset + along;
                        terms[found] = (jumps[component].row(place), weight * last);
                        found += usize::from(met(component, place));
                    }
                }
                interpolated.add(point * components + component, &jumps[component], &terms[..found]);
            }
        }
    }
}

fn met<const D: usize>(nodes: &JumpNodes<D>, corners: &[u32]) -> Vec<bool> {
    let offsets = row_offsets(nodes.indices.strides());
    let mut met = vec![false; nodes.indices.len()];
    for &corner in corners {
        for offset in &offsets[..NODES.pow(D as u32 - 1)] {
            met[corner as usize + offset..][..NODES].fill(true);
        }
    }
    met
}

/// What is to be fetched: in each row of nodes, from the first to the last that is met.
fn runs<const D: usize>(grid: &Grid<D>, nodes: &JumpNodes<D>, met: &[bool]) -> Vec<NodeRun> {
    let narrowed = |row: Range<usize>| {
        let first = row.clone().find(|&place| met[place]).unwrap_or(row.end);
        first..row.rev().find(|&place| met[place]).map_or(first, |last| last + 1)
    };
    let mut runs = Vec::new();
    nodes.runs(grid, narrowed, |start, length, unknown| {
        runs.push(NodeRun { start: start as u32, length: length as u32, unknown: index(unknown), place: 0 });
    });
    runs.shrink_to_fit();
    runs
}

impl Interpolated {
    fn clear(&mut self, stride: usize) {
        self.rows.clear();
        self.values.clear();
        self.stride = stride;
    }

    fn add(&mut self, row: usize, jumps: &Jumps, terms: &[(u32, f64)]) {
        if !terms.is_empty() {
            self.rows.push(row as u32);
            let start = self.values.len();
            self.values.resize(start + self.stride, 0.0);
            jumps.add(terms, &mut self.values[start..]);
        }
    }

    /// The block of E of the jumps of a body, times `sign`, transposed: its modes down; modes of the surface across, or the values that are met
    /// if they are fewer.
    fn block<const D: usize>(&self, placed: &Placed<D>, body: usize, of: &Placed<D>, sign: f64) -> Option<LocalBlock> {
        let (met, modes) = (self.rows.len(), of.surface.modes.jump_count());
        if met == 0 {
            return None;
        }
        let values = DMatrixView::<f64, Dyn, Dyn>::from_slice_with_strides(&self.values, modes, met, 1, self.stride);
        if self.at_points && met < placed.surface.modes.count() {
            return Some(LocalBlock { body, transposed: values * sign, at_points: Some(self.rows.clone()) });
        }
        Some(LocalBlock { body, transposed: self.project(placed, &values, sign), at_points: None })
    }

    fn project<const D: usize>(&self, placed: &Placed<D>, values: &DMatrixView<f64, Dyn, Dyn>, sign: f64) -> DMatrix<f64> {
        let (projector, selected) = (placed.surface.projector(), &self.rows);
        let selection;
        let projector = if selected.len() == projector.ncols() {
            projector
        } else {
            selection = projector.select_columns(&selected.iter().map(|&row| row as usize).collect::<Vec<_>>());
            &selection
        };
        let count = projector.nrows();
        let transposed = DMatrixView::<f64, Dyn, Dyn>::from_slice_with_strides(projector.as_slice(), selected.len(), count, count, 1);
        let mut block = DMatrix::zeros(values.nrows(), count);
        block.gemm(sign, values, &transposed, 0.0);
        block
    }
}
