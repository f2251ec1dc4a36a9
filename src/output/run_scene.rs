//! Where the scene of a run lies, and what is said of a folder that holds none.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::frames::{FRAMES, FrameFile};
use crate::{
    error::{Error, Offer, Refusal, Result},
    scene::Scene,
};

/// The scene of a run, in its folder.
pub const SCENE: &str = "scene.toml";

/// What a sweep measured, in its folder.
pub const SWEEP: &str = "sweep.json";

/// The folder within that of a sweep that holds its runs.
pub const SWEEP_RUNS: &str = "runs";

/// The file of the scene of the run in a folder.
///
/// # Errors
/// [`Error::Refused`] when there is no such folder, or it holds none; of a sweep, what to do is offered.
pub fn scene_file(folder: &Path, of_sweep: impl FnOnce() -> Offer) -> Result<PathBuf> {
    let refuse = |what: &str, offer: Offer| Err(Refusal::from(format!("{}: {what}", folder.display())).offering(offer));
    let path = folder.join(SCENE);
    match (path.exists(), folder.exists()) {
        (true, _) => Ok(path),
        (_, false) => refuse("no such folder", Offer::FolderOfRun),
        _ if !folder.is_dir() => refuse("is no folder", Offer::FolderOfRun),
        _ if folder.join(SWEEP).exists() => refuse("holds a sweep, not a run", of_sweep()),
        _ => refuse(&format!("holds no {SCENE}"), Offer::FolderOfRun),
    }
}

/// The scene of a run, and its frames, in the order of time.
///
/// # Errors
/// As [`scene_file`]; there are no frames, or the folder cannot be read.
pub fn scene_and_frames(folder: &Path) -> Result<(Scene, Vec<FrameFile>)> {
    let path = scene_file(folder, || Offer::RunWithFrames(runs_with_frames(&folder.join(SWEEP_RUNS))))?;
    let (scene, files) = (Scene::read(&path, &[])?, frames(folder)?);
    let without = |reason: &str| format!("{}: holds no frames{reason}", folder.display());
    match files.is_empty() {
        false => Ok((scene, files)),
        true if of_sweep(folder) && scene.time.is_some() => Err(Refusal::from(without("")).offering(Offer::RunWithFrames(Vec::new()))),
        true => Err(Error::refused(without("; only runs with a [time] section write them"))),
    }
}

/// The frames of a run, also of one that has no folder for them.
fn frames(folder: &Path) -> Result<Vec<FrameFile>> {
    if folder.join(FRAMES).exists() { FrameFile::of_run(folder) } else { Ok(Vec::new()) }
}

/// Whether a run is kept in the folder of a sweep.
fn of_sweep(folder: &Path) -> bool {
    let above = folder.canonicalize().ok().and_then(|folder| Some(folder.parent()?.parent()?.join(SWEEP)));
    above.is_some_and(|sweep| sweep.exists())
}

/// The runs in a folder of runs that have frames, in the order of their names.
fn runs_with_frames(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let with_frames = |folder: &PathBuf| frames(folder).is_ok_and(|files| !files.is_empty());
    let mut folders: Vec<PathBuf> = entries.filter(with_frames).collect();
    folders.sort();
    folders
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const TEXT: &str =
        "domain.size = [4.0, 4.0]\nresolution.spacing = 0.25\ntime.end = 1.0\n[[bodies]]\nradius = 1.0\ncenters = [[2.0, 2.0]]\n";

    fn offered(folder: &Path) -> (String, Option<Offer>) {
        match scene_and_frames(folder).map(drop).unwrap_err() {
            Error::Refused(refusal) => (refusal.remedy.clone(), refusal.offer.clone()),
            other => panic!("{other}"),
        }
    }

    #[test]
    fn folders_without_frames_are_told_apart() {
        let here = std::env::temp_dir().join(format!("turbid-run-scene-{}", std::process::id()));
        let (sweep, [bare, kept]) = (here.join("sweep"), ["bare", "kept"].map(|name| here.join("sweep/runs").join(name)));
        let without = |folder: &Path, what: &str| format!("{}: {what}", folder.display());
        assert_eq!(offered(&sweep), (without(&sweep, "no such folder"), Some(Offer::FolderOfRun)));
        fs::create_dir_all(&bare).unwrap();
        assert_eq!(offered(&sweep), (without(&sweep, "holds no scene.toml"), Some(Offer::FolderOfRun)));
        fs::write(sweep.join(SWEEP), "{}").unwrap();
        assert_eq!(offered(&sweep), (without(&sweep, "holds a sweep, not a run"), Some(Offer::RunWithFrames(Vec::new()))));
        let file = sweep.join(SWEEP);
        assert_eq!(offered(&file), (without(&file, "is no folder"), Some(Offer::FolderOfRun)));
        fs::write(bare.join(SCENE), TEXT).unwrap();
        assert_eq!(offered(&bare), (without(&bare, "holds no frames"), Some(Offer::RunWithFrames(Vec::new()))));
        fs::create_dir_all(kept.join("frames")).unwrap();
        fs::write(kept.join("frames/000000.h5"), "").unwrap();
        assert_eq!(offered(&sweep).1, Some(Offer::RunWithFrames(vec![kept])));
        let alone = here.join("alone");
        fs::create_dir_all(&alone).unwrap();
        fs::write(alone.join(SCENE), TEXT).unwrap();
        assert_eq!(offered(&alone), (without(&alone, "holds no frames; only runs with a [time] section write them"), None));
        fs::remove_dir_all(&here).unwrap();
    }
}
