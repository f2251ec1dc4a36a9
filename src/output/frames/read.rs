//! Frames read back: their bodies and vorticity, for animations, and what a run needs to go on.

use std::path::{Path, PathBuf};

use hdf5::{Dataset, File, H5Type};
use nalgebra::SVector;

use super::{
    body::COLUMNS,
    bond,
    contact::{self, FrameContact},
    entry::{ContactNetwork, Entry, Membranes, Mesh},
    index::frame_files,
    membrane,
    store::{FORMAT, OFFSET, VERSION, VORTICITY},
};
use crate::{
    error::{Error, Result},
    observe::{FlowCut, FrameBody, Plane},
    output::files::{
        checksum::{intact, numbers_checksum, stored},
        slab,
    },
};

/// The bodies of one time.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredFrame<const D: usize> {
    /// Time.
    pub time: f64,
    /// Number of time steps until then.
    pub step: usize,
    /// Edge lengths of the box.
    pub size: SVector<f64, D>,
    /// Displacement of the images above the box along x, within a length of the box, where images slide.
    pub offset: Option<f64>,
    /// All bodies, with centres in the box.
    pub bodies: Vec<FrameBody<D>>,
    /// All contacts, if there is a law of contact.
    pub contacts: Option<Vec<FrameContact<D>>>,
}

/// A frame of a run that can be read; local to this rank.
pub struct FrameFile {
    path: PathBuf,
}

impl FrameFile {
    /// The frames in the folder of a run, in the order of time.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn of_run(folder: &Path) -> Result<Vec<FrameFile>> {
        Ok(frame_files(folder)?.into_iter().map(|(_, path)| FrameFile { path }).collect())
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its time.
    ///
    /// # Errors
    /// [`Error::Refused`], here and below, when the frame cannot be read.
    pub fn time(&self) -> Result<f64> {
        read_with(&self.path, |file| slab::get(file, "time")).map_err(refused)
    }

    /// All of it but the fields, which must have this dimension.
    pub fn read<const D: usize>(&self) -> Result<StoredFrame<D>> {
        read_with(&self.path, bodies).map_err(refused)
    }

    /// Of each body the number of its chain, cell or cluster, if it has one.
    pub fn chains(&self) -> Result<Vec<Option<usize>>> {
        read_with(&self.path, chains).map_err(refused)
    }

    /// The vorticity in a plane through the middle of the box, counterclockwise positive as it is seen; nothing if the frame does not hold it.
    pub fn vorticity<const D: usize>(&self, plane: Plane) -> Result<Option<FlowCut>> {
        read_with(&self.path, |file| vorticity_of(file)?.map(|dataset| cut::<D>(&dataset, plane)).transpose()).map_err(refused)
    }
}

/// The bodies of all frames in the folder of a run at once, in the order of time; local to this rank.
///
/// # Errors
/// [`Error::Refused`] when a frame cannot be read or has another dimension.
pub fn read_frames<const D: usize>(folder: &Path) -> Result<Vec<StoredFrame<D>>> {
    FrameFile::of_run(folder)?.iter().map(FrameFile::read).collect()
}

pub(super) fn refused(reason: String) -> Error {
    Error::refused(format!("{reason}; move it out of the folder to go on without it"))
}

/// What the other frames need to know of a frame, or what is wrong with it.
pub(super) fn entry(number: usize, path: &Path) -> std::result::Result<Entry, String> {
    read_with(path, |file| {
        let step = slab::get::<u64>(file, "step")? as usize;
        let bodies = slab::get::<u64>(file, "body_count")? as usize;
        let with_fields = file.link_exists("fields");
        let network = |file: &File| {
            let group = file.group("contacts")?;
            let present = contact::OPTIONAL.map(|(name, _)| group.link_exists(name));
            Ok::<_, hdf5::Error>(ContactNetwork { count: slab::get::<u64>(file, "contact_count")? as usize, present })
        };
        let contacts = file.link_exists("contacts").then(|| network(file)).transpose()?;
        let cells = || Ok::<_, hdf5::Error>(list::<u64>(file, "cells")?.into_iter().map(|cells| cells as usize).collect());
        let mesh =
            || Ok::<_, hdf5::Error>(Mesh { cells: cells()?, spacing: list(file, "spacing")?, vorticity: vorticity_of(file)?.is_some() });
        let mesh = with_fields.then(mesh).transpose()?;
        let bonds = if file.link_exists("bonds") { slab::get::<u64>(file, "bond_count")? as usize } else { 0 };
        let membranes = file.link_exists("membranes").then(|| membranes(file)).transpose()?;
        Ok(Entry { number, time: slab::get(file, "time")?, step, bodies, contacts, bonds, membranes, mesh, offset: offset(file)? })
    })
}

pub(super) fn read_with<T>(path: &Path, read: impl Fn(&File) -> hdf5::Result<T>) -> std::result::Result<T, String> {
    let checked = || {
        let file = File::open(path)?;
        let format = slab::get_text(&file, "format")?;
        let version = slab::get::<u32>(&file, "version")?;
        if (format.as_str(), version) != (FORMAT, VERSION) {
            return Err(format!("it holds {format} version {version}, not {FORMAT} version {VERSION}").into());
        }
        read(&file)
    };
    checked().map_err(|error| format!("frame {} cannot be read ({error})", path.display()))
}

fn bodies<const D: usize>(file: &File) -> hdf5::Result<StoredFrame<D>> {
    let size = list::<f64>(file, "size")?;
    if size.len() != D {
        return Err(format!("its box has {} dimensions, not {D}", size.len()).into());
    }
    let count = slab::get::<u64>(file, "body_count")? as usize;
    let group = FrameColumns { file, group: "bodies", count };
    let columns = group.all::<f64, _>(&COLUMNS)?;
    let [contacts] = group.all::<i32, 1>(&[("contacts", 1)])?;
    let body = |body: usize| FrameBody::from_columns(body, entry_of(&columns, &COLUMNS, body), contacts[body] as usize);
    let (time, step) = (slab::get(file, "time")?, slab::get::<u64>(file, "step")? as usize);
    let contacts = file.link_exists("contacts").then(|| network(file)).transpose()?;
    let (size, offset, bodies) = (SVector::from_column_slice(&size), offset(file)?, (0..count).map(body).collect());
    Ok(StoredFrame { time, step, size, offset, bodies, contacts })
}

fn chains(file: &File) -> hdf5::Result<Vec<Option<usize>>> {
    let mut chains = vec![None; slab::get::<u64>(file, "body_count")? as usize];
    if file.link_exists("bonds") {
        let group = FrameColumns { file, group: "bonds", count: 2 * slab::get::<u64>(file, "bond_count")? as usize };
        let [bodies, of] = group.all::<i32, _>(&bond::COUNTS)?;
        for (body, chain) in bodies.into_iter().zip(of) {
            let place = chains.get_mut(body as usize).ok_or("its bonds name a body that is not there")?;
            *place = Some(chain as usize);
        }
    }
    Ok(chains)
}

/// Where the vorticity is, if it is there.
fn vorticity_of(file: &File) -> hdf5::Result<Option<Dataset>> {
    let there = file.link_exists("fields") && file.group("fields")?.link_exists(VORTICITY);
    there.then(|| file.dataset(&format!("fields/{VORTICITY}"))).transpose()
}

/// The layer of cells in the middle of the box that lies in a plane.
fn cut<const D: usize>(dataset: &Dataset, plane: Plane) -> hdf5::Result<FlowCut> {
    let (shape, [across, up]) = (dataset.shape(), plane.axes());
    // slowest first, z, y, x, and components last
    let cells = |axis: usize| shape[2 - axis];
    let (component, sign) = plane.vorticity::<D>();
    let range = |axis: usize| if axis == across || axis == up { 0..cells(axis) } else { cells(axis) / 2..cells(axis) / 2 + 1 };
    let ranges: Vec<_> = (0..3).rev().map(range).chain((D == 3).then_some(component..component + 1)).collect();
    let values = slab::read(dataset, &ranges)?.into_iter().map(|value| sign * value).collect();
    Ok(FlowCut { cells: [cells(across), cells(up)], values })
}

fn network<const D: usize>(file: &File) -> hdf5::Result<Vec<FrameContact<D>>> {
    let group = FrameColumns { file, group: "contacts", count: slab::get::<u64>(file, "contact_count")? as usize };
    let (columns, counts) = (group.all::<f64, _>(&contact::COLUMNS)?, group.all::<i32, _>(&contact::COUNTS)?);
    let stored = file.group("contacts")?;
    let optional = |column: (&'static str, usize)| {
        stored.link_exists(column.0).then(|| Ok::<_, hdf5::Error>((group.all::<f64, 1>(&[column])?, column.1))).transpose()
    };
    let [gamma, friction] = contact::OPTIONAL.map(optional);
    let optional = [gamma?, friction?];
    let contact = |place: usize| {
        let optional = optional.each_ref().map(|column| column.as_ref().map(|([numbers], width)| &numbers[place * width..][..*width]));
        FrameContact::from_columns(entry_of(&columns, &contact::COLUMNS, place), entry_of(&counts, &contact::COUNTS, place), optional)
    };
    Ok((0..group.count).map(contact).collect())
}

fn membranes(file: &File) -> hdf5::Result<Membranes> {
    let length = |path: &str| Ok::<_, hdf5::Error>(file.dataset(path)?.shape()[0]);
    let topology = length(&format!("faces/{}", membrane::TOPOLOGY))?;
    Ok(Membranes { corners: length("membranes/point")?, faces: slab::get::<u64>(file, "face_count")? as usize, topology })
}

/// A group of columns of so many entries.
pub(super) struct FrameColumns<'a> {
    pub file: &'a File,
    pub group: &'a str,
    pub count: usize,
}

impl FrameColumns<'_> {
    /// The numbers of these columns, each with its width.
    pub fn all<T: H5Type + Copy + Into<f64>, const C: usize>(&self, names: &[(&str, usize); C]) -> hdf5::Result<[Vec<T>; C]> {
        let mut columns = std::array::from_fn(|_| Vec::new());
        if self.count == 0 {
            return Ok(columns);
        }
        let group = self.file.group(self.group)?;
        for (column, (name, width)) in columns.iter_mut().zip(names) {
            let dataset = group.dataset(name)?;
            *column = dataset.read_raw::<T>()?;
            if column.len() != self.count * width {
                return Err(format!("its {} differ in length", self.group).into());
            }
            let sum = || numbers_checksum(0, &column.iter().map(|&number| number.into()).collect::<Vec<f64>>());
            if stored(&dataset)?.is_some_and(|stored| stored != sum()) {
                return Err(altered(&dataset).into());
            }
        }
        Ok(columns)
    }
}

/// Refuses a file of which a data set is not as its checksum has it.
pub(super) fn verify(path: &Path) -> std::result::Result<(), String> {
    read_with(path, |file| {
        for dataset in file.groups()?.iter().map(hdf5::Group::datasets).collect::<hdf5::Result<Vec<_>>>()?.iter().flatten() {
            if intact(dataset)? == Some(false) {
                return Err(altered(dataset).into());
            }
        }
        Ok(())
    })
}

fn altered(dataset: &Dataset) -> String {
    format!("its {} differs from its checksum", dataset.name().trim_start_matches('/'))
}

/// The numbers of an entry, column by column.
fn entry_of<'a, T, const C: usize>(columns: &'a [Vec<T>; C], names: &[(&str, usize); C], entry: usize) -> [&'a [T]; C] {
    std::array::from_fn(|column| &columns[column][entry * names[column].1..][..names[column].1])
}

/// Where images slide.
fn offset(file: &File) -> hdf5::Result<Option<f64>> {
    let there = file.attr_names()?.iter().any(|name| name == OFFSET);
    there.then(|| slab::get(file, OFFSET)).transpose()
}

fn list<T: H5Type>(file: &File, name: &str) -> hdf5::Result<Vec<T>> {
    file.attr(name)?.read_raw()
}
