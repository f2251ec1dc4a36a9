//! What every run that ends well promises, whatever is in its scene.

use std::{collections::HashMap, fs, path::Path};

use serde_json::Value;

use super::{
    drawn::Drawn,
    objects::{MEMBRANE_BEADS, Motion, SPACING, part_radius},
};
use crate::common::summary;

/// Relative differences of stresses from bodies and from walls.
const STRESS: f64 = 1e-5;

/// Overlap of bodies that touch, in radii, and relative change of what is rigid.
const OVERLAP: f64 = 1e-6;
const RIGID: f64 = 1e-6;

/// A table of rows of numbers; an empty cell is none.
pub struct Table {
    pub names: Vec<String>,
    pub rows: Vec<Vec<Option<f64>>>,
}

impl Table {
    /// Reads a table; says what is wrong with its shape.
    pub fn read(path: &Path) -> Result<Table, String> {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
        let names: Vec<String> = lines.next().unwrap_or_default().into_iter().map(str::to_owned).collect();
        let rows: Vec<Vec<&str>> = lines.collect();
        if let Some(place) = rows.iter().position(|row| row.len() != names.len()) {
            return Err(format!("{}: row {place} has {} cells, the header {}", path.display(), rows[place].len(), names.len()));
        }
        Ok(Table { names, rows: rows.iter().map(|row| row.iter().map(|cell| cell.parse().ok()).collect()).collect() })
    }

    /// The numbers of a column; nothing without it.
    pub fn column(&self, name: &str) -> Option<Vec<Option<f64>>> {
        let place = self.names.iter().position(|column| column == name)?;
        Some(self.rows.iter().map(|row| row[place]).collect())
    }
}

/// What a run does not keep of its promises.
pub fn broken(drawn: &Drawn, out: &Path) -> Vec<String> {
    let summary = summary(out);
    let mut wrong = tables(out);
    wrong.extend(not_numbers("summary", &summary));
    if drawn.end.is_some() && wrong.is_empty() {
        let series = Table::read(&out.join("series.csv")).unwrap();
        wrong.extend(time(drawn, &series));
        wrong.extend(stresses(drawn, &series));
        wrong.extend(energies(&series));
        wrong.extend(gaps(drawn, &series));
    }
    wrong.extend(bodies(drawn, &summary));
    wrong
}

/// Tables with rows of another width than their header, or with numbers that are none.
fn tables(out: &Path) -> Vec<String> {
    let tables = ["series.csv", "forces.csv", "energy.csv", "chains.csv", "cells.csv", "clusters.csv"];
    let measured = ["profiles.csv", "profile-frames.csv", "pairs.csv", "probe.csv"];
    let paths = tables.into_iter().chain(measured).map(|name| out.join(name)).filter(|path| path.exists());
    let check = |path: &Path| match Table::read(path) {
        Err(wrong) => Some(wrong),
        Ok(table) => {
            let bad = |value: &Option<f64>| value.is_some_and(|number| !number.is_finite());
            table.rows.iter().flatten().any(bad).then(|| format!("{}: a number that is none", path.display()))
        }
    };
    paths.filter_map(|path| check(&path)).collect()
}

/// Places of a summary at which a number is none: JSON has only finite ones, so an absent one must be an explicit null in no list of numbers.
fn not_numbers(at: &str, value: &Value) -> Vec<String> {
    match value {
        Value::Array(values) if values.iter().any(Value::is_number) && values.iter().any(Value::is_null) => {
            vec![format!("{at}: a number that is none")]
        }
        Value::Array(values) => values.iter().flat_map(|value| not_numbers(at, value)).collect(),
        Value::Object(entries) => entries.iter().flat_map(|(name, value)| not_numbers(&format!("{at}.{name}"), value)).collect(),
        _ => Vec::new(),
    }
}

/// Times grow from 0 to the end that was asked for, in a sheared box to the last slide of its images by whole cells before it, and steps count one by one.
fn time(drawn: &Drawn, series: &Table) -> Option<String> {
    let times: Vec<f64> = series.column("time")?.into_iter().flatten().collect();
    let steps: Vec<f64> = series.column("step")?.into_iter().flatten().collect();
    let (end, last) = (drawn.end?, *times.last()?);
    let grow = times[0] == 0.0 && times.windows(2).all(|pair| pair[1] > pair[0]);
    let count = steps.iter().enumerate().all(|(place, &step)| step == place as f64);
    let right = grow && count && last - end <= 1e-12 * end && end - last <= 1e-12 * end + drawn.slide;
    (!right).then(|| format!("times {times:?} and steps {steps:?} of a run to {end}"))
}

/// The stress on the walls is that from bodies and fluid, where both are a viscosity.
fn stresses(drawn: &Drawn, series: &Table) -> Option<String> {
    if !drawn.couette || drawn.inertia {
        return None;
    }
    let (own, walls) = (series.column("viscosity")?, series.column("viscosity_from_walls")?);
    let off = own.iter().zip(&walls).filter_map(|(own, walls)| Some(((*own)? - (*walls)?).abs() / own.unwrap_or(1.0).abs().max(1.0)));
    let worst = off.fold(0.0, f64::max);
    (worst > STRESS).then(|| format!("viscosity {own:?}, from walls {walls:?}"))
}

/// Kinetic energies are not negative.
fn energies(series: &Table) -> Option<String> {
    let energies = series.column("kinetic_energy")?;
    energies.iter().flatten().any(|&energy| energy < 0.0).then(|| format!("kinetic energies {energies:?}"))
}

/// Where contacts are kept, nothing overlaps.
fn gaps(drawn: &Drawn, series: &Table) -> Option<String> {
    let kept = ["inelastic", "gluey"].iter().any(|model| drawn.text.contains(&format!("model = \"{model}\"")));
    let gaps = series.column("smallest_gap")?;
    (kept && gaps.iter().flatten().any(|&gap| gap < -OVERLAP)).then(|| format!("smallest gaps {gaps:?}"))
}

/// Rigid distances and given places, at the end.
fn bodies(drawn: &Drawn, summary: &Value) -> Vec<String> {
    let time = summary["time"].as_f64().unwrap_or(0.0);
    let centers: Vec<Vec<f64>> = summary["bodies"].as_array().map_or(Vec::new(), |bodies| {
        bodies.iter().map(|body| body["center"].as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()).collect()
    });
    let mut places = centers.iter();
    let mut wrong = Vec::new();
    for group in &drawn.objects.balls {
        for start in &group.centers {
            wrong.extend(given_place(drawn, &group.motion, [start, places.next().unwrap()], time));
        }
    }
    for chain in &drawn.objects.chains {
        let beads: Vec<&Vec<f64>> = places.by_ref().take(chain.centers.len()).collect();
        let lengths = beads.windows(2).map(|pair| distance(drawn, pair[0], pair[1], time) / (2.0 * part_radius(drawn.dimension) * SPACING));
        let off = lengths.map(|length| (length - 1.0).abs()).fold(0.0, f64::max);
        wrong.extend((chain.rigid && off > RIGID).then(|| format!("a rigid bond is off by {off:.1e}")));
    }
    let cells: usize = drawn.objects.cells.len() * MEMBRANE_BEADS;
    places.by_ref().take(cells).for_each(drop);
    let balls = HashMap::from([("rod", 3), ("cross", 5), ("triangle", 3), ("tetrahedron", 4)]);
    for cluster in &drawn.objects.clusters {
        let balls: Vec<&Vec<f64>> = places.by_ref().take(balls[cluster.shape]).collect();
        let nearest = balls[1..].iter().map(|ball| distance(drawn, balls[0], ball, time)).fold(f64::INFINITY, f64::min)
            / (2.0 * part_radius(drawn.dimension));
        wrong.extend(((nearest - 1.0).abs() > RIGID).then(|| format!("a {} has its first balls {nearest} diameters apart", cluster.shape)));
    }
    wrong.extend(places.next().map(|_| "more bodies than objects have".to_owned()));
    wrong
}

/// A body on a given motion that is not where it was told to be.
fn given_place(drawn: &Drawn, motion: &Motion, [start, seen]: [&Vec<f64>; 2], time: f64) -> Option<String> {
    let expected = match motion {
        Motion::Fixed => start.to_vec(),
        Motion::Steady(velocity) => start.iter().zip(velocity).map(|(start, velocity)| start + velocity * time).collect(),
        _ => return None,
    };
    let off = distance(drawn, &expected, seen, time);
    (off > 1e-12).then(|| format!("a body of given motion {motion:?} is {off:.1e} away from its place"))
}

/// Distance of the nearest images, those across the lower and upper side of a sheared box too.
fn distance(drawn: &Drawn, one: &[f64], other: &[f64], time: f64) -> f64 {
    let mut arm: Vec<f64> = (0..drawn.dimension).map(|axis| other[axis] - one[axis]).collect();
    let boxes = (arm[1] / drawn.size[1]).round();
    arm[0] -= boxes * drawn.background_rate * drawn.size[1] * time;
    arm.iter_mut().zip(&drawn.size).for_each(|(part, size)| *part -= (*part / size).round() * size);
    arm.iter().map(|part| part * part).sum::<f64>().sqrt()
}
