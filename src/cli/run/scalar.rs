//! A scalar around inclusions: solve, write, report.

use super::folder::RunFolder;
use crate::{
    error::Result,
    observe,
    output::{self, Progress, Summary},
    petsc::{Session, Stage, enter},
    scene::{ConstraintMethod, Scene},
    simulation::{FittedInclusions, Inclusions, ScalarSetup, SolvedScalar},
};

/// Solves a scalar scene of dimension `D`.
pub fn run<const D: usize>(session: &Session, scene: &Scene, folder: &mut RunFolder) -> Result<()> {
    let world = session.world();
    let setup = world.agree(ScalarSetup::<D>::of(scene))?;
    let progress = Progress::new(world.rank(), scene.method.tolerance.at_an_instant());
    let mut seen = |iteration, residual| progress.show(iteration, residual);
    match scene.method.constraint {
        ConstraintMethod::Fitted => {
            let mut inclusions = FittedInclusions::new(session, setup)?;
            folder.claim(scene)?;
            let solution = inclusions.solve(&mut seen);
            progress.end();
            let (setup, grid, cost) = (inclusions.setup(), inclusions.grid(), inclusions.cost());
            write(session, scene, folder, &SolvedScalar { setup, grid, solution: &solution?, inverse: "direct", cost })
        }
        _ => {
            let mut inclusions = Inclusions::new(session, setup)?;
            folder.claim(scene)?;
            let solution = inclusions.solve(&mut seen);
            progress.end();
            let (setup, grid, cost) = (inclusions.setup(), inclusions.grid(), inclusions.cost());
            write(session, scene, folder, &SolvedScalar { setup, grid, solution: &solution?, inverse: "hypre", cost })
        }
    }
}

/// Writes and reports what was solved.
fn write<const D: usize>(session: &Session, scene: &Scene, folder: &RunFolder, solved: &SolvedScalar<D>) -> Result<()> {
    let (world, first) = (session.world(), session.world().rank() == 0);
    let summary = Summary::of_scalar(&scene.name, &scene.title, solved, world);
    let output = enter(Stage::Output);
    let mut files = vec!["scene.toml"];
    if let Some(points) = scene.output.probe {
        let probe = observe::scalar_probe((solved.setup, solved.grid), solved.solution, points)?.csv();
        world.agree(if first { output::write_whole(&folder.path().join("probe.csv"), probe.as_bytes()) } else { Ok(()) })?;
        files.push("probe.csv");
    }
    if scene.output.picture {
        let picture = observe::scalar_picture(scene.shown_title(), solved)?.svg();
        world.agree(if first { output::write_whole(&folder.path().join("picture.svg"), picture.as_bytes()) } else { Ok(()) })?;
        files.push("picture.svg");
    }
    files.push("summary.json");
    folder.complete(&summary)?;
    drop(output);
    if first {
        output::say(&output::report(&summary))?;
        output::say(&format!("files                {}: {}", folder.path().display(), files.join(", ")))?;
    }
    Ok(())
}
