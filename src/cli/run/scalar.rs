//! A scalar around inclusions: solve, write, report.

use std::path::Path;

use super::folder;
use crate::{
    error::Result,
    output::{self, Progress, Summary},
    petsc::Session,
    scene::Scene,
    simulation::{Inclusions, ScalarSetup},
};

/// Solves a scalar scene of dimension `D`.
#[allow(clippy::print_stdout)]
pub fn run<const D: usize>(session: &Session, scene: &Scene, folder: &Path) -> Result<()> {
    let world = session.world();
    let first = world.rank() == 0;
    let setup = world.agree(ScalarSetup::<D>::of(scene))?;
    let mut inclusions = Inclusions::new(session, setup)?;
    world.agree(if first { folder::claim(folder, scene) } else { Ok(()) })?;

    let progress = Progress::new(world.rank(), scene.method.tolerance.at_an_instant());
    let solution = inclusions.solve(&mut |iteration, residual| progress.show(iteration, residual));
    progress.end();
    let solution = solution?;

    let summary = Summary::of_scalar((&scene.name, &scene.title), &inclusions, &solution, world);
    world.agree(if first { folder::complete(folder, &summary) } else { Ok(()) })?;
    if first {
        println!("{}", output::report(&summary));
        println!("files                {}: scene.toml, summary.json", folder.display());
    }
    Ok(())
}
