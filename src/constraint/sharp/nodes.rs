//! The lattice points of one field around one body, and what stands on which side of its surface.

use nalgebra::SVector;

use crate::{
    constraint::{index_box::IndexBox, placed::Placed, unknowns::Unknowns},
    grid::{Grid, Index},
};

/// Lattice points around a surface that stencils and interpolation may touch, in spacings: next to walls it is one-sided, and on oblique grids stencils have
/// corners.
const REACHES: [f64; 2] = [2.0, 3.0];

/// How far from a surface, along each axis, stencils and interpolation reach.
pub fn reach<const D: usize>(grid: &Grid<D>) -> f64 {
    REACHES[usize::from(!grid.domain().fully_periodic() || grid.slope() != 0.0)] * grid.spacing().max()
}

/// Lattice points, and points of walls between them, around a body.
pub struct JumpNodes<const D: usize> {
    unknowns: Unknowns,
    /// The field.
    pub field: usize,
    /// Its lattice.
    pub lattice: usize,
    /// Their indices.
    pub indices: IndexBox<D>,
    /// Coordinates along each axis, straightened.
    coordinates: [Vec<f64>; D],
    slope: f64,
    /// Square of the distance of each from the centre of the body.
    pub squares: Vec<f64>,
    /// Whether each lies outside the body.
    pub outside: Vec<bool>,
}

impl<const D: usize> JumpNodes<D> {
    /// The nodes within `reach` of the centre along each axis.
    pub fn around(grid: &Grid<D>, field: usize, placed: &Placed<D>, reach: f64) -> JumpNodes<D> {
        let unknowns = Unknowns::of(placed.surface.modes.as_ref());
        let lattice = unknowns.lattice::<D>(field);
        let indices = match unknowns {
            Unknowns::Fluid => IndexBox::with_walls(grid, lattice, &placed.center, reach),
            Unknowns::Scalar => IndexBox::of_cells(grid, &placed.center, reach),
        };
        let coordinates = std::array::from_fn(|axis| {
            let start = indices.start()[axis];
            (0..indices.extent()[axis] as isize).map(|along| coordinate(grid, lattice, axis, start + along)).collect()
        });
        let slope = grid.slope();
        let squares = squares(&coordinates, slope, &placed.center);
        let mut nodes = JumpNodes { unknowns, field, lattice, indices, coordinates, slope, squares, outside: Vec::new() };
        let is_outside = placed.outside_test();
        let outside = |(place, &square): (usize, &f64)| is_outside(square, &|| nodes.position(place) - placed.center);
        nodes.outside = nodes.squares.iter().enumerate().map(outside).collect();
        nodes
    }

    /// Where the node at a place is.
    pub fn position(&self, place: usize) -> SVector<f64, D> {
        let (index, start) = (self.indices.index(place), self.indices.start());
        let mut position = SVector::from_fn(|axis, _| self.coordinates[axis][(index[axis] - start[axis]) as usize]);
        position[0] += self.slope * position[1];
        position
    }

    /// Visits the places of the nodes inside another body.
    pub fn inside(&self, other: &Placed<D>, mut visit: impl FnMut(usize)) {
        let (radius, is_outside) = (other.ball().radius, other.outside_test());
        let ranges: [(usize, usize); D] = std::array::from_fn(|axis| {
            let (coordinates, mut center, mut radius) = (&self.coordinates[axis], other.center[axis], radius);
            if axis == 0 {
                (center, radius) = (center - self.slope * other.center[1], radius * (1.0 + self.slope.abs()));
            }
            (coordinates.partition_point(|x| *x < center - radius), coordinates.partition_point(|x| *x <= center + radius))
        });
        let (start, strides) = (ranges.map(|(first, _)| first), self.indices.strides());
        let extent: [usize; D] = ranges.map(|(first, end)| end - first);
        for mut rest in 0..extent.iter().product() {
            let mut place = 0;
            for axis in (0..D).rev() {
                place += (start[axis] + rest % extent[axis]) * strides[axis];
                rest /= extent[axis];
            }
            let offset = self.position(place) - other.center;
            if !is_outside(offset.norm_squared(), &|| offset) {
                visit(place);
            }
        }
    }

    /// Visits runs of nodes that follow each other here and in fluid vectors: first place, number and first unknown.
    ///
    /// `wanted` narrows each row along the last axis.
    pub fn runs(
        &self,
        grid: &Grid<D>,
        wanted: impl Fn(std::ops::Range<usize>) -> std::ops::Range<usize>,
        mut visit: impl FnMut(usize, usize, usize),
    ) {
        let length = self.indices.extent()[D - 1];
        for first in (0..self.indices.len()).step_by(length.max(1)) {
            let range = wanted(first..first + length);
            let mut index: Index<D> = self.indices.index(first);
            index[D - 1] += (range.start - first) as isize;
            let mut place = range.start;
            while place < range.end {
                let (node, follow) = if self.on_lattice(grid, index) { self.unknowns.run(grid, self.field, index) } else { (None, 1) };
                let length = follow.min(range.end - place);
                if let Some(unknown) = node {
                    visit(place, length, unknown);
                }
                place += length;
                index[D - 1] += length as isize;
            }
        }
    }

    /// Whether an index stands for a point of the lattice, and not for a wall between its points.
    fn on_lattice(&self, grid: &Grid<D>, index: Index<D>) -> bool {
        (0..D).all(|axis| grid.domain().periodic(axis) || self.lattice == axis || (0..grid.cells()[axis] as isize).contains(&index[axis]))
    }
}

/// Coordinate of an index along an axis: that of the wall if it lies beyond a lattice that has no points on it.
fn coordinate<const D: usize>(grid: &Grid<D>, lattice: usize, axis: usize, index: isize) -> f64 {
    match grid.domain().periodic(axis) {
        false if index < 0 => 0.0,
        false if lattice != axis && index == grid.cells()[axis] as isize => grid.domain().size[axis],
        _ => (index as f64 + grid.stagger(lattice, axis)) * grid.spacing()[axis],
    }
}

/// Squares of distances from a centre, at straightened coordinates of a grid whose lines along y have a slope.
fn squares<const D: usize>(coordinates: &[Vec<f64>; D], slope: f64, center: &SVector<f64, D>) -> Vec<f64> {
    let of_plane = coordinates[0]
        .iter()
        .flat_map(|x| coordinates[1].iter().map(move |y| (x + slope * y - center[0]).powi(2) + (y - center[1]).powi(2)));
    (2..D).fold(of_plane.collect(), |squares: Vec<f64>, axis| {
        let along: Vec<f64> = coordinates[axis].iter().map(|x| (x - center[axis]).powi(2)).collect();
        squares.iter().flat_map(|before| along.iter().map(move |square| before + square)).collect()
    })
}
