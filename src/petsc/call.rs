//! Calls of PETSc functions and callbacks from them: how errors cross C.

use std::{
    cell::RefCell,
    ffi::{CStr, c_char, c_int, c_void},
    ptr::null_mut,
};

use super::ffi;
use crate::error::{Error, Result};

/// Calls a PETSc function and turns its error code into an [`Error`] that carries the call's name.
macro_rules! petsc {
    ($function:ident($($argument:expr),* $(,)?)) => {
        $crate::petsc::call::check(stringify!($function), unsafe { $crate::petsc::ffi::$function($($argument),*) })
    };
}
pub(super) use petsc;

/// Width of PETSc's indices, as the build found them.
pub const INDEX_BITS: u32 = ffi::PetscInt::BITS;

/// Lets PETSc find a size that follows from others.
pub(super) const DETERMINE: ffi::PetscInt = ffi::PETSC_DETERMINE as ffi::PetscInt;

/// Lets PETSc choose a number.
pub(super) const DEFAULT: ffi::PetscInt = ffi::PETSC_DEFAULT as ffi::PetscInt;

/// PETSc's index, 32 or 64 bits wide.
pub type PetscIndex = ffi::PetscInt;

/// A size as PETSc's index, which is narrower in most builds: what is beyond it is refused before a grid is made.
pub fn index(size: usize) -> PetscIndex {
    ffi::PetscInt::try_from(size).expect("sizes are checked against PETSc's indices before a grid is made")
}

thread_local! {
    /// What PETSc said about the error under way, innermost first.
    static TEXT: RefCell<String> = const { RefCell::new(String::new()) };
    /// The error of a callback, which crossed C as a mere code.
    static CALLBACK_ERROR: RefCell<Option<Error>> = const { RefCell::new(None) };
}

/// Keeps what PETSc says about an error for the call that returns it.
pub(super) extern "C" fn remember(
    _: ffi::MPI_Comm,
    _: c_int,
    _: *const c_char,
    _: *const c_char,
    code: ffi::PetscErrorCode,
    kind: ffi::PetscErrorType,
    message: *const c_char,
    _: *mut c_void,
) -> ffi::PetscErrorCode {
    if kind == ffi::PetscErrorType_PETSC_ERROR_INITIAL && !message.is_null() {
        let message = unsafe { CStr::from_ptr(message) }.to_string_lossy().trim().replace('\n', " ");
        TEXT.set(message);
    }
    code
}

/// Turns a code into a result; an error raised inside a callback comes out as itself.
pub(super) fn check(call: &'static str, code: ffi::PetscErrorCode) -> Result<()> {
    if code == 0 {
        return Ok(());
    }
    if let Some(error) = CALLBACK_ERROR.take() {
        return Err(error);
    }
    let mut text = TEXT.take();
    if text.is_empty() {
        text = generic_text(code);
    }
    Err(Error::Petsc { call, code, text })
}

fn generic_text(code: ffi::PetscErrorCode) -> String {
    let mut text = std::ptr::null();
    unsafe { ffi::PetscErrorMessage(code, &mut text, null_mut()) };
    if text.is_null() { "no message".into() } else { unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned() }
}

/// Runs the body of a callback: errors and panics are kept aside and cross C as a code.
pub(super) fn guard(body: impl FnOnce() -> Result<()>) -> ffi::PetscErrorCode {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(body)) {
        Ok(Ok(())) => 0,
        Ok(Err(error)) => {
            CALLBACK_ERROR.set(Some(error));
            ffi::PETSC_ERR_USER as ffi::PetscErrorCode
        }
        // the panic hook has stopped all ranks; under a test harness without it, unwinding into C is not allowed
        Err(_) => std::process::abort(),
    }
}
