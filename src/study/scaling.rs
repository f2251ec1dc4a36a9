//! Strong and weak scaling of a scene, measured on this machine, with a model that goes on to more ranks.
//!
//! Each rank count is a run of its own, started by a launcher; what it cost is read from its summary. A scene in time is
//! timed by the step, over as many as it has. *Strong*: the same scene on more ranks. *Weak*: as many times the bodies in
//! as many times the volume as there are ranks, along the periodic axes of the box.

mod arrangement;
mod growth;
mod measurement;
mod model;
mod report;
mod table;

use std::path::PathBuf;

use self::{
    arrangement::{Arrangement, Shares},
    growth::{copies, write_grown},
    measurement::Measurement,
    model::{Model, Sample},
    report::Report,
    table::{Row, Table},
};
use super::launcher::{Job, Launcher, Scratch, WITHOUT_PICTURE};
use crate::{
    error::{Error, Result},
    output::{FolderLock, prepare_folder, say, write_whole},
    scene::Scene,
};

pub use model::Network;

/// Most ranks that the model speaks of.
const MOST_RANKS: usize = 4096;

/// Most ranks that a run is started on.
const MOST_STARTED: usize = 65_536;

/// What to measure, and how.
#[derive(Debug, Clone)]
pub struct ScalingOptions {
    /// Scene file.
    pub scene: PathBuf,
    /// What is set in it.
    pub overrides: Vec<String>,
    /// Rank counts.
    pub ranks: Vec<usize>,
    /// Command line that starts a run, with `{ranks}` in it.
    pub launcher: String,
    /// Runs of each, of which the fastest counts.
    pub repeat: usize,
    /// Folder for tables and chart, `out/NAME-scaling` if there is none.
    pub out: Option<PathBuf>,
    /// Cores that the launcher reaches, those of this machine if nothing is said.
    pub cores: Option<usize>,
    /// Network that the model assumes.
    pub network: Network,
    /// Options for PETSc.
    pub petsc: Vec<String>,
}

/// Measures, fits, prints the tables and writes them; to be called outside of MPI.
///
/// # Errors
/// The scene, the ranks or the launcher cannot be used, or a run fails.
pub fn scaling(options: &ScalingOptions) -> Result<()> {
    let scene = Scene::read(&options.scene, &options.overrides)?;
    if scene.dry() {
        let remedy = "scaling measures the solver of the fluid, and a dry scene has none; choose a scene with a flow";
        return Err(scene.refuse("flow.model", "\"none\"", remedy));
    }
    if scene.scalar() {
        return Err(scene.refuse("flow.model", "\"scalar\"", "scaling measures the solver of the fluid; choose a scene with a flow"));
    }
    match scene.dimension() {
        2 => Study::<2>::new(options, scene)?.report(),
        _ => Study::<3>::new(options, scene)?.report(),
    }
}

/// A scaling study of a scene of dimension `D`.
struct Study<'a, const D: usize> {
    options: &'a ScalingOptions,
    scene: Scene,
    ranks: Vec<usize>,
    cores: usize,
    launcher: Launcher,
    arrangement: Arrangement<D>,
    folder: PathBuf,
    scratch: Scratch,
    _lock: FolderLock,
}

/// Whether the scene grows with the ranks.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Strong,
    Weak,
}

impl<'a, const D: usize> Study<'a, D> {
    fn new(options: &'a ScalingOptions, scene: Scene) -> Result<Study<'a, D>> {
        let ranks = rank_counts(&options.ranks)?;
        let launcher = Launcher::new(&options.launcher, &options.petsc)?;
        let arrangement = Arrangement::of(&scene)?;
        let folder = options.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{}-scaling", scene.name)));
        prepare_folder(&folder)?;
        let lock = FolderLock::take(&folder)?;
        let scratch = Scratch::within(&folder)?;
        let cores = options.cores.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        Ok(Study { options, scene, ranks, cores, launcher, arrangement, folder, scratch, _lock: lock })
    }

    fn report(&self) -> Result<()> {
        let strong = self.measure(Kind::Strong)?;
        let (weak, weak_refusal) = match copies::<D>(&self.scene, 2) {
            Ok(_) => (Some(self.measure(Kind::Weak)?), None),
            Err(reason) => (None, Some(reason.to_string())),
        };
        let both = strong.iter().chain(weak.iter().flatten());
        let samples: Vec<Sample> = both.filter_map(|(_, sample)| sample.as_ref().ok().cloned()).collect();
        let model = Model::fit(&samples, self.cores, self.options.network);
        let report = Report {
            scene: self.scene.shown_title().to_owned(),
            steps: self.scene.time.is_some(),
            launcher: self.options.launcher.clone(),
            repeat: self.options.repeat,
            cores: self.cores,
            strong: self.table(&strong, model.as_ref(), Kind::Strong),
            weak: weak.map(|weak| self.table(&weak, model.as_ref(), Kind::Weak)),
            weak_refusal,
            network: self.options.network,
            model,
        };
        for (name, text) in report.files() {
            write_whole(&self.folder.join(name), text.as_bytes())?;
        }
        say(&format!("{}\n\nfiles: {}: scaling.json, scaling.csv, scaling.svg", report.markdown(), self.folder.display()))
    }

    /// A run for each rank count, or why there is none.
    fn measure(&self, kind: Kind) -> Result<Vec<(usize, Result<Sample>)>> {
        let mut samples = Vec::new();
        for &ranks in &self.ranks {
            let shares = self.arrangement(kind, ranks).and_then(|arrangement| arrangement.shares(ranks));
            let sample = match shares {
                Ok(shares) => Ok(Sample { shares, measured: self.run(kind, ranks)? }),
                Err(reason) => Err(reason),
            };
            samples.push((ranks, sample));
        }
        Ok(samples)
    }

    /// Shares on any number of ranks. Copies of a cell share out evenly, bodies placed anew do not: as unevenly as in a measured run.
    fn expected_shares(&self, kind: Kind, ranks: usize, like: &Measurement) -> Result<Shares> {
        let mut shares = self.arrangement(kind, ranks)?.shares(ranks)?;
        if kind == Kind::Weak && ranks > 1 {
            shares.bodies.most = shares.bodies.most.max(shares.bodies.mean * like.parallel.bodies.imbalance());
        }
        Ok(shares)
    }

    fn arrangement(&self, kind: Kind, ranks: usize) -> Result<Arrangement<D>> {
        match kind {
            Kind::Strong => Ok(self.arrangement.clone()),
            Kind::Weak => Ok(self.arrangement.repeated(copies(&self.scene, ranks)?)),
        }
    }

    fn run(&self, kind: Kind, ranks: usize) -> Result<Measurement> {
        let out = self.scratch.0.join("out");
        let (grown, overrides): (PathBuf, &[String]) = match kind {
            Kind::Weak if ranks > 1 => (write_grown(&self.scene, copies::<D>(&self.scene, ranks)?, &self.scratch.0)?, &[]),
            _ => (self.options.scene.clone(), &self.options.overrides),
        };
        let overrides = [overrides, &[WITHOUT_PICTURE.to_owned()]].concat();
        let job = Job { scene: &grown, overrides: &overrides, folder: &out };
        self.launcher.measure((ranks, self.options.repeat), &job, Measurement::read, Measurement::seconds)
    }

    fn table(&self, samples: &[(usize, Result<Sample>)], model: Option<&Model>, kind: Kind) -> Table {
        let measured: Vec<Row> =
            samples.iter().map(|(ranks, sample)| Row::measured(*ranks, *ranks > self.cores, sample.as_ref())).collect();
        let last = samples.iter().rev().find_map(|(_, sample)| sample.as_ref().ok());
        let model = model.zip(last).map_or(Vec::new(), |(model, last)| {
            let powers = (0..).map(|power| 1 << power).take_while(|&ranks| ranks <= MOST_RANKS);
            let shares = |ranks| self.expected_shares(kind, ranks, &last.measured);
            let rows = powers.map(|ranks| Row::predicted(ranks, model, &last.measured, shares(ranks).as_ref()));
            up_to_the_first(rows, Row::absent)
        });
        Table::new(measured, model, kind == Kind::Weak)
    }
}

/// The items of a sequence, of which the first that is the `last` one ends it.
fn up_to_the_first<T>(items: impl Iterator<Item = T>, last: impl Fn(&T) -> bool) -> Vec<T> {
    let mut taken = Vec::new();
    for item in items {
        let over = last(&item);
        taken.push(item);
        if over {
            break;
        }
    }
    taken
}

/// In rising order, each once.
fn rank_counts(ranks: &[usize]) -> Result<Vec<usize>> {
    let mut ranks = ranks.to_vec();
    ranks.sort_unstable();
    ranks.dedup();
    if ranks.is_empty() || ranks[0] == 0 {
        return Err(Error::refused("--ranks: must be numbers from 1 up, for example --ranks 1,2,4"));
    }
    if let Some(many) = ranks.last().filter(|&&ranks| ranks > MOST_STARTED) {
        return Err(Error::refused(format!("--ranks {many}: must be at most {MOST_STARTED}; more are only modelled")));
    }
    Ok(ranks)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn rank_counts_rise_and_start_at_one_or_more() {
        assert_eq!(rank_counts(&[4, 1, 4, 2]).unwrap(), [1, 2, 4]);
        assert!(rank_counts(&[]).is_err() && rank_counts(&[0, 2]).is_err() && rank_counts(&[1, 1_000_000_000]).is_err());
    }
}
