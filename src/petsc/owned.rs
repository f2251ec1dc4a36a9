//! The one owner of PETSc objects.

use super::{ObjectCounts, Session, ffi, object_counts::Class, petsc};

/// A PETSc object type and how it is destroyed.
pub(super) trait Object: Copy {
    const CLASS: Class;

    fn destroy(&mut self) -> ffi::PetscErrorCode;
}

macro_rules! object {
    ($($kind:ident, $class:ident => $destroy:ident),*) => { $(
        impl Object for ffi::$kind {
            const CLASS: Class = Class::$class;

            fn destroy(&mut self) -> ffi::PetscErrorCode {
                unsafe { ffi::$destroy(self) }
            }
        }
    )* };
}

object!(
    Vec, Vector => VecDestroy,
    Mat, Matrix => MatDestroy,
    KSP, Solver => KSPDestroy,
    PC, Preconditioner => PCDestroy,
    IS, IndexSet => ISDestroy,
    VecScatter, Scatter => VecScatterDestroy,
    MatNullSpace, NullSpace => MatNullSpaceDestroy
);

/// One reference to a PETSc object, released on drop; keeps the session alive.
pub(super) struct Owned<T: Object> {
    raw: T,
    session: Session,
}

impl<T: Object> Owned<T> {
    pub(super) fn new(session: &Session, raw: T) -> Self {
        ObjectCounts::enter(T::CLASS);
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
        ObjectCounts::leave(T::CLASS);
        // a failed destroy leaves nothing to do but to leak
        let _ = self.raw.destroy();
    }
}
