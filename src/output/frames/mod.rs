//! Frames: one HDF5 file an output time, `frames/000012.h5`, and companions that show them as one run.
//!
//! `run.h5` links to all frames; `bodies.xdmf`, `fields.xdmf`, `contacts.xdmf`, `bonds.xdmf` and `membranes.xdmf` show them to ParaView, each once it has
//! something to show; `bodies.vtkhdf` and `fields.vtkhdf` do so for its own reader of HDF5, once the frames have ended.
//! Where the images of the box slide, a frame holds by how much: `offset` along x, which `offset_rate` makes grow (what is at `(x, y)` is
//! also at `(x + offset, y + size_y)` and moves there faster by `offset_rate`). Every file is written aside and renamed, so that a reader never
//! meets half of one and the end of the program at any moment loses at most the frame under way. The companions grow: a frame adds its own entry.

mod body;
mod bond;
mod contact;
mod entry;
mod frame;
mod index;
mod listing;
mod membrane;
mod read;
mod recovery;
mod run_file;
mod store;
mod surroundings;
mod vtkhdf;
mod xdmf;

use std::path::{Path, PathBuf};

pub use bond::FrameBond;
pub use contact::FrameContact;
pub(super) use entry::FOLDER as FRAMES;
pub use frame::{Frame, FrameFields};
pub use membrane::{FrameCorner, FrameFace, FrameMembranes};
pub use read::{FrameFile, StoredFrame, read_frames};
pub use surroundings::{FlowLayer, FrameSurroundings};

use super::files::parallel_file::ParallelFile;
use crate::{error::Result, parallel::World};
use entry::{Entry, path_in_run};
use index::Index;
use recovery::KeptFrames;

/// The frames of a run. All functions are collective.
pub struct Frames {
    folder: PathBuf,
    /// Number of the next frame.
    next: usize,
    /// The frames so far, known to the first rank only.
    entries: Vec<Entry>,
    /// On the first rank.
    index: Option<Index>,
}

impl Frames {
    /// No frames yet; those of an older run in the folder are removed. With `vtkhdf` they are shown in VTKHDF too once they have ended.
    ///
    /// # Errors
    /// [`Error::File`](crate::error::Error::File), here and below, when a file cannot be written or removed.
    pub fn create(world: &World, folder: &Path, vtkhdf: bool) -> Result<Frames> {
        Ok(Frames::keep(world, folder, f64::NEG_INFINITY, vtkhdf)?.0)
    }

    /// The frames of a run that goes on from `time`, of which later ones are removed, and what is missing of them (on the first rank).
    /// A frame that cannot be read is set aside.
    pub fn resume(world: &World, folder: &Path, time: f64, vtkhdf: bool) -> Result<(Frames, Vec<String>)> {
        Frames::keep(world, folder, time, vtkhdf)
    }

    fn keep(world: &World, folder: &Path, time: f64, vtkhdf: bool) -> Result<(Frames, Vec<String>)> {
        let KeptFrames { entries, index, next, notes } = world.on_first_rank(|| recovery::keep_until(folder, time, vtkhdf))?;
        let next = world.gather(&[next as u64])[0] as usize;
        Ok((Frames { folder: folder.to_owned(), next, entries, index }, notes))
    }

    /// Adds a frame.
    pub fn write<const D: usize>(&mut self, world: &World, frame: &Frame<D>) -> Result<()> {
        let rows = frame.rows(world)?;
        let mut file = ParallelFile::create(world, &self.folder.join(path_in_run(self.next)))?;
        store::store(&mut file, frame, &rows)?;
        file.finish()?;
        let number = self.next;
        self.next += 1;
        world.on_first_rank(|| {
            self.entries.push(Entry::of(number, frame, &rows));
            self.index.as_mut().map_or(Ok(()), |index| index.update(&self.entries))
        })
    }

    /// Lists the frames so far everywhere, on a rank by itself: no further frame comes.
    pub fn settle_local(&mut self) -> Result<()> {
        self.index.as_mut().map_or(Ok(()), |index| index.settle(&self.entries))
    }

    /// Ends the lists, but for frames that have gone since they were written, and says which these are (on the first rank).
    pub fn finish(&mut self, world: &World) -> Result<Option<String>> {
        let Some(index) = &mut self.index else { return world.agree(Ok(None)) };
        world.agree(recovery::forget_lost(&self.folder, &mut self.entries, index))
    }
}
