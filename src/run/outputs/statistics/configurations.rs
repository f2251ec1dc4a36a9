//! The configurations that are measured once a run has ended: its frames from a time on, which ranks read in turn, one at a time.

use std::path::Path;

use crate::{
    error::Result,
    geometry::{Axis, Domain, LeesEdwards},
    linalg::ROUNDING,
    observe::Shear,
    output::{FrameFile, MeanViscosity, StoredFrame},
    parallel::World,
    run::{MotionView, View},
};

/// What a rank finds with the two files that say it, names and contents.
type FoundStatistics<S> = Option<(S, [(&'static str, Vec<u8>); 2])>;

/// Part of a run without a steady viscosity that is left out.
const START_UP: f64 = 0.5;

/// The time from which frames of a run until `end` count: where the steady part of its viscosity begins, or else its second half, but for rounding.
/// Collective.
pub fn steady_from<const D: usize>(world: &World, shear: Option<&Shear<D>>, end: f64, mean: Option<&MeanViscosity>) -> f64 {
    let begin = match (shear, mean) {
        (Some(shear), Some(mean)) => mean.strains[0] / shear.rate.abs(),
        _ => START_UP * end,
    };
    // the mean is known to the first rank only
    world.gather(&[begin - ROUNDING * end])[0]
}

/// Frames in the folder of a run from a time on.
pub struct Configurations {
    files: Vec<FrameFile>,
    begin: f64,
}

impl Configurations {
    /// Those in a folder. Local, as is [`visit_own`](Self::visit_own).
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn since(begin: f64, folder: &Path) -> Result<Configurations> {
        Ok(Configurations { files: FrameFile::of_run(folder)?, begin })
    }

    /// How many frames the run has, those of earlier times too.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// Shows the frames that are this rank's to read, each with its number among all of the run, and gives the first time.
    ///
    /// # Errors
    /// A frame cannot be read.
    pub fn visit_own<const D: usize>(&self, world: &World, visit: impl FnMut(usize, StoredFrame<D>)) -> Result<Option<f64>> {
        self.visit(world.rank(), world.size(), visit)
    }

    /// Shows all frames to this rank, one after the other, as [`visit_own`](Self::visit_own) does.
    ///
    /// # Errors
    /// A frame cannot be read.
    pub fn visit_all<const D: usize>(&self, mut visit: impl FnMut(StoredFrame<D>)) -> Result<Option<f64>> {
        self.visit(0, 1, |_, frame| visit(frame))
    }

    fn visit<const D: usize>(&self, start: usize, stride: usize, mut visit: impl FnMut(usize, StoredFrame<D>)) -> Result<Option<f64>> {
        let mut first = None;
        for (number, file) in self.files.iter().enumerate().skip(start).step_by(stride) {
            if file.time()? >= self.begin {
                let frame = file.read::<D>()?;
                first.get_or_insert(frame.time);
                visit(number, frame);
            }
        }
        Ok(first)
    }
}

/// What the first rank finds in the frames of the steady part of a run, for measurements that take frames in turn, and the files of these `names` that it
/// wrote; nothing where it finds nothing. Collective.
///
/// # Errors
/// A frame cannot be read, or a file written.
pub fn measured_by_first_rank<const D: usize, S>(
    view: &View<D>,
    motion: &MotionView<D>,
    folder: &Path,
    names: [&'static str; 2],
    measure: impl FnOnce(&Configurations) -> Result<FoundStatistics<S>>,
) -> Result<(Option<S>, Vec<String>)> {
    let begin = steady_from(view.world, view.shear().as_ref(), motion.state().time, view.history.mean());
    let found = view.world.on_first_rank(|| measure(&Configurations::since(begin, folder)?))?;
    if view.world.max(f64::from(found.is_some())) == 0.0 {
        return Ok((None, Vec::new()));
    }
    let (of_run, files) = found.unzip();
    let files = files.unwrap_or_else(|| names.map(|name| (name, Vec::new())));
    let written: Result<Vec<String>> = files.iter().map(|(name, bytes)| view.write_file(folder, name, bytes)).collect();
    Ok((of_run, written?))
}

/// The first of the times that ranks have found; infinite without any. Collective.
pub fn first_time(world: &World, own: Option<f64>) -> f64 {
    -world.max(own.map_or(f64::NEG_INFINITY, |first| -first))
}

/// The box as it was when a frame was written: of a shear whose rate a stress has found, the box itself knows the last rate only.
pub fn box_of<const D: usize>(domain: &Domain<D>, frame: &StoredFrame<D>) -> Domain<D> {
    let mut domain = domain.clone().at(frame.time);
    if let (Axis::Sheared(slide), Some(offset)) = (&mut domain.axes[1], frame.offset) {
        *slide = LeesEdwards::steady(offset - slide.speed() * frame.time, slide.speed(), frame.time);
    }
    domain
}
