//! How a scene moves in time.

use toml_edit::Value;

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::table::Table;

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
    pub(in crate::scene) fn read(root: &Table) -> Result<Option<Self>> {
        let Some(entry) = root.get("time") else { return Ok(None) };
        let table = entry.table(&["step", "end", "scheme", "travel"])?;
        let end = table.require("end", "10.0")?.positive()?;
        let step = table.get("step").map_or(Ok(Step::Auto), |entry| Step::read(&entry, end))?;
        let schemes = [("two-step", Scheme::TwoStep), ("midpoint", Scheme::Midpoint), ("euler", Scheme::Euler)];
        Ok(Some(TimeSection {
            step,
            end,
            scheme: table.get("scheme").map_or(Ok(Scheme::TwoStep), |entry| entry.choice(&schemes, &[]))?,
            travel: table.get("travel").map_or(Ok(0.1), |entry| read_travel(&entry, step))?,
        }))
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

fn read_travel(entry: &Entry, step: Step) -> Result<f64> {
    entry.expect((), step == Step::Auto, "only an automatic step has a travel; remove it or set time.step = \"auto\"")?;
    let travel = entry.number()?;
    entry.expect(travel, travel > 0.0 && travel <= 1.0, "must be above 0 and at most 1")
}
