//! A scalar around inclusions: solve, write, report.

use std::path::Path;

use super::folder;
use crate::{
    error::Result,
    output::{self, Progress, Summary},
    petsc::Session,
    scene::{ConstraintMethod, Scene},
    simulation::{FittedInclusions, Inclusions, ScalarSetup},
};

/// Solves a scalar scene of dimension `D`.
#[allow(clippy::print_stdout)]
pub fn run<const D: usize>(session: &Session, scene: &Scene, folder: &Path) -> Result<()> {
    let world = session.world();
    let first = world.rank() == 0;
    let setup = world.agree(ScalarSetup::<D>::of(scene))?;
    let progress = Progress::new(world.rank(), scene.method.tolerance.at_an_instant());
    let mut seen = |iteration, residual| progress.show(iteration, residual);
    let (named, claim) = ((scene.name.as_str(), scene.title.as_str()), || if first { folder::claim(folder, scene) } else { Ok(()) });
    let summary = match scene.method.constraint {
        ConstraintMethod::Fitted => {
            let mut inclusions = FittedInclusions::new(session, setup)?;
            world.agree(claim())?;
            let solution = inclusions.solve(&mut seen);
            progress.end();
            Summary::of_scalar(named, (inclusions.setup(), inclusions.grid()), (&solution?, ("direct", inclusions.cost())), world)
        }
        _ => {
            let mut inclusions = Inclusions::new(session, setup)?;
            world.agree(claim())?;
            let solution = inclusions.solve(&mut seen);
            progress.end();
            Summary::of_scalar(named, (inclusions.setup(), inclusions.grid()), (&solution?, ("hypre", inclusions.cost())), world)
        }
    };
    world.agree(if first { folder::complete(folder, &summary) } else { Ok(()) })?;
    if first {
        println!("{}", output::report(&summary));
        println!("files                {}: scene.toml, summary.json", folder.display());
    }
    Ok(())
}
