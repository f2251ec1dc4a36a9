//! The page on which a run is played: frames, the facts of the scene and the program of the page in one file of HTML that needs no network.
//!
//! Each frame is a [chunk](chunk::Chunk), deflated and written in letters, that the page inflates when it is shown. Pages that are [served](serve) ask for them.

mod chunk;
mod facts;
mod frame;
mod program;
mod server;

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use serde_json::{Value, json};

use super::{frames::FrameFile, run_scene::scene_and_frames};
use crate::{
    error::{Error, Result},
    observe::Plane,
    scene::Scene,
};
use chunk::{Chunk, base64};
pub use server::serve;

/// Most frames of a page, and most bytes that they take together, unless a number of frames is asked for.
const MOST_FRAMES: usize = 1000;
const MOST_BYTES: usize = 64 << 20;
/// Frames whose size is looked at beforehand.
const SAMPLES: usize = 4;

/// The frames of a run, to be looked at; local to this rank.
pub struct RunView {
    folder: PathBuf,
    scene: Scene,
    files: Vec<FrameFile>,
}

impl RunView {
    /// The frames in the folder of a run.
    ///
    /// # Errors
    /// [`Error::Refused`], here and below, when there are none or one cannot be read; [`Error::File`] when the folder cannot.
    pub fn open(folder: &Path) -> Result<RunView> {
        let (scene, files) = scene_and_frames(folder)?;
        Ok(RunView { folder: folder.to_owned(), scene, files })
    }

    /// Number of frames.
    pub fn count(&self) -> usize {
        self.files.len()
    }

    /// The frames of a page of its own: all, or, of more than `most` or than the page has room for, evenly spread ones with the first and the last.
    pub fn shown(&self, most: Option<usize>) -> Result<Vec<usize>> {
        let count = self.count();
        let room = || -> Result<usize> {
            let sizes = spread(count, SAMPLES).into_iter().map(|number| Ok(4 * self.chunk(number)?.packed(None).len() / 3));
            let largest = sizes.collect::<Result<Vec<_>>>()?.into_iter().max().unwrap_or(1);
            Ok((MOST_BYTES / largest).clamp(2, MOST_FRAMES))
        };
        Ok(spread(count, most.map_or_else(room, Ok)?))
    }

    /// Writes a page with these frames, reading one at a time.
    ///
    /// # Errors
    /// The page cannot be written; a frame that cannot be read is told as such.
    pub fn write(&self, out: &mut impl Write, shown: &[usize]) -> io::Result<Result<()>> {
        let times = match self.times(shown) {
            Ok(times) => times,
            Err(error) => return Ok(Err(error)),
        };
        program::write_head(out, self.scene.shown_title())?;
        let mut first = None;
        for (place, &number) in shown.iter().enumerate() {
            let chunk = match self.chunk(number) {
                Ok(chunk) => chunk,
                Err(error) => return Ok(Err(error)),
            };
            writeln!(out, "<script type=\"text/plain\" id=\"frame-{place}\">{}</script>", base64(&chunk.packed(first.as_ref())))?;
            first.get_or_insert(chunk);
        }
        program::write_foot(out, &self.index(shown, &times, false))?;
        Ok(Ok(()))
    }

    /// The page that asks its server for frames.
    fn served_page(&self) -> Result<Vec<u8>> {
        let shown: Vec<usize> = (0..self.count()).collect();
        let times = self.times(&shown)?;
        let mut page = Vec::new();
        let written = program::write_head(&mut page, self.scene.shown_title());
        written.and_then(|()| program::write_foot(&mut page, &self.index(&shown, &times, true))).expect("a vector takes any bytes");
        Ok(page)
    }

    fn times(&self, shown: &[usize]) -> Result<Vec<f64>> {
        shown.iter().map(|&number| self.files[number].time()).collect()
    }

    fn index(&self, shown: &[usize], times: &[f64], served: bool) -> Value {
        let mut index = facts::facts(&self.scene, &self.folder);
        index["frames"] = json!({ "numbers": shown, "times": times, "total": self.count(), "served": served });
        index
    }

    fn chunk(&self, number: usize) -> Result<Chunk> {
        if self.scene.dimension() == 2 { self.chunk_in::<2>(number) } else { self.chunk_in::<3>(number) }
    }

    fn chunk_in<const D: usize>(&self, number: usize) -> Result<Chunk> {
        let file = &self.files[number];
        let chunk = frame::chunk(&file.read::<D>()?, &file.surroundings::<D>(Plane::of(&self.scene))?);
        let refuse = |reason| {
            Error::refused(format!(
                "frame {} cannot be shown ({reason}); move it out of the folder to go on without it",
                file.path().display()
            ))
        };
        chunk.map_err(refuse)
    }
}

/// So many of a number of things, evenly spread, the first and the last among them; all if there are no more.
fn spread(count: usize, most: usize) -> Vec<usize> {
    let kept = most.clamp(1, count);
    (0..kept).map(|place| if kept == 1 { 0 } else { (place * (count - 1) + (kept - 1) / 2) / (kept - 1) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_left_out_evenly() {
        assert_eq!(spread(5, 9), [0, 1, 2, 3, 4]);
        assert_eq!(spread(101, 3), [0, 50, 100]);
        assert_eq!(spread(4, 3), [0, 2, 3]);
        assert_eq!((spread(7, 1), spread(1, 2)), (vec![0], vec![0]));
        assert!(spread(1000, 999).windows(2).all(|pair| pair[0] < pair[1]));
    }
}
