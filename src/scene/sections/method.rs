//! How the equations of a scene are solved.

use crate::error::Result;
use crate::scene::FlowModel;
use crate::scene::entry::Entry;
use crate::scene::table::Table;

/// How the equations are solved.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodSection {
    /// How bodies act on the grid.
    pub constraint: ConstraintMethod,
    /// What solves the Stokes problem of the empty box.
    pub inverse: StokesSolver,
    /// Relative residual at which a solve ends, above 0 and at most 0.1.
    pub tolerance: f64,
}

/// How bodies act on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConstraintMethod {
    /// Multipliers on the surface with jump corrections.
    Sharp,
}

/// What solves the Stokes problem of the empty box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StokesSolver {
    /// Multigrid of hypre: any box.
    Hypre,
    /// Fourier transforms: boxes with at most one walled axis.
    Transform,
    /// Fourier transforms where the box allows them.
    Auto,
}

/// Words of the inverses.
const INVERSES: [(&str, StokesSolver); 3] =
    [("hypre", StokesSolver::Hypre), ("transform", StokesSolver::Transform), ("auto", StokesSolver::Auto)];

impl StokesSolver {
    /// The word for it in a scene file.
    pub fn word(self) -> &'static str {
        INVERSES.iter().find(|(_, solver)| *solver == self).map_or("", |(word, _)| word)
    }
}

impl MethodSection {
    pub(in crate::scene) fn read(root: &Table, model: FlowModel) -> Result<Self> {
        model.allow(root.get("method"))?;
        let table = root.section("method", &["constraint", "inverse", "tolerance"])?;
        let planned = ["mean-value", "distributed", "penalty", "fitted"];
        let constraint = |entry: Entry| entry.choice(&[("sharp", ConstraintMethod::Sharp)], &planned);
        let inverse = |entry: Entry| entry.choice(&INVERSES, &[]);
        Ok(MethodSection {
            constraint: table.get("constraint").map_or(Ok(ConstraintMethod::Sharp), constraint)?,
            inverse: table.get("inverse").map_or(Ok(StokesSolver::Hypre), inverse)?,
            tolerance: table.get("tolerance").map_or(Ok(1e-6), |entry| read_tolerance(&entry))?,
        })
    }
}

fn read_tolerance(entry: &Entry) -> Result<f64> {
    let tolerance = entry.number()?;
    entry.expect(tolerance, tolerance > 0.0 && tolerance <= 0.1, "must be above 0 and at most 0.1")
}
