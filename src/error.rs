//! The one error type: what went wrong, sorted by what the user can do about it.

use std::path::PathBuf;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Everything that can stop a run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene, the command line or the rank count cannot be used; the message names key, value and remedy.
    #[error("{0}")]
    Refused(String),
    /// A solver did not reach its tolerance; the message says how far it came and what to change.
    #[error("{0}")]
    Diverged(String),
    /// A PETSc call failed.
    #[error("{call} failed with PETSc error {code}: {text}")]
    Petsc {
        /// Name of the C function.
        call: &'static str,
        /// PETSc's error code.
        code: i32,
        /// PETSc's own text.
        text: String,
    },
    /// Bodies in contact could not be kept apart.
    #[error("{text}")]
    Contact {
        /// How many bodies and contacts, what failed, and what to try.
        text: String,
        /// The bodies and contacts as JSON, to solve the same problem again.
        island: String,
    },
    /// Another rank failed.
    #[error("rank {rank}: {text}")]
    Elsewhere {
        /// The rank that failed first.
        rank: usize,
        /// Its message.
        text: String,
    },
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl Error {
    /// Exit code of the program: 2 for input or files that cannot be used, 1 for anything else.
    pub fn exit_code(&self) -> i32 {
        match self {
            Error::Refused(_) | Error::File { .. } => 2,
            _ => 1,
        }
    }
}
