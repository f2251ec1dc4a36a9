//! `turbid run` and `turbid resume`: an instantaneous solve, or a simulation in time.

use std::path::{Path, PathBuf};

use crate::{
    error::Result,
    output::{note, say, stage_table},
    petsc::{Profile, Session},
    run::{self, Finished, NewRun, Options, Run, RunFolder},
    scene::Scene,
    study::SceneArguments,
};

/// What the program's runs do: they listen to signals and show how far they have come.
const OPTIONS: Options = Options { signals: true, progress: true };

/// How a run is started.
#[derive(Debug, clap::Args)]
pub struct RunArguments {
    #[command(flatten)]
    pub(super) scene: SceneArguments,
    /// Output folder (default: out/NAME of the scene).
    #[arg(long)]
    pub(super) out: Option<PathBuf>,
    /// Overwrite what another run has left in the output folder, and run even if it takes more memory than is free.
    #[arg(long)]
    pub(super) force: bool,
    /// Print at the end what each stage took.
    #[arg(long)]
    pub(super) profile: bool,
}

/// How a run goes on.
#[derive(Debug, clap::Args)]
pub struct ResumeArguments {
    /// Output folder of the run.
    pub(super) folder: PathBuf,
    /// Override time.end or a key of output: --set time.end=20
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) overrides: Vec<String>,
    /// Print at the end what each stage took.
    #[arg(long)]
    pub(super) profile: bool,
}

/// Runs a scene from its start.
pub fn run(session: &Session, arguments: &RunArguments) -> Result<()> {
    profiled(session, arguments.profile, || {
        let scene = arguments.scene.read(session)?;
        session.world().on_first_rank(|| {
            scene.warning().into_iter().for_each(|warning| note(&format!("turbid: warning: {warning}")));
            Ok(())
        })?;
        if !arguments.force {
            run::check_memory(session.world(), &scene)?;
        }
        let new = NewRun { scene: &scene, scene_file: Some(&arguments.scene.scene), overwrite: arguments.force };
        let folder = Some(RunFolder::to_begin(session.world(), &output_folder(&arguments.out, &scene), new)?);
        let finished = match scene.dimension() {
            2 => run::complete::<2>(session, &scene, folder, OPTIONS),
            _ => run::complete::<3>(session, &scene, folder, OPTIONS),
        };
        tell(session, &scene, finished)
    })
}

/// Goes on with a run.
pub fn resume(session: &Session, arguments: &ResumeArguments) -> Result<()> {
    profiled(session, arguments.profile, || {
        let mut folder = RunFolder::to_resume(session.world(), &arguments.folder)?;
        let (scene, checkpoint) = folder.read(&arguments.overrides)?;
        let ended = session.world().on_first_rank(|| Ok(folder.ended_local(&scene)))?;
        let finished = match scene.dimension() {
            2 => Run::<2>::resume(session, &scene, folder, &checkpoint, OPTIONS).and_then(Run::complete),
            _ => Run::<3>::resume(session, &scene, folder, &checkpoint, OPTIONS).and_then(Run::complete),
        };
        tell(session, &scene, finished)?;
        if ended {
            note(&format!("turbid: {}", at_its_end(&arguments.folder, &scene)));
        }
        Ok(())
    })
}

/// What is said of a run that is at its end already.
fn at_its_end(folder: &Path, scene: &Scene) -> String {
    let (folder, end) = (folder.display(), scene.end());
    let until = scene.time.as_ref().and_then(|time| time.until).map_or("", |_| " or --set time.until.viscosity_interval=..");
    format!("{folder}: the run is at its end (time.end = {end}); `turbid resume {folder} --set time.end=..`{until} takes it further")
}

/// The output folder that is asked for, or that of the scene's name.
pub fn output_folder(out: &Option<PathBuf>, scene: &Scene) -> PathBuf {
    out.clone().unwrap_or_else(|| Path::new("out").join(&scene.name))
}

fn tell(session: &Session, scene: &Scene, finished: Result<Finished>) -> Result<()> {
    let finished = finished.map_err(|error| scene.place(error))?;
    session.world().on_first_rank(|| say(&finished.text()))
}

/// Does a run, and prints what its stages took if a profile is wanted; collective.
fn profiled(session: &Session, wanted: bool, run: impl FnOnce() -> Result<()>) -> Result<()> {
    if !wanted {
        return run();
    }
    let profile = Profile::start()?;
    run()?;
    let table = stage_table(session.world(), &profile.finish()?);
    session.world().on_first_rank(|| say(&table))
}
