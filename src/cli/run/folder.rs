//! The output folder of a run: whose it is, and the text of its scene.

use std::{fs, path::Path};

use crate::{
    error::{Error, Result},
    output::{check_finite, prepare_folder, write_whole},
    scene::Scene,
};

/// Name of the newest checkpoint.
pub const CHECKPOINT: &str = "checkpoint.h5";

const SCENE: &str = "scene.toml";
const SUMMARY: &str = "summary.json";

/// Makes a folder ready for a run from the start: it may be new, empty of runs, or hold a finished run of the same scene.
///
/// # Errors
/// [`Error::Refused`] when it cannot be written to or holds another run, or one that can be resumed.
pub fn claim(folder: &Path, scene: &Scene) -> Result<()> {
    let refuse = |reason: String| Err(Error::Refused(format!("--out {}: {reason}", folder.display())));
    if folder.join(SCENE).exists() {
        let other = Scene::read(&folder.join(SCENE), &[]).and_then(|there| scene.same_run(&there, "the run in this folder"));
        if let Err(error) = other {
            return refuse(format!("holds another run ({error}); choose another folder or remove this one"));
        }
        if folder.join(CHECKPOINT).exists() && !folder.join(SUMMARY).exists() {
            let path = folder.display();
            return refuse(format!(
                "holds a run that has not ended; `turbid resume {path}` goes on with it, removing the folder starts anew"
            ));
        }
    }
    prepare_folder(folder)?;
    // a folder with a summary is complete: from now on this one is not
    for name in [SUMMARY, CHECKPOINT] {
        remove(&folder.join(name))?;
    }
    write_whole(&folder.join(SCENE), scene.movable_text()?.as_bytes())
}

/// Makes the folder of a run ready to go on.
///
/// # Errors
/// It cannot be written to.
pub fn reclaim(folder: &Path, scene: &Scene) -> Result<()> {
    prepare_folder(folder)?;
    remove(&folder.join(SUMMARY))?;
    write_whole(&folder.join(SCENE), scene.movable_text()?.as_bytes())
}

/// The scene of a folder's run, with what a resumed run may change.
///
/// # Errors
/// There is none, or an override would change the scene.
pub fn read_scene(folder: &Path, overrides: &[String]) -> Result<Scene> {
    let path = folder.join(SCENE);
    if !path.exists() {
        let folder = folder.display();
        return Err(Error::Refused(format!("{folder}: holds no {SCENE}; turbid resume takes the output folder of a run")));
    }
    Scene::resumable_overrides(overrides)?;
    Scene::read(&path, overrides)
}

/// The last file of a run: a folder that has it is complete.
///
/// # Errors
/// It cannot be written.
pub fn complete(folder: &Path, summary: &crate::output::Summary) -> Result<()> {
    check_finite(SUMMARY, summary)?;
    let json = serde_json::to_string_pretty(summary).expect("a summary is plain numbers and text");
    write_whole(&folder.join(SUMMARY), json.as_bytes())
}

fn remove(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(Error::File { path: path.to_owned(), source }),
        _ => Ok(()),
    }
}
