//! What a study is to the program: a name, its arguments on the command line, and what it does with them.

use clap::{ArgMatches, Command};

pub use crate::experiment::arguments::{PetscOptions, SceneArguments, count, positive};
use crate::{
    error::{Error, Result},
    parallel::launched,
    petsc::Session,
};

/// A study. Its type holds the arguments; it is made on `On`: on the ranks of a [`Session`], or, if it starts runs of its own outside of
/// MPI, with the [`PetscOptions`] of these.
pub trait Study<On: ?Sized>: clap::Args {
    /// The word that calls it.
    const NAME: &'static str;

    /// What it does, in a sentence.
    const ABOUT: &'static str;

    /// Measures, prints and writes what was found.
    ///
    /// # Errors
    /// An argument cannot be used, a solve or a run fails, or a file cannot be written.
    fn run(&self, on: &On) -> Result<()>;
}

/// A study in the list of those that the program knows.
#[derive(Debug, Clone, Copy)]
pub struct StudyCommand {
    /// The word that calls it.
    pub name: &'static str,
    about: &'static str,
    arguments: fn(Command) -> Command,
    run: StudyRun,
}

#[derive(Debug, Clone, Copy)]
enum StudyRun {
    Alone(fn(&ArgMatches, &PetscOptions) -> Result<()>),
    OnRanks(fn(&ArgMatches, &Session) -> Result<()>),
}

impl StudyCommand {
    /// A study that starts runs of its own and must not be one of several ranks.
    pub fn alone<S: Study<PetscOptions>>() -> StudyCommand {
        let run: fn(&ArgMatches, &PetscOptions) -> Result<()> = |matches, petsc| {
            if launched() { Err(ranks_refused()) } else { parsed::<S>(matches)?.run(petsc) }
        };
        StudyCommand { name: S::NAME, about: S::ABOUT, arguments: S::augment_args, run: StudyRun::Alone(run) }
    }

    /// A study on the ranks of this program.
    pub fn on_ranks<S: Study<Session>>() -> StudyCommand {
        let run: fn(&ArgMatches, &Session) -> Result<()> = |matches, session| parsed::<S>(matches)?.run(session);
        StudyCommand { name: S::NAME, about: S::ABOUT, arguments: S::augment_args, run: StudyRun::OnRanks(run) }
    }

    /// The command with its help.
    pub fn command(&self) -> Command {
        (self.arguments)(Command::new(self.name)).about(self.about).long_about(None)
    }

    /// Makes a study that starts runs of its own; nothing if it is another one.
    pub fn run_alone(&self, matches: &ArgMatches, petsc: &PetscOptions) -> Option<Result<()>> {
        if let StudyRun::Alone(run) = self.run { Some(run(matches, petsc)) } else { None }
    }

    /// Makes a study on the ranks of this program.
    ///
    /// # Errors
    /// It fails, or is one that starts runs of its own.
    pub fn run_on_ranks(&self, matches: &ArgMatches, session: &Session) -> Result<()> {
        if let StudyRun::OnRanks(run) = self.run { run(matches, session) } else { Err(ranks_refused()) }
    }
}

fn parsed<S: clap::Args>(matches: &ArgMatches) -> Result<S> {
    S::from_arg_matches(matches).map_err(|error| Error::refused(error.to_string()))
}

/// The refusal to be one of several ranks.
fn ranks_refused() -> Error {
    Error::refused(
        "this study starts its own ranks: call `turbid scaling SCENE --ranks 1,2,4` (or `turbid cost SCENE`, `turbid inverses SCENE..`, `turbid viscosity`) without mpirun; \
         --launcher says how they start",
    )
}

/// A study whose arguments are those of a command line without its name.
#[cfg(test)]
pub fn from_words<S: clap::Args>(words: &[&str]) -> S {
    let matches = S::augment_args(Command::new("study").no_binary_name(true)).get_matches_from(words);
    S::from_arg_matches(&matches).expect("the words are those of the study")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A study whose argument must be even.
    #[derive(clap::Args)]
    struct Toy {
        #[arg(long, default_value_t = 2)]
        number: usize,
    }

    impl Study<PetscOptions> for Toy {
        const NAME: &'static str = "toy";
        const ABOUT: &'static str = "Refuse odd numbers.";

        fn run(&self, petsc: &PetscOptions) -> Result<()> {
            if self.number.is_multiple_of(2) { Ok(()) } else { Err(Error::refused(format!("{} {petsc:?}", self.number))) }
        }
    }

    #[test]
    fn a_study_is_a_type_and_a_line_in_a_list() {
        let studies = [StudyCommand::alone::<Toy>()];
        let run = |words: &[&str]| {
            let matches = Command::new("turbid").subcommands(studies.iter().map(StudyCommand::command)).get_matches_from(words);
            let (name, own) = matches.subcommand().unwrap();
            let study = studies.iter().find(|study| study.name == name).unwrap();
            study.run_alone(own, &["-log_view".to_owned()]).unwrap()
        };
        assert!(run(&["turbid", "toy"]).is_ok());
        assert_eq!(run(&["turbid", "toy", "--number", "3"]).unwrap_err().to_string(), "3 [\"-log_view\"]");
        assert!(studies[0].command().get_about().unwrap().to_string().starts_with("Refuse odd"));
    }
}
