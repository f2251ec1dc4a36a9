//! The program: reads the command line, starts MPI and PETSc, and turns errors into exit codes.

use clap::{CommandFactory, Parser, error::ErrorKind};
use turbid::{
    cli::{Arguments, check_options, execute, execute_alone, join_lists, message, unknown_command},
    error::{Error, Result},
    output::note,
    parallel::{abort_on_panic, end_together, first_of_launched},
    petsc::{Session, unused_options},
};

fn main() {
    let arguments = Arguments::try_parse_from(join_lists(std::env::args_os())).unwrap_or_else(|error| end_together(misused(&error)));
    let alone = check_options(&arguments.petsc).map_or_else(|error| Some(Err(error)), |()| execute_alone(&arguments));
    match alone {
        Some(outcome) => end_together(finish_alone(outcome)),
        None => std::process::exit(on_all_ranks(&arguments)),
    }
}

/// Tells what is wrong with the command line, or the help that it asks for, and returns the exit code.
fn misused(error: &clap::Error) -> i32 {
    if !first_of_launched() {
        return error.exit_code();
    }
    if let Some(word) = no_command(error) {
        return finish_alone(Err(unknown_command(&Arguments::command(), &word)));
    }
    // clap prints help to the standard output and errors to the standard error
    if let Err(failure) = error.print().as_ref().map_err(std::io::Error::kind)
        && failure != std::io::ErrorKind::BrokenPipe
    {
        return finish_alone(Err(Error::File { path: "standard output".into(), source: failure.into() }));
    }
    let program = Arguments::command();
    let shown = program.get_subcommands().filter(|command| !command.is_hide_set());
    let names: Vec<&str> = shown.map(clap::Command::get_name).collect();
    if error.use_stderr() && std::env::args().nth(1).is_none_or(|word| !names.contains(&word.as_str())) {
        note(&format!("commands: {}", names.join(", ")));
    }
    error.exit_code()
}

/// The first word of the command line, where it is what is wrong and no flag: clap takes it for one of the words that stand after `--`.
fn no_command(error: &clap::Error) -> Option<String> {
    let word = std::env::args().nth(1).filter(|word| !word.starts_with('-'))?;
    let mut program = Arguments::command();
    // with the command `help`, which clap adds
    program.build();
    let wrong = matches!(error.kind(), ErrorKind::UnknownArgument | ErrorKind::InvalidSubcommand);
    (wrong && program.find_subcommand(&word).is_none()).then_some(word)
}

fn on_all_ranks(arguments: &Arguments) -> i32 {
    abort_on_panic();
    match Session::start(&arguments.petsc) {
        Ok(session) => {
            let code = finish(&session, execute(arguments, &session));
            if code == 0 {
                warn_of_unused(&session, &arguments.petsc);
            }
            code
        }
        Err(error) => {
            complain(&message(&error));
            error.exit_code()
        }
    }
}

/// Says which words after `--` PETSc had no use for: a misspelt option changes nothing.
fn warn_of_unused(session: &Session, words: &[String]) {
    let unused = unused_options(session, words).unwrap_or_default();
    if session.world().rank() == 0 && !unused.is_empty() {
        complain(&format!("warning: PETSc had no use for {}: check the spelling, or whether this run needs it", unused.join(", ")));
    }
}

fn finish_alone(outcome: Result<()>) -> i32 {
    let Err(error) = outcome else { return 0 };
    if first_of_launched() {
        complain(&message(&error));
    }
    error.exit_code()
}

fn finish(session: &Session, outcome: Result<()>) -> i32 {
    let Err(error) = outcome else { return 0 };
    let world = session.world();
    if let Error::Petsc { .. } = error {
        // others may be waiting for this rank
        complain(&format!("rank {}: {error}", world.rank()));
        world.abort(1);
    }
    if world.rank() == 0 {
        complain(&message(&error));
    }
    error.exit_code()
}

fn complain(text: &str) {
    note(&format!("turbid: {text}"));
}
