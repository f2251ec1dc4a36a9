//! A scalar around inclusions: solve, write, report.

use super::{finished::Finished, folder::RunFolder, options::Options};
use crate::{
    error::Result,
    observe,
    output::{self, Progress, Summary},
    parallel::World,
    petsc::{Session, Stage, enter},
    scene::{ConstraintMethod, Scene},
    simulation::{FittedInclusions, Inclusions, ScalarSetup, SolvedScalar},
};

/// Solves a scalar scene of dimension `D`; without a folder it leaves nothing behind. Collective.
///
/// # Errors
/// The scene does not fit, the solve fails, or a file cannot be written.
pub fn run<const D: usize>(session: &Session, scene: &Scene, mut folder: Option<RunFolder>, options: Options) -> Result<Finished> {
    let world = session.world();
    let setup = world.agree(ScalarSetup::<D>::on(world.into(), scene))?;
    let progress = options.progress.then(|| Progress::new(world.rank(), scene.method.tolerance.at_an_instant()));
    let mut seen = |iteration, residual| progress.iter().for_each(|line| line.show(iteration, residual));
    let mut claim = || folder.as_mut().map_or(Ok(()), |folder| folder.claim(scene));
    match scene.method.constraint {
        ConstraintMethod::Fitted => {
            let mut inclusions = FittedInclusions::new(session, setup)?;
            claim()?;
            let solution = &inclusions.solve(&mut seen)?;
            drop(progress);
            let (setup, grid, cost) = (inclusions.setup(), inclusions.grid(), inclusions.cost());
            write(world, scene, folder, &SolvedScalar { setup, grid, solution, inverse: "direct", cost })
        }
        _ => {
            let mut inclusions = Inclusions::new(session, setup)?;
            claim()?;
            let solution = &inclusions.solve(&mut seen)?;
            drop(progress);
            let (setup, grid, cost) = (inclusions.setup(), inclusions.grid(), inclusions.cost());
            write(world, scene, folder, &SolvedScalar { setup, grid, solution, inverse: "hypre", cost })
        }
    }
}

/// Writes what was solved.
fn write<const D: usize>(world: &World, scene: &Scene, folder: Option<RunFolder>, solved: &SolvedScalar<D>) -> Result<Finished> {
    let summary = Summary::of_scalar(scene, solved, world);
    let _stage = enter(Stage::Output);
    let mut files = Vec::new();
    if let Some(folder) = &folder {
        files.push("scene.toml".to_owned());
        let mut write = |name: &str, text: String| {
            files.push(name.to_owned());
            let path = folder.path().join(name);
            world.on_first_rank(|| output::write_whole(&path, text.as_bytes()))
        };
        if let Some(points) = scene.output.probe {
            write("probe.csv", observe::scalar_probe(solved.setup, solved.grid, solved.solution, points)?.csv())?;
        }
        if scene.output.picture {
            write("picture.svg", observe::scalar_picture(scene, solved)?.svg())?;
        }
        files.push(folder.complete(&summary)?);
    }
    Ok(Finished { summary, curve: Vec::new(), folder: folder.map(|folder| folder.path().to_owned()), files })
}
