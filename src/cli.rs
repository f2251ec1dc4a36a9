//! The command line: words become calls.

mod animate;
mod columns;
mod commands;
mod examples;
mod keys;
mod lists;
mod lubrication;
mod petsc_options;
mod plan;
mod shell;
mod simulate;
mod studies;
mod view;
mod words;

use std::path::PathBuf;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;

use crate::{error::Result, parallel::first_of_launched, petsc::Session, run::check_memory_of_plan, study::SceneArguments};
pub use commands::unknown_command;
pub use lists::join_lists;
pub use petsc_options::check_options;
use studies::SelectedStudy;
pub use words::message;

/// Particles in viscous flow, particle by particle. Run it as it is, or under `mpirun -n N`.
#[derive(Debug, Parser)]
#[command(name = "turbid", version, long_version = shell::VERSION, about)]
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
    /// Draw the frames of a run in time as an animation (APNG or GIF; MP4 or WebM where ffmpeg is installed).
    Animate {
        /// Output folder of the run.
        folder: PathBuf,
        /// File to write, whose ending tells the format: .png, .gif, .mp4, .webm (default: animation.png in the folder).
        #[arg(long)]
        out: Option<PathBuf>,
        /// Width of the picture in pixels.
        #[arg(long, default_value_t = 640, value_parser = clap::value_parser!(u32).range(100..=4000))]
        width: u32,
        /// Length of the film in seconds.
        #[arg(long, default_value_t = 6.0)]
        seconds: f64,
    },
    /// Make a page that plays the frames of a run in a browser: colours, contacts, flow, histories of bodies (view.html).
    View(view::ViewArguments),
    /// Say what a run would build, with unknowns, memory and seconds; solve no more than a sample.
    Plan {
        #[command(flatten)]
        scene: SceneArguments,
        /// Output folder of the run, where a calibrated resolution is kept (default: out/NAME of the scene).
        #[arg(long)]
        out: Option<PathBuf>,
        /// Ranks that the run is to have, which are not started (default: those of this program).
        #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
        ranks: Option<u32>,
    },
    /// What two near bodies, or a body and a wall, resist, what modes see of it, and what lubrication adds.
    Lubrication(lubrication::LubricationArguments),
    /// List the keys of a scene file, with type, unit, default, range and example.
    Keys(keys::KeysArguments),
    /// List the columns of series.csv, with unit and meaning.
    Columns(columns::ColumnsArguments),
    /// Print a script that completes the words of this command line, for example `turbid completions bash`.
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Print the manual page of the program or of a command.
    #[command(hide = true)]
    Man {
        /// The command.
        command: Option<String>,
    },
    /// List the example scenes, or copy one of them here.
    Examples(examples::ExampleArguments),
    /// Write a scene with comments to begin with.
    New(examples::NewArguments),
    #[command(flatten)]
    Study(SelectedStudy),
}

/// Carries out a command that starts ranks of its own and must not be one of them, or that needs none; nothing if it is another command.
pub fn execute_alone(arguments: &Arguments) -> Option<Result<()>> {
    if let Command::Study(study) = &arguments.command {
        return study.run_alone(&arguments.petsc);
    }
    let answer: Box<dyn Fn() -> Result<()>> = match &arguments.command {
        Command::Keys(arguments) => Box::new(|| keys::keys(arguments)),
        Command::Columns(arguments) => Box::new(|| columns::list(arguments)),
        Command::Completions { shell } => Box::new(|| shell::completions(Arguments::command(), *shell)),
        Command::Man { command } => Box::new(|| shell::manual(Arguments::command(), command.as_deref())),
        Command::Examples(arguments) => Box::new(|| examples::examples(arguments)),
        Command::New(arguments) => Box::new(|| examples::new_scene(arguments)),
        _ => return None,
    };
    Some(if first_of_launched() { answer() } else { Ok(()) })
}

/// Carries out a command on all ranks.
pub fn execute(arguments: &Arguments, session: &Session) -> Result<()> {
    match &arguments.command {
        Command::Run(arguments) => simulate::run(session, arguments),
        Command::Resume(arguments) => simulate::resume(session, arguments),
        Command::Animate { folder, out, width, seconds } => {
            let film = animate::AnimationArguments {
                folder,
                out: out.clone().unwrap_or_else(|| folder.join("animation.png")),
                width: *width,
                seconds: *seconds,
            };
            animate::animate(session, &film)
        }
        Command::View(arguments) => view::view(session, arguments),
        Command::Plan { scene, out, ranks } => {
            let scene = scene.read(session)?;
            check_memory_of_plan(session.world(), &scene)?;
            let ranks = ranks.map(|ranks| ranks as usize);
            let folder = simulate::output_folder(out, &scene);
            let outcome = match scene.dimension() {
                2 => plan::plan::<2>(session, &scene, &folder, ranks),
                _ => plan::plan::<3>(session, &scene, &folder, ranks),
            };
            outcome.map_err(|error| scene.place(error))
        }
        Command::Lubrication(arguments) => session.world().agree(lubrication::lubrication(session.world(), arguments)),
        Command::Study(study) => study.run_on_ranks(session),
        Command::Columns(_)
        | Command::Keys(_)
        | Command::Completions { .. }
        | Command::Man { .. }
        | Command::Examples(_)
        | Command::New(_) => Ok(()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{error::Error, scene::Scene};

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
            let Err(error @ Error::Refused(_)) = outcome else { panic!("{words}: {outcome:?}") };
            let expected =
                "/nowhere/scene.toml: no such file; `turbid new` writes a scene to begin with, `turbid examples` lists others to copy";
            assert_eq!(message(&error), expected, "{words}");
        }
        assert!(matches!(execute_alone(&parsed("turbid keys flow.viscosity")), Some(Ok(()))));
        let on_ranks =
            ["run a.toml", "resume o", "animate o", "view o", "plan a.toml", "lubrication", "validation", "conditioning", "doctor"];
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
            "turbid view o --frames 0",
            "turbid view o --serve 70000",
            "turbid view o --serve 1 --out a.html",
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
