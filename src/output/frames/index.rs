//! What is known of all frames: `run.h5` with links to them, and the files for ParaView.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{
    entry::{Entry, FOLDER},
    listing::Listing,
    run_file::{RUN, RunFile},
    vtkhdf::{SERIES, Series},
    xdmf::{self, Companion},
};
use crate::{
    error::{Error, Result},
    output::files::file::remove_file,
};

/// All that lists the frames of a run.
pub(super) struct Index {
    run: Listing<RunFile>,
    companions: Vec<Listing<Companion>>,
    /// Written as a whole at the beginning and the end; none where nobody wants them.
    series: Vec<Listing<Series>>,
}

impl Index {
    /// The index of a run's folder with these frames, in place of what is there, with VTKHDF or without; what a run that was killed left beside it goes.
    pub fn begin(folder: &Path, entries: &[Entry], vtkhdf: bool) -> Result<Index> {
        let companion = |companion: Companion| Listing::new(folder.join(companion.name), companion);
        let companions = xdmf::COMPANIONS.into_iter().map(companion).collect::<Result<_>>()?;
        let series = |series: Series| Listing::new(folder.join(series.name), series);
        let mut series = SERIES.into_iter().map(series).collect::<Result<Vec<_>>>()?;
        if !vtkhdf {
            SERIES.iter().try_for_each(|series| remove_file(&folder.join(series.name)))?;
            series.clear();
        }
        let mut index = Index { run: Listing::new(folder.join(RUN), RunFile)?, companions, series };
        index.rewrite(entries)?;
        Ok(index)
    }

    /// Writes all of it anew.
    pub fn rewrite(&mut self, entries: &[Entry]) -> Result<()> {
        self.run.rewrite(entries)?;
        self.companions.iter_mut().try_for_each(|companion| companion.rewrite(entries))?;
        self.series.iter_mut().try_for_each(|series| series.rewrite(entries))
    }

    /// Lists all frames everywhere and leaves nothing beside the files.
    pub fn settle(&mut self, entries: &[Entry]) -> Result<()> {
        self.run.settle()?;
        self.companions.iter_mut().try_for_each(Listing::settle)?;
        self.series.iter_mut().try_for_each(|series| series.update(entries).and_then(|()| series.settle()))
    }

    /// Adds the frames that are new.
    pub fn update(&mut self, entries: &[Entry]) -> Result<()> {
        self.run.update(entries)?;
        self.companions.iter_mut().try_for_each(|companion| companion.update(entries))
    }
}

/// Numbers and times of the frames that `run.h5` lists, or what is wrong with it.
pub(super) fn listed(folder: &Path) -> std::result::Result<Vec<(usize, f64)>, String> {
    let path = folder.join(RUN);
    if !path.exists() {
        return Err(format!("{} is missing", path.display()));
    }
    let read = || {
        let file = hdf5::File::open(&path)?;
        let mut numbers: Vec<usize> = file.group(FOLDER)?.member_names()?.iter().filter_map(|name| name.parse().ok()).collect();
        numbers.sort_unstable();
        let times = file.dataset("times")?.read_raw::<f64>()?;
        Ok::<_, hdf5::Error>(numbers.into_iter().zip(times).collect())
    };
    read().map_err(|error| format!("{} cannot be read ({error})", path.display()))
}

/// The frames in the folder of a run, in their order.
pub(super) fn frame_files(folder: &Path) -> Result<Vec<(usize, PathBuf)>> {
    let number = |path: &Path| path.extension().filter(|ending| *ending == "h5").and(path.file_stem()?.to_str()?.parse::<usize>().ok());
    let mut frames: Vec<_> = files(&folder.join(FOLDER))?.into_iter().filter_map(|path| Some((number(&path)?, path))).collect();
    frames.sort();
    Ok(frames)
}

/// Removes frames that were under way when a run ended.
pub(super) fn remove_halves(folder: &Path) -> Result<()> {
    let halves = files(&folder.join(FOLDER))?.into_iter().filter(|path| path.to_string_lossy().ends_with(".h5.part"));
    halves.into_iter().try_for_each(|path| fs::remove_file(&path).map_err(|source| Error::File { path, source }))
}

fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>();
    list().map_err(|source| Error::File { path: folder.to_owned(), source })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::output::frames::{
        entry::{ContactNetwork, Membranes, Mesh},
        run_file::LARGEST_BLOCK,
    };

    fn entries(count: usize) -> Vec<Entry> {
        let mesh = Mesh { cells: vec![8, 6], spacing: vec![0.25, 0.5], vorticity: true };
        let entry = |number: usize| Entry {
            number,
            time: number as f64 / 8.0,
            step: 2 * number,
            bodies: 4,
            contacts: Some(ContactNetwork { count: number % 3, present: [false, true] }),
            bonds: number,
            membranes: Some(Membranes { corners: 4, faces: 1, topology: 6 }),
            mesh: Some(mesh.clone()),
            offset: None,
        };
        (0..count).map(entry).collect()
    }

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("turbid-index-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn steps(folder: &Path) -> Vec<u64> {
        hdf5::File::open(folder.join(RUN)).unwrap().dataset("steps").unwrap().read_raw().unwrap()
    }

    /// All files by name, with the text of those that are text.
    fn texts(folder: &Path) -> Vec<(String, String)> {
        let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
        let text = |path: &PathBuf| (name(path), fs::read_to_string(path).unwrap_or_default());
        let mut texts: Vec<(String, String)> = files(folder).unwrap().iter().map(text).collect();
        texts.sort();
        texts
    }

    #[test]
    fn frames_that_come_one_by_one_are_listed_as_those_that_come_at_once() {
        let (grown, whole) = (folder("grown"), folder("whole"));
        let all = entries(40);
        let mut index = Index::begin(&grown, &[], true).unwrap();
        for count in 1..=all.len() {
            // another hand changes what lies beside, and a reader has a list open
            if count == 7 {
                fs::write(grown.join("run.h5.part"), b"garbage").unwrap();
                fs::write(grown.join("bodies.xdmf.part"), b"garbage").unwrap();
            }
            let _reader = (count % 5 == 0).then(|| hdf5::File::open(grown.join(RUN)).unwrap());
            index.update(&all[..count]).unwrap();
            assert_eq!(listed(&grown).unwrap().len(), count);
            let shown = |name: &str| fs::read_to_string(grown.join(name)).map_or(0, |text| text.matches("<Time").count());
            assert_eq!(
                xdmf::COMPANIONS.map(|companion| shown(companion.name)),
                [count, count - count.div_ceil(3), count - 1, count, count]
            );
        }
        index.settle(&all).unwrap();
        Index::begin(&whole, &all, true).unwrap();
        assert_eq!(texts(&grown), texts(&whole));
        assert_eq!((listed(&grown), steps(&grown)), (listed(&whole), steps(&whole)));
        [grown, whole].iter().for_each(|folder| fs::remove_dir_all(folder).unwrap());
    }

    /// Bytes that this thread has read and written so far.
    fn traffic() -> [u64; 2] {
        let text = fs::read_to_string("/proc/thread-self/io").unwrap();
        let number = |name: &str| text.lines().find_map(|line| line.strip_prefix(name)).unwrap().trim().parse().unwrap();
        ["rchar:", "wchar:"].map(number)
    }

    #[test]
    fn a_frame_costs_the_same_however_many_were_before() {
        let folder = folder("cost");
        // a block of HDF5's heap, read and written; the bytes of all entries are far more
        let most = LARGEST_BLOCK + (1 << 14);
        for before in [10, 1000, 20_000] {
            let all = entries(before + 6);
            let mut index = Index::begin(&folder, &all[..before], true).unwrap();
            // the first one makes the version beside
            index.update(&all[..before + 1]).unwrap();
            for count in before + 2..=all.len() {
                let start = traffic();
                index.update(&all[..count]).unwrap();
                let [read, written] = [0, 1].map(|way| traffic()[way] - start[way]);
                assert!(read < most && written < most, "frame {count} reads {read} bytes and writes {written}");
            }
        }
        let whole: u64 = xdmf::COMPANIONS.iter().map(|companion| fs::metadata(folder.join(companion.name)).unwrap().len()).sum();
        assert!(whole > 100 * most);
        fs::remove_dir_all(&folder).unwrap();
    }
}
