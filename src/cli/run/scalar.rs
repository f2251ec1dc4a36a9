//! A scalar around inclusions: solve, write, report.

use std::path::Path;

use super::folder;
use crate::{
    error::Result,
    observe,
    output::{self, Progress, Summary},
    petsc::{Session, Stage, enter},
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
    let output = enter(Stage::Output);
    let mut files = vec!["scene.toml"];
    if let Some(points) = scene.output.probe {
        let probe = observe::scalar_probe(&inclusions, &solution, points)?.csv();
        world.agree(if first { output::write_whole(&folder.join("probe.csv"), probe.as_bytes()) } else { Ok(()) })?;
        files.push("probe.csv");
    }
    if scene.output.picture {
        let picture = observe::scalar_picture(scene.shown_title(), &inclusions, &solution)?.svg();
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
