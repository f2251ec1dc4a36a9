//! The command line: words become calls.

mod animate;
mod lubrication;
mod memory;
mod plan;
mod run;

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use crate::{
    error::Result,
    petsc::Session,
    scene::Scene,
    study::{SceneArguments, SelectedStudy},
};

/// Particles in viscous flow, particle by particle. Run it as it is, or under `mpirun -n N`.
#[derive(Debug, Parser)]
#[command(name = "turbid", version, about)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    command: Command,
    /// Options for PETSc, after `--` (for example `-- -coupled_ksp_monitor`).
    #[arg(last = true, global = true)]
    pub petsc: Vec<String>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulate a scene, at an instant or in time; writes summary.json, scene.toml, pictures, series and frames into the output folder.
    Run {
        #[command(flatten)]
        scene: SceneArguments,
        /// Output folder (default: out/NAME of the scene).
        #[arg(long)]
        out: Option<PathBuf>,
        /// Overwrite what another run has left in the output folder, and run even if it takes more memory than is free.
        #[arg(long)]
        force: bool,
        /// Print at the end what each stage took.
        #[arg(long)]
        profile: bool,
    },
    /// Go on with a run in time from its last checkpoint.
    Resume {
        /// Output folder of the run.
        folder: PathBuf,
        /// Override time.end or a key of output: --set time.end=20
        #[arg(long = "set", value_name = "KEY=VALUE")]
        overrides: Vec<String>,
        /// Print at the end what each stage took.
        #[arg(long)]
        profile: bool,
    },
    /// Draw the frames of a run in time as an animation (APNG).
    Animate {
        /// Output folder of the run.
        folder: PathBuf,
        /// File to write (default: animation.png in the folder).
        #[arg(long)]
        out: Option<PathBuf>,
        /// Width of the picture in pixels.
        #[arg(long, default_value_t = 640, value_parser = clap::value_parser!(u32).range(100..=4000))]
        width: u32,
        /// Length of the film in seconds.
        #[arg(long, default_value_t = 6.0)]
        seconds: f64,
    },
    /// Say what a run would build, with unknowns, memory and seconds; solve no more than a sample.
    Plan {
        #[command(flatten)]
        scene: SceneArguments,
        /// Output folder of the run, where a calibrated resolution is kept (default: out/NAME of the scene).
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// What two near bodies, or a body and a wall, resist, what modes see of it, and what lubrication adds.
    Lubrication(lubrication::LubricationArguments),
    #[command(flatten)]
    Study(SelectedStudy),
}

/// Carries out a command that starts ranks of its own and must not be one of them; nothing if it is another command.
pub fn execute_alone(arguments: &Arguments) -> Option<Result<()>> {
    if let Command::Study(study) = &arguments.command { study.run_alone(&arguments.petsc) } else { None }
}

/// Carries out a command on all ranks.
pub fn execute(arguments: &Arguments, session: &Session) -> Result<()> {
    match &arguments.command {
        Command::Run { scene: arguments, out, force, profile } => run::profiled(session, *profile, || {
            let scene = arguments.read(session)?;
            if !force {
                memory::check(session.world(), &scene)?;
            }
            let mut folder = run::RunFolder::to_begin(session.world(), &folder(out, &scene), (&scene, &arguments.scene), *force)?;
            let outcome = match scene.dimension() {
                2 => run::run::<2>(session, &scene, &mut folder),
                _ => run::run::<3>(session, &scene, &mut folder),
            };
            outcome.map_err(|error| scene.place(error))
        }),
        Command::Resume { folder, overrides, profile } => run::profiled(session, *profile, || {
            let mut folder = run::RunFolder::to_resume(session.world(), folder)?;
            let (scene, checkpoint) = folder.read(overrides)?;
            let outcome = match scene.dimension() {
                2 => run::resume::<2>(session, &scene, &mut folder, &checkpoint),
                _ => run::resume::<3>(session, &scene, &mut folder, &checkpoint),
            };
            outcome.map_err(|error| scene.place(error))
        }),
        Command::Animate { folder, out, width, seconds } => {
            let film = animate::Film {
                folder,
                out: out.clone().unwrap_or_else(|| folder.join("animation.png")),
                width: *width,
                seconds: *seconds,
            };
            animate::animate(session, &film)
        }
        Command::Plan { scene, out } => {
            let scene = scene.read(session)?;
            memory::check_plan(session.world(), &scene)?;
            let folder = folder(out, &scene);
            let outcome = match scene.dimension() {
                2 => plan::plan::<2>(session, &scene, &folder),
                _ => plan::plan::<3>(session, &scene, &folder),
            };
            outcome.map_err(|error| scene.place(error))
        }
        Command::Lubrication(arguments) => session.world().agree(lubrication::lubrication(session.world(), arguments)),
        Command::Study(study) => study.run_on_ranks(session),
    }
}

/// The output folder that is asked for, or that of the scene's name.
fn folder(out: &Option<PathBuf>, scene: &Scene) -> PathBuf {
    out.clone().unwrap_or_else(|| PathBuf::from("out").join(&scene.name))
}
