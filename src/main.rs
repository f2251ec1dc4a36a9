//! The program: reads the command line, starts MPI and PETSc, and turns errors into exit codes.

use clap::Parser;
use turbid::{
    cli::{Arguments, execute, execute_alone},
    error::{Error, Result},
    parallel::abort_on_panic,
    petsc::{Session, check_options, unused_options},
};

fn main() {
    let arguments = arguments();
    let alone = check_options(&arguments.petsc).map_or_else(|error| Some(Err(error)), |()| execute_alone(&arguments));
    std::process::exit(match alone {
        Some(outcome) => finish_alone(outcome),
        None => on_all_ranks(&arguments),
    });
}

/// The command line; a wrong one is told by one rank and ends with code 2.
fn arguments() -> Arguments {
    Arguments::try_parse().unwrap_or_else(|error| {
        if speaker() {
            // clap prints help to the standard output and errors to the standard error
            let _ = error.print();
        }
        std::process::exit(error.exit_code())
    })
}

/// Whether this process speaks for all ranks before MPI is there to tell.
fn speaker() -> bool {
    std::env::var("OMPI_COMM_WORLD_RANK").map_or(true, |rank| rank == "0")
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
            complain(&error.to_string());
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
    if speaker() {
        complain(&error.to_string());
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
        complain(&error.to_string());
    }
    error.exit_code()
}

#[allow(clippy::print_stderr)]
fn complain(text: &str) {
    eprintln!("turbid: {text}");
}
