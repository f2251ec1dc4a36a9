//! Which files of a folder are those of a run.

use std::{
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};

use super::{body_summary::BODY_TABLE, frames::FRAMES};
use crate::error::{Error, Result};

/// The last file of a run: a folder that has it is complete.
pub const SUMMARY: &str = "summary.json";
/// The newest checkpoint.
pub const CHECKPOINT: &str = "checkpoint.h5";

/// The progress of the run.
pub const LOG: &str = "run.log";
/// The page of the run.
pub const REPORT: &str = "report.html";
/// What the folder holds, and how it came about.
pub const CRATE: &str = "ro-crate-metadata.json";

/// The files that a run may leave, the first one first to go; not the text of its scene, nor its calibration, which says what it is of.
const FILES: [&str; 50] = [
    SUMMARY,
    CHECKPOINT,
    "series.csv",
    "forces.csv",
    "energy.csv",
    "chains.csv",
    "cells.csv",
    "clusters.csv",
    "run.h5",
    BODY_TABLE,
    "bodies.xdmf",
    "bonds.xdmf",
    "contacts.xdmf",
    "fields.xdmf",
    "membranes.xdmf",
    "bodies.vtkhdf",
    "fields.vtkhdf",
    "picture.svg",
    "picture.png",
    "animation.png",
    "view.html",
    "viscosity.svg",
    "stress.svg",
    "creep.svg",
    "effort.svg",
    "probe.csv",
    "pairs.csv",
    "pairs.json",
    "pairs.svg",
    "structure-factor.csv",
    "structure-factor.svg",
    "displacements.csv",
    "displacements.svg",
    "velocity-autocorrelation.csv",
    "velocity-autocorrelation.svg",
    "pairs-map.svg",
    "profiles.csv",
    "profiles.svg",
    "profile-frames.csv",
    ".series.csv.sums",
    ".forces.csv.sums",
    ".energy.csv.sums",
    ".chains.csv.sums",
    ".cells.csv.sums",
    ".clusters.csv.sums",
    ".profile-frames.csv.sums",
    "contact-island.json",
    REPORT,
    CRATE,
    LOG,
];

/// Files of a run for people, and what they are.
pub const KNOWN_FILES: [(&str, &str); 41] = [
    (SUMMARY, "the numbers of the run"),
    ("series.csv", "a row for each step"),
    ("forces.csv", "forces on bodies with prescribed motion, a row for each step"),
    ("energy.csv", "the balance of energy, a row for each step"),
    ("chains.csv", "chains, a row for each of them at the time of every frame"),
    ("cells.csv", "cells, a row for each of them at the time of every frame"),
    ("clusters.csv", "rigid clusters, a row for each of them at the time of every frame"),
    (BODY_TABLE, "all bodies at the end"),
    ("picture.svg", "the end of the run"),
    ("picture.png", "the end of the run"),
    ("animation.png", "the run as an animated picture"),
    ("viscosity.svg", "the viscosity over the strain"),
    ("stress.svg", "the shear stress over the strain, of a shear that changes"),
    ("creep.svg", "the strain over time, of a shear that a stress decides"),
    ("effort.svg", "what the steps cost"),
    ("pairs.svg", "the pair distribution"),
    ("pairs-map.svg", "the pair distribution in the plane of the shear"),
    ("pairs.csv", "the pair distribution as numbers"),
    ("pairs.json", "the pair distribution with its angles"),
    ("structure-factor.svg", "the structure factor"),
    ("structure-factor.csv", "the structure factor as numbers"),
    ("displacements.svg", "mean-square displacements over the lag"),
    ("displacements.csv", "mean-square displacements as numbers"),
    ("velocity-autocorrelation.svg", "the velocity autocorrelation over the lag"),
    ("velocity-autocorrelation.csv", "the velocity autocorrelation as numbers"),
    ("profiles.svg", "profiles across the box"),
    ("profiles.csv", "profiles across the box as numbers"),
    ("view.html", "a page that plays the frames"),
    ("probe.csv", "the flow on a lattice of points"),
    ("run.h5", "all frames as one HDF5 file"),
    ("bodies.xdmf", "bodies of all frames, for ParaView"),
    ("fields.xdmf", "the flow of all frames, for ParaView"),
    ("contacts.xdmf", "contacts of all frames, for ParaView"),
    ("bonds.xdmf", "bonds of all frames, for ParaView"),
    ("membranes.xdmf", "membranes of all frames, for ParaView"),
    ("bodies.vtkhdf", "bodies of all frames as VTKHDF, for ParaView"),
    ("fields.vtkhdf", "the flow of all frames as VTKHDF, for ParaView"),
    (CHECKPOINT, "from where the run can go on"),
    ("scene.toml", "the scene"),
    (CRATE, "all files of the run with their checksums, as RO-Crate"),
    (LOG, "dates and progress of the run"),
];

/// What runs have left in a folder.
pub struct Traces {
    folder: PathBuf,
    files: Vec<PathBuf>,
    frames: Vec<PathBuf>,
}

impl Traces {
    /// Those in a folder, which need not be there.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn of(folder: &Path) -> Result<Traces> {
        let known = FILES.iter().map(|name| folder.join(name)).filter(|path| path.exists());
        let tables = entries(folder)?.into_iter().filter(|path| ["bodies-", "path-"].iter().any(|what| numbered(path, what, &[".csv"])));
        let frames = entries(&folder.join(FRAMES))?.into_iter().filter(|path| numbered(path, "", &[".h5", ".h5.part", ".h5.damaged"]));
        Ok(Traces { folder: folder.to_owned(), files: known.chain(tables).collect(), frames: frames.collect() })
    }

    /// Those that are not as `known`, names of files with their texts, has them.
    pub fn besides(mut self, known: &[(String, String)]) -> Traces {
        let same = |path: &Path, (name, text): &(String, String)| {
            path.ends_with(name) && fs::read(path).is_ok_and(|bytes| bytes == text.as_bytes())
        };
        self.files.retain(|path| !known.iter().any(|known| same(path, known)));
        self
    }

    /// Whether there are none.
    pub fn none(&self) -> bool {
        self.files.is_empty() && self.frames.is_empty()
    }

    /// Whether a file of this name is among them.
    pub fn has(&self, name: &str) -> bool {
        self.files.iter().any(|path| path.ends_with(name))
    }

    /// Their paths in the folder.
    pub fn names(&self) -> Vec<String> {
        let all = self.files.iter().chain(&self.frames);
        all.filter_map(|path| Some(path.strip_prefix(&self.folder).ok()?.to_string_lossy().into_owned())).collect()
    }

    /// What they are, in words.
    pub fn words(&self) -> String {
        let names = self.files.iter().filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
        let frames = (!self.frames.is_empty()).then(|| format!("{} in {FRAMES}/", self.frames.len()));
        names.chain(frames).collect::<Vec<_>>().join(", ")
    }

    /// Removes them.
    ///
    /// # Errors
    /// One of them cannot be removed.
    pub fn remove(self) -> Result<()> {
        for path in self.files.into_iter().chain(self.frames) {
            fs::remove_file(&path).map_err(|source| Error::File { path, source })?;
        }
        // it stays if others have put something there
        let _ = fs::remove_dir(self.folder.join(FRAMES));
        Ok(())
    }
}

/// The entries of a folder; none if there is no such folder.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>();
    match list() {
        Err(source) if matches!(source.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Ok(Vec::new()),
        list => list.map_err(|source| Error::File { path: folder.to_owned(), source }),
    }
}

/// Whether a file is called so, with a number between a beginning and one of these endings.
fn numbered(path: &Path, beginning: &str, endings: &[&str]) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let number = |ending: &&str| name.strip_prefix(beginning)?.strip_suffix(*ending)?.parse::<usize>().ok();
    endings.iter().any(|ending| number(ending).is_some())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_a_run_left_is_named_and_removed_and_nothing_else_is() {
        let folder = std::env::temp_dir().join(format!("turbid-traces-{}", std::process::id()));
        assert!(Traces::of(&folder).unwrap().none());
        fs::create_dir_all(folder.join("frames")).unwrap();
        let own = ["summary.json", "bodies-0.csv", "frames/000000.h5", "frames/000001.h5.damaged"];
        let foreign = ["notes.txt", "bodies-all.csv", "frames/best.h5"];
        own.iter().chain(&foreign).for_each(|name| fs::write(folder.join(name), b"x").unwrap());
        let traces = Traces::of(&folder).unwrap();
        assert!(traces.has(SUMMARY) && !traces.has(CHECKPOINT));
        assert_eq!(traces.words(), "summary.json, bodies-0.csv, 2 in frames/");
        let known = |text: &str| [("bodies-0.csv".to_owned(), text.to_owned())];
        assert_eq!(Traces::of(&folder).unwrap().besides(&known("y")).words(), traces.words());
        assert_eq!(Traces::of(&folder).unwrap().besides(&known("x")).words(), "summary.json, 2 in frames/");
        traces.remove().unwrap();
        assert!(own.iter().all(|name| !folder.join(name).exists()) && foreign.iter().all(|name| folder.join(name).exists()));
        fs::remove_dir_all(&folder).unwrap();
    }
}
