//! Runs that are compared with known values at their instants.

use std::path::Path;

use crate::{
    error::Result,
    motion::{Observation, Simulation},
    petsc::Session,
    scene::Scene,
};

/// A comparison with a known value.
pub struct Row {
    /// What is compared.
    pub case: String,
    /// Cells and modes.
    pub resolution: String,
    /// The known value.
    pub reference: f64,
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
