//! A rate that changes with time, as a scene file has it.

use toml_edit::Value;

use crate::error::Result;
use crate::geometry::Protocol;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;

/// Keys of a rate that oscillates.
pub(in crate::scene) const OSCILLATION_KEYS: [Key; 2] = [
    Key::new("amplitude", "number", "0.1", "Of the strain, which is amplitude sin(2 pi frequency time).")
        .default("required with frequency")
        .range("above 0")
        .needs(OSCILLATION),
    Key::new("frequency", "number", "1.0", "Cycles a time.")
        .unit("1/time")
        .default("required with amplitude")
        .range("above 0")
        .needs(OSCILLATION),
];

/// Keys of a step of a rate.
pub(in crate::scene) const STEP_KEYS: [Key; 2] = [
    Key::new("until", "number", "2.0", "When the step ends. The last one goes on to the end of the run and has none.")
        .unit("time")
        .default("required but for the last step")
        .range("above that of the step before")
        .needs(STEPS),
    Key::new("rate", "number", "-1.0", "The rate in the step.").unit("1/time").default("required").needs(STEPS),
];

const OSCILLATION: &str = "domain.y = \"walls\"; time.end = 1.0; flow.drive.shear_rate = { amplitude = 0.1, frequency = 1.0 }";
const STEPS: &str = "domain.y = \"walls\"; time.end = 3.0; flow.drive.shear_rate = [{ until = 1.0, rate = 1.0 }, { rate = -1.0 }]";

/// A number, an oscillation or a list of steps.
pub(super) fn read(entry: &Entry) -> Result<Protocol> {
    match entry.value {
        Value::InlineTable(_) => read_oscillation(entry),
        Value::Array(_) => read_steps(entry),
        _ => entry.number().map(Protocol::Steady),
    }
}

fn read_oscillation(entry: &Entry) -> Result<Protocol> {
    let table = Table::of(entry, &OSCILLATION_KEYS)?;
    let amplitude = table.require("amplitude", "0.1")?.positive()?;
    Ok(Protocol::Oscillation { amplitude, frequency: table.require("frequency", "1.0")?.positive()? })
}

fn read_steps(entry: &Entry) -> Result<Protocol> {
    let entries = entry.list()?;
    let (mut steps, mut before) = (Vec::new(), 0.0);
    for (place, step) in entries.iter().enumerate() {
        let table = Table::of(step, &STEP_KEYS)?;
        let rate = table.require("rate", "1.0")?.number()?;
        let last = place + 1 == entries.len();
        let until = match table.get("until") {
            Some(until) if last => return Err(until.refuse("the last step goes on to the end of the run; remove it, or add a step")),
            Some(until) => {
                let end = until.positive()?;
                until.expect(end, end > before, "must come after that of the step before")?
            }
            None if last => f64::INFINITY,
            None => table.require("until", "1.0")?.positive()?,
        };
        steps.push((until, rate));
        before = until;
    }
    entry.expect((), !steps.is_empty(), "must have a step at least, for example [{ until = 1.0, rate = 1.0 }, { rate = -1.0 }]")?;
    Ok(if let [(_, rate)] = steps[..] { Protocol::Steady(rate) } else { Protocol::steps(&steps) })
}
