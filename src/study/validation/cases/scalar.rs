//! The cases of a scalar around inclusions.

use std::f64::consts::PI;

use nalgebra::{SVector, Vector2, Vector3};

use crate::{
    error::{Error, Result},
    geometry::{Axis, Ball, Domain},
    mechanics::{Inclusions, ScalarSetup, ScalarSolution},
    petsc::Session,
    scene::{ConstraintMethod, Tolerance},
    study::validation::case::Case,
};

/// Far below the errors that are measured.
const TOLERANCE: f64 = 1e-8;

/// A centre in no special place on any grid.
const DISK: [f64; 2] = [0.513, 0.527];
const SPHERE: [f64; 3] = [0.513, 0.527, 0.481];

/// All of them.
pub fn cases() -> Vec<Case> {
    vec![
        disk_in_a_square("scalar, value in a disk in a square", 0.04067803527883, |solution| solution.inclusions[0].value),
        disk_in_a_square("scalar, energy around the same", -0.5 * 0.020998646033, |solution| solution.energy),
        square_array("conductivity, square array 0.3", 0.3, 1.8601883065),
        square_array("conductivity, square array 0.5", 0.5, 3.0801978262),
        cubic_array(),
    ]
}

/// Unit box with one ball in it.
fn setup<const D: usize>(axes: [Axis<D>; D], spacing: f64, ball: Ball<D>, order: usize) -> ScalarSetup<D> {
    ScalarSetup {
        domain: Domain { size: SVector::repeat(1.0), axes },
        spacing,
        source: 1.0,
        gradient: None,
        inclusions: vec![(ball, order)],
        constraint: ConstraintMethod::Sharp,
        tolerance: Tolerance::Fixed(TOLERANCE),
    }
}

fn disk_in_a_square(name: &'static str, reference: f64, quantity: fn(&ScalarSolution<2>) -> f64) -> Case {
    let solve = move |session: &Session| {
        let ball = Ball { center: Vector2::new(0.4, 0.55), radius: 0.2 };
        Ok(quantity(
            &Inclusions::new(session, setup([Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }; 2], 1.0 / 64.0, ball, 8))?
                .solve(&mut |_, _| {})?,
        ))
    };
    Case {
        name,
        source: "series fitted to 1e-13",
        resolution: "a/h = 12.8, K = 8".into(),
        reference,
        tolerance: 5e-4,
        solve: Box::new(solve),
    }
}

/// Conductivity along the first axis of a cubic array with perfectly conducting balls.
fn conductivity<const D: usize>(session: &Session, spacing: f64, ball: Ball<D>, order: usize) -> Result<f64> {
    let gradient = SVector::from_fn(|axis, _| if axis == 0 { 1.0 } else { 0.0 });
    let setup = ScalarSetup { source: 0.0, gradient: Some(gradient), ..setup([Axis::Periodic; D], spacing, ball, order) };
    let solution = Inclusions::new(session, setup)?.solve(&mut |_, _| {})?;
    let flux = solution.mean_flux.ok_or_else(|| Error::Diverged("a case of the validation has no mean gradient".into()))?;
    Ok(flux[0])
}

fn square_array(name: &'static str, fraction: f64, reference: f64) -> Case {
    let radius = (fraction / PI).sqrt();
    let solve = move |session: &Session| conductivity(session, radius / 12.0, Ball { center: Vector2::from(DISK), radius }, 10);
    let source = "Perrins et al. 1979, recomputed";
    Case { name, source, resolution: "a/h = 12, K = 10".into(), reference, tolerance: 3e-4, solve: Box::new(solve) }
}

fn cubic_array() -> Case {
    let radius = (0.75 * 0.3 / PI).cbrt();
    let solve = move |session: &Session| conductivity(session, radius / 7.0, Ball { center: Vector3::from(SPHERE), radius }, 5);
    Case {
        name: "conductivity, cubic array 0.3",
        source: "Sangani & Acrivos 1983",
        resolution: "a/h = 7, L = 5".into(),
        // their expansion to the power 22/3 of the fraction
        reference: 2.3326,
        tolerance: 1e-3,
        solve: Box::new(solve),
    }
}
