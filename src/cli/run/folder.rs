//! The output folder of a run: whose it is, what it holds, and the text of its scene.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::origin::Origin;
use crate::{
    error::{Error, Result},
    output::{CHECKPOINT, Checkpoint, FolderLock, SUMMARY, Summary, Traces, check_finite, prepare_folder, write_whole},
    parallel::World,
    scene::Scene,
};

const SCENE: &str = "scene.toml";

/// The folder that a run writes into. Once it is claimed, no other run writes there until this is dropped. All functions are collective.
pub struct RunFolder<'a> {
    world: &'a World,
    path: PathBuf,
    /// Where the scene was read.
    scene_file: PathBuf,
    /// Whether what other runs have left may go.
    force: bool,
    /// The files that the scene names, as they were when the run was asked for.
    files: Vec<(String, String)>,
    claimed: bool,
    /// On the first rank.
    _lock: Option<FolderLock>,
}

impl<'a> RunFolder<'a> {
    /// For a run from the start of the scene of a file; nothing is written yet.
    ///
    /// # Errors
    /// [`Error::Refused`] if it holds what another run has left, and nobody said `force`.
    pub fn to_begin(world: &'a World, path: &Path, (scene, scene_file): (&Scene, &Path), force: bool) -> Result<RunFolder<'a>> {
        let files = world.agree(scene.files())?;
        let (path, scene_file) = (path.to_owned(), scene_file.to_owned());
        let folder = RunFolder { world, path, scene_file, force, files, claimed: false, _lock: None };
        folder.on_first_rank(|| {
            FolderLock::refuse_held(&folder.path)?;
            folder.refuse(scene)
        })?;
        Ok(folder)
    }

    /// For a run that is to go on; from now on no other writes there.
    ///
    /// # Errors
    /// [`Error::Refused`] if it holds no run, or one that is under way.
    pub fn to_resume(world: &'a World, path: &Path) -> Result<RunFolder<'a>> {
        let lock = || {
            read_scene(path, &[])?;
            FolderLock::take(path).map(Some)
        };
        let lock = world.agree(if world.rank() == 0 { lock() } else { Ok(None) })?;
        let (path, scene_file) = (path.to_owned(), path.join(SCENE));
        Ok(RunFolder { world, path, scene_file, force: false, files: Vec::new(), claimed: false, _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The scene and the checkpoint of the run that goes on, with what it may change.
    ///
    /// # Errors
    /// There is none, it belongs to another scene, a file of the run has changed, or an override would change the scene.
    pub fn read(&mut self, overrides: &[String]) -> Result<(Scene, Checkpoint<'a>)> {
        let (world, path) = (self.world, self.path.as_path());
        let scene = world.agree(read_scene(path, overrides))?;
        let checkpoint = Checkpoint::open(world, &path.join(CHECKPOINT))?;
        let origin = checkpoint.text_if_any("origin")?;
        let origin = world.agree(origin.map(|text| Origin::read(&text, path)).transpose())?;
        let scene = Scene { name: origin.map_or(scene.name.clone(), |origin| origin.name), ..scene };
        let text = checkpoint.text("scene")?;
        let began = world.agree(Scene::parse(&scene.name, path, &text, &[]))?;
        world.agree(scene.same_run(&began, "the checkpoint"))?;
        self.files = world.agree(scene.files())?;
        Ok((scene, checkpoint))
    }

    /// Makes the folder ready for a run from the start, once: what others have left is gone.
    ///
    /// # Errors
    /// [`Error::Refused`] when it cannot be written to, another run is under way there, or it holds what may not go.
    pub fn claim(&mut self, scene: &Scene) -> Result<()> {
        if self.claimed {
            return Ok(());
        }
        self.lock()?;
        self.on_first_rank(|| {
            self.refuse(scene)?;
            if scene.files()? != self.files {
                let path = self.path.display();
                return Err(Error::Refused(format!(
                    "--out {path}: a file of the scene changed while the run was made ready; start it again"
                )));
            }
            Traces::of(&self.path)?.remove()?;
            self.write_scene(scene)
        })?;
        self.claimed = true;
        Ok(())
    }

    /// Makes the folder ready for a run that goes on.
    ///
    /// # Errors
    /// It cannot be written to.
    pub fn reclaim(&mut self, scene: &Scene) -> Result<()> {
        self.on_first_rank(|| {
            prepare_folder(&self.path)?;
            // a folder with a summary is complete: from now on this one is not
            remove(&self.path.join(SUMMARY))?;
            self.write_scene(scene)
        })
    }

    /// What checkpoints hold of the scene: its text, which names the copies of its files, and its origin.
    ///
    /// # Errors
    /// The scene cannot be written so.
    pub fn texts(&self, scene: &Scene) -> Result<Vec<(&'static str, String)>> {
        Ok(vec![("scene", scene.copied_text()?), ("origin", Origin::new(&scene.name, &self.files).text())])
    }

    /// Writes the last file of the run.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn complete(&self, summary: &Summary) -> Result<()> {
        check_finite(SUMMARY, summary)?;
        let json = serde_json::to_string_pretty(summary).expect("a summary is plain numbers and text");
        self.on_first_rank(|| write_whole(&self.path.join(SUMMARY), json.as_bytes()))
    }

    fn lock(&mut self) -> Result<()> {
        let lock = || prepare_folder(&self.path).and_then(|()| FolderLock::take(&self.path)).map(Some);
        self._lock = self.world.agree(if self.world.rank() == 0 { lock() } else { Ok(None) })?;
        Ok(())
    }

    fn on_first_rank(&self, act: impl FnOnce() -> Result<()>) -> Result<()> {
        self.world.agree(if self.world.rank() == 0 { act() } else { Ok(()) })
    }

    fn write_scene(&self, scene: &Scene) -> Result<()> {
        self.files.iter().try_for_each(|(name, text)| write_whole(&self.path.join(name), text.as_bytes()))?;
        write_whole(&self.path.join(SCENE), scene.copied_text()?.as_bytes())
    }

    /// Refuses to let go what is there, unless it is what the same scene left without a checkpoint.
    fn refuse(&self, scene: &Scene) -> Result<()> {
        // a run that was killed before it wrote its scene may have copied files
        let (there, kept) = (Traces::of(&self.path)?.besides(&self.files), self.path.join(SCENE));
        if self.force || (there.none() && !kept.exists()) {
            return Ok(());
        }
        let refuse = |what: String, remedy: &str| {
            let (path, files) = (self.path.display(), there.words());
            let files = if files.is_empty() { files } else { format!(": {files}") };
            Err(Error::Refused(format!("--out {path}: {what}{files}; choose another folder, or {remedy}")))
        };
        let anew = "let it all be overwritten with --force";
        if !kept.exists() {
            return refuse(format!("holds files of no run that is known (it has no {SCENE})"), anew);
        }
        if same_place(&kept, &self.scene_file) {
            return refuse("holds the scene itself, which the run would overwrite".into(), anew);
        }
        if let Err(error) = Scene::read(&kept, &[]).and_then(|there| scene.same_run(&there, "the run in this folder")) {
            return refuse(format!("holds another run ({error})"), anew);
        }
        let resume = format!("go on with it by `turbid resume {}`, or start anew with --force", self.path.display());
        match (there.has(SUMMARY), there.has(CHECKPOINT)) {
            (false, true) => refuse("holds a run that has not ended".into(), &resume),
            (true, true) => refuse("holds this run, finished".into(), &resume),
            (true, false) => refuse("holds this run, finished".into(), anew),
            (false, false) => Ok(()),
        }
    }
}

/// The scene of a folder's run, with what a resumed run may change.
fn read_scene(folder: &Path, overrides: &[String]) -> Result<Scene> {
    let path = folder.join(SCENE);
    if !path.exists() {
        let folder = folder.display();
        return Err(Error::Refused(format!("{folder}: holds no {SCENE}; turbid resume takes the output folder of a run")));
    }
    Scene::resumable_overrides(overrides)?;
    let scene = Scene::read(&path, overrides)?;
    if scene.time.is_none() {
        return Err(Error::Refused(format!("{}: holds no run in time; only these are resumed", folder.display())));
    }
    Ok(scene)
}

fn same_place(one: &Path, two: &Path) -> bool {
    matches!((one.canonicalize(), two.canonicalize()), (Ok(one), Ok(two)) if one == two)
}

fn remove(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(Error::File { path: path.to_owned(), source }),
        _ => Ok(()),
    }
}
