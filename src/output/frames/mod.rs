//! Frames: one HDF5 file an output time, `frames/000012.h5`, and companions that show them as one run.
//!
//! `run.h5` links to all frames; `bodies.xdmf`, `fields.xdmf` and `contacts.xdmf` show them to ParaView, each once it has something to show.
//! Where the images of the box slide, a frame holds by how much: `offset` along x, which `offset_rate` makes grow (what is at `(x, y)` is
//! also at `(x + offset, y + size_y)` and moves there faster by `offset_rate`). Every file is written aside and renamed, so that a reader never meets half of one and the end of the program at any moment loses at most the frame under way.

mod body;
mod contact;
mod index;
mod read;
mod recovery;
mod store;
mod xdmf;

use std::path::{Path, PathBuf};

use nalgebra::SVector;

pub use body::FrameBody;
pub use contact::FrameContact;
pub(super) use index::FOLDER as FRAMES;
pub use read::{StoredFrame, read_frames};

use super::{finite::not_finite, parallel_file::ParallelFile};
use crate::{error::Result, geometry::Domain, grid::Grid, parallel::World};
use index::{Entry, path_in_run};
use recovery::Kept;

/// The fluid of one rank at one time: a value for each cell of its block of the pressure, in the block's order.
pub struct FrameFields<'a, const D: usize> {
    /// The grid.
    pub grid: &'a Grid<D>,
    /// Velocity at the centres of the cells.
    pub velocity: Vec<SVector<f64, D>>,
    /// Pressure.
    pub pressure: Vec<f64>,
    /// Part of the cell that lies in bodies.
    pub inside: Vec<f64>,
}

/// What is to be shown of one time.
pub struct Frame<'a, const D: usize> {
    /// Time.
    pub time: f64,
    /// Number of time steps so far.
    pub step: usize,
    /// The box.
    pub domain: &'a Domain<D>,
    /// All bodies, the same on all ranks.
    pub bodies: &'a [FrameBody<D>],
    /// All contacts that bear a force or stick, the same on all ranks; nothing without a law of contact.
    pub contacts: Option<&'a [FrameContact<D>]>,
    /// The fluid, on all ranks or on none.
    pub fields: Option<FrameFields<'a, D>>,
}

impl<const D: usize> Frame<'_, D> {
    /// Refuses numbers that are not finite.
    fn check(&self) -> Result<()> {
        let columns = self.bodies.iter().flat_map(|body| body::COLUMNS.iter().zip(body.columns()));
        let contacts = self.contacts.into_iter().flatten().flat_map(|held| contact::COLUMNS.iter().zip(held.columns()));
        for ((name, _), numbers) in columns.chain(contacts) {
            check_all(name, numbers)?;
        }
        let Some(fields) = &self.fields else { return Ok(()) };
        check_all("velocity", fields.velocity.iter().flat_map(|velocity| velocity.iter().copied()))?;
        check_all("pressure", fields.pressure.iter().copied())
    }

    /// Displacement of the images above the box along x, within a length of the box; nothing where images do not slide.
    fn offset(&self) -> Option<f64> {
        let length = self.domain.size[0];
        // rem_euclid of a tiny negative number rounds up to the length itself
        self.domain.slide().map(|slide| slide.shift().rem_euclid(length)).map(|offset| if offset < length { offset } else { 0.0 })
    }
}

fn check_all(name: &str, numbers: impl IntoIterator<Item = f64>) -> Result<()> {
    let broken = numbers.into_iter().find(|number| !number.is_finite());
    broken.map_or(Ok(()), |number| Err(not_finite("a frame", name, number)))
}

/// The frames of a run. All functions are collective.
pub struct Frames {
    folder: PathBuf,
    /// Number of the next frame.
    next: usize,
    /// The frames so far, known to the first rank only.
    entries: Vec<Entry>,
}

impl Frames {
    /// No frames yet; those of an older run in the folder are removed.
    ///
    /// # Errors
    /// [`Error::File`](crate::error::Error::File), here and below, when a file cannot be written or removed.
    pub fn create(world: &World, folder: &Path) -> Result<Frames> {
        Ok(Frames::keep(world, folder, f64::NEG_INFINITY)?.0)
    }

    /// The frames of a run that goes on from `time`, of which later ones are removed, and what is missing of them (on the first rank).
    /// A frame that cannot be read is set aside.
    pub fn resume(world: &World, folder: &Path, time: f64) -> Result<(Frames, Vec<String>)> {
        Frames::keep(world, folder, time)
    }

    fn keep(world: &World, folder: &Path, time: f64) -> Result<(Frames, Vec<String>)> {
        let Kept { entries, next, notes } = world.on_first_rank(|| recovery::keep_until(folder, time))?;
        let next = world.gather(&[next as u64])[0] as usize;
        Ok((Frames { folder: folder.to_owned(), next, entries }, notes))
    }

    /// Adds a frame.
    pub fn write<const D: usize>(&mut self, world: &World, frame: &Frame<D>) -> Result<()> {
        world.agree(frame.check())?;
        let mut file = ParallelFile::create(world, &self.folder.join(path_in_run(self.next)))?;
        store::store(&mut file, frame)?;
        file.finish()?;
        let number = self.next;
        self.next += 1;
        world.on_first_rank(|| {
            self.entries.push(Entry::of(number, frame));
            index::write(&self.folder, &self.entries)
        })
    }

    /// Lists no more frames that have gone since they were written, and says which (on the first rank).
    pub fn finish(&mut self, world: &World) -> Result<Option<String>> {
        world.on_first_rank(|| recovery::forget_lost(&self.folder, &mut self.entries))
    }
}
