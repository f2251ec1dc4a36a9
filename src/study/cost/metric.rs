//! How a quantity is read from a run of a scene, and how far two values of it are apart.

use std::{fs, path::Path};

use serde_json::Value;

use super::{
    properties::SceneProperties,
    quantity::{CostQuantity, QuantityKind},
};
use crate::{
    error::{Error, Result},
    experiment::summary::{RunSummary, numbers},
    output::Columns,
};

/// A quantity of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Metric {
    /// The quantity.
    pub quantity: CostQuantity,
    /// The scene as it is.
    pub properties: SceneProperties,
}

impl Metric {
    /// In words.
    pub fn words(&self) -> String {
        let end = if self.properties.steady { ", at the end of the run" } else { "" };
        format!("{}{end}", self.kind_in_words())
    }

    fn kind_in_words(&self) -> String {
        let of = self.quantity.body.map_or(String::new(), |body| format!(" of body {body}"));
        match self.quantity.kind {
            QuantityKind::Drag if self.quantity.body.is_none() && self.properties.held.iter().filter(|&&held| held).count() > 1 => {
                "drag: magnitude of the mean force on the bodies with prescribed motion".into()
            }
            QuantityKind::Drag => format!("drag{of}: magnitude of the force by the fluid"),
            QuantityKind::Resistance => "resistance: mean pressure gradient over viscosity and mean velocity".into(),
            QuantityKind::MeanVelocity => "mean velocity: its magnitude".into(),
            QuantityKind::Viscosity => "relative viscosity".into(),
            QuantityKind::Reynolds => "largest Reynolds number of a body, by the density of the fluid".into(),
            QuantityKind::Velocity => format!("velocity{of}, with spin times radius; errors over its norm"),
            QuantityKind::Value => format!("value in the inclusions{of}"),
            QuantityKind::Energy => "energy".into(),
            QuantityKind::Position => format!("position{of} at the end; errors are root mean squares in radii"),
            QuantityKind::Field => format!("field on {} points an axis; errors in L2 over its norm", self.quantity.probe.unwrap_or(0)),
            QuantityKind::Gradient => {
                format!(
                    "differences of the field between {} points an axis; errors in L2 over their norm",
                    self.quantity.probe.unwrap_or(0)
                )
            }
        }
    }

    /// Its values, from the summary of a run and what lies beside it.
    ///
    /// # Errors
    /// The run does not tell it.
    pub fn read(&self, summary: &RunSummary, folder: &Path) -> Result<Vec<f64>> {
        let values = match self.quantity.kind {
            QuantityKind::Drag => self.drag(summary),
            QuantityKind::Resistance => magnitude(summary, "/flow/pressure_gradient")
                .zip(magnitude(summary, "/flow/mean_velocity"))
                .map(|(gradient, velocity)| vec![gradient / (self.properties.viscosity * velocity)]),
            QuantityKind::MeanVelocity => magnitude(summary, "/flow/mean_velocity").map(|velocity| vec![velocity]),
            QuantityKind::Reynolds => Columns::read(&folder.join("series.csv"))?.largest("reynolds").map(|largest| vec![largest]),
            QuantityKind::Viscosity => summary.get("/viscosity/relative").map(|viscosity| vec![viscosity]),
            QuantityKind::Energy => summary.get("/scalar/energy").map(|energy| vec![energy]),
            QuantityKind::Value => self.each(&summary.0["scalar"]["inclusions"], |inclusion| Some(vec![inclusion["value"].as_f64()?])),
            QuantityKind::Velocity => self.each(&summary.0["bodies"], velocity),
            QuantityKind::Position => self.each(&summary.0["bodies"], |body| numbers(&body["center"])),
            QuantityKind::Field | QuantityKind::Gradient => return self.lattice(&folder.join("probe.csv")),
        };
        values
            .ok_or_else(|| Error::refused(format!("--quantity {}: the run does not report it; choose another", self.quantity.kind.word())))
    }

    /// Numbers of the bodies whose mean force is the drag.
    pub fn counted(&self) -> Vec<usize> {
        let held = || (0..self.properties.held.len()).filter(|&body| self.properties.held[body]).collect();
        self.quantity.body.map_or_else(held, |body| vec![body])
    }

    fn drag(&self, summary: &RunSummary) -> Option<Vec<f64>> {
        let mean = summary.mean_of_bodies("force", self.counted())?;
        let size = norm(&mean);
        size.is_finite().then_some(vec![size])
    }

    /// Numbers of all bodies, or of the chosen one.
    fn each(&self, bodies: &Value, read: impl Fn(&Value) -> Option<Vec<f64>>) -> Option<Vec<f64>> {
        let bodies = bodies.as_array()?;
        let chosen = match self.quantity.body {
            Some(body) => std::slice::from_ref(bodies.get(body)?),
            None => bodies.as_slice(),
        };
        Some(chosen.iter().map(read).collect::<Option<Vec<_>>>()?.concat())
    }

    fn lattice(&self, path: &Path) -> Result<Vec<f64>> {
        let unreadable = |source| Error::File { path: path.to_owned(), source };
        let text = fs::read_to_string(path).map_err(unreadable)?;
        let parse = |cell: &str| cell.parse::<f64>().map_err(|error| unreadable(std::io::Error::other(error)));
        let line = |line: &str| line.split(',').skip(self.properties.dimension).map(parse).collect::<Result<Vec<f64>>>();
        let values = text.lines().skip(1).map(line).collect::<Result<Vec<_>>>()?;
        match self.quantity.probe {
            Some(points) if self.quantity.kind == QuantityKind::Gradient => Ok(differences(&values, points, self.properties.dimension)),
            _ => Ok(values.concat()),
        }
    }

    /// Values moved by periods of the box to where they are nearest to others.
    pub fn near(&self, values: &[f64], others: &[f64]) -> Vec<f64> {
        if self.quantity.kind != QuantityKind::Position {
            return values.to_vec();
        }
        let moved = |(place, (value, other)): (usize, (&f64, &f64))| match self.properties.periods[place % self.properties.dimension] {
            Some(period) => value - period * ((value - other) / period).round(),
            None => *value,
        };
        values.iter().zip(others).enumerate().map(moved).collect()
    }

    /// What errors are taken over: the norm of the quantity, or of positions a radius for each body.
    pub fn scale(&self, values: &[f64]) -> f64 {
        let scale = match (self.quantity.kind, self.properties.radius) {
            (QuantityKind::Position, Some(radius)) => radius * (values.len() as f64 / self.properties.dimension as f64).sqrt(),
            _ => norm(values),
        };
        if scale > 0.0 { scale } else { 1.0 }
    }

    /// How far values are from others, over the scale of these; with its sign where there is one value.
    pub fn error(&self, values: &[f64], others: &[f64]) -> f64 {
        let near = self.near(values, others);
        let differences: Vec<f64> = near.iter().zip(others).map(|(value, other)| value - other).collect();
        let size = if let [difference] = differences[..] { difference } else { norm(&differences) };
        size / self.scale(others)
    }
}

/// Differences between neighbours along each axis, of values on a lattice whose first axis is fastest.
fn differences(values: &[Vec<f64>], points: usize, dimension: usize) -> Vec<f64> {
    let mut all = Vec::new();
    for axis in 0..dimension {
        let stride = points.pow(axis as u32);
        for place in (0..values.len()).filter(|place| place / stride % points + 1 < points) {
            all.extend(values[place + stride].iter().zip(&values[place]).map(|(next, value)| next - value));
        }
    }
    all
}

/// Length of the vector at a place of a summary.
fn magnitude(summary: &RunSummary, place: &str) -> Option<f64> {
    summary.vector(place).map(|vector| norm(&vector))
}

fn velocity(body: &Value) -> Option<Vec<f64>> {
    let radius = body["radius"].as_f64()?;
    let mut all = numbers(&body["velocity"])?;
    all.extend(numbers(&body["spin"])?.iter().map(|spin| spin * radius));
    Some(all)
}

/// Root of the sum of squares.
pub fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::cost::properties::tests::suits;

    fn properties() -> SceneProperties {
        SceneProperties { radius: Some(0.5), held: vec![true, false, true], viscosity: 0.5, ..SceneProperties::default() }
    }

    fn read(kind: QuantityKind, body: Option<usize>, summary: &RunSummary) -> Option<Vec<f64>> {
        Metric { quantity: CostQuantity { kind, body, probe: None }, properties: properties() }.read(summary, Path::new("")).ok()
    }

    #[test]
    fn quantities_are_read_from_a_summary() {
        let body = |force: f64| serde_json::json!({"force": [force, 4.0], "velocity": [1.0, 2.0], "spin": [3.0], "radius": 0.5, "center": [0.1, 0.2]});
        let flow = serde_json::json!({"pressure_gradient": [-3.0, 4.0], "mean_velocity": [2.0, 0.0]});
        let bodies = [body(2.0), body(100.0), body(4.0)];
        let summary = RunSummary(serde_json::json!({"bodies": bodies, "viscosity": {"relative": 2.5}, "flow": flow}));
        assert_eq!(read(QuantityKind::Resistance, None, &summary), Some(vec![5.0]), "5 over 0.5 and 2");
        assert_eq!(read(QuantityKind::MeanVelocity, None, &summary), Some(vec![2.0]));
        assert_eq!(read(QuantityKind::Drag, None, &summary), Some(vec![5.0]), "the mean of the held ones is (3, 4)");
        assert_eq!(read(QuantityKind::Viscosity, None, &summary), Some(vec![2.5]));
        assert_eq!(read(QuantityKind::Velocity, Some(1), &summary), Some(vec![1.0, 2.0, 1.5]));
        assert_eq!(read(QuantityKind::Position, Some(2), &summary), Some(vec![0.1, 0.2]));
        assert_eq!(read(QuantityKind::Energy, None, &summary), None);
        assert_eq!(read(QuantityKind::Velocity, Some(3), &summary), None);
    }

    #[test]
    fn differences_are_between_neighbours_along_each_axis() {
        let values: Vec<Vec<f64>> = [0.0, 1.0, 10.0, 12.0].map(|value| vec![value]).to_vec();
        assert_eq!(differences(&values, 2, 2), [1.0, 2.0, 10.0, 11.0]);
    }

    #[test]
    fn positions_are_compared_across_the_sides_of_the_box() {
        let (_, properties) = suits("force = [1.0, 0.0]\n[time]\nend = 1\n");
        let metric = |kind| Metric { quantity: CostQuantity { kind, body: None, probe: None }, properties: properties.clone() };
        assert!((metric(QuantityKind::Position).error(&[3.9, 1.0], &[0.1, 1.0]) - 0.4).abs() < 1e-12, "0.2 are 0.4 radii");
        assert!((metric(QuantityKind::Drag).error(&[9.0], &[10.0]) + 0.1).abs() < 1e-12);
    }
}
