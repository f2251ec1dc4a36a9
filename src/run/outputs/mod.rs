//! The outputs of a run, one a file.

mod cell;
mod charts;
mod checkpoint;
mod checksums;
mod context;
mod energy;
mod fields;
mod forces;
mod frames;
mod instant;
mod kept_rows;
pub mod log;
mod objects;
mod picture;
mod probe;
mod protocol;
mod report;
mod series;
mod settling;
mod statistics;
mod step_table;

use std::path::Path;

use crate::{
    dimension::{same, same_ref},
    error::Result,
    motion::Simulation,
    output::CurvePoint,
    parallel::World,
    run::Output,
    scene::Scene,
};
pub use checkpoint::restore;
use context::{Context, Wanted, boxed};
use statistics::{autocorrelation, displacements, pairs, profiles, structure_factor};

/// Outputs of a run, in the order in which they write.
pub type Outputs<const D: usize> = Vec<Box<dyn Output<D>>>;

/// What checkpoints hold of a scene, by names.
type Texts = Vec<(&'static str, String)>;

/// Outputs that are open, and the viscosity of the run so far.
type Opened<const D: usize> = Result<(Outputs<D>, Vec<CurvePoint>)>;

/// Opens an output if a scene calls for it.
type Open<const D: usize> = fn(&Context<D>) -> Wanted<D>;

/// The outputs of an instant, in the order in which they write.
fn at_an_instant<const D: usize>() -> [Open<D>; 6] {
    [picture::wanted, instant::wanted, probe::wanted, pairs::wanted, structure_factor::wanted, profiles::wanted]
}

/// The outputs of a run in time after its series, in the order in which they write.
fn in_time<const D: usize>() -> [Open<D>; 18] {
    [
        frames::wanted,
        checkpoint::wanted,
        charts::viscosity,
        forces::wanted,
        protocol::wanted,
        energy::wanted,
        objects::chains::wanted,
        objects::cells::wanted,
        objects::clusters::wanted,
        probe::wanted,
        charts::effort,
        settling::wanted,
        picture::wanted,
        pairs::wanted,
        structure_factor::wanted,
        displacements::wanted,
        autocorrelation::wanted,
        profiles::wanted,
    ]
}

/// The outputs that a scene asks for, in the order in which they write, and the viscosity of the run so far (on the first rank).
///
/// `texts` are what checkpoints hold of the scene. A run without a `simulation` is one instant. Collective.
///
/// # Errors
/// Files of the run so far cannot be read or written.
pub fn outputs<const D: usize>(world: &World, scene: &Scene, folder: &Path, texts: Texts, simulation: Option<&Simulation<D>>) -> Opened<D> {
    match D {
        2 => same(in_plane(world, scene, folder, texts, simulation.map(same_ref))),
        _ => same(in_space(world, scene, folder, texts, simulation.map(same_ref))),
    }
}

fn in_plane(world: &World, scene: &Scene, folder: &Path, texts: Texts, simulation: Option<&Simulation<2>>) -> Opened<2> {
    open(world, scene, folder, texts, simulation)
}

fn in_space(world: &World, scene: &Scene, folder: &Path, texts: Texts, simulation: Option<&Simulation<3>>) -> Opened<3> {
    open(world, scene, folder, texts, simulation)
}

fn open<const D: usize>(world: &World, scene: &Scene, folder: &Path, texts: Texts, simulation: Option<&Simulation<D>>) -> Opened<D> {
    let context = Context { world, scene, folder, texts: &texts, simulation };
    let began = simulation.filter(|simulation| simulation.state().steps > 0).map(|simulation| simulation.state().time);
    let log = log::RunLog::open(world, folder, began, scene.end())?;
    let (mut all, mut points): (Outputs<D>, _) = (Vec::new(), Vec::new());
    if let Some(simulation) = simulation {
        let (series, so_far) = series::SeriesFile::open(world, folder, simulation.state().steps)?;
        all.push(boxed(series));
        // a mean over all strains means nothing where the rate changes
        points = if scene.changing_shear().is_some() { Vec::new() } else { so_far };
    }
    let list = if simulation.is_some() { in_time().to_vec() } else { at_an_instant().to_vec() };
    for open in list {
        all.extend(open(&context)?);
    }
    all.push(boxed(log));
    // last, since it shows what the others have written
    all.extend(report::wanted(&context)?);
    Ok((all, points))
}
