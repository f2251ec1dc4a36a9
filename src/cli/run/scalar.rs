//! A scalar around inclusions: solve, write, report.

use super::folder::RunFolder;
use crate::{
    error::Result,
    grid::Grid,
    observe,
    output::{self, Progress, Summary},
    petsc::{Session, Stage, enter},
    scene::{ConstraintMethod, Scene},
    simulation::{Cost, FittedInclusions, Inclusions, ScalarSetup, ScalarSolution},
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
            write(session, (scene, folder), (inclusions.setup(), inclusions.grid()), (&solution?, ("direct", inclusions.cost())))
        }
        _ => {
            let mut inclusions = Inclusions::new(session, setup)?;
            folder.claim(scene)?;
            let solution = inclusions.solve(&mut seen);
            progress.end();
            write(session, (scene, folder), (inclusions.setup(), inclusions.grid()), (&solution?, ("hypre", inclusions.cost())))
        }
    }
}

/// Writes and reports what was solved.
fn write<const D: usize>(
    session: &Session,
    (scene, folder): (&Scene, &RunFolder),
    problem: (&ScalarSetup<D>, &Grid<D>),
    (solution, solver): (&ScalarSolution<D>, (&'static str, &Cost)),
) -> Result<()> {
    let (world, first) = (session.world(), session.world().rank() == 0);
    let summary = Summary::of_scalar((&scene.name, &scene.title), problem, (solution, solver), world);
    let output = enter(Stage::Output);
    let mut files = vec!["scene.toml"];
    if let Some(points) = scene.output.probe {
        let probe = observe::scalar_probe(problem, solution, points)?.csv();
        world.agree(if first { output::write_whole(&folder.path().join("probe.csv"), probe.as_bytes()) } else { Ok(()) })?;
        files.push("probe.csv");
    }
    if scene.output.picture {
        let picture = observe::scalar_picture(scene.shown_title(), problem, solution)?.svg();
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
