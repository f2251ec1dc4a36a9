//! hypre's BoomerAMG on a scalar matrix: set up once, one V-cycle per application.

use std::{ffi::CString, ptr::null_mut};

use super::{Matrix, Vector, ffi, owned::Owned, petsc};
use crate::error::Result;

/// BoomerAMG parameters that matter for Laplacians on Cartesian grids.
#[derive(Debug, Clone)]
pub struct AmgSettings {
    /// Coarsening method.
    pub coarsening: &'static str,
    /// Interpolation method.
    pub interpolation: &'static str,
    /// Most entries of a row of the interpolation.
    pub most_interpolation_entries: usize,
    /// Strength threshold.
    pub strength: f64,
    /// Relaxation on every level but the coarsest.
    pub relaxation: &'static str,
}

impl AmgSettings {
    /// Measured choice for the 5-point (2D) and 7-point (3D) Laplacian inside the coupled solver.
    ///
    /// Aggressive coarsening, which pays for a Laplacian alone, costs up to four times the iterations there; with fewer
    /// than six interpolation entries the iterations grow with refinement in 3D.
    pub fn laplacian() -> Self {
        AmgSettings { coarsening: "HMIS", interpolation: "ext+i", most_interpolation_entries: 6, strength: 0.25, relaxation: "SOR/Jacobi" }
    }
}

/// One BoomerAMG V-cycle as an approximate inverse of a symmetric matrix.
pub struct Amg {
    owned: Owned<ffi::PC>,
    singular: bool,
}

impl Amg {
    /// Sets up the hierarchy of `matrix`; `singular` says that constants are its null space.
    pub fn new(matrix: &Matrix, singular: bool, settings: &AmgSettings) -> Result<Amg> {
        let session = matrix.session();
        let mut raw = null_mut();
        petsc!(PCCreate(session.communicator(), &mut raw))?;
        let owned = Owned::new(session, raw);
        petsc!(PCSetOptionsPrefix(raw, c"amg_".as_ptr()))?;
        insert_options(settings)?;
        petsc!(PCSetType(raw, c"hypre".as_ptr()))?;
        petsc!(PCHYPRESetType(raw, c"boomeramg".as_ptr()))?;
        petsc!(PCSetOperators(raw, matrix.raw(), matrix.raw()))?;
        petsc!(PCSetFromOptions(raw))?;
        petsc!(PCSetUp(raw))?;
        Ok(Amg { owned, singular })
    }

    /// One V-cycle from zero: `output = A^ input`.
    pub fn apply(&self, input: &Vector, output: &mut Vector) -> Result<()> {
        petsc!(PCApply(self.owned.raw(), input.raw(), output.raw()))?;
        if self.singular {
            output.remove_mean()?;
        }
        Ok(())
    }
}

/// hypre reads its parameters from PETSc's options; what the user gave after `--` is kept.
fn insert_options(settings: &AmgSettings) -> Result<()> {
    let options = [
        ("coarsen_type", settings.coarsening.to_string()),
        ("interp_type", settings.interpolation.to_string()),
        ("strong_threshold", settings.strength.to_string()),
        ("P_max", settings.most_interpolation_entries.to_string()),
        ("relax_type_all", settings.relaxation.to_string()),
        ("relax_type_coarse", "symmetric-SOR/Jacobi".to_string()),
        ("grid_sweeps_coarse", "4".to_string()),
        ("max_iter", "1".to_string()),
        ("tol", "0.0".to_string()),
    ];
    for (name, value) in options {
        insert_unless_given(&format!("-amg_pc_hypre_boomeramg_{name}"), &value)?;
    }
    Ok(())
}

fn insert_unless_given(name: &str, value: &str) -> Result<()> {
    let text = |text: &str| CString::new(text).expect("option names and values are plain text");
    let (name, value) = (text(name), text(value));
    let mut given = ffi::PetscBool_PETSC_FALSE;
    petsc!(PetscOptionsHasName(null_mut(), std::ptr::null(), name.as_ptr(), &mut given))?;
    if given == ffi::PetscBool_PETSC_FALSE {
        petsc!(PetscOptionsSetValue(null_mut(), name.as_ptr(), value.as_ptr()))?;
    }
    Ok(())
}
