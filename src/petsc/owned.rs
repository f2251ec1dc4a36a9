//! The one owner of PETSc objects.

use super::{Session, ffi, petsc};

/// A PETSc object type and how it is destroyed.
pub(super) trait Object: Copy {
    fn destroy(&mut self) -> ffi::PetscErrorCode;
}

macro_rules! object {
    ($($kind:ident => $destroy:ident),*) => { $(
        impl Object for ffi::$kind {
            fn destroy(&mut self) -> ffi::PetscErrorCode {
                unsafe { ffi::$destroy(self) }
            }
        }
    )* };
}

object!(Vec => VecDestroy, Mat => MatDestroy, KSP => KSPDestroy, PC => PCDestroy, IS => ISDestroy, VecScatter => VecScatterDestroy, MatNullSpace => MatNullSpaceDestroy);

/// One reference to a PETSc object, released on drop; keeps the session alive.
pub(super) struct Owned<T: Object> {
    raw: T,
    session: Session,
}

impl<T: Object> Owned<T> {
    pub(super) fn new(session: &Session, raw: T) -> Self {
        Owned { raw, session: session.clone() }
    }

    pub(super) fn raw(&self) -> T {
        self.raw
    }

    pub(super) fn session(&self) -> &Session {
        &self.session
    }
}

impl Owned<ffi::Vec> {
    /// A further reference to a vector that PETSc hands to a callback.
    pub(super) fn share(session: &Session, raw: ffi::Vec) -> crate::error::Result<Self> {
        petsc!(PetscObjectReference(raw.cast()))?;
        Ok(Owned::new(session, raw))
    }
}

impl<T: Object> Drop for Owned<T> {
    fn drop(&mut self) {
        // a failed destroy leaves nothing to do but to leak
        let _ = self.raw.destroy();
    }
}
