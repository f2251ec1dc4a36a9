//! What a frame holds besides its bodies and contacts, read back for those who look at it: bonds, membranes and a layer of the flow.

use hdf5::{Dataset, File};

use super::{
    bond, membrane,
    read::{FrameColumns, FrameFile, read_with, refused},
};
use crate::{error::Result, observe::Plane, output::files::slab};

/// Bonds, membranes and flow of one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameSurroundings {
    /// Of each bond its two bodies and the number of its chain, cell or cluster.
    pub bonds: Vec<[usize; 3]>,
    /// Of each face of a membrane its bodies, in their order around it.
    pub faces: Vec<Vec<usize>>,
    /// The flow, where the frame holds it.
    pub flow: Option<FlowLayer>,
}

/// The layer of cells in the middle of the box that lies in a plane, or all of a box in two dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowLayer {
    /// Cells to the right and up.
    pub cells: [usize; 2],
    /// Where the middle of the layer lies, as a part of the box along the axis across the plane.
    pub depth: f64,
    /// Velocity to the right, up, and along the third axis, row by row from the bottom; two components in two dimensions.
    pub velocity: Vec<Vec<f64>>,
    /// Pressure, in the same order.
    pub pressure: Vec<f64>,
}

impl FrameFile {
    /// Its bonds and membranes, and the flow in a plane.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::error::Error::Refused) when the frame cannot be read.
    pub fn surroundings<const D: usize>(&self, plane: Plane) -> Result<FrameSurroundings> {
        let read = |file: &File| {
            let flow = file.link_exists("fields").then(|| layer::<D>(file, plane)).transpose()?;
            Ok(FrameSurroundings { bonds: bonds(file)?, faces: faces(file)?, flow })
        };
        read_with(self.path(), read).map_err(refused)
    }
}

fn bonds(file: &File) -> hdf5::Result<Vec<[usize; 3]>> {
    if !file.link_exists("bonds") {
        return Ok(Vec::new());
    }
    let group = FrameColumns { file, group: "bonds", count: 2 * slab::get::<u64>(file, "bond_count")? as usize };
    let [bodies, chains] = group.all::<i32, _>(&bond::COUNTS)?;
    let all = bodies.chunks_exact(2).zip(chains.chunks_exact(2));
    all.map(|(ends, chain)| Ok([body_of(file, ends[0])?, body_of(file, ends[1])?, chain[0].max(0) as usize])).collect()
}

fn body_of(file: &File, body: i32) -> hdf5::Result<usize> {
    let count = slab::get::<u64>(file, "body_count")? as usize;
    usize::try_from(body).ok().filter(|body| *body < count).ok_or_else(|| format!("it names body {body} of {count}").into())
}

/// The list of faces has, for each, a 4 and the places of three corners, or a 3, the number of corners and their places.
fn faces(file: &File) -> hdf5::Result<Vec<Vec<usize>>> {
    if !file.link_exists("faces") {
        return Ok(Vec::new());
    }
    let topology = file.dataset(&format!("faces/{}", membrane::TOPOLOGY))?.read_raw::<i32>()?;
    let corners = file.dataset("membranes/body")?.read_raw::<i32>()?;
    let broken = || hdf5::Error::from("its list of faces is broken");
    let (mut rest, mut faces) = (topology.as_slice(), Vec::new());
    while let Some((&kind, after)) = rest.split_first() {
        let (count, places) =
            if kind as usize == membrane::TRIANGLE { (3, after) } else { after.split_first().map(|(n, p)| (*n, p)).ok_or_else(broken)? };
        let count = usize::try_from(count).ok().filter(|count| *count <= places.len()).ok_or_else(broken)?;
        let body = |place: &i32| corners.get(*place as usize).ok_or_else(broken).and_then(|body| body_of(file, *body));
        faces.push(places[..count].iter().map(body).collect::<hdf5::Result<_>>()?);
        rest = &places[count..];
    }
    Ok(faces)
}

fn layer<const D: usize>(file: &File, plane: Plane) -> hdf5::Result<FlowLayer> {
    let ([across, up], velocity) = (plane.axes(), file.dataset("fields/velocity")?);
    let normal = (0..D).find(|axis| *axis != across && *axis != up);
    let shape = velocity.shape();
    if shape.len() < 3 {
        return Err("its fields are no box of cells".into());
    }
    let cells = |axis: usize| shape[2 - axis];
    let values = |dataset: &Dataset, component: Option<usize>| {
        let range = |axis: usize| if axis == across || axis == up { 0..cells(axis) } else { cells(axis) / 2..cells(axis) / 2 + 1 };
        let ranges: Vec<_> = (0..3).rev().map(range).chain(component.map(|component| component..component + 1)).collect();
        slab::read(dataset, &ranges)
    };
    let components = [across, up].into_iter().chain(normal);
    let depth = normal.map_or(0.5, |axis| (cells(axis) / 2) as f64 + 0.5) / normal.map_or(1.0, |axis| cells(axis) as f64);
    Ok(FlowLayer {
        cells: [cells(across), cells(up)],
        depth,
        velocity: components.map(|component| values(&velocity, Some(component))).collect::<hdf5::Result<_>>()?,
        pressure: values(&file.dataset("fields/pressure")?, None)?,
    })
}
