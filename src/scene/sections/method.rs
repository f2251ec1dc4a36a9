//! How the equations of a scene are solved.

use crate::error::Result;
use crate::flow::InverseMethod;
use crate::scene::FlowModel;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;

/// Keys of `[method]`.
pub(in crate::scene) const KEYS: [Key; 6] = [
    Key::new(
        "constraint",
        "\"sharp\", \"mean-value\", \"distributed\", \"penalty\" or \"fitted\"",
        "\"penalty\"",
        "How bodies act on the grid. \
        Sharp: multipliers on surfaces with jump corrections. Mean-value: the same without corrections. Distributed: multipliers in the \
        volume. Penalty: bodies are very viscous fluid. Fitted: a mesh that fits the bodies (2D).",
    )
    .default("\"sharp\""),
    Key::new("epsilon", "\"auto\" or a number", "1e-6", "Viscosity of the fluid over that in bodies.")
        .unit("ratio")
        .default("\"auto\"")
        .range("at least 1e-12, below 1")
        .needs("method.constraint = \"penalty\""),
    Key::new("solver", "\"krylov\" or \"uzawa\"", "\"uzawa\"", "What solves for the multipliers.")
        .default("\"krylov\"")
        .needs("method.constraint = \"mean-value\""),
    Key::new("uzawa_step", "\"auto\" or a number", "0.5", "Step of Uzawa's iteration; automatic: the best one is estimated first.")
        .default("\"auto\"")
        .range("above 0")
        .needs("method.constraint = \"mean-value\"; method.solver = \"uzawa\""),
    Key::new(
        "inverse",
        "\"hypre\", \"transform\" or \"auto\"",
        "\"auto\"",
        "What solves for the fluid of the empty box: algebraic multigrid for \
        any box, transforms for any without an inflow (exact where walls lie across one axis at most), or the faster one that fits.",
    )
    .default("\"auto\""),
    Key::new(
        "tolerance",
        "\"auto\" or a number",
        "1e-8",
        "Relative residual at which a solve ends. Automatic: 1e-6 at an instant; in time looser, \
        with an error well below that of the step.",
    )
    .default("\"auto\"")
    .range("1e-13 to 0.1"),
];

/// How the equations are solved.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodSection {
    /// How bodies act on the grid.
    pub constraint: ConstraintMethod,
    /// What solves the Stokes problem of the empty box; nothing for the fastest that the box allows.
    pub inverse: Option<InverseMethod>,
    /// When a solve ends.
    pub tolerance: Tolerance,
}

/// The relative residual at which a solve ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// 1e-6 at an instant; in time looser, as long as the error stays small beside that of the step.
    Auto,
    /// This one, at least 1e-13 and at most 0.1.
    Fixed(f64),
    /// As the automatic one, but this one where that is looser.
    AtMost(f64),
}

/// How bodies act on the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ConstraintMethod {
    /// Multipliers on the surface with jump corrections.
    Sharp,
    /// Multipliers on the surface, the grid velocity interpolated linearly.
    MeanValue(MultiplierSolver),
    /// Multipliers at every grid velocity inside a body.
    Distributed,
    /// Fluid inside bodies that is more viscous by one over this number; nothing leaves the choice to the method.
    Penalty(Option<f64>),
    /// A mesh that fits the bodies and moves with them, in 2D, and a direct solver: modes, inverse and tolerance have no meaning then.
    Fitted,
}

/// What solves for the multipliers of the mean-value method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MultiplierSolver {
    /// The Krylov solver of all methods.
    Krylov,
    /// Uzawa's iteration `lambda += step (u - m(u))`; without a step, the best one is estimated first.
    Uzawa(Option<f64>),
}

impl ConstraintMethod {
    /// The words of all methods.
    pub const WORDS: [&str; 5] = ["sharp", "mean-value", "distributed", "penalty", "fitted"];

    /// Whether its multipliers are coefficients of modes on the surface.
    pub fn has_modes(self) -> bool {
        matches!(self, ConstraintMethod::Sharp | ConstraintMethod::MeanValue(_))
    }

    /// The word for it in a scene file.
    pub fn word(self) -> &'static str {
        match self {
            ConstraintMethod::Sharp => "sharp",
            ConstraintMethod::MeanValue(_) => "mean-value",
            ConstraintMethod::Distributed => "distributed",
            ConstraintMethod::Penalty(_) => "penalty",
            ConstraintMethod::Fitted => "fitted",
        }
    }

    /// The small parameter that is given for it, if it has one.
    pub fn epsilon(self) -> Option<f64> {
        match self {
            ConstraintMethod::Penalty(epsilon) => epsilon,
            _ => None,
        }
    }

    /// What solves for its multipliers.
    pub fn solver(self) -> MultiplierSolver {
        match self {
            ConstraintMethod::MeanValue(solver) => solver,
            _ => MultiplierSolver::Krylov,
        }
    }

    fn read(table: &Table) -> Result<Self> {
        let plain = [
            ("sharp", ConstraintMethod::Sharp),
            ("mean-value", ConstraintMethod::MeanValue(MultiplierSolver::Krylov)),
            ("distributed", ConstraintMethod::Distributed),
            ("penalty", ConstraintMethod::Penalty(None)),
            ("fitted", ConstraintMethod::Fitted),
        ];
        let method = table.get("constraint").map_or(Ok(ConstraintMethod::Sharp), |entry| entry.choice(&plain, &[]))?;
        let penalty = matches!(method, ConstraintMethod::Penalty(_));
        let epsilon = of_method(table.get("epsilon"), penalty, "is for constraint = \"penalty\" only; remove it")?;
        let surfaces = matches!(method, ConstraintMethod::MeanValue(_));
        let solver = of_method(table.get("solver"), surfaces, "is for constraint = \"mean-value\" only; remove it")?;
        let uzawa = solver.as_ref().map_or(Ok(false), |entry| entry.choice(&[("krylov", false), ("uzawa", true)], &[]))?;
        let step = of_method(table.get("uzawa_step"), uzawa, "is for solver = \"uzawa\" only; remove it")?;
        match method {
            ConstraintMethod::Penalty(_) => Ok(ConstraintMethod::Penalty(epsilon.map_or(Ok(None), |entry| read_epsilon(&entry))?)),
            ConstraintMethod::MeanValue(_) if uzawa => {
                let step = step.map_or(Ok(None), |entry| automatic(&entry, |entry| entry.positive()))?;
                Ok(ConstraintMethod::MeanValue(MultiplierSolver::Uzawa(step)))
            }
            method => Ok(method),
        }
    }
}

/// An entry, if the method has a use for it.
fn of_method<'a>(entry: Option<Entry<'a>>, used: bool, remedy: &str) -> Result<Option<Entry<'a>>> {
    match entry {
        Some(entry) if !used => Err(entry.refuse(remedy)),
        entry => Ok(entry),
    }
}

fn read_epsilon(entry: &Entry) -> Result<Option<f64>> {
    let epsilon = automatic(entry, |entry| entry.number())?;
    entry.expect(epsilon, epsilon.is_none_or(|epsilon| (1e-12..1.0).contains(&epsilon)), "must be \"auto\", or at least 1e-12 and below 1")
}

/// Nothing for the word "auto".
fn automatic(entry: &Entry, read: impl Fn(&Entry) -> Result<f64>) -> Result<Option<f64>> {
    if entry.value.as_str().is_some() { entry.choice(&[("auto", None)], &[]) } else { read(entry).map(Some) }
}

/// Words of the inverses of the fluid; automatic is the fastest that the box allows.
const INVERSES: [(&str, Option<InverseMethod>); 3] =
    [("hypre", Some(InverseMethod::Hypre)), ("transform", Some(InverseMethod::Transform)), ("auto", None)];

/// What can be asked for: below it residuals are the rounding of what they are computed from.
const SMALLEST_TOLERANCE: f64 = 1e-13;
const LARGEST_TOLERANCE: f64 = 0.1;

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
            Tolerance::AtMost(loosest) => Tolerance::Auto.in_a_step(travel).min(loosest),
        }
    }

    /// As a scene file writes it.
    pub fn text(self) -> String {
        match self {
            Tolerance::Auto => "\"auto\"".into(),
            Tolerance::Fixed(tolerance) | Tolerance::AtMost(tolerance) => tolerance.to_string(),
        }
    }

    fn read(entry: &Entry) -> Result<Self> {
        if entry.value.as_str().is_some() {
            return entry.choice(&[("auto", Tolerance::Auto)], &[]);
        }
        let tolerance = entry.number()?;
        let usable = (SMALLEST_TOLERANCE..=LARGEST_TOLERANCE).contains(&tolerance);
        let remedy = format!(
            "must be \"auto\", or at least {SMALLEST_TOLERANCE:e}, which is what sums of doubles can reach, and at most {LARGEST_TOLERANCE}"
        );
        entry.expect(Tolerance::Fixed(tolerance), usable, &remedy)
    }
}

impl Default for MethodSection {
    fn default() -> Self {
        MethodSection { constraint: ConstraintMethod::Sharp, inverse: None, tolerance: Tolerance::Auto }
    }
}

impl MethodSection {
    pub(in crate::scene) fn read(root: &Table, model: FlowModel) -> Result<Self> {
        model.allow(root.get("method"))?;
        let table = root.section("method", &KEYS)?;
        let (default, inverse) = (MethodSection::default(), |entry: Entry| entry.choice(&INVERSES, &[]));
        Ok(MethodSection {
            constraint: ConstraintMethod::read(&table)?,
            inverse: table.get("inverse").map_or(Ok(default.inverse), inverse)?,
            tolerance: table.get("tolerance").map_or(Ok(default.tolerance), |entry| Tolerance::read(&entry))?,
        })
    }
}
