//! What all frames together know of one.

use super::{
    contact::Present,
    frame::{Frame, FrameFields, FrameRows},
};

/// The folder of the frames in the run's folder.
pub(in crate::output) const FOLDER: &str = "frames";

/// The cells of a frame with fields, along each axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mesh {
    pub cells: Vec<usize>,
    pub spacing: Vec<f64>,
    /// Whether they hold the vorticity.
    pub vorticity: bool,
}

impl Mesh {
    /// Cells, origin and spacing along z, y, x. A plane is one layer of cells about z = 0, where the bodies lie: VTK turns a
    /// `2DCoRectMesh` of XDMF into the plane of y and z.
    pub fn in_space(&self) -> ([usize; 3], [f64; 3], [f64; 3]) {
        match (&self.cells[..], &self.spacing[..]) {
            (&[x, y], &[dx, dy]) => ([1, y, x], [-0.5 * dx, 0.0, 0.0], [dx, dy, dx]),
            (&[x, y, z], &[dx, dy, dz]) => ([z, y, x], [0.0; 3], [dz, dy, dx]),
            _ => unreachable!("a box has two or three dimensions"),
        }
    }
}

/// The contacts of a frame under a law of contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ContactNetwork {
    pub count: usize,
    /// What they have besides their columns.
    pub present: Present,
}

/// The membranes of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Membranes {
    pub corners: usize,
    pub faces: usize,
    /// Entries of the list of faces.
    pub topology: usize,
}

/// A frame as the others see it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub number: usize,
    pub time: f64,
    pub step: usize,
    pub bodies: usize,
    pub contacts: Option<ContactNetwork>,
    pub bonds: usize,
    pub membranes: Option<Membranes>,
    pub mesh: Option<Mesh>,
    /// Displacement of the images above the box, where images slide.
    pub offset: Option<f64>,
}

impl Entry {
    /// The entry of a frame with these rows.
    pub fn of<const D: usize>(number: usize, frame: &Frame<D>, rows: &FrameRows) -> Entry {
        let mesh = |fields: &FrameFields<D>| Mesh {
            cells: fields.grid.cells().to_vec(),
            spacing: fields.grid.spacing().as_slice().to_vec(),
            vorticity: fields.vorticity.is_some(),
        };
        let mesh = frame.fields.as_ref().map(mesh);
        let contacts = rows.contacts.as_ref().map(|(contacts, present)| ContactNetwork { count: contacts.total(), present: *present });
        let bonds = rows.bonds.as_ref().map_or(0, |ends| ends.total() / 2);
        let membranes = rows.membranes.as_ref().map(|rows| Membranes {
            corners: rows.corners.total(),
            faces: rows.faces,
            topology: rows.topology.total(),
        });
        let (bodies, offset) = (rows.bodies.total(), frame.offset());
        Entry { number, time: frame.time, step: frame.step, bodies, contacts, bonds, membranes, mesh, offset }
    }
}

/// Where a frame lies in the run's folder.
pub(super) fn path_in_run(number: usize) -> String {
    format!("{FOLDER}/{number:06}.h5")
}
