//! What sections of a scene demand of each other.

use crate::error::Result;
use crate::scene::{AxisSection, Drive, Scene, Spacing};

pub(super) fn check(scene: &Scene) -> Result<()> {
    check_spacing(scene)?;
    match &scene.flow.drive {
        Some(Drive::ShearRate(rate)) => check_shear(scene, *rate),
        Some(Drive::MeanVelocity(vector)) => check_walls(scene, "flow.drive.mean_velocity", vector),
        Some(Drive::PressureGradient(vector)) => check_walls(scene, "flow.drive.pressure_gradient", vector),
        Some(Drive::BodyForce(_)) | None => Ok(()),
    }
}

fn check_spacing(scene: &Scene) -> Result<()> {
    match scene.resolution.as_ref().map(|resolution| resolution.spacing) {
        Some(Spacing::CellsPerRadius(cells)) if scene.bodies.is_empty() => {
            let remedy = "there are no bodies to measure by; give resolution.spacing instead";
            Err(scene.refuse("resolution.cells_per_radius", cells, remedy))
        }
        _ => Ok(()),
    }
}

fn check_shear(scene: &Scene, rate: f64) -> Result<()> {
    match walled(scene).next() {
        Some(axis) => {
            let remedy = format!("needs a fully periodic box, but domain.{} has walls", name(axis));
            Err(scene.refuse("flow.drive.shear_rate", rate, &remedy))
        }
        None => Ok(()),
    }
}

fn check_walls(scene: &Scene, key: &str, vector: &[f64]) -> Result<()> {
    match walled(scene).find(|&axis| vector[axis] != 0.0) {
        Some(axis) => {
            let remedy = format!("number {} must be 0: domain.{} has walls", axis + 1, name(axis));
            Err(scene.refuse(key, format!("{vector:?}"), &remedy))
        }
        None => Ok(()),
    }
}

fn walled(scene: &Scene) -> impl Iterator<Item = usize> {
    let axes = scene.domain.axes.iter().enumerate();
    axes.filter(|(_, axis)| **axis != AxisSection::Periodic).map(|(axis, _)| axis)
}

fn name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}
