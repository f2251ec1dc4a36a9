//! The outputs of a run, one a file.

mod autocorrelation;
mod cell;
mod charts;
mod checkpoint;
mod checksums;
mod configurations;
mod displacements;
mod energy;
mod fields;
mod forces;
mod frames;
mod instant;
mod kept_rows;
pub mod log;
mod pairs;
mod picture;
mod probe;
mod profiles;
mod progress;
mod protocol;
mod report;
mod series;
mod settling;
mod step_table;
mod structure_factor;

use std::path::Path;

use crate::{error::Result, motion::Simulation, output::CurvePoint, parallel::World, run::Output, scene::Scene};
pub use checkpoint::restore;

/// Outputs of a run, in the order in which they write.
pub type Outputs<const D: usize> = Vec<Box<dyn Output<D>>>;

/// The outputs that a scene asks for, in the order in which they write, and the viscosity of the run so far (on the first rank).
///
/// `texts` are what checkpoints hold of the scene. A run without a `simulation` is one instant. Collective.
///
/// # Errors
/// Files of the run so far cannot be read or written.
pub fn outputs<const D: usize>(
    world: &World,
    scene: &Scene,
    folder: &Path,
    texts: Vec<(&'static str, String)>,
    simulation: Option<&Simulation<D>>,
) -> Result<(Outputs<D>, Vec<CurvePoint>)> {
    let path = || folder.to_owned();
    let began = simulation.filter(|simulation| simulation.state().steps > 0).map(|simulation| simulation.state().time);
    let log: Box<dyn Output<D>> = Box::new(log::RunLog::open(world, folder, began, scene.end())?);
    let probe = scene.output.probe.map(|points| Box::new(probe::ProbeFile { folder: path(), points }) as Box<dyn Output<D>>);
    let picture = scene.output.picture.then(|| Box::new(picture::PictureFile { folder: path() }) as Box<dyn Output<D>>);
    let pairs = scene.output.pairs.then(|| Box::new(pairs::PairFiles { folder: path() }) as Box<dyn Output<D>>);
    let structure_factor =
        scene.output.structure_factor.then(|| Box::new(structure_factor::StructureFactorFiles { folder: path() }) as Box<dyn Output<D>>);
    let time = simulation.map_or(0.0, |simulation| simulation.state().time);
    let profiles = match scene.output.profiles.is_empty() {
        true => None,
        false => Some(Box::new(profiles::ProfileFiles::open(world, scene, folder, time)?) as Box<dyn Output<D>>),
    };
    // last, since it shows what the others have written
    let report = scene.output.report.then(|| Box::new(report::ReportFile::new(world, scene, folder)) as Box<dyn Output<D>>);
    let Some(simulation) = simulation else {
        let frame = scene.stores_fields().then(|| Box::new(instant::InstantFrame { folder: path() }) as Box<dyn Output<D>>);
        let all =
            picture.into_iter().chain(frame).chain(probe).chain(pairs).chain(structure_factor).chain(profiles).chain([log]).chain(report);
        return Ok((all.collect(), Vec::new()));
    };
    let (mut all, points) = of_steps(world, scene, folder, texts, simulation)?;
    all.extend(probe);
    if scene.output.picture {
        all.push(Box::new(charts::EffortChart { folder: path() }));
    }
    if scene.gravity.is_some() {
        all.push(Box::new(settling::MeanSettling { folder: path() }));
    }
    let displacements =
        scene.output.displacements.then(|| Box::new(displacements::DisplacementFiles { folder: path() }) as Box<dyn Output<D>>);
    let autocorrelation = scene
        .output
        .velocity_autocorrelation
        .then(|| Box::new(autocorrelation::AutocorrelationFiles { folder: path() }) as Box<dyn Output<D>>);
    all.extend(
        picture
            .into_iter()
            .chain(pairs)
            .chain(structure_factor)
            .chain(displacements)
            .chain(autocorrelation)
            .chain(profiles)
            .chain([log])
            .chain(report),
    );
    Ok((all, points))
}

/// Those that write after every step or so, and the viscosity of the run so far.
fn of_steps<const D: usize>(
    world: &World,
    scene: &Scene,
    folder: &Path,
    texts: Vec<(&'static str, String)>,
    simulation: &Simulation<D>,
) -> Result<(Outputs<D>, Vec<CurvePoint>)> {
    let (series, mut points) = series::SeriesFile::open(world, folder, simulation.state().steps)?;
    if scene.changing_shear().is_some() {
        // a mean over all strains means nothing
        points.clear();
    }
    let mut all: Outputs<D> = vec![
        Box::new(series),
        Box::new(frames::FrameFiles::open(world, scene, folder, simulation)?),
        Box::new(checkpoint::CheckpointFile::new(folder, texts, scene.output.checkpoint)),
        Box::new(charts::ViscosityChart { folder: folder.to_owned() }),
    ];
    if let Some(forces) = forces::ForcesFile::open(world, scene, folder, simulation)? {
        all.push(Box::new(forces));
    }
    if scene.changing_shear().is_some() {
        all.push(Box::new(protocol::ProtocolFiles { folder: folder.to_owned() }));
    }
    if scene.output.energy {
        all.push(Box::new(energy::EnergyFile::open(world, folder, simulation)?));
    }
    Ok((all, points))
}
