//! The lines of a block along one axis, a few neighbours at a time: strided memory is read and written in whole cache lines.

use crate::grid::Block;

/// Most lines of a tile.
pub const TILE: usize = 16;

/// The lines of a block along one axis.
#[derive(Clone)]
pub struct Lines<const D: usize> {
    block: Block<D>,
    axis: usize,
}

/// Neighbouring lines: where they lie in the values of a block.
pub struct Tile<const D: usize> {
    /// Lattice index where the first line starts.
    pub start: [usize; D],
    /// Number of lines.
    pub lines: usize,
    /// The axis along which the lines lie side by side.
    pub across: usize,
    /// Points of a line.
    pub points: usize,
    offset: usize,
    line_step: usize,
    point_step: usize,
}

impl<const D: usize> Lines<D> {
    /// The lines of `block` along `axis`.
    pub fn new(block: Block<D>, axis: usize) -> Lines<D> {
        Lines { block, axis }
    }

    /// The block.
    pub fn block(&self) -> &Block<D> {
        &self.block
    }

    /// Points of a line.
    pub fn points(&self) -> usize {
        self.block.end[self.axis] - self.block.start[self.axis]
    }

    /// The axis along which the lines of a tile lie side by side.
    pub fn across(&self) -> usize {
        if self.axis == D - 1 { D - 2 } else { D - 1 }
    }

    /// Whether the points of a line are neighbours in memory, and the lines follow each other.
    pub fn in_sequence(&self) -> bool {
        self.axis == D - 1
    }

    /// All tiles; blocks that differ only along the axis have the same ones.
    pub fn tiles(&self) -> impl Iterator<Item = Tile<D>> + use<D> {
        let (block, axis) = (self.block, self.axis);
        let across = self.across();
        let mut starts = if block.is_empty() { Block { start: [0; D], end: [0; D] } } else { block.flattened(axis) };
        let side_by_side = block.end[across] - block.start[across];
        let tiles = side_by_side.div_ceil(TILE);
        starts.end[across] = starts.start[across] + tiles;
        let stride = move |axis: usize| (axis + 1..D).map(|axis| block.end[axis] - block.start[axis]).product::<usize>();
        starts.indices().map(move |mut start| {
            let tile = start[across] - block.start[across];
            let cut = |tile: usize| (tile * TILE).min(side_by_side);
            start[across] = block.start[across] + cut(tile);
            Tile {
                start,
                lines: cut(tile + 1) - cut(tile),
                across,
                points: block.end[axis] - block.start[axis],
                offset: block.offset(start),
                line_step: stride(across),
                point_step: stride(axis),
            }
        })
    }
}

impl<const D: usize> Tile<D> {
    /// Lattice index where a line starts.
    pub fn line_start(&self, line: usize) -> [usize; D] {
        let mut start = self.start;
        start[self.across] += line;
        start
    }

    /// Copies the values of the block on the lines to `lines`, line after line.
    pub fn gather<T: Copy>(&self, values: &[T], lines: &mut [T]) {
        if self.point_step == 1 {
            for (line, points) in lines.chunks_exact_mut(self.points).take(self.lines).enumerate() {
                let start = self.offset + line * self.line_step;
                points.copy_from_slice(&values[start..start + self.points]);
            }
            return;
        }
        for point in 0..self.points {
            let neighbours = values[self.offset + point * self.point_step..].iter().step_by(self.line_step);
            let places = lines[point..].iter_mut().step_by(self.points);
            places.zip(neighbours).take(self.lines).for_each(|(place, value)| *place = *value);
        }
    }

    /// Copies `lines` back to the values of the block.
    pub fn scatter<T: Copy>(&self, lines: &[T], values: &mut [T]) {
        if self.point_step == 1 {
            for (line, points) in lines.chunks_exact(self.points).take(self.lines).enumerate() {
                let start = self.offset + line * self.line_step;
                values[start..start + self.points].copy_from_slice(points);
            }
            return;
        }
        for point in 0..self.points {
            let neighbours = values[self.offset + point * self.point_step..].iter_mut().step_by(self.line_step);
            let places = lines[point..].iter().step_by(self.points);
            neighbours.zip(places).take(self.lines).for_each(|(value, place)| *value = *place);
        }
    }
}
