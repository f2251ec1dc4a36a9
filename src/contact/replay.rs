//! An island that was not solved, read back from the file that a failed run leaves, to solve it again.

use nalgebra::SVector;
use serde_json::Value;

use super::Problem;
use crate::{
    error::{Error, Result},
    geometry::{Axis, Ball, Domain},
};

/// The bodies of an island and what they wanted, numbered from 0 in the order of the file; what gluey contacts remember is not in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Island<const D: usize> {
    /// The box; of its walls only the places are known.
    pub domain: Domain<D>,
    /// The bodies before the step.
    pub balls: Vec<Ball<D>>,
    /// Their weights, infinite for those that do not give way.
    pub weights: Vec<f64>,
    /// Velocities wanted.
    pub velocities: Vec<SVector<f64, D>>,
    /// Length of the step.
    pub step: f64,
}

impl<const D: usize> Island<D> {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`Error::Refused`] if it is not the file of an island in this dimension.
    pub fn read(text: &str) -> Result<Self> {
        let parse = || {
            let value: Value = serde_json::from_str(text).ok()?;
            let size = vector(&value["size"])?;
            let periodic: Vec<bool> = value["periodic"].as_array()?.iter().map(Value::as_bool).collect::<Option<_>>()?;
            let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
            let axes = <[bool; D]>::try_from(periodic).ok()?.map(|periodic| if periodic { Axis::Periodic } else { wall });
            let bodies = value["bodies"].as_array()?;
            let ball = |body: &Value| Some(Ball { center: vector(&body["center"])?, radius: body["radius"].as_f64()? });
            Some(Self {
                domain: Domain { size, axes },
                balls: bodies.iter().map(ball).collect::<Option<_>>()?,
                // null stands for an infinite weight
                weights: bodies.iter().map(|body| body["weight"].as_f64().unwrap_or(f64::INFINITY)).collect(),
                velocities: bodies.iter().map(|body| vector(&body["wanted"])).collect::<Option<_>>()?,
                step: value["step"].as_f64()?,
            })
        };
        parse().ok_or_else(|| Error::refused(format!("contact-island.json: is no island of dimension {D}; take the file of a failed run")))
    }

    /// The problem to solve again.
    pub fn problem(&self) -> Problem<'_, D> {
        let Island { domain, balls, weights, velocities, step } = self;
        Problem::new(domain, balls, weights, velocities, *step)
    }
}

fn vector<const D: usize>(value: &Value) -> Option<SVector<f64, D>> {
    let numbers: Vec<f64> = value.as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
    (numbers.len() == D).then(|| SVector::from_vec(numbers))
}
