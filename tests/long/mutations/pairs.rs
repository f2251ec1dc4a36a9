//! Pairs of runs that must say the same: in other units, elsewhere in the box, on other ranks, in two halves.

use std::path::Path;

use serde_json::Value;

use super::{
    drawn::{Drawn, draw},
    motion::run,
    promises::Table,
    units::{Units, powers},
};
use crate::common::{command, said, summary};

/// Differences relative to the largest number of a kind: solves are to 1e-9.
const SAME: f64 = 1e-5;

/// Most steps of a run that is taken again on more ranks than there are cores.
const MOST_STEPS: u64 = 12;

/// Numbers of a run that units do not change, by name.
type Numbers = Vec<(String, f64)>;

/// Micrometres, milliseconds and the like, as powers of two.
pub fn in_other_units(seed: u64, drawn: &Drawn, here: &Path, out: &Path) -> Vec<String> {
    let powers = [(-20, -10, 0), (20, 7, -30), (-7, 20, 13), (10, 0, 30)][seed as usize / 10 % 4];
    compared(seed, "units", Units::of_powers(powers.0, powers.1, powers.2), drawn, here, out)
}

/// Everything some cells further along the axes that have no walls.
pub fn elsewhere(seed: u64, drawn: &Drawn, here: &Path, out: &Path) -> Vec<String> {
    let cells = [0, 1, 2].map(|axis| if drawn.movable[axis] { [7, 19, 5][axis] } else { 0 });
    if cells == [0; 3] || !drawn.text.contains("step = ") && drawn.end.is_some() {
        return Vec::new();
    }
    compared(seed, "place", Units::moved(cells), drawn, here, out)
}

fn compared(seed: u64, what: &str, units: Units, drawn: &Drawn, here: &Path, out: &Path) -> Vec<String> {
    let Some((other, output)) = run(here, &format!("{what}-{seed}"), &draw(seed, units).text, &[]) else { return Vec::new() };
    if output.status.code() != Some(0) {
        return vec![format!("in other {what} ({units:?}) it ends with {:?}: {}", output.status.code(), said(&output))];
    }
    differing(&numbers(drawn, Units::PLAIN, out), &numbers(drawn, units, &other), &format!("in other {what} ({units:?})"))
}

/// On three ranks, which have two cores in turn: short runs only.
pub fn on_other_ranks(seed: u64, drawn: &Drawn, here: &Path, out: &Path) -> Vec<String> {
    if summary(out)["steps"].as_u64().is_none_or(|steps| steps > MOST_STEPS) {
        return Vec::new();
    }
    let (scene, other) = (here.join(format!("run-{seed}.toml")), here.join(format!("ranks-{seed}")));
    let output = command(3, &["run", scene.to_str().unwrap(), "--out", other.to_str().unwrap()]).output().unwrap();
    // a grid may have too few layers for three ranks
    match output.status.code() {
        Some(0) => differing(&numbers(drawn, Units::PLAIN, out), &numbers(drawn, Units::PLAIN, &other), "on 3 ranks"),
        Some(2) => Vec::new(),
        code => vec![format!("on 3 ranks it ends with {code:?}: {}", said(&output))],
    }
}

/// Half of the time, and the rest after a restart, in fixed steps.
pub fn in_halves(seed: u64, drawn: &Drawn, here: &Path, out: &Path) -> Vec<String> {
    let Some(end) = drawn.end.filter(|_| drawn.text.contains("step = ")) else { return Vec::new() };
    let Some((other, output)) = run(here, &format!("halves-{seed}"), &drawn.text, &[&format!("time.end={:?}", 0.5 * end)]) else {
        return Vec::new();
    };
    if output.status.code() != Some(0) {
        return vec![format!("to half of its time it ends with {:?}: {}", output.status.code(), said(&output))];
    }
    let output = command(1, &["resume", other.to_str().unwrap(), "--set", &format!("time.end={end:?}")]).output().unwrap();
    if output.status.code() != Some(0) {
        return vec![format!("resumed at half of its time it ends with {:?}: {}", output.status.code(), said(&output))];
    }
    differing(&numbers(drawn, Units::PLAIN, out), &numbers(drawn, Units::PLAIN, &other), "in halves")
}

/// What a run says of its bodies and of its stress, in plain units and as seen from the same place.
fn numbers(drawn: &Drawn, units: Units, out: &Path) -> Numbers {
    let summary = summary(out);
    let plain = |value: f64, powers: [i32; 3]| value / units.number(1.0, powers);
    let mut numbers = Numbers::new();
    let mut add = |name: String, value: &Value| numbers.extend(value.as_f64().map(|value| (name, value)));
    let viscosity =
        ["relative", "hydrodynamic", "lubrication", "contact", "friction", "bonds", "first_normal_difference", "particle_pressure"];
    viscosity.iter().for_each(|name| add(format!("viscosity.{name}"), &summary["viscosity"][name]));
    // parts go with the whole, as they may cancel
    for name in ["first_normal_difference", "second_normal_difference", "particle_pressure"] {
        let parts = summary["quantities"].as_object().into_iter().flatten().filter(|(part, _)| part.starts_with(&format!("{name}_")));
        parts.for_each(|(_, part)| add(format!("viscosity.{name}"), &part["last"]));
    }
    add("lubrication.smallest_gap".to_owned(), &summary["lubrication"]["smallest_gap"]);
    let bodies = summary["bodies"].as_array().cloned().unwrap_or_default();
    for body in &bodies {
        let of = |name: &str, powers: [i32; 3]| -> Vec<f64> {
            let list = body[name].as_array().cloned().unwrap_or_else(|| vec![body[name].clone()]);
            list.iter().filter_map(Value::as_f64).map(|value| plain(value, powers)).collect()
        };
        let height = of("center", powers::LENGTH)[1];
        let mut velocity = of("velocity", powers::VELOCITY);
        velocity[0] -= drawn.background_rate * height;
        numbers.extend(velocity.iter().map(|&value| ("velocity".to_owned(), value)));
        numbers.extend(of("spin", powers::RATE).iter().map(|&value| ("spin".to_owned(), value)));
        numbers.extend(of("force", powers::FORCE).iter().map(|&value| ("force".to_owned(), value)));
    }
    if drawn.end.is_some() {
        let series = Table::read(&out.join("series.csv")).unwrap();
        numbers.push(("rows".to_owned(), series.rows.len() as f64));
        let energy = series.column("kinetic_energy").unwrap_or_default();
        numbers.extend(energy.last().copied().flatten().map(|value| ("kinetic_energy".to_owned(), plain(value, powers::ENERGY))));
    }
    numbers
}

/// The worst difference of each kind, relative to the largest number of that kind.
fn differing(one: &Numbers, other: &Numbers, how: &str) -> Vec<String> {
    let names = |numbers: &Numbers| numbers.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    if names(one) != names(other) {
        return vec![format!("{how}: {:?} for {:?}", names(other), names(one))];
    }
    let mut quantities = names(one);
    quantities.sort();
    quantities.dedup();
    let mut wrong = Vec::new();
    for quantity in quantities {
        let of = |numbers: &Numbers| numbers.iter().filter(|(name, _)| *name == quantity).map(|(_, value)| *value).collect::<Vec<f64>>();
        let (one, other) = (of(one), of(other));
        let largest = one.iter().fold(1e-9_f64, |largest, value| largest.max(value.abs()));
        let off = one.iter().zip(&other).map(|(one, other)| (one - other).abs() / largest).fold(0.0, f64::max);
        if off > SAME {
            wrong.push(format!("{how}: {quantity} is off by {off:.1e}: {one:?}, {other:?}"));
        }
    }
    wrong
}
