//! The quantity whose error is measured: which one, how it is read from a run, and how far two values of it are apart.

use std::{fs, path::Path};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::facts::Facts;
use crate::error::{Error, Result};
pub use crate::linalg::norm;

/// What can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Magnitude of the mean force by the fluid on held bodies.
    Drag,
    /// Relative viscosity.
    Viscosity,
    /// Velocities of bodies, with their spins times their radii.
    Velocity,
    /// The scalar in inclusions.
    Value,
    /// The least value of the functional of the scalar problem.
    Energy,
    /// Centres of bodies at the end of a run in time.
    Position,
    /// The flow, or the scalar, on a lattice of points.
    Field,
    /// Differences of the field between neighbouring points of that lattice: the energy norm as the lattice sees it.
    Gradient,
}

/// Their words.
pub const WORDS: [(&str, Kind); 8] = [
    ("drag", Kind::Drag),
    ("viscosity", Kind::Viscosity),
    ("velocity", Kind::Velocity),
    ("value", Kind::Value),
    ("energy", Kind::Energy),
    ("position", Kind::Position),
    ("field", Kind::Field),
    ("gradient", Kind::Gradient),
];

/// The quantity of a study.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Which.
    pub kind: Kind,
    /// Of this body alone, where it is one of bodies.
    pub body: Option<usize>,
    /// Points along each axis of the lattice, where it is one of fields.
    pub probe: Option<usize>,
}

impl Kind {
    /// Its word.
    pub fn word(self) -> &'static str {
        WORDS.iter().find(|(_, kind)| *kind == self).map_or("", |(word, _)| word)
    }

    /// Whether it is one of bodies.
    pub fn of_bodies(self) -> bool {
        matches!(self, Kind::Drag | Kind::Velocity | Kind::Value | Kind::Position)
    }

    /// Whether it is one of fields.
    pub fn of_field(self) -> bool {
        matches!(self, Kind::Field | Kind::Gradient)
    }

    /// The order in the spacing at which theory sees its error fall with a method.
    ///
    /// Fields are seen through a grid, whose interpolation reaches across the kinks at surfaces: an error of order h in a layer as thick as the
    /// spacing. Differences between points of the lattice follow them once the grid is finer than the lattice.
    pub fn predicted_order(self, method: &str) -> f64 {
        match (method, self) {
            ("sharp" | "fitted", Kind::Field | Kind::Gradient) => 1.5,
            ("sharp", _) => 2.0,
            ("fitted", _) => 4.0,
            _ => 1.0,
        }
    }
}

impl Quantity {
    /// In words.
    pub fn words(&self, facts: &Facts) -> String {
        let of = self.body.map_or(String::new(), |body| format!(" of body {body}"));
        match self.kind {
            Kind::Drag if self.body.is_none() && facts.held.iter().filter(|&&held| held).count() > 1 => {
                "drag: magnitude of the mean force on the held bodies".into()
            }
            Kind::Drag => format!("drag{of}: magnitude of the force by the fluid"),
            Kind::Viscosity => "relative viscosity".into(),
            Kind::Velocity => format!("velocity{of}, with spin times radius; errors over its norm"),
            Kind::Value => format!("value in the inclusions{of}"),
            Kind::Energy => "energy".into(),
            Kind::Position => format!("position{of} at the end; errors are root mean squares in radii"),
            Kind::Field => format!("field on {} points an axis; errors in L2 over its norm", self.probe.unwrap_or(0)),
            Kind::Gradient => {
                format!("differences of the field between {} points an axis; errors in L2 over their norm", self.probe.unwrap_or(0))
            }
        }
    }

    /// Its values, from the summary of a run and what lies beside it.
    ///
    /// # Errors
    /// The run does not tell it.
    pub fn read(&self, summary: &Value, folder: &Path, facts: &Facts) -> Result<Vec<f64>> {
        let values = match self.kind {
            Kind::Drag => self.drag(summary, facts),
            Kind::Viscosity => number(summary, "/viscosity/relative").map(|viscosity| vec![viscosity]),
            Kind::Energy => number(summary, "/scalar/energy").map(|energy| vec![energy]),
            Kind::Value => self.each(&summary["scalar"]["inclusions"], |inclusion| Some(vec![inclusion["value"].as_f64()?])),
            Kind::Velocity => self.each(&summary["bodies"], velocity),
            Kind::Position => self.each(&summary["bodies"], |body| numbers(&body["center"])),
            Kind::Field | Kind::Gradient => return self.probe(&folder.join("probe.csv"), facts.dimension),
        };
        values.ok_or_else(|| Error::refused(format!("--quantity {}: the run does not tell it; choose another", self.kind.word())))
    }

    fn drag(&self, summary: &Value, facts: &Facts) -> Option<Vec<f64>> {
        let forces = summary["bodies"].as_array()?.iter().map(|body| numbers(&body["force"])).collect::<Option<Vec<_>>>()?;
        let chosen = |place: usize| self.body.map_or(facts.held.get(place) == Some(&true), |body| body == place);
        let counted: Vec<&Vec<f64>> = (0..).zip(&forces).filter(|(place, _)| chosen(*place)).map(|(_, force)| force).collect();
        let mean: Vec<f64> =
            (0..facts.dimension).map(|axis| counted.iter().map(|force| force[axis]).sum::<f64>() / counted.len() as f64).collect();
        let size = norm(&mean);
        size.is_finite().then_some(vec![size])
    }

    /// Numbers of all bodies, or of the chosen one.
    fn each(&self, bodies: &Value, read: impl Fn(&Value) -> Option<Vec<f64>>) -> Option<Vec<f64>> {
        let bodies = bodies.as_array()?;
        let chosen = match self.body {
            Some(body) => std::slice::from_ref(bodies.get(body)?),
            None => bodies.as_slice(),
        };
        Some(chosen.iter().map(read).collect::<Option<Vec<_>>>()?.concat())
    }

    fn probe(&self, path: &Path, dimension: usize) -> Result<Vec<f64>> {
        let unreadable = |source| Error::File { path: path.to_owned(), source };
        let text = fs::read_to_string(path).map_err(unreadable)?;
        let parse = |cell: &str| cell.parse::<f64>().map_err(|error| unreadable(std::io::Error::other(error)));
        let line = |line: &str| line.split(',').skip(dimension).map(parse).collect::<Result<Vec<f64>>>();
        let values = text.lines().skip(1).map(line).collect::<Result<Vec<_>>>()?;
        match self.probe {
            Some(points) if self.kind == Kind::Gradient => Ok(differences(&values, points, dimension)),
            _ => Ok(values.concat()),
        }
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

fn velocity(body: &Value) -> Option<Vec<f64>> {
    let radius = body["radius"].as_f64()?;
    let mut all = numbers(&body["velocity"])?;
    all.extend(numbers(&body["spin"])?.iter().map(|spin| spin * radius));
    Some(all)
}

fn number(summary: &Value, place: &str) -> Option<f64> {
    summary.pointer(place)?.as_f64()
}

fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts() -> Facts {
        Facts { dimension: 2, radius: Some(0.5), held: vec![true, false, true], periods: vec![None; 2], bodies: 3, volume: 1.0 }
    }

    fn read(kind: Kind, body: Option<usize>, summary: &Value) -> Option<Vec<f64>> {
        Quantity { kind, body, probe: None }.read(summary, Path::new(""), &facts()).ok()
    }

    #[test]
    fn quantities_are_read_from_a_summary() {
        let body = |force: f64| serde_json::json!({"force": [force, 4.0], "velocity": [1.0, 2.0], "spin": [3.0], "radius": 0.5, "center": [0.1, 0.2]});
        let summary = serde_json::json!({"bodies": [body(2.0), body(100.0), body(4.0)], "viscosity": {"relative": 2.5}});
        assert_eq!(read(Kind::Drag, None, &summary), Some(vec![5.0]), "the mean of the held ones is (3, 4)");
        assert_eq!(read(Kind::Viscosity, None, &summary), Some(vec![2.5]));
        assert_eq!(read(Kind::Velocity, Some(1), &summary), Some(vec![1.0, 2.0, 1.5]));
        assert_eq!(read(Kind::Position, Some(2), &summary), Some(vec![0.1, 0.2]));
        assert_eq!(read(Kind::Energy, None, &summary), None);
        assert_eq!(read(Kind::Velocity, Some(3), &summary), None);
    }

    #[test]
    fn differences_are_between_neighbours_along_each_axis() {
        let values: Vec<Vec<f64>> = [0.0, 1.0, 10.0, 12.0].map(|value| vec![value]).to_vec();
        assert_eq!(differences(&values, 2, 2), [1.0, 2.0, 10.0, 11.0]);
    }
}
