//! How runs of an experiment are started.

use crate::study::command::PetscOptions;

/// How runs are started.
pub struct Start<'a> {
    /// The command line of the launcher, in which `{ranks}` stands for the number of ranks.
    pub launcher: &'a str,
    /// Options for PETSc.
    pub petsc: &'a PetscOptions,
    /// Ranks of each run.
    pub ranks: usize,
}
