//! `turbid plan`: what a run would build and what not.

use crate::{error::Result, petsc::Session, scene::Scene, simulation::Plan};

/// Prints the plan of a scene of dimension `D`.
#[allow(clippy::print_stdout)]
pub fn plan<const D: usize>(session: &Session, scene: &Scene) -> Result<()> {
    let world = session.world();
    let plan = world.agree(Plan::of::<D>(scene, world.size()))?;
    if world.rank() == 0 {
        println!("{plan}");
    }
    Ok(())
}
