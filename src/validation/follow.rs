//! Runs that are compared with known values at their instants.

use std::path::Path;

use crate::{
    error::Result,
    motion::{Observation, Simulation},
    petsc::Session,
    scene::Scene,
};

/// A comparison with a known value.
pub struct ComparisonRow {
    /// What is compared.
    pub case: String,
    /// Cells and modes.
    pub resolution: String,
    /// The known value, if there is one.
    pub reference: Option<f64>,
    /// What comes out.
    pub found: f64,
    /// Where the known value is from.
    pub source: &'static str,
}

/// Runs a scene to its end and shows each instant.
pub fn follow<const D: usize>(
    session: &Session,
    text: &str,
    mut see: impl FnMut(&Simulation<D>, &Observation<D>) -> Result<()>,
) -> Result<usize> {
    let scene = session.world().agree(Scene::parse("validation", Path::new("."), text, &[]))?;
    let mut simulation = Simulation::<D>::new(session, &scene)?;
    loop {
        let observation = simulation.evaluate(&mut |_, _| {})?;
        see(&simulation, &observation)?;
        if simulation.over() {
            return Ok(simulation.state().steps);
        }
        simulation.step(&observation, &mut |_, _| {})?;
    }
}

/// The cubic through the four points around a time.
pub fn interpolated(curve: &[(f64, f64)], time: f64) -> f64 {
    let after = curve.partition_point(|(at, _)| *at < time);
    let first = after.saturating_sub(2).min(curve.len() - 4);
    let points = &curve[first..first + 4];
    let weights = crate::linalg::lagrange(&[points[0].0, points[1].0, points[2].0, points[3].0], time);
    weights.iter().zip(points).map(|(weight, (_, value))| weight * value).sum()
}
