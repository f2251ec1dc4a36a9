//! The life of MPI and PETSc: started once, finalised after the last object is gone.

use std::{
    cell::RefCell,
    ffi::{CStr, CString, c_char, c_int, c_void},
    ptr::null_mut,
    rc::Rc,
};

use mpi::{topology::SimpleCommunicator, traits::Communicator};

use super::{ffi, traffic::count_collective};
use crate::{
    error::{Error, Result},
    parallel::World,
};

thread_local! {
    /// What PETSc said about the error under way, innermost first.
    static TEXT: RefCell<String> = const { RefCell::new(String::new()) };
    /// The error of a callback, which crossed C as a mere code.
    static CALLBACK_ERROR: RefCell<Option<Error>> = const { RefCell::new(None) };
}

/// A running MPI and PETSc; clones share it, and the last one ends what the first has started.
#[derive(Clone)]
pub struct Session {
    inner: Rc<Inner>,
}

struct Inner {
    world: World,
    // dropped last: PETSc is finalised before MPI, if this session has started it
    _universe: Option<mpi::environment::Universe>,
}

impl Session {
    /// Starts MPI and PETSc; `options` are PETSc's own (`-ksp_view`, ...).
    ///
    /// # Errors
    /// MPI is already running, or PETSc does not start.
    pub fn start(options: &[String]) -> Result<Session> {
        let running = || Error::refused("MPI is already running in this process; join it");
        let universe = mpi::initialize().ok_or_else(running)?;
        Session::open(SimpleCommunicator::world(), Some(universe), options)
    }

    /// Starts PETSc on ranks of an MPI that the caller has started, and ends after this session. Collective on the communicator,
    /// of which the session takes a duplicate.
    ///
    /// # Errors
    /// PETSc is already running in this process, or does not start.
    pub fn join(communicator: &impl Communicator, options: &[String]) -> Result<Session> {
        Session::open(communicator.duplicate(), None, options)
    }

    fn open(communicator: SimpleCommunicator, universe: Option<mpi::environment::Universe>, options: &[String]) -> Result<Session> {
        let mut running = ffi::PetscBool_PETSC_FALSE;
        super::petsc!(PetscInitialized(&mut running))?;
        if running == ffi::PetscBool_PETSC_TRUE {
            return Err(Error::refused("PETSc is already running in this process; clone its session"));
        }
        let mut arguments: Vec<*mut c_char> = Vec::new();
        for argument in ["turbid", "-no_signal_handler"].into_iter().chain(options.iter().map(String::as_str)) {
            let argument = CString::new(argument).map_err(|_| Error::refused(format!("option {argument:?} contains a zero byte")))?;
            // PETSc keeps pointers to its arguments until the end
            arguments.push(argument.into_raw());
        }
        arguments.push(null_mut());
        let arguments = Box::leak(arguments.into_boxed_slice());
        let count = Box::leak(Box::new(arguments.len() as c_int - 1));
        let list = Box::leak(Box::new(arguments.as_mut_ptr()));
        let inner = Inner { world: World::new(communicator, count_collective), _universe: universe };
        // the ranks that PETSc takes for all there are; it reads this as it starts
        unsafe { ffi::PETSC_COMM_WORLD = inner.world.raw() };
        super::petsc!(PetscInitialize(count, list, null_mut(), null_mut()))?;
        super::petsc!(PetscPushErrorHandler(Some(remember), null_mut()))?;
        Ok(Session { inner: Rc::new(inner) })
    }

    /// The ranks.
    pub fn world(&self) -> &World {
        &self.inner.world
    }

    pub(super) fn communicator(&self) -> ffi::MPI_Comm {
        self.inner.world.raw()
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        let _ = super::petsc!(PetscFinalize());
    }
}

extern "C" fn remember(
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
