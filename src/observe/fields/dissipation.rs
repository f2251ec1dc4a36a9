//! What viscosity dissipates in the fluid: `2 mu` times the integral of the square of the rate of strain outside bodies.
//!
//! The flow outside is extended into bodies, so that its slopes near surfaces do not see the kink there: in each cell it is a polynomial of third or
//! fourth order along each axis. Cells near bodies, where the square falls by much within one, are taken in parts, each with as much of it as lies
//! outside; that cuts the integrand off as if the surface were smeared over such a part, which a part of its second difference takes back.

use std::collections::BTreeMap;

use nalgebra::{SMatrix, SVector};

use super::{
    cells::own_place,
    faces::{DenseFaces, LAYERS, NearFaces},
};
use crate::{
    constraint::IndexBox,
    error::Result,
    flow::Drive,
    geometry::{Ball, fraction},
    grid::{Grid, Index, operators::signed, stencil::moved},
    linalg::{lagrange, lagrange_slope},
    petsc::Vector,
};

/// Parts of a cell near a body along each axis.
const PARTS: usize = 3;

/// Cells from a surface up to which cells are taken in parts.
const NEAR: f64 = 2.0;

/// Part of the second difference of a field smeared over a cell that sharpens it.
const SHARPENING: f64 = -1.0 / 24.0;

/// Places of the nodes of a component along its own axis and along others, in cells from the centre of a cell.
const FACES: [f64; 4] = [-1.5, -0.5, 0.5, 1.5];
const CENTERS: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];

/// Weights of these in the mean and in the slope at the centre, and of the differences over two and over four cells in that along another axis.
const FACE_MEAN: [f64; 4] = [-1.0 / 16.0, 9.0 / 16.0, 9.0 / 16.0, -1.0 / 16.0];
const FACE_SLOPE: [f64; 4] = [1.0 / 24.0, -27.0 / 24.0, 27.0 / 24.0, -1.0 / 24.0];
const CENTER_SLOPE: [f64; 2] = [8.0 / 12.0, -1.0 / 12.0];

/// The dissipation per viscosity of a velocity extended into bodies, with the background of a drive, in a box without open ends. Collective.
///
/// # Errors
/// PETSc fails.
pub fn dissipation<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>], extended: &Vector, drive: &Drive<D>) -> Result<f64> {
    let mut near = NearFaces::new(grid, extended, LAYERS)?;
    let values = near.of(grid, extended)?.dense();
    let background = SMatrix::from_fn(|component, axis| drive.slope(component, axis));
    let strain = Strain { values, along: weights(&FACES), across: weights(&CENTERS), spacing: grid.spacing(), background };
    let (outside, mut squares) = (outside(grid, balls), Squares::default());
    let of_cell = |(place, cell): (usize, [usize; D])| match outside.get(&place) {
        None => strain.square(signed(cell)),
        Some(outside) if outside.iter().all(|part| *part == 0.0) => 0.0,
        Some(outside) => {
            let squares = squares.of(&strain, signed(cell));
            outside.iter().zip(squares).map(|(part, square)| part * square).sum::<f64>() / outside.len() as f64
        }
    };
    let mut sum = [grid.block(D).indices().enumerate().map(of_cell).sum::<f64>() * grid.spacing().product()];
    extended.session().world().sum(&mut sum);
    Ok(sum[0])
}

/// The rate of strain of a flow, `2 D : D` of it.
struct Strain<'a, const D: usize> {
    values: DenseFaces<'a, D>,
    /// For the nodes of a component along its own axis.
    along: Weights<4>,
    /// For those along another.
    across: Weights<5>,
    spacing: SVector<f64, D>,
    background: SMatrix<f64, D, D>,
}

impl<const D: usize> Strain<'_, D> {
    /// At the middle of a cell.
    fn square(&self, cell: Index<D>) -> f64 {
        let strides = self.values.strides().map(|stride| stride as isize);
        let gradient = SMatrix::from_fn(|component, axis| {
            let (values, at) = self.values.of(component, cell);
            let (along, step) = (strides[component], strides[axis]);
            let node = |face: isize, steps: isize| values[(at as isize + face * along + steps * step) as usize];
            let slope = if axis == component {
                (0..4).map(|face| FACE_SLOPE[face] * node(face as isize - 1, 0)).sum::<f64>()
            } else {
                let side = |steps: isize| (0..4).map(|face| FACE_MEAN[face] * node(face as isize - 1, steps)).sum::<f64>();
                CENTER_SLOPE[0] * (side(1) - side(-1)) + CENTER_SLOPE[1] * (side(2) - side(-2))
            };
            slope / self.spacing[axis]
        });
        doubled_square(&(gradient + self.background))
    }

    /// Values of a component at the nodes around a cell, the last axis fastest.
    fn nodes(&self, component: usize, cell: Index<D>, nodes: &mut Vec<f64>) {
        let (first, count) = ([-1, -2], [FACES.len(), CENTERS.len()]);
        let start: Index<D> = std::array::from_fn(|axis| cell[axis] + first[usize::from(axis != component)]);
        let end: Index<D> = std::array::from_fn(|axis| start[axis] + count[usize::from(axis != component)] as isize);
        let value = |index: Index<D>| {
            let (values, at) = self.values.of(component, index);
            values[at]
        };
        nodes.clear();
        nodes.extend(IndexBox::between(start, end).indices().map(value));
    }
}

/// Evaluates a rate of strain in the parts of a cell; keeps memory from cell to cell.
#[derive(Default)]
struct Squares<const D: usize> {
    gradients: Vec<SMatrix<f64, D, D>>,
    nodes: Vec<f64>,
    /// Sums over the nodes along some of the axes, and those that come from them.
    sums: [Vec<f64>; 2],
}

impl<const D: usize> Squares<D> {
    /// `2 D : D` at the middle of each part of a cell, the last axis fastest.
    fn of(&mut self, strain: &Strain<D>, cell: Index<D>) -> impl Iterator<Item = f64> {
        self.gradients.clear();
        self.gradients.resize(PARTS.pow(D as u32), strain.background);
        for component in 0..D {
            strain.nodes(component, cell, &mut self.nodes);
            for axis in 0..D {
                self.add_slopes(strain, component, axis);
            }
        }
        self.gradients.iter().map(doubled_square)
    }

    /// The slopes of a component along an axis at all parts: sums over its nodes, axis by axis from the last one on.
    fn add_slopes(&mut self, strain: &Strain<D>, component: usize, slope: usize) {
        let [sums, next] = &mut self.sums;
        sums.clone_from(&self.nodes);
        for axis in (0..D).rev() {
            let kind = usize::from(axis == slope);
            if axis == component {
                contract(sums, &strain.along[kind], next);
            } else {
                contract(sums, &strain.across[kind], next);
            }
            std::mem::swap(sums, next);
        }
        self.gradients.iter_mut().zip(sums).for_each(|(gradient, sum)| gradient[(component, slope)] += *sum / strain.spacing[slope]);
    }
}

/// Sums over the last axis of values, one for each part; the parts become the first axis.
fn contract<const N: usize>(values: &[f64], weights: &[[f64; N]; PARTS], sums: &mut Vec<f64>) {
    sums.clear();
    let of_part = |weights: &[f64; N], nodes: &[f64; N]| (0..N).map(|node| nodes[node] * weights[node]).sum::<f64>();
    for weights in weights {
        sums.extend(values.as_chunks::<N>().0.iter().map(|nodes| of_part(weights, nodes)));
    }
}

/// `2 D : D` of the rate of strain of a gradient.
fn doubled_square<const D: usize>(gradient: &SMatrix<f64, D, D>) -> f64 {
    0.5 * (gradient + gradient.transpose()).norm_squared()
}

/// Weights of `N` nodes in the values at the middles of the parts of a cell, and in the slopes there per cell.
type Weights<const N: usize> = [[[f64; N]; PARTS]; 2];

fn weights<const N: usize>(nodes: &[f64; N]) -> Weights<N> {
    let middle = |part: usize| (part as f64 + 0.5) / PARTS as f64 - 0.5;
    let of = |rule: fn(&[f64; N], f64) -> [f64; N]| std::array::from_fn(|part| rule(nodes, middle(part)));
    [of(lagrange), of(lagrange_slope)]
}

/// For each of this rank's cells near bodies or in them, by its place in the block, how much of each of its parts lies outside.
fn outside<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>]) -> BTreeMap<usize, Vec<f64>> {
    let mut outside = BTreeMap::new();
    for ball in balls {
        let ball = Ball { center: grid.domain().wrap(ball.center), ..*ball };
        let near = |index: &Index<D>| {
            let nearest = (grid.position(D, *index) - ball.center).component_div(&grid.spacing()).norm() * grid.spacing().min();
            nearest < ball.radius + NEAR * grid.spacing().max()
        };
        let around = IndexBox::around(grid, D, &ball.center, ball.radius + NEAR * grid.spacing().max());
        let cells: Vec<(Index<D>, usize)> =
            around.indices().filter(near).filter_map(|index| own_place(grid, index).map(|place| (index, place))).collect();
        if cells.is_empty() {
            continue;
        }
        let filled = Filled::of(grid, &ball, around.start(), around.extent());
        for (index, place) in cells {
            let parts = outside.entry(place).or_insert_with(|| vec![1.0; PARTS.pow(D as u32)]);
            parts.iter_mut().zip(filled.parts(index)).for_each(|(part, filled)| *part -= filled);
        }
    }
    outside
}

/// How much of each part of the cells around a ball it fills.
struct Filled<'a, const D: usize> {
    ball: &'a Ball<D>,
    /// Edges of a part.
    size: SVector<f64, D>,
    parts: IndexBox<D>,
    filled: Vec<f64>,
}

impl<'a, const D: usize> Filled<'a, D> {
    fn of(grid: &Grid<D>, ball: &'a Ball<D>, start: Index<D>, extent: [usize; D]) -> Filled<'a, D> {
        let (size, parts) = (grid.spacing() / PARTS as f64, PARTS as isize);
        let first: Index<D> = start.map(|first| first * parts - 1);
        let around = IndexBox::between(first, std::array::from_fn(|axis| first[axis] + extent[axis] as isize * parts + 2));
        let middle = |index: Index<D>| SVector::from_fn(|axis, _| (index[axis] as f64 + 0.5) * size[axis]);
        let filled = around.indices().map(|index| fraction(ball, &middle(index), &size)).collect();
        Filled { ball, size, parts: around, filled }
    }

    /// Those of the parts of a cell, sharpened, the last axis fastest.
    fn parts(&self, cell: Index<D>) -> impl Iterator<Item = f64> {
        let first: Index<D> = cell.map(|index| index * PARTS as isize);
        let within = IndexBox::between(first, first.map(|index| index + PARTS as isize));
        let cut = self.cuts_around(cell);
        within.indices().map(move |index| if cut { self.sharpened(index) } else { self.at(index) })
    }

    /// Whether the surface may pass a cell or a part beside it.
    fn cuts_around(&self, cell: Index<D>) -> bool {
        let offset = SVector::from_fn(|axis, _| (cell[axis] as f64 + 0.5) * PARTS as f64 * self.size[axis]) - self.ball.center;
        (offset.norm() - self.ball.radius).abs() < 0.5 * (PARTS + 2) as f64 * self.size.norm()
    }

    fn at(&self, index: Index<D>) -> f64 {
        self.filled[self.parts.place(index)]
    }

    fn sharpened(&self, index: Index<D>) -> f64 {
        let second = |axis: usize| self.at(moved(index, axis, 1)) - 2.0 * self.at(index) + self.at(moved(index, axis, -1));
        self.at(index) + SHARPENING * (0..D).map(second).sum::<f64>()
    }
}
