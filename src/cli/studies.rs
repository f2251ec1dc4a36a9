//! The studies that the program knows.

use clap::{ArgMatches, Command, FromArgMatches, Subcommand};

use crate::{
    error::Result,
    petsc::Session,
    study::{Conditioning, CostStudy, Inverses, ParameterSweep, PetscOptions, Scaling, StudyCommand, ViscosityStudy},
    validation::{Doctor, Validation},
};

/// All of them; a new study is its file and a line here.
pub fn studies() -> [StudyCommand; 8] {
    [
        StudyCommand::alone::<Scaling>(),
        StudyCommand::alone::<CostStudy>(),
        StudyCommand::alone::<Inverses>(),
        StudyCommand::alone::<ViscosityStudy>(),
        StudyCommand::alone::<ParameterSweep>(),
        StudyCommand::on_ranks::<Validation>(),
        StudyCommand::on_ranks::<Conditioning>(),
        StudyCommand::on_ranks::<Doctor>(),
    ]
}

/// The study that a command line asks for.
#[derive(Debug)]
pub struct SelectedStudy {
    study: StudyCommand,
    matches: ArgMatches,
}

impl SelectedStudy {
    /// Makes it if it starts runs of its own.
    pub fn run_alone(&self, petsc: &PetscOptions) -> Option<Result<()>> {
        self.study.run_alone(&self.matches, petsc)
    }

    /// Makes it on the ranks of this program.
    ///
    /// # Errors
    /// It fails, or is one that starts runs of its own.
    pub fn run_on_ranks(&self, session: &Session) -> Result<()> {
        self.study.run_on_ranks(&self.matches, session)
    }
}

impl FromArgMatches for SelectedStudy {
    fn from_arg_matches(matches: &ArgMatches) -> std::result::Result<SelectedStudy, clap::Error> {
        let missing = || clap::Error::new(clap::error::ErrorKind::MissingSubcommand);
        let (name, matches) = matches.subcommand().ok_or_else(missing)?;
        let study = studies().into_iter().find(|study| study.name == name).ok_or_else(missing)?;
        Ok(SelectedStudy { study, matches: matches.clone() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> std::result::Result<(), clap::Error> {
        *self = SelectedStudy::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Subcommand for SelectedStudy {
    fn augment_subcommands(command: Command) -> Command {
        command.subcommands(studies().iter().map(StudyCommand::command))
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        SelectedStudy::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        studies().iter().any(|study| study.name == name)
    }
}
