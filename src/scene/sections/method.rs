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
    /// When a solve ends.
    pub tolerance: Tolerance,
}

/// The relative residual at which a solve ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// 1e-6 at an instant; in time looser, as long as the error stays small beside that of the step.
    Auto,
    /// This one, above 0 and at most 0.1.
    Fixed(f64),
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

/// The automatic tolerance of an instant, and the loosest of a step.
const TIGHTEST: f64 = 1e-6;
const LOOSEST: f64 = 1e-3;

/// Automatic tolerance over the square of what bodies move in a step, in radii: the order of what a step gets wrong in velocities.
///
/// Measured on `examples/shear.toml` to strain 0.3 (36 steps, bodies move 0.1 radii in each): halving the step moves bodies by
/// 2.2e-4 at most, a tolerance of 1e-3 by 1.5e-5, of 1e-4 by 1.3e-6, of 1e-6 by 9e-9.
const PART_OF_STEP_ERROR: f64 = 0.02;

impl Tolerance {
    /// For bodies that do not move.
    pub fn at_an_instant(self) -> f64 {
        self.in_a_step(0.0)
    }

    /// For a step after one in which a body moved so many radii.
    pub fn in_a_step(self, travel: f64) -> f64 {
        match self {
            Tolerance::Auto => (PART_OF_STEP_ERROR * travel * travel).clamp(TIGHTEST, LOOSEST),
            Tolerance::Fixed(tolerance) => tolerance,
        }
    }

    /// As a scene file writes it.
    pub fn text(self) -> String {
        match self {
            Tolerance::Auto => "\"auto\"".into(),
            Tolerance::Fixed(tolerance) => tolerance.to_string(),
        }
    }

    fn read(entry: &Entry) -> Result<Self> {
        if entry.value.as_str().is_some() {
            return entry.choice(&[("auto", Tolerance::Auto)], &[]);
        }
        let tolerance = entry.number()?;
        entry.expect(Tolerance::Fixed(tolerance), tolerance > 0.0 && tolerance <= 0.1, "must be \"auto\", or above 0 and at most 0.1")
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
            tolerance: table.get("tolerance").map_or(Ok(Tolerance::Auto), |entry| Tolerance::read(&entry))?,
        })
    }
}
