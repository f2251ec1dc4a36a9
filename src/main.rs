//! The program: reads the command line, starts MPI and PETSc, and turns errors into exit codes.

use clap::Parser;
use turbid::{
    cli::{Arguments, execute, execute_alone},
    error::{Error, Result},
    parallel::abort_on_panic,
    petsc::Session,
};

fn main() {
    let arguments = arguments();
    std::process::exit(match execute_alone(&arguments) {
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
        Ok(session) => finish(&session, execute(arguments, &session)),
        Err(error) => {
            complain(&error.to_string());
            error.exit_code()
        }
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
