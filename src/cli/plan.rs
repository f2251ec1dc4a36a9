//! `turbid plan`: what a run would build and what not.

use crate::{
    error::Result,
    petsc::Session,
    scene::Scene,
    simulation::{Plan, Setup},
};

/// Prints the plan of a scene of dimension `D`.
#[allow(clippy::print_stdout)]
pub fn plan<const D: usize>(session: &Session, scene: &Scene) -> Result<()> {
    let world = session.world();
    let setup = world.agree(Setup::<D>::of(scene))?;
    let plan = Plan::of(&setup, world.size())?;
    if world.rank() == 0 {
        println!("{plan}");
    }
    Ok(())
}
