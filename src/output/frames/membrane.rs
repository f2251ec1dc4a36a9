//! The membranes of cells in a frame: surfaces of triangles in 3D, polygons in 2D.

use nalgebra::SVector;

use super::body::in_space;

/// The membranes at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameMembranes<const D: usize> {
    /// Their corners that this rank writes, in the order of the bodies; each body is on one rank.
    pub corners: Vec<FrameCorner<D>>,
    /// Their faces that this rank writes, those of a cell on one rank, in the order of the cells.
    pub faces: Vec<FrameFace>,
}

/// A corner of a membrane: the centre of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameCorner<const D: usize> {
    /// The body.
    pub body: usize,
    /// Number of its cell, as of a [`FrameBond`](super::FrameBond).
    pub chain: usize,
    /// Where it is; some corners of a membrane that crosses a side of the box lie outside.
    pub point: SVector<f64, D>,
}

/// A face of a membrane.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFace {
    /// First body of its cell.
    pub first: usize,
    /// Places of its corners among those of all ranks, in their order around it.
    pub corners: Vec<usize>,
}

/// A named vector of each corner.
pub(super) const COLUMNS: [(&str, usize); 1] = [("point", 3)];
/// Named whole numbers of each corner.
pub(super) const COUNTS: [(&str, usize); 2] = [("body", 1), ("chain", 1)];
/// Numbers of a corner's row: the entries of [`COUNTS`] and of [`COLUMNS`].
pub(super) const WIDTH: usize = 5;
/// The faces, one after the other, as XDMF has them: what a face is, and its corners.
pub(super) const TOPOLOGY: &str = "topology";
/// Numbers of a row of them: the first body of the cell and the entry.
pub(super) const FACE_WIDTH: usize = 2;

/// What XDMF calls a polygon, whose number of corners follows, and a triangle.
const POLYGON: usize = 3;
pub(super) const TRIANGLE: usize = 4;

impl<const D: usize> FrameMembranes<D> {
    pub(super) fn corner_rows(&self) -> Vec<f64> {
        let row = |corner: &FrameCorner<D>| [corner.body as f64, corner.chain as f64].into_iter().chain(in_space(&corner.point));
        self.corners.iter().flat_map(row).collect()
    }

    pub(super) fn face_rows(&self) -> Vec<f64> {
        let entries = |face: &FrameFace| {
            let kind = if face.corners.len() == 3 { vec![TRIANGLE] } else { vec![POLYGON, face.corners.len()] };
            let first = face.first as f64;
            kind.into_iter().chain(face.corners.iter().copied()).flat_map(move |entry| [first, entry as f64]).collect::<Vec<_>>()
        };
        self.faces.iter().flat_map(entries).collect()
    }
}
