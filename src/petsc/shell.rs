//! Operators written in Rust that PETSc's solvers apply.

use std::{ffi::c_void, ptr::null_mut};

use super::{DETERMINE, Session, Vector, call::guard, ffi, owned::Owned, petsc};
use crate::error::Result;

/// A linear system as a Krylov solver sees it.
pub trait System {
    /// `output = A input`; an error ends the solve and comes out of it unchanged.
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()>;

    /// `output = P input`, with `P` a fixed linear map near the inverse of `A`; the identity if there is none.
    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        output.copy_from(input)
    }
}

/// What a callback needs; it lives on the stack of the solve that it serves.
pub(super) struct Context<'a> {
    pub(super) session: Session,
    pub(super) system: &'a mut dyn System,
}

/// Which of the two maps of a system a callback stands for.
type Map = fn(&mut dyn System, &Vector, &mut Vector) -> Result<()>;

impl Context<'_> {
    fn call(&mut self, map: Map, input: ffi::Vec, output: ffi::Vec) -> Result<()> {
        let input = Vector::share(&self.session, input)?;
        let mut output = Vector::share(&self.session, output)?;
        map(self.system, &input, &mut output)
    }
}

/// A shell matrix of `local` rows and columns on this rank, for operators given at each solve.
pub(super) fn shell_matrix(session: &Session, local: ffi::PetscInt) -> Result<Owned<ffi::Mat>> {
    let mut raw = null_mut();
    petsc!(MatCreateShell(session.communicator(), local, local, DETERMINE, DETERMINE, null_mut(), &mut raw))?;
    let owned = Owned::new(session, raw);
    type Erased = unsafe extern "C" fn();
    let multiply: extern "C" fn(ffi::Mat, ffi::Vec, ffi::Vec) -> ffi::PetscErrorCode = apply_matrix;
    // PETSc stores every operation as a function without arguments
    let multiply = unsafe { std::mem::transmute::<*const (), Erased>(multiply as *const ()) };
    petsc!(MatShellSetOperation(raw, ffi::MatOperation_MATOP_MULT, Some(multiply)))?;
    Ok(owned)
}

extern "C" fn apply_matrix(matrix: ffi::Mat, input: ffi::Vec, output: ffi::Vec) -> ffi::PetscErrorCode {
    guard(|| {
        let mut context: *mut c_void = null_mut();
        petsc!(MatShellGetContext(matrix, (&raw mut context).cast()))?;
        unsafe { &mut *context.cast::<Context>() }.call(|system, x, y| system.apply(x, y), input, output)
    })
}

pub(super) extern "C" fn apply_preconditioner(pc: ffi::PC, input: ffi::Vec, output: ffi::Vec) -> ffi::PetscErrorCode {
    guard(|| {
        let mut context: *mut c_void = null_mut();
        petsc!(PCShellGetContext(pc, (&raw mut context).cast()))?;
        unsafe { &mut *context.cast::<Context>() }.call(|system, x, y| system.precondition(x, y), input, output)
    })
}
