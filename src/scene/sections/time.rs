//! How a scene moves in time.

use toml_edit::Value;

use crate::error::Result;
use crate::scene::FlowModel;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;

/// Strain that a mean viscosity is taken over at least, if nobody says.
const STRAIN: f64 = 20.0;

/// The travel of automatic steps, if nobody says.
const TRAVEL: f64 = 0.1;

/// The error that goes with it.
const ERROR: f64 = 3e-4;

/// Keys of `[time]`.
pub(in crate::scene) const KEYS: [Key; 6] = [
    Key::new("step", "\"auto\" or a number", "0.01", "The time step; automatic: as long as travel lets it.")
        .unit("time")
        .default("\"auto\"")
        .range("above 0, at most end")
        .needs(IN_TIME),
    Key::new("end", "number", "10.0", "Time at which the run ends; it starts at 0.").unit("time").default("required").range("above 0"),
    Key::new(
        "scheme",
        "\"two-step\", \"midpoint\" or \"euler\"",
        "\"midpoint\"",
        "How a step is taken: second order with one solve, second \
        order with two solves, or first order.",
    )
    .default("\"two-step\"")
    .needs(IN_TIME),
    Key::new(
        "travel",
        "number",
        "0.05",
        "Largest part of its radius that a body moves in an automatic step: in Stokes flow as seen by what is near it (to a neighbour the smaller diameter and the \
        gap, to a wall its radius and the gap, to the mean of all bodies ten radii), and the largest strain of the box; otherwise in the box. Of dry bodies with friction or torques also the largest angle of a turn, in radians.",
    )
    .unit("radii")
    .default("0.1")
    .range("above 0, at most 1")
    .needs(IN_TIME),
    Key::new(
        "error",
        "number",
        "1e-4",
        "Error of the displacements of bodies in Stokes flow in an automatic step, over their radii: root mean square of the difference \
        between the displacement of the last step and its length times the mean of the velocities before and after it; for a single \
        body ten times as much.",
    )
    .unit("radii")
    .default("0.3 of the cube of travel: 3e-4")
    .range("above 0, at most 1")
    .needs(IN_TIME),
    Key::new("until", "table", "{ viscosity_interval = 0.02 }", "What ends the run before end.")
        .default("none: the run goes on to end")
        .needs(SHEARED),
];

/// Keys of `time.until`.
pub(in crate::scene) const UNTIL_KEYS: [Key; 2] = [
    Key::new("viscosity_interval", "number", "0.02", "Half the width of the 95 % interval of the mean viscosity over that mean.")
        .unit("ratio")
        .default("required")
        .range("above 0, below 1")
        .needs(SHEARED),
    Key::new("strain", "number", "50.0", "Least strain over which the mean is taken; less than 20 counts as 20.")
        .default("20.0")
        .range("above 0")
        .needs("time.end = 1.0; domain.y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }; time.until.viscosity_interval = 0.02"),
];

/// What makes a scene of the reference one in time.
const IN_TIME: &str = "time.end = 1.0";

/// What makes it one that has a viscosity.
const SHEARED: &str = "time.end = 1.0; domain.y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }";

/// How far bodies go; a scene without it is one instantaneous solve.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeSection {
    /// The time step.
    pub step: Step,
    /// The time at which the run ends, positive; it starts at 0.
    pub end: f64,
    /// How a step is taken.
    pub scheme: Scheme,
    /// Largest part of its radius that a body moves in an automatic step, above 0 and at most 1.
    pub travel: f64,
    /// Part of their radius by which bodies in Stokes flow err in an automatic step, above 0 and at most 1.
    pub error: f64,
    /// What ends the run before `end`.
    pub until: Option<Until>,
}

/// What ends a run before its latest end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Until {
    /// Half the width of the 95 % interval of the mean viscosity over that mean, above 0 and below 1.
    pub viscosity_interval: f64,
    /// Least strain that the mean is taken over, positive.
    pub strain: f64,
}

/// The time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// As long as `travel` lets it.
    Auto,
    /// This long, positive and at most the time of the whole run.
    Fixed(f64),
}

/// How a step is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// Second order with one solve a step, from the velocities of this step and the last.
    TwoStep,
    /// Second order with two solves a step.
    Midpoint,
    /// First order with one solve a step.
    Euler,
}

impl TimeSection {
    /// Automatic steps to an end.
    pub fn to(end: f64) -> Self {
        TimeSection { step: Step::Auto, end, scheme: Scheme::TwoStep, travel: TRAVEL, error: error_of(TRAVEL), until: None }
    }

    pub(in crate::scene) fn read(root: &Table, model: FlowModel) -> Result<Option<Self>> {
        let Some(entry) = root.get("time") else { return Ok(None) };
        let table = Table::of(&entry, &KEYS)?;
        let end = table.require("end", "10.0")?.positive()?;
        let step = table.get("step").map_or(Ok(Step::Auto), |entry| Step::read(&entry, end))?;
        let default = TimeSection::to(end);
        let part = |name: &str| table.get(name).map(|entry| read_part(&entry, step)).transpose();
        let travel = part("travel")?.unwrap_or(default.travel);
        let error = part("error")?;
        if let (Some(entry), true) = (table.get("error"), model != FlowModel::Stokes) {
            return Err(entry.refuse("is of steps in Stokes flow; with inertia and in dry scenes time.travel limits them: remove it"));
        }
        Ok(Some(TimeSection {
            step,
            end,
            scheme: table.get("scheme").map_or(Ok(default.scheme), |entry| entry.choice(&Scheme::WORDS, &[]))?,
            travel,
            error: error.unwrap_or(error_of(travel)),
            until: table.get("until").map(|entry| Until::read(&entry)).transpose()?,
        }))
    }
}

impl Scheme {
    /// Words of the schemes.
    pub(in crate::scene) const WORDS: [(&str, Scheme); 3] =
        [("two-step", Scheme::TwoStep), ("midpoint", Scheme::Midpoint), ("euler", Scheme::Euler)];
}

impl Until {
    fn read(entry: &Entry) -> Result<Self> {
        let table = Table::of(entry, &UNTIL_KEYS)?;
        let interval = table.require("viscosity_interval", "0.02")?;
        let viscosity_interval = interval.positive()?;
        interval.expect((), viscosity_interval < 1.0, "must be below 1: it is a part of the mean viscosity")?;
        Ok(Until { viscosity_interval, strain: table.get("strain").map_or(Ok(STRAIN), |entry| entry.positive())? })
    }
}

impl Step {
    fn read(entry: &Entry, end: f64) -> Result<Self> {
        const CHOICES: &str = "\"auto\" or a number";
        match entry.value {
            Value::String(word) if word.value() == "auto" => Ok(Step::Auto),
            Value::String(_) => Err(entry.refuse(&format!("must be {CHOICES}"))),
            Value::Integer(_) | Value::Float(_) => {
                let step = entry.positive()?;
                entry.expect(Step::Fixed(step), step <= end, &format!("must not be longer than time.end = {end}"))
            }
            _ => Err(entry.mistyped(CHOICES)),
        }
    }
}

/// The error of a step that goes with a travel: both fall alike with shorter steps.
fn error_of(travel: f64) -> f64 {
    ERROR * (travel / TRAVEL).powi(3)
}

/// A travel or an error.
fn read_part(entry: &Entry, step: Step) -> Result<f64> {
    entry.expect((), step == Step::Auto, "only automatic steps are as long as it lets them; remove it or set time.step = \"auto\"")?;
    let part = entry.number()?;
    entry.expect(part, part > 0.0 && part <= 1.0, "must be above 0 and at most 1")
}
