//! Sparse matrices and nests of them.

use std::ptr::{null, null_mut};

use super::{DETERMINE, Session, Vector, ffi, index, owned::Owned, petsc};
use crate::error::Result;

/// A sparse matrix whose rows are spread over the ranks, or a nest of such matrices.
pub struct Matrix {
    owned: Owned<ffi::Mat>,
}

/// Collects this rank's rows, in order, as (global column, value) entries; entries of equal column add up.
#[derive(Default)]
pub struct RowBuilder {
    starts: Vec<ffi::PetscInt>,
    columns: Vec<ffi::PetscInt>,
    values: Vec<f64>,
    row: Vec<(ffi::PetscInt, f64)>,
}

impl RowBuilder {
    /// Adds an entry to the row under way.
    pub fn push(&mut self, column: usize, value: f64) {
        self.row.push((index(column), value));
    }

    /// Ends the row under way.
    pub fn end_row(&mut self) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        self.row.sort_unstable_by_key(|&(column, _)| column);
        let begin = self.columns.len();
        for (column, value) in self.row.drain(..) {
            if self.columns.len() > begin && self.columns.last() == Some(&column) {
                *self.values.last_mut().expect("a column has its value") += value;
            } else {
                self.columns.push(column);
                self.values.push(value);
            }
        }
        self.starts.push(index(self.columns.len()));
    }
}

impl Matrix {
    /// The matrix of the collected rows, with `local_columns` entries of the input vector on this rank.
    pub fn from_rows(session: &Session, local_columns: usize, mut rows: RowBuilder) -> Result<Matrix> {
        if rows.starts.is_empty() {
            rows.starts.push(0);
        }
        let local_rows = index(rows.starts.len() - 1);
        let mut raw = null_mut();
        petsc!(MatCreate(session.communicator(), &mut raw))?;
        let matrix = Matrix { owned: Owned::new(session, raw) };
        petsc!(MatSetSizes(raw, local_rows, index(local_columns), DETERMINE, DETERMINE))?;
        petsc!(MatSetType(raw, c"aij".as_ptr()))?;
        let (starts, columns, values) = (rows.starts.as_ptr(), rows.columns.as_ptr(), rows.values.as_ptr());
        petsc!(MatSeqAIJSetPreallocationCSR(raw, starts, columns, values))?;
        petsc!(MatMPIAIJSetPreallocationCSR(raw, starts, columns, values))?;
        Ok(matrix)
    }

    /// Gives it other values in the same places, row by row in the same order.
    ///
    /// # Errors
    /// A value has no place.
    pub(super) fn replace(&mut self, rows: RowBuilder) -> Result<()> {
        let (mut first, mut past) = (0, 0);
        petsc!(MatGetOwnershipRange(self.raw(), &mut first, &mut past))?;
        for (row, places) in (first..past).zip(rows.starts.windows(2)) {
            let places = places[0] as usize..places[1] as usize;
            let (columns, values) = (&rows.columns[places.clone()], &rows.values[places]);
            let (count, insert) = (index(columns.len()), ffi::InsertMode_INSERT_VALUES);
            petsc!(MatSetValues(self.raw(), 1, &row, count, columns.as_ptr(), values.as_ptr(), insert))?;
        }
        petsc!(MatAssemblyBegin(self.raw(), ffi::MatAssemblyType_MAT_FINAL_ASSEMBLY))?;
        petsc!(MatAssemblyEnd(self.raw(), ffi::MatAssemblyType_MAT_FINAL_ASSEMBLY))
    }

    /// The block matrix `blocks[row][column]` (absent blocks are zero) on vectors whose local parts follow one another.
    pub fn nest(session: &Session, blocks: &[Vec<Option<&Matrix>>]) -> Result<Matrix> {
        let flat: Vec<ffi::Mat> = blocks.iter().flatten().map(|block| block.map_or(null_mut(), |matrix| matrix.raw())).collect();
        let mut raw = null_mut();
        let (rows, columns) = (index(blocks.len()), index(flat.len() / blocks.len()));
        petsc!(MatCreateNest(session.communicator(), rows, null(), columns, null(), flat.as_ptr(), &mut raw))?;
        Ok(Matrix { owned: Owned::new(session, raw) })
    }

    pub(super) fn raw(&self) -> ffi::Mat {
        self.owned.raw()
    }

    /// The session it belongs to.
    pub fn session(&self) -> &Session {
        self.owned.session()
    }

    /// `output = self * input`.
    pub fn multiply(&self, input: &Vector, output: &mut Vector) -> Result<()> {
        petsc!(MatMult(self.raw(), input.raw(), output.raw()))
    }

    /// `output += self * input`.
    pub fn multiply_add(&self, input: &Vector, output: &mut Vector) -> Result<()> {
        petsc!(MatMultAdd(self.raw(), input.raw(), output.raw(), output.raw()))
    }
}
