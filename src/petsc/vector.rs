//! Distributed vectors.

use std::{
    ops::{Deref, DerefMut, Range},
    ptr::null_mut,
};

use super::{DETERMINE, Session, ffi, index, owned::Owned, petsc};
use crate::error::Result;

/// A vector whose entries are spread over the ranks, each with a contiguous part.
pub struct Vector {
    owned: Owned<ffi::Vec>,
}

impl Vector {
    /// A vector of zeros with `local` entries on this rank.
    pub fn new(session: &Session, local: usize) -> Result<Vector> {
        let mut raw = null_mut();
        petsc!(VecCreateMPI(session.communicator(), index(local), DETERMINE, &mut raw))?;
        let vector = Vector { owned: Owned::new(session, raw) };
        petsc!(VecSet(raw, 0.0))?;
        Ok(vector)
    }

    /// A vector of zeros that lives on this rank alone (made on every rank, lengths may differ).
    pub(super) fn new_local(session: &Session, length: usize) -> Result<Vector> {
        let mut raw = null_mut();
        petsc!(VecCreateSeq(session.world().raw_self(), index(length), &mut raw))?;
        let vector = Vector { owned: Owned::new(session, raw) };
        petsc!(VecSet(raw, 0.0))?;
        Ok(vector)
    }

    pub(super) fn share(session: &Session, raw: ffi::Vec) -> Result<Vector> {
        Ok(Vector { owned: Owned::share(session, raw)? })
    }

    pub(super) fn raw(&self) -> ffi::Vec {
        self.owned.raw()
    }

    /// The session it belongs to.
    pub fn session(&self) -> &Session {
        self.owned.session()
    }

    /// A vector of zeros of the same shape.
    pub fn like(&self) -> Result<Vector> {
        let mut raw = null_mut();
        petsc!(VecDuplicate(self.raw(), &mut raw))?;
        let vector = Vector { owned: Owned::new(self.session(), raw) };
        petsc!(VecSet(raw, 0.0))?;
        Ok(vector)
    }

    /// A copy.
    pub fn copied(&self) -> Result<Vector> {
        let mut raw = null_mut();
        petsc!(VecDuplicate(self.raw(), &mut raw))?;
        let copy = Vector { owned: Owned::new(self.session(), raw) };
        petsc!(VecCopy(self.raw(), raw))?;
        Ok(copy)
    }

    /// This rank's entries, to read.
    pub fn local(&self) -> Result<LocalRead<'_>> {
        let (mut array, mut length) = (std::ptr::null(), 0);
        petsc!(VecGetLocalSize(self.raw(), &mut length))?;
        petsc!(VecGetArrayRead(self.raw(), &mut array))?;
        Ok(LocalRead { vector: self, array, length: length as usize })
    }

    /// This rank's entries, to change.
    pub fn local_mut(&mut self) -> Result<LocalWrite<'_>> {
        let (mut array, mut length) = (null_mut(), 0);
        petsc!(VecGetLocalSize(self.raw(), &mut length))?;
        petsc!(VecGetArray(self.raw(), &mut array))?;
        Ok(LocalWrite { vector: self, array, length: length as usize })
    }

    /// The numbers, on all ranks, of this rank's entries.
    pub fn range(&self) -> Result<Range<usize>> {
        let (mut start, mut end) = (0, 0);
        petsc!(VecGetOwnershipRange(self.raw(), &mut start, &mut end))?;
        Ok(start as usize..end as usize)
    }

    /// Sets every entry.
    pub fn fill(&mut self, value: f64) -> Result<()> {
        petsc!(VecSet(self.raw(), value))
    }

    /// Copies the entries of a vector of the same shape.
    pub fn copy_from(&mut self, other: &Vector) -> Result<()> {
        petsc!(VecCopy(other.raw(), self.raw()))
    }

    /// `self += factor * other`.
    pub fn add(&mut self, factor: f64, other: &Vector) -> Result<()> {
        petsc!(VecAXPY(self.raw(), factor, other.raw()))
    }

    /// `self *= factor`.
    pub fn scale(&mut self, factor: f64) -> Result<()> {
        petsc!(VecScale(self.raw(), factor))
    }

    /// Scalar product.
    pub fn dot(&self, other: &Vector) -> Result<f64> {
        let mut value = 0.0;
        petsc!(VecDot(self.raw(), other.raw(), &mut value))?;
        Ok(value)
    }

    /// Euclidean norm.
    pub fn norm(&self) -> Result<f64> {
        let mut value = 0.0;
        petsc!(VecNorm(self.raw(), ffi::NormType_NORM_2, &mut value))?;
        Ok(value)
    }

    /// Sum of all entries over the number of entries.
    pub fn mean(&self) -> Result<f64> {
        let (mut sum, mut size) = (0.0, 0);
        petsc!(VecGetSize(self.raw(), &mut size))?;
        petsc!(VecSum(self.raw(), &mut sum))?;
        Ok(sum / size.max(1) as f64)
    }

    /// Subtracts the mean from every entry.
    pub fn remove_mean(&mut self) -> Result<()> {
        let mean = self.mean()?;
        petsc!(VecShift(self.raw(), -mean))
    }
}

/// This rank's entries of a [`Vector`], borrowed.
pub struct LocalRead<'a> {
    vector: &'a Vector,
    array: *const f64,
    length: usize,
}

impl Deref for LocalRead<'_> {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        if self.length == 0 { &[] } else { unsafe { std::slice::from_raw_parts(self.array, self.length) } }
    }
}

impl Drop for LocalRead<'_> {
    fn drop(&mut self) {
        let _ = petsc!(VecRestoreArrayRead(self.vector.raw(), &mut self.array));
    }
}

/// This rank's entries of a [`Vector`], borrowed to change.
pub struct LocalWrite<'a> {
    vector: &'a mut Vector,
    array: *mut f64,
    length: usize,
}

impl Deref for LocalWrite<'_> {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        if self.length == 0 { &[] } else { unsafe { std::slice::from_raw_parts(self.array, self.length) } }
    }
}

impl DerefMut for LocalWrite<'_> {
    fn deref_mut(&mut self) -> &mut [f64] {
        if self.length == 0 { &mut [] } else { unsafe { std::slice::from_raw_parts_mut(self.array, self.length) } }
    }
}

impl Drop for LocalWrite<'_> {
    fn drop(&mut self) {
        let _ = petsc!(VecRestoreArray(self.vector.raw(), &mut self.array));
    }
}
