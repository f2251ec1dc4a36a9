//! A scalar around inclusions: solve, write, report.

use super::{finished::Finished, folder::RunFolder, options::Options, outputs::log::RunLog, page::PageOfRun, progress::Progress};
use crate::{
    error::Result,
    mechanics::{FittedInclusions, Inclusions, ScalarSetup, SolvedScalar},
    observe,
    output::{self, LOG, REPORT, Summary},
    parallel::World,
    petsc::{Session, Stage, enter},
    scene::{ConstraintMethod, Scene},
};

/// Solves a scalar scene of dimension `D`; without a folder it leaves nothing behind. Collective.
///
/// # Errors
/// The scene does not fit, the solve fails, or a file cannot be written.
pub fn run<const D: usize>(session: &Session, scene: &Scene, mut folder: Option<RunFolder>, options: Options) -> Result<Finished> {
    let world = session.world();
    let setup = world.agree(ScalarSetup::<D>::on(world.into(), scene))?;
    let progress = options.progress.then(|| Progress::new(world.rank(), scene.method.tolerance.at_an_instant()));
    let mut monitor = |iteration, residual| progress.iter().for_each(|line| line.show(iteration, residual));
    let mut claim = || folder.as_mut().map(|folder| begin(world, scene, folder)).transpose();
    match scene.method.constraint {
        ConstraintMethod::Fitted => {
            let mut inclusions = FittedInclusions::new(session, setup)?;
            let notes = claim()?;
            let solution = &inclusions.solve(&mut monitor)?;
            drop(progress);
            let (setup, grid, cost) = (inclusions.setup(), inclusions.grid(), inclusions.cost());
            write(world, scene, notes, folder, &SolvedScalar { setup, grid, solution, inverse: "direct", cost })
        }
        _ => {
            let mut inclusions = Inclusions::new(session, setup)?;
            let notes = claim()?;
            let solution = &inclusions.solve(&mut monitor)?;
            drop(progress);
            let (setup, grid, cost) = (inclusions.setup(), inclusions.grid(), inclusions.cost());
            write(world, scene, notes, folder, &SolvedScalar { setup, grid, solution, inverse: "hypre", cost })
        }
    }
}

/// What is noted of a run with a folder from its start on: its log, and its page on the first rank.
struct Notes {
    log: RunLog,
    page: Option<PageOfRun>,
}

fn begin(world: &World, scene: &Scene, folder: &mut RunFolder) -> Result<Notes> {
    folder.claim(scene)?;
    let page = (world.rank() == 0 && scene.output.report).then(|| PageOfRun::new(scene, folder.path(), world.size()));
    Ok(Notes { log: RunLog::open(world, folder.path(), None, 0.0)?, page })
}

/// Writes what was solved.
fn write<const D: usize>(
    world: &World,
    scene: &Scene,
    notes: Option<Notes>,
    folder: Option<RunFolder>,
    solved: &SolvedScalar<D>,
) -> Result<Finished> {
    let mut summary = Summary::of_scalar(scene, solved, world);
    let _stage = enter(Stage::Output);
    let mut files = Vec::new();
    if let (Some(folder), Some(mut notes)) = (&folder, notes) {
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
            summary.measure_memory(world);
        }
        notes.log.end("ended");
        files.push(LOG.to_owned());
        if scene.output.report {
            let html = notes.page.map_or(String::new(), |page| page.ended(&summary, None).html());
            world.on_first_rank(|| output::write_whole(&folder.path().join(REPORT), html.as_bytes()))?;
            files.push(REPORT.to_owned());
        }
        files.extend(folder.complete(&summary)?);
    }
    Ok(Finished { summary, curve: Vec::new(), folder: folder.map(|folder| folder.path().to_owned()), files })
}
