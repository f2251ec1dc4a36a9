//! Operators written in Rust that PETSc's solvers apply.

use std::{ffi::c_void, ptr::null_mut};

use super::{Session, Vector, ffi, owned::Owned, petsc, session::guard};
use crate::error::Result;

/// A linear map on vectors: an operator of a solver, or its preconditioner.
pub trait Operator {
    /// `output = self(input)`; every entry of `output` is set.
    ///
    /// # Errors
    /// Whatever the map meets; it ends the solve and comes out of it unchanged.
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()>;
}

impl Operator for super::Matrix {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.multiply(input, output)
    }
}

/// The identity: "no preconditioner".
pub struct Identity;

impl Operator for Identity {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        output.copy_from(input)
    }
}

/// What a callback needs; it lives on the stack of the solve that it serves.
pub(super) struct Context<'a> {
    pub(super) session: Session,
    pub(super) operator: &'a mut dyn Operator,
}

impl Context<'_> {
    fn apply(&mut self, input: ffi::Vec, output: ffi::Vec) -> Result<()> {
        let input = Vector::share(&self.session, input)?;
        let mut output = Vector::share(&self.session, output)?;
        self.operator.apply(&input, &mut output)
    }
}

/// A shell matrix of `local` rows and columns on this rank, for operators given at each solve.
pub(super) fn shell_matrix(session: &Session, local: i32) -> Result<Owned<ffi::Mat>> {
    let mut raw = null_mut();
    let all = ffi::PETSC_DETERMINE;
    petsc!(MatCreateShell(session.communicator(), local, local, all, all, null_mut(), &mut raw))?;
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
        unsafe { &mut *context.cast::<Context>() }.apply(input, output)
    })
}

pub(super) extern "C" fn apply_preconditioner(pc: ffi::PC, input: ffi::Vec, output: ffi::Vec) -> ffi::PetscErrorCode {
    guard(|| {
        let mut context: *mut c_void = null_mut();
        petsc!(PCShellGetContext(pc, (&raw mut context).cast()))?;
        unsafe { &mut *context.cast::<Context>() }.apply(input, output)
    })
}
