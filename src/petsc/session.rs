//! The life of MPI and PETSc: started once, finalised after the last object is gone.

use std::{
    ffi::{CString, c_char, c_int},
    ptr::null_mut,
    rc::Rc,
};

use mpi::{topology::SimpleCommunicator, traits::Communicator};

use super::{call::remember, ffi, petsc, traffic::TRAFFIC_LOG};
use crate::{
    error::{Error, Result},
    parallel::World,
};

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
        petsc!(PetscInitialized(&mut running))?;
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
        let inner = Inner { world: World::new(communicator, TRAFFIC_LOG), _universe: universe };
        // the ranks that PETSc takes for all there are; it reads this as it starts
        unsafe { ffi::PETSC_COMM_WORLD = inner.world.raw() };
        petsc!(PetscInitialize(count, list, null_mut(), null_mut()))?;
        petsc!(PetscPushErrorHandler(Some(remember), null_mut()))?;
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
        let _ = petsc!(PetscFinalize());
    }
}
