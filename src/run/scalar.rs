//! A scalar around inclusions: solve, write, report.

use super::{finished::Finished, folder::RunFolder, options::Options};
use crate::{
    error::Result,
    grid::Grid,
    observe,
    output::{self, Progress, Summary},
    parallel::World,
    petsc::{Session, Stage, enter},
    scene::{ConstraintMethod, Scene},
    simulation::{Cost, FittedInclusions, Inclusions, ScalarSetup, ScalarSolution},
};

/// What was solved, and what it took.
struct Solved<'a, const D: usize> {
    setup: &'a ScalarSetup<D>,
    grid: &'a Grid<D>,
    solution: &'a ScalarSolution<D>,
    inverse: &'static str,
    cost: &'a Cost,
}

/// Solves a scalar scene of dimension `D`; without a folder it leaves nothing behind. Collective.
///
/// # Errors
/// The scene does not fit, the solve fails, or a file cannot be written.
pub fn run<const D: usize>(session: &Session, scene: &Scene, mut folder: Option<RunFolder>, options: Options) -> Result<Finished> {
    let world = session.world();
    let setup = world.agree(ScalarSetup::<D>::of(scene))?;
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
            write(world, scene, folder, &Solved { setup, grid, solution, inverse: "direct", cost })
        }
        _ => {
            let mut inclusions = Inclusions::new(session, setup)?;
            claim()?;
            let solution = &inclusions.solve(&mut seen)?;
            drop(progress);
            let (setup, grid, cost) = (inclusions.setup(), inclusions.grid(), inclusions.cost());
            write(world, scene, folder, &Solved { setup, grid, solution, inverse: "hypre", cost })
        }
    }
}

/// Writes what was solved.
fn write<const D: usize>(world: &World, scene: &Scene, folder: Option<RunFolder>, solved: &Solved<D>) -> Result<Finished> {
    let problem = (solved.setup, solved.grid);
    let summary = Summary::of_scalar(scene, problem, (solved.solution, (solved.inverse, solved.cost)), world);
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
            write("probe.csv", observe::scalar_probe(problem, solved.solution, points)?.csv())?;
        }
        if scene.output.picture {
            write("picture.svg", observe::scalar_picture(scene.shown_title(), problem, solved.solution)?.svg())?;
        }
        files.push(folder.complete(&summary)?);
    }
    Ok(Finished { summary, curve: Vec::new(), folder: folder.map(|folder| folder.path().to_owned()), files })
}
