//! An instantaneous solve: solve, write, report.

use std::path::Path;

use super::folder;
use crate::{
    error::Result,
    observe,
    output::{self, Progress, Summary},
    petsc::{Session, Stage, enter},
    scene::Scene,
    simulation::{Setup, flow_solver},
};

/// Solves a scene of dimension `D` with the bodies where they start.
#[allow(clippy::print_stdout)]
pub fn run<const D: usize>(session: &Session, scene: &Scene, folder: &Path) -> Result<()> {
    let world = session.world();
    let first = world.rank() == 0;
    let setup = world.agree(Setup::<D>::of(scene))?;
    let mut suspension = flow_solver(session, scene, setup)?;
    world.agree(if first { folder::claim(folder, scene) } else { Ok(()) })?;

    let progress = Progress::new(world.rank(), scene.method.tolerance.at_an_instant());
    let solution = suspension.solve(&mut |iteration, residual| progress.show(iteration, residual));
    progress.end();
    let solution = solution?;

    let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[])?;
    let summary = Summary::of_flow((&scene.name, &scene.title), suspension.as_ref(), (&solution, viscosity), world)?;
    let output = enter(Stage::Output);
    let mut files = vec!["scene.toml"];
    if scene.output.picture {
        let picture = observe::picture(scene.shown_title(), suspension.as_ref(), &solution)?.svg();
        world.agree(if first { output::write_whole(&folder.join("picture.svg"), picture.as_bytes()) } else { Ok(()) })?;
        files.push("picture.svg");
    }
    files.push("summary.json");
    world.agree(if first { folder::complete(folder, &summary) } else { Ok(()) })?;
    drop(output);
    if first {
        println!("{}", output::report(&summary));
        println!("files                {}: {}", folder.display(), files.join(", "));
    }
    Ok(())
}
