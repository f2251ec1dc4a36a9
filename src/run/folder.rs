//! The output folder of a run: whose it is, what it holds, and the text of its scene.

use std::{
    path::{Path, PathBuf},
    time::SystemTime,
};

use super::{calibration, command::command, origin::Origin};
use crate::{
    error::{Error, Offer, Place, Refusal, Result},
    output::{
        CHECKPOINT, CRATE, Checkpoint, FolderLock, RunRecord, SCENE, SUMMARY, Summary, Traces, check_finite, prepare_folder, remove_file,
        scene_file, write_crate, write_whole,
    },
    parallel::World,
    scene::Scene,
};

/// The folder that a run writes into. Once it is claimed, no other run writes there until this is dropped. All functions are collective.
pub struct RunFolder<'a> {
    world: &'a World,
    path: PathBuf,
    /// Where the scene was read, if it was.
    scene_file: Option<PathBuf>,
    /// Whether what other runs have left may go.
    overwrite: bool,
    /// Whether a run goes on here.
    resumed: bool,
    /// The files that the scene names, as they were when the run was asked for.
    files: Vec<(String, String)>,
    claimed: bool,
    /// When this program came to it.
    begun: SystemTime,
    /// On the first rank.
    _lock: Option<FolderLock>,
}

/// A run from its start.
#[derive(Debug, Clone, Copy)]
pub struct NewRun<'s> {
    /// What is run.
    pub scene: &'s Scene,
    /// Where it was read, if it was.
    pub scene_file: Option<&'s Path>,
    /// Whether what other runs have left in the folder may go.
    pub overwrite: bool,
}

impl<'a> RunFolder<'a> {
    /// For a run from its start; nothing is written yet.
    ///
    /// # Errors
    /// [`Error::Refused`] if it holds what another run has left that may not be overwritten.
    pub fn to_begin(world: &'a World, path: &Path, new: NewRun) -> Result<RunFolder<'a>> {
        let files = world.agree(new.scene.files())?;
        let (path, scene_file) = (path.to_owned(), new.scene_file.map(Path::to_owned));
        let folder = RunFolder {
            world,
            path,
            scene_file,
            overwrite: new.overwrite,
            resumed: false,
            files,
            claimed: false,
            begun: SystemTime::now(),
            _lock: None,
        };
        world.on_first_rank(|| {
            FolderLock::refuse_held(&folder.path)?;
            folder.refuse(new.scene)
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
        let lock = world.on_first_rank(lock)?;
        let files = Vec::new();
        Ok(RunFolder {
            world,
            path: path.to_owned(),
            scene_file: None,
            overwrite: false,
            resumed: true,
            files,
            claimed: false,
            begun: SystemTime::now(),
            _lock: lock,
        })
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

    /// Whether the run is at the end that a scene of it has: it was finished, and goes no further. On the first rank.
    pub fn ended_local(&self, scene: &Scene) -> bool {
        self.path.join(SUMMARY).exists() && read_scene(&self.path, &[]).is_ok_and(|kept| kept.time == scene.time)
    }

    /// Makes the folder ready, once: what others have left is gone, unless the run goes on there.
    ///
    /// # Errors
    /// [`Error::Refused`] when it cannot be written to, another run is under way there, or it holds what may not go.
    pub fn claim(&mut self, scene: &Scene) -> Result<()> {
        if self.claimed {
            return Ok(());
        }
        if !self.resumed {
            self.lock()?;
        }
        self.world.on_first_rank(|| {
            if self.resumed {
                prepare_folder(&self.path)?;
                // a folder with a summary is complete: from now on this one is not
                [SUMMARY, CRATE].iter().try_for_each(|name| remove_file(&self.path.join(name)))?;
            } else {
                self.clear(scene)?;
            }
            self.write_scene(scene)
        })?;
        self.claimed = true;
        Ok(())
    }

    /// Removes what other runs have left.
    fn clear(&self, scene: &Scene) -> Result<()> {
        self.refuse(scene)?;
        if scene.files()? != self.files {
            let remedy = "a file of the scene changed while the run was made ready; start it again";
            return Err(self.refusal(remedy.into()).into());
        }
        Traces::of(&self.path)?.remove()
    }

    fn refusal(&self, remedy: String) -> Refusal {
        Refusal { place: Some(Place::Folder(self.path.clone())), ..Refusal::from(remedy) }
    }

    /// What checkpoints hold of the scene: its text, which names the copies of its files, and its origin.
    ///
    /// # Errors
    /// The scene cannot be written so.
    pub fn texts(&self, scene: &Scene) -> Result<Vec<(&'static str, String)>> {
        Ok(vec![("scene", scene.copied_text()?), ("origin", Origin::new(&scene.name, &self.files).text())])
    }

    /// Writes the last files of the run, the summary after the others, and gives their names.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn complete(&self, summary: &Summary) -> Result<Vec<String>> {
        check_finite(SUMMARY, summary)?;
        let json = serde_json::to_string_pretty(summary).expect("a summary is plain numbers and text");
        let inputs = [SCENE, calibration::FILE].into_iter().chain(self.files.iter().map(|(name, _)| name.as_str()));
        let inputs = inputs.map(str::to_owned).collect();
        write_crate(self.world, &self.path, &RunRecord { summary, text: &json, command: command(), begun: self.begun, inputs })?;
        self.world.on_first_rank(|| write_whole(&self.path.join(SUMMARY), json.as_bytes()))?;
        Ok([CRATE, SUMMARY].map(str::to_owned).to_vec())
    }

    fn lock(&mut self) -> Result<()> {
        let lock = || prepare_folder(&self.path).and_then(|()| FolderLock::take(&self.path)).map(Some);
        self._lock = self.world.on_first_rank(lock)?;
        Ok(())
    }

    fn write_scene(&self, scene: &Scene) -> Result<()> {
        self.files.iter().try_for_each(|(name, text)| write_whole(&self.path.join(name), text.as_bytes()))?;
        write_whole(&self.path.join(SCENE), scene.copied_text()?.as_bytes())
    }

    /// Refuses to let go what is there, unless it is what the same scene left without a checkpoint.
    fn refuse(&self, scene: &Scene) -> Result<()> {
        // a run that was killed before it wrote its scene may have copied files
        let (there, kept) = (Traces::of(&self.path)?.besides(&self.files), self.path.join(SCENE));
        if self.overwrite || (there.none() && !kept.exists()) {
            return Ok(());
        }
        let state = |what: &str| {
            let files = there.words();
            let files = if files.is_empty() { files } else { format!(": {files}") };
            format!("{what}{files}; choose another folder")
        };
        let refuse = |what: &str, offer: Offer| Err(self.refusal(state(what)).offering(offer));
        if !kept.exists() {
            return refuse(&format!("holds files of no run that is known (it has no {SCENE})"), Offer::Overwrite);
        }
        if self.scene_file.as_ref().is_some_and(|file| same_place(&kept, file)) {
            return refuse("holds the scene itself, which the run would overwrite", Offer::Overwrite);
        }
        if let Err(error) = Scene::read(&kept, &[]).and_then(|there| scene.same_run(&there, "the run in this folder")) {
            let cause = Some(Box::new(Refusal::from(error)));
            return Err(Refusal { cause, ..self.refusal(state("holds another run ({cause})")) }.offering(Offer::Overwrite));
        }
        let resume = Offer::ResumeOrOverwrite(self.path.clone());
        match (there.has(SUMMARY), there.has(CHECKPOINT)) {
            (false, true) => refuse("holds a run that has not ended", resume),
            (true, true) => refuse("holds this run, finished", resume),
            (true, false) => refuse("holds this run, finished", Offer::Overwrite),
            (false, false) => Ok(()),
        }
    }
}

/// The scene of a folder's run, with what a resumed run may change.
fn read_scene(folder: &Path, overrides: &[String]) -> Result<Scene> {
    let path = scene_file(folder, || Offer::RepeatSweep)?;
    Scene::resumable_overrides(overrides)?;
    let scene = Scene::read(&path, overrides)?;
    if scene.time.is_none() {
        return Err(Error::refused(format!("{}: holds no run in time; only these are resumed", folder.display())));
    }
    Ok(scene)
}

fn same_place(one: &Path, two: &Path) -> bool {
    matches!((one.canonicalize(), two.canonicalize()), (Ok(one), Ok(two)) if one == two)
}
