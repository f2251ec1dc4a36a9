//! `turbid run`: solve, write, report.

use std::path::Path;

use crate::{
    error::{Error, Result},
    observe,
    output::{self, Progress, Summary},
    petsc::Session,
    scene::{Placement, Scene},
    simulation::{Setup, Solution, Suspension},
};

/// Runs a scene of dimension `D`.
#[allow(clippy::print_stdout)]
pub fn run<const D: usize>(session: &Session, scene: &Scene, folder: &Path) -> Result<()> {
    let world = session.world();
    let first = world.rank() == 0;
    let setup = world.agree(Setup::<D>::of(scene))?;
    let mut suspension = Suspension::new(session, setup)?;
    world.agree(if first { output::prepare_folder(folder) } else { Ok(()) })?;

    let progress = Progress::new(world.rank(), scene.method.tolerance);
    let solution = suspension.solve(&mut |iteration, residual| progress.show(iteration, residual));
    progress.end();
    let solution = solution?;

    let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[])?;
    let named = (scene.name.as_str(), scene.title.as_str());
    let summary = Summary::new(named, suspension.setup(), (&solution, viscosity), suspension.cost(), world);
    let files = files(scene, &suspension, &solution, &summary)?;
    let write = || files.iter().try_for_each(|(name, text)| output::write_whole(&folder.join(name), text.as_bytes()));
    world.agree(if first { write() } else { Ok(()) })?;
    if first {
        println!("{}", output::report(&summary));
        let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
        println!("files                {}: {}", folder.display(), names.join(", "));
    }
    Ok(())
}

/// The text of a scene that gives the same scene from any folder.
fn movable_text(scene: &Scene) -> Result<String> {
    let files = scene.bodies.iter().enumerate().filter_map(|(group, bodies)| match &bodies.placement {
        Placement::File(path) => Some((group, path)),
        _ => None,
    });
    let absolute = files.map(|(group, path)| {
        let path = path.canonicalize().map_err(|source| Error::File { path: path.clone(), source })?;
        Ok(format!("bodies.{group}.file={:?}", path.to_string_lossy()))
    });
    Ok(Scene::parse(&scene.name, Path::new("."), &scene.text, &absolute.collect::<Result<Vec<_>>>()?)?.text)
}

/// The files of a run, by name; collective.
fn files<const D: usize>(
    scene: &Scene,
    suspension: &Suspension<D>,
    solution: &Solution<D>,
    summary: &Summary,
) -> Result<Vec<(&'static str, String)>> {
    let json = serde_json::to_string_pretty(summary).expect("a summary is plain numbers and text");
    let mut files = vec![("scene.toml", movable_text(scene)?)];
    if scene.output.picture {
        let title = if scene.title.is_empty() { &scene.name } else { &scene.title };
        files.push(("picture.svg", observe::picture(title, suspension, solution)?.svg()));
    }
    // last: a folder with a summary is complete
    files.push(("summary.json", json));
    Ok(files)
}
