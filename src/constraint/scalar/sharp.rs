//! The sharp method: flux multipliers on the surface, and stencils corrected for the jump of the slope.
//!
//! As in the method for velocities, a stencil takes values from across a surface as its own side would extend them, and values on a
//! surface are interpolated from its inner extension, which in the solution is a constant.

use nalgebra::{DMatrix, SVector};

use super::{
    PlacedInclusion,
    blocks::InclusionBlocks,
    coupling::{Coupling, Modes},
    nodes::Nodes,
};
use crate::{
    constraint::{
        Layout,
        conservation::{TERMS, conserve},
        dense::LocalBlock,
        rows::Rows,
    },
    grid::{
        Grid, dirichlet,
        interpolation::{self, NODES},
    },
};

/// The place of a node that has none.
const EMPTY: usize = usize::MAX;

/// The blocks of an inclusion, from it and the neighbours, with their numbers, that its interpolation may meet.
pub fn assemble<const D: usize>(
    grid: &Grid<D>,
    layout: &Layout,
    (body, inclusion): (usize, &PlacedInclusion<D>),
    neighbours: &[(usize, PlacedInclusion<D>)],
) -> InclusionBlocks {
    let nodes = Nodes::around(grid, inclusion);
    let (rows, source) = corrections(grid, inclusion, &nodes);
    let sampling = Sampling::new(grid, inclusion, &nodes);
    let (mut local, mut by_source) = (Vec::new(), vec![0.0; inclusion.surface().modes.count()]);
    let mut add = |other: usize, of: &PlacedInclusion<D>, sign: f64, meets: &dyn Fn(usize) -> bool| {
        if let Some((block, values)) = sampling.jumps((sign, of), meets) {
            local.push(LocalBlock { body: other, transposed: block });
            by_source.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
    };
    add(body, inclusion, -1.0, &|place| nodes.outside[place]);
    for (other, neighbour) in neighbours {
        add(*other, neighbour, 1.0, &|place| nodes.inside(neighbour, place));
    }
    let surface = inclusion.surface();
    let (first, values) = (layout.local(body), surface.modes.isolated_values());
    let (area, _) = measures::<D>(inclusion.ball.radius);
    let range = first..first + surface.modes.count();
    let (constant, positions) = (surface.constant(), surface.mean_moments().columns(1, D) * inclusion.ball.radius);
    let (reaction, sampled) = (values[0], sampling.rows());
    let coupling = Coupling::Modes(Modes { rows, sampled, local, by_source, values: values.into(), ..Modes::default() });
    InclusionBlocks { range, constant, positions, measure: area, reaction, source, coupling }
}

/// Stencils that cross the surface: rows of C; and what a unit source differs from one everywhere, in one column.
fn corrections<const D: usize>(grid: &Grid<D>, inclusion: &PlacedInclusion<D>, nodes: &Nodes<D>) -> (Rows, Rows) {
    let (radius, reach) = (inclusion.ball.radius, grid.spacing().max());
    let mut source = Rows::default();
    let (mut unknowns, mut offsets, mut ends, mut terms) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (place, offset) in nodes.offsets.iter().enumerate().filter(|(_, offset)| offset.norm() < radius + reach) {
        let Some(unknown) = nodes.unknown(place) else { continue };
        let (before, side) = (terms.len(), if nodes.outside[place] { 1.0 } else { -1.0 });
        dirichlet::laplacian(grid, nodes.patch.index(place), |neighbour, weight| {
            let across = nodes.patch.place(neighbour);
            if nodes.outside[across] != nodes.outside[place] {
                terms.push((across, side * weight));
            }
        });
        if terms.len() > before {
            unknowns.push(unknown);
            offsets.push(*offset);
            ends.push(terms.len());
        } else if side < 0.0 {
            source.unknowns.push(unknown);
        }
    }
    let jumps = nodes.jumps(inclusion, terms.iter().map(|&(place, _)| place));
    let mut values = DMatrix::zeros(jumps.nrows(), unknowns.len());
    let mut start = 0;
    for (mut row, &end) in values.column_iter_mut().zip(&ends) {
        (start..end).for_each(|term| row.axpy(terms[term].1, &jumps.column(term), 1.0));
        start = end;
    }
    let wanted = wanted_moments(inclusion, nodes, grid.spacing().product());
    conserve((radius, wanted), &offsets, values.as_mut_slice());
    source.values = vec![-1.0; source.unknowns.len()];
    let last = values.nrows() - 1;
    source.unknowns.extend(&unknowns);
    let corrected = values.row(last);
    source.values.extend(offsets.iter().zip(corrected.iter()).map(
        |(offset, value)| {
            if inclusion.excludes(offset) { *value } else { value - 1.0 }
        },
    ));
    (Rows::new(unknowns, values.remove_row(last).as_slice().to_vec()), source)
}

/// Sums of the rows, and of rows times offsets over the radius: those of the modes, and of the missing source inside.
///
/// Then every discrete flux out of a box around the inclusion is that of its multipliers and of the source outside of it.
fn wanted_moments<const D: usize>(inclusion: &PlacedInclusion<D>, nodes: &Nodes<D>, cell_volume: f64) -> DMatrix<f64> {
    let (surface, radius) = (inclusion.surface(), inclusion.ball.radius);
    let count = surface.modes.count();
    let (area, volume) = measures::<D>(radius);
    let mut wanted = DMatrix::zeros(count + 1, TERMS);
    wanted.view_mut((0, 0), (count, D + 1)).copy_from(&(surface.mean_moments() * (area / cell_volume)));
    wanted[(count, 0)] = -volume / cell_volume;
    let inside = (0..nodes.offsets.len()).filter(|&place| !nodes.outside[place] && nodes.unknown(place).is_some());
    for offset in inside.map(|place| nodes.offsets[place]) {
        wanted[(count, 0)] += 1.0;
        (0..D).for_each(|axis| wanted[(count, axis + 1)] += offset[axis] / radius);
    }
    wanted
}

/// Area of the surface and volume of a ball.
pub fn measures<const D: usize>(radius: f64) -> (f64, f64) {
    let volume = crate::geometry::Ball::<D> { center: SVector::zeros(), radius }.volume();
    (volume * D as f64 / radius, volume)
}

/// Interpolation on the surface, tested with the modes.
struct Sampling<'a, const D: usize> {
    nodes: &'a Nodes<'a, D>,
    /// Places of the nodes that it meets.
    met: Vec<usize>,
    /// For each of them, what a unit value there gives each mode.
    values: DMatrix<f64>,
}

impl<'a, const D: usize> Sampling<'a, D> {
    fn new(grid: &Grid<D>, inclusion: &PlacedInclusion<D>, nodes: &'a Nodes<'a, D>) -> Self {
        let (projector, count) = (inclusion.surface().projector(), inclusion.surface().modes.count());
        let mut columns = vec![EMPTY; nodes.patch.len()];
        let (mut met, mut values) = (Vec::new(), Vec::new());
        for (offset, tests) in inclusion.surface().offsets().zip(projector.column_iter()) {
            each_node(grid, nodes, &(inclusion.ball.center + offset), |place, weight| {
                if columns[place] == EMPTY {
                    columns[place] = met.len();
                    met.push(place);
                    values.resize(met.len() * count, 0.0);
                }
                let column: &mut [f64] = &mut values[columns[place] * count..][..count];
                column.iter_mut().zip(tests.iter()).for_each(|(value, test)| *value += weight * test);
            });
        }
        Sampling { nodes, values: DMatrix::from_vec(count, met.len(), values), met }
    }

    /// What `sign` times the jumps of an inclusion add at those nodes that it `meets`: for its modes (down) and for a unit source.
    fn jumps(&self, (sign, of): (f64, &PlacedInclusion<D>), meets: &dyn Fn(usize) -> bool) -> Option<(DMatrix<f64>, Vec<f64>)> {
        let chosen: Vec<usize> = (0..self.met.len()).filter(|&node| meets(self.met[node])).collect();
        if chosen.is_empty() {
            return None;
        }
        let jumps = self.nodes.jumps(of, chosen.iter().map(|&node| self.met[node]));
        let block = (jumps * self.values.select_columns(&chosen).transpose()) * sign;
        let last = block.nrows() - 1;
        let by_source = block.row(last).iter().copied().collect();
        Some((block.remove_row(last), by_source))
    }

    /// The rows of the transpose of J that belong to unknowns.
    fn rows(self) -> Rows {
        let mut rows = Rows::default();
        for (&place, column) in self.met.iter().zip(self.values.column_iter()) {
            if let Some(unknown) = self.nodes.unknown(place) {
                rows.unknowns.push(unknown);
                rows.values.extend(column.iter());
            }
        }
        rows
    }
}

/// Visits the places and weights of the nodes that interpolate at a point.
fn each_node<const D: usize>(grid: &Grid<D>, nodes: &Nodes<D>, point: &SVector<f64, D>, mut visit: impl FnMut(usize, f64)) {
    let lines: [_; D] = std::array::from_fn(|axis| interpolation::line(grid, D, axis, point[axis]));
    let corner = nodes.patch.place(std::array::from_fn(|axis| lines[axis].index[0]));
    let strides = nodes.patch.strides();
    for combination in 0..NODES.pow(D as u32) {
        let choice: [usize; D] = std::array::from_fn(|axis| (combination >> (2 * axis)) % NODES);
        let place = corner + (0..D).map(|axis| choice[axis] * strides[axis]).sum::<usize>();
        visit(place, (0..D).map(|axis| lines[axis].weight[choice[axis]]).product());
    }
}
