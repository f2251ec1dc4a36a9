//! The command line: words become calls.

mod animate;
mod cost;
mod lubrication;
mod petsc_options;
mod plan;
mod scene;
mod simulate;
mod studies;
mod viscosity;
mod words;

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use crate::{
    error::{Error, Result},
    petsc::Session,
    run::check_memory_of_plan,
    study::{self, ConditioningOptions},
};
pub use petsc_options::check_options;
use scene::SceneArguments;
use studies::ScalingArguments;
pub use words::told;

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
    Run(simulate::RunArguments),
    /// Go on with a run in time from its last checkpoint.
    Resume(simulate::ResumeArguments),
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
    /// Seconds, shares and traffic of a scene on several numbers of ranks, with a model of more; starts the ranks itself.
    Scaling {
        #[command(flatten)]
        scene: SceneArguments,
        #[command(flatten)]
        scaling: ScalingArguments,
    },
    /// Error against seconds on a scene: every method on grids from coarse to fine, and the cheapest setting for a wanted error.
    Cost {
        #[command(flatten)]
        scene: SceneArguments,
        #[command(flatten)]
        cost: Box<cost::CostArguments>,
    },
    /// What two near bodies, or a body and a wall, resist, what modes see of it, and what lubrication adds.
    Lubrication(lubrication::LubricationArguments),
    /// Run scenes with each inverse of the fluid that suits them and print what each costs.
    Inverses(studies::InverseArguments),
    /// Viscosity against fraction in 2D and 3D with error bars beside published laws, and against strain; starts its own runs.
    Viscosity(viscosity::ViscosityArguments),
    /// Solve cases with known answers and print a table of errors and seconds.
    Validation {
        /// Solve scenes with known answers to these accuracies instead, and print their error bars beside the true errors.
        #[arg(long, value_delimiter = ',', num_args = 0.., default_missing_value = "1e-2", value_name = "ACCURACY")]
        bars: Vec<f64>,
        /// With --bars: so many scenes drawn at random, with answers from fine grids, in place of those with known ones.
        #[arg(long, requires = "bars", value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..=10_000))]
        random: Option<u64>,
        /// Seed of the first of them.
        #[arg(long, default_value_t = 1, requires = "random", value_parser = clap::value_parser!(u64).range(..=1_000_000))]
        seed: u64,
        /// Solve crowds with many films instead, known ones and such as show how the cost grows with number, fraction and gap.
        #[arg(long, conflicts_with = "bars")]
        crowds: bool,
    },
    /// Condition numbers, iterations, seconds and memory of the linear systems against the grid, and what theory predicts.
    Conditioning {
        /// Finest grid in 2D, in cells per side.
        #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=8192))]
        finest_2d: u32,
        /// Finest grid in 3D, in cells per side.
        #[arg(long, default_value_t = 96, value_parser = clap::value_parser!(u32).range(8..=512))]
        finest_3d: u32,
        /// Folder for conditioning.csv, conditioning.json and the charts (default: none is written).
        #[arg(long)]
        out: Option<PathBuf>,
    },
}

/// Carries out a command that starts ranks of its own and must not be one of them; nothing if it is another command.
pub fn execute_alone(arguments: &Arguments) -> Option<Result<()>> {
    match &arguments.command {
        Command::Scaling { scene, scaling } => Some(studies::scaling((&scene.scene, &scene.overrides), scaling, &arguments.petsc)),
        Command::Cost { scene, cost } => Some(cost::cost((&scene.scene, &scene.overrides), cost, &arguments.petsc)),
        Command::Inverses(inverses) => Some(studies::inverses(inverses, &arguments.petsc)),
        Command::Viscosity(options) => Some(viscosity::viscosity(options, &arguments.petsc)),
        _ => None,
    }
}

/// Carries out a command on all ranks.
pub fn execute(arguments: &Arguments, session: &Session) -> Result<()> {
    match &arguments.command {
        Command::Run(arguments) => simulate::run(session, arguments),
        Command::Resume(arguments) => simulate::resume(session, arguments),
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
            check_memory_of_plan(session.world(), &scene)?;
            let folder = simulate::output_folder(out, &scene);
            let outcome = match scene.dimension() {
                2 => plan::plan::<2>(session, &scene, &folder),
                _ => plan::plan::<3>(session, &scene, &folder),
            };
            outcome.map_err(|error| scene.place(error))
        }
        Command::Lubrication(arguments) => session.world().agree(lubrication::lubrication(session.world(), arguments)),
        Command::Scaling { .. } | Command::Cost { .. } | Command::Inverses(_) | Command::Viscosity(_) => Err(studies::ranks_refused()),
        Command::Validation { crowds: true, .. } => study::crowds(session),
        Command::Validation { bars, .. } if bars.is_empty() => match study::validation(session)? {
            true => Ok(()),
            false => Err(Error::Diverged("a case is further from its reference than promised".into())),
        },
        Command::Validation { bars, random, seed, .. } => match study::bars(session, bars, random.map(|count| *seed..*seed + count))? {
            true => Ok(()),
            false => Err(Error::Diverged("more than one error bar in twelve does not hold the true error".into())),
        },
        Command::Conditioning { finest_2d, finest_3d, out } => {
            let (finest_2d, finest_3d) = (*finest_2d as usize, *finest_3d as usize);
            study::conditioning(session, &ConditioningOptions { finest_2d, finest_3d, out: out.clone() })
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn parsed(line: &str) -> Arguments {
        Arguments::try_parse_from(line.split_whitespace()).unwrap_or_else(|error| panic!("{line}: {error}"))
    }

    #[test]
    fn the_words_of_a_run_are_its_arguments() {
        let Arguments { command, petsc } = parsed("turbid run a/b.toml --set seed=2 --set time.end=3 --out o --force -- -log_view");
        let Command::Run(run) = command else { panic!("{command:?}") };
        assert_eq!((run.scene.scene, run.scene.overrides), ("a/b.toml".into(), vec!["seed=2".to_owned(), "time.end=3".to_owned()]));
        assert_eq!((run.out, run.force, run.profile), (Some("o".into()), true, false));
        assert_eq!(petsc, ["-log_view"]);
        let Command::Resume(resume) = parsed("turbid resume o --set time.end=3 --profile").command else { panic!("no resume") };
        assert_eq!((resume.folder, resume.overrides.len(), resume.profile), ("o".into(), 1, true));
    }

    #[test]
    fn a_run_goes_where_it_is_told_or_into_a_folder_of_its_name() {
        let scene = Scene::new("disks", &[1.0, 1.0]);
        assert_eq!(simulate::output_folder(&None, &scene), PathBuf::from("out/disks"));
        assert_eq!(simulate::output_folder(&Some("o".into()), &scene), PathBuf::from("o"));
    }

    #[test]
    fn every_command_is_carried_out_at_the_right_place() {
        let absent = "/nowhere/scene.toml";
        let alone = [format!("scaling {absent}"), format!("cost {absent}"), format!("inverses {absent}")];
        for words in alone {
            let outcome = execute_alone(&parsed(&format!("turbid {words}"))).unwrap_or_else(|| panic!("{words} takes a session"));
            assert!(matches!(outcome, Err(Error::File { .. })), "{words}: {outcome:?}");
        }
        let on_ranks = ["run a.toml", "resume o", "animate o", "plan a.toml", "lubrication", "validation", "conditioning"];
        for words in on_ranks {
            assert!(execute_alone(&parsed(&format!("turbid {words}"))).is_none(), "{words} takes no session");
        }
    }

    #[test]
    fn words_that_mean_nothing_are_refused() {
        let wrong = [
            "turbid",
            "turbid fly",
            "turbid run",
            "turbid run a.toml b.toml",
            "turbid run a.toml --colour",
            "turbid resume",
            "turbid animate o --width 1",
            "turbid lubrication --dimension 4",
            "turbid validation --random 3",
            "turbid validation --crowds --bars 1e-2",
            "turbid conditioning --finest-2d 8",
            "turbid cost a.toml --resolutions 4 --spacings 0.1",
            "turbid cost a.toml --error 0",
        ];
        for line in wrong {
            assert!(Arguments::try_parse_from(line.split_whitespace()).is_err(), "{line}");
        }
    }
}
