//! Solves a scene at an instant.

use std::path::Path;

use crate::{
    error::{Error, Result},
    mechanics::{FlowSolver, Suspension},
    observe::{self, Viscosity},
    petsc::Session,
    scene::Scene,
    setup::Setup,
    system::Solution,
};

/// Solves the scene of a text with overrides; collective.
///
/// # Errors
/// It cannot be used, or the solver does not converge.
pub fn solve<const D: usize>(session: &Session, text: &str, overrides: &[String]) -> Result<(Suspension<D>, Solution<D>)> {
    let world = session.world();
    let setup = world.agree(Scene::parse("validation", Path::new("."), text, overrides).and_then(|scene| Setup::<D>::of(&scene)))?;
    let mut suspension = Suspension::new(session, setup)?;
    let solution = suspension.solve(&mut |_, _| {})?;
    Ok((suspension, solution))
}

/// The viscosity of a sheared suspension; collective.
///
/// # Errors
/// It is not sheared.
pub fn viscosity<const D: usize>(suspension: &Suspension<D>, solution: &Solution<D>) -> Result<Viscosity> {
    let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), solution, &[])?;
    viscosity.ok_or_else(|| Error::Diverged("a scene of the validation is not sheared".into()))
}
