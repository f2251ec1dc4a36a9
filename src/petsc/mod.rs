//! A small safe layer over PETSc: the only room with unsafe code.
//!
//! One macro wraps a call and checks its code, one owner destroys any object, and every object keeps the session
//! alive so that `PetscFinalize` comes last. **Every function here is collective unless its name says `local`, and so
//! is every drop**: no object of this module may live on some ranks only.

mod amg;
mod call;
mod direct;
#[doc(hidden)]
pub mod ffi;
mod heap;
mod krylov;
mod matrix;
mod object_counts;
mod options;
mod owned;
mod preconditioner;
mod profile;
mod scatter;
mod session;
mod shell;
mod sparse_solver;
mod traffic;
mod vector;

pub use amg::{Amg, AmgSettings};
pub use call::{INDEX_BITS, PetscIndex, index};
pub use direct::Direct;
pub use heap::local_heap_bytes;
pub use krylov::{Krylov, KrylovMethod, KrylovSettings, Report};
pub use matrix::{Matrix, RowBuilder};
pub use object_counts::{Class, ObjectCounts};
pub use options::{names_option, unused_options};
pub use preconditioner::{Preconditioner, PreconditionerKind};
pub use profile::{Profile, Stage, StageCounts, StageGuard, enter};
pub use scatter::{Scatter, WantedRun};
pub use session::Session;
pub use shell::System;
pub use sparse_solver::{SparseMethod, SparseSolver};
pub use traffic::Traffic;
pub use vector::{LocalRead, Vector};

use call::{DEFAULT, DETERMINE, petsc};
