//! Copies chosen entries of a distributed vector to the rank that wants them, and adds them back.

use std::ptr::null_mut;

use super::{Vector, ffi, index, owned::Owned, petsc, vector::LocalRead, vector::LocalWrite};
use crate::error::Result;

/// A fixed list of wanted entries with a local place for each.
pub struct Scatter {
    owned: Owned<ffi::VecScatter>,
    place: Vector,
}

impl Scatter {
    /// Plans the exchange of the entries `wanted` (global indices, any rank's) of vectors shaped like `vector`.
    pub fn new(vector: &Vector, wanted: &[usize]) -> Result<Scatter> {
        let session = vector.session();
        let place = Vector::new_local(session, wanted.len())?;
        let wanted: Vec<ffi::PetscInt> = wanted.iter().map(|&entry| index(entry)).collect();
        let mut set = null_mut();
        let copy = ffi::PetscCopyMode_PETSC_COPY_VALUES;
        petsc!(ISCreateGeneral(session.communicator(), index(wanted.len()), wanted.as_ptr(), copy, &mut set))?;
        let set = Owned::new(session, set);
        let mut raw = null_mut();
        petsc!(VecScatterCreate(vector.raw(), set.raw(), place.raw(), null_mut(), &mut raw))?;
        Ok(Scatter { owned: Owned::new(session, raw), place })
    }

    /// Fetches the wanted entries of `vector`, in the order in which they were asked for.
    pub fn fetch(&mut self, vector: &Vector) -> Result<LocalRead<'_>> {
        self.exchange(vector.raw(), self.place.raw(), ffi::InsertMode_INSERT_VALUES, ffi::ScatterMode_SCATTER_FORWARD)?;
        self.place.local()
    }

    /// The local places, zeroed, to fill before [`add_back`](Self::add_back).
    pub fn places(&mut self) -> Result<LocalWrite<'_>> {
        self.place.fill(0.0)?;
        self.place.local_mut()
    }

    /// Adds the local places to the entries of `vector` they stand for.
    pub fn add_back(&mut self, vector: &mut Vector) -> Result<()> {
        self.exchange(self.place.raw(), vector.raw(), ffi::InsertMode_ADD_VALUES, ffi::ScatterMode_SCATTER_REVERSE)
    }

    fn exchange(&self, from: ffi::Vec, to: ffi::Vec, insert: ffi::InsertMode, direction: ffi::ScatterMode) -> Result<()> {
        petsc!(VecScatterBegin(self.owned.raw(), from, to, insert, direction))?;
        petsc!(VecScatterEnd(self.owned.raw(), from, to, insert, direction))
    }
}
