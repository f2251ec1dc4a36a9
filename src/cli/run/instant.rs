//! An instantaneous solve: solve, write, report.

use super::{
    calibration::Calibrated,
    folder::RunFolder,
    pairs::{self, Crowd},
};
use crate::{
    error::Result,
    geometry::Ball,
    observe,
    output::{self, Progress, Summary},
    petsc::{Session, Stage, enter},
    scene::Scene,
    simulation::{FlowSolver, Setup, Solution, flow_solver},
};

/// Solves a scene of dimension `D` with the bodies where they start, at the resolution that `resolved` has.
pub fn run<const D: usize>(
    session: &Session,
    (scene, resolved): (&Scene, &Scene),
    folder: &mut RunFolder,
    calibrated: Option<&Calibrated>,
) -> Result<()> {
    let world = session.world();
    let setup = world.agree(Setup::<D>::of(resolved))?;
    let mut suspension = flow_solver(session, setup)?;
    folder.claim(scene)?;

    let progress = Progress::new(world.rank(), resolved.method.tolerance.at_an_instant());
    let solution = suspension.solve(&mut |iteration, residual| progress.show(iteration, residual));
    progress.end();
    write(session, scene, folder, ((suspension.as_ref(), &solution?), calibrated))
}

/// Writes and reports what was solved.
pub fn write<const D: usize>(
    session: &Session,
    scene: &Scene,
    folder: &RunFolder,
    ((suspension, solution), calibrated): ((&dyn FlowSolver<D>, &Solution<D>), Option<&Calibrated>),
) -> Result<()> {
    let (world, first) = (session.world(), session.world().rank() == 0);
    let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), solution, &[])?;
    let mut summary = Summary::of_flow((&scene.name, &scene.title), suspension, (solution, viscosity), world)?;
    let mut files = vec!["scene.toml"];
    if let Some(calibrated) = calibrated {
        calibrated.attach(&mut summary, (suspension, solution))?;
        files.push("calibration.json");
    }
    let output = enter(Stage::Output);
    if scene.output.picture {
        let picture = observe::picture(scene.shown_title(), suspension, solution)?.svg();
        world.agree(if first { output::write_whole(&folder.path().join("picture.svg"), picture.as_bytes()) } else { Ok(()) })?;
        files.push("picture.svg");
    }
    if let Some(points) = scene.output.probe {
        let probe = observe::velocity_probe(suspension, solution, points)?.csv();
        world.agree(if first { output::write_whole(&folder.path().join("probe.csv"), probe.as_bytes()) } else { Ok(()) })?;
        files.push("probe.csv");
    }
    if scene.output.pairs {
        let setup = suspension.setup();
        let balls: Vec<Ball<D>> = setup.bodies.iter().map(|suspended| suspended.body.ball).collect();
        let radii: Vec<f64> = balls.iter().map(|ball| ball.radius).collect();
        let crowd = Crowd { domain: &setup.domain, radii: &radii, shear: observe::Shear::of(&setup.domain, &setup.drive) };
        if let Some(pairs) = pairs::at_an_instant(crowd, &balls) {
            let write = || pairs.files.iter().try_for_each(|(name, bytes)| output::write_whole(&folder.path().join(name), bytes));
            world.agree(if first { write() } else { Ok(()) })?;
            files.extend(pairs.files.iter().map(|(name, _)| *name));
            summary.pairs = Some(pairs.summary);
        }
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
