//! A rate, or a factor, that changes with time, as a scene file has it.

use std::f64::consts::TAU;

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

/// Keys of a step of a stress.
pub(in crate::scene) const STRESS_STEP_KEYS: [Key; 2] = [
    Key::new("until", "number", "2.0", "When the step ends. The last one goes on to the end of the run and has none.")
        .unit("time")
        .default("required but for the last step")
        .range("above that of the step before")
        .needs(STRESS_STEPS),
    Key::new("stress", "number", "2.0", "The shear stress in the step.")
        .unit("pressure")
        .default("required")
        .range("not 0")
        .needs(STRESS_STEPS),
];

/// Keys of a factor that oscillates.
pub(in crate::scene) const FACTOR_OSCILLATION_KEYS: [Key; 2] = [
    Key::new("amplitude", "number", "1.0", "Of the factor, which is amplitude cos(2 pi frequency time).")
        .default("required with frequency")
        .range("above 0")
        .needs(FACTOR_OSCILLATION),
    Key::new("frequency", "number", "0.5", "Cycles a time.")
        .unit("1/time")
        .default("required with amplitude")
        .range("above 0")
        .needs(FACTOR_OSCILLATION),
];

/// Keys of a step of a factor.
pub(in crate::scene) const FACTOR_STEP_KEYS: [Key; 2] = [
    Key::new("until", "number", "2.0", "When the step ends. The last one goes on to the end of the run and has none.")
        .unit("time")
        .default("required but for the last step")
        .range("above that of the step before")
        .needs(FACTOR_STEPS),
    Key::new("value", "number", "-1.0", "The factor in the step.").default("required").needs(FACTOR_STEPS),
];

const FACTOR_OSCILLATION: &str = "domain.y = \"walls\"; time.end = 1.0; flow.drive.factor = { amplitude = 1.0, frequency = 0.5 }";
const FACTOR_STEPS: &str = "domain.y = \"walls\"; time.end = 3.0; flow.drive.factor = [{ until = 1.0, value = 1.0 }, { value = -1.0 }]";

const OSCILLATION: &str = "domain.y = \"walls\"; time.end = 1.0; flow.drive.shear_rate = { amplitude = 0.1, frequency = 1.0 }";
const STRESS_STEPS: &str =
    "domain.y = \"walls\"; time.end = 3.0; flow.drive.shear_stress = [{ until = 1.0, stress = 5.0 }, { stress = 2.0 }]";
const STEPS: &str = "domain.y = \"walls\"; time.end = 3.0; flow.drive.shear_rate = [{ until = 1.0, rate = 1.0 }, { rate = -1.0 }]";

/// A rate: a number, an oscillation of its integral or a list of steps.
pub(super) fn read(entry: &Entry) -> Result<Protocol> {
    match entry.value {
        Value::InlineTable(_) => {
            let [amplitude, frequency] = read_oscillation(entry, &OSCILLATION_KEYS)?;
            Ok(Protocol::Oscillation { amplitude, frequency })
        }
        Value::Array(_) => read_steps(entry, &STEP_KEYS).map(|steps| steady_or(&steps)),
        _ => entry.number().map(Protocol::Steady),
    }
}

/// A factor: a number, an oscillation or a list of steps.
pub(super) fn read_factor(entry: &Entry) -> Result<Protocol> {
    match entry.value {
        Value::InlineTable(_) => {
            let [amplitude, frequency] = read_oscillation(entry, &FACTOR_OSCILLATION_KEYS)?;
            Ok(Protocol::Oscillation { amplitude: amplitude / (TAU * frequency), frequency })
        }
        Value::Array(_) => read_steps(entry, &FACTOR_STEP_KEYS).map(|steps| steady_or(&steps)),
        _ => entry.number().map(Protocol::Steady),
    }
}

/// A stress, or steps of it, that decides the rate in a fluid of this viscosity.
pub(super) fn read_stress(entry: &Entry, viscosity: f64) -> Result<Protocol> {
    let stresses = match entry.value {
        Value::Array(_) => read_steps(entry, &STRESS_STEP_KEYS)?,
        _ => vec![(f64::INFINITY, entry.number()?)],
    };
    Ok(Protocol::of_stresses(&stresses, viscosity))
}

/// One rate where there is one step.
fn steady_or(steps: &[(f64, f64)]) -> Protocol {
    if let [(_, value)] = steps { Protocol::Steady(*value) } else { Protocol::steps(steps) }
}

/// Amplitude and frequency.
fn read_oscillation(entry: &Entry, keys: &'static [Key; 2]) -> Result<[f64; 2]> {
    let table = Table::of(entry, keys)?;
    let amplitude = table.require("amplitude", keys[0].example)?.positive()?;
    Ok([amplitude, table.require("frequency", keys[1].example)?.positive()?])
}

/// Steps, at least one, of what the second key names: when each ends, and its value.
fn read_steps(entry: &Entry, keys: &'static [Key; 2]) -> Result<Vec<(f64, f64)>> {
    let name = keys[1].name;
    let entries = entry.list()?;
    let (mut steps, mut before) = (Vec::new(), 0.0);
    for (place, step) in entries.iter().enumerate() {
        let table = Table::of(step, keys)?;
        let value = table.require(name, "1.0")?.number()?;
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
        steps.push((until, value));
        before = until;
    }
    entry.expect(
        (),
        !steps.is_empty(),
        &format!("must have a step at least, for example [{{ until = 1.0, {name} = 1.0 }}, {{ {name} = -1.0 }}]"),
    )?;
    Ok(steps)
}
