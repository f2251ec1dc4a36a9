//! hypre's BoomerAMG on a scalar matrix: set up once, one V-cycle per application.

use std::ptr::null_mut;

use super::{Matrix, Vector, ffi, options::insert_unless_given, owned::Owned, petsc};
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
    /// The same on the way up.
    pub upward_relaxation: &'static str,
}

impl AmgSettings {
    /// Measured choice for the 5-point (2D) and 7-point (3D) Laplacian inside the coupled solver.
    ///
    /// No level is coarsened aggressively: it pays for a Laplacian alone, but crowded disks take an eighth to a quarter more iterations for it
    /// (by two ways; by one three times as many), the more so the more ranks, and spheres a third. With fewer than six interpolation entries
    /// the iterations grow with refinement in 3D.
    pub fn laplacian(dimension: usize) -> Self {
        let most_interpolation_entries = if dimension == 2 { 4 } else { 6 };
        let (coarsening, interpolation, relaxation) = ("HMIS", "ext+i", "SOR/Jacobi");
        AmgSettings { coarsening, interpolation, most_interpolation_entries, strength: 0.25, relaxation, upward_relaxation: relaxation }
    }

    /// The same with sweeps that run backwards on the way up: a symmetric cycle at the same cost, which conjugate gradients need.
    pub fn symmetric(self) -> Self {
        AmgSettings { upward_relaxation: "backward-SOR/Jacobi", ..self }
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
        ("relax_type_up", settings.upward_relaxation.to_string()),
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
