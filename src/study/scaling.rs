//! Strong and weak scaling of a scene, measured on this machine, with a model that goes on to more ranks.
//!
//! Each rank count is a run of its own, started by a launcher; what it cost is read from its summary. A scene in time is
//! timed by the step, over as many as it has. *Strong*: the same scene on more ranks. *Weak*: as many times the bodies in
//! as many times the volume as there are ranks, along the periodic axes of the box.

mod check;
mod enlarge;
mod kind;
mod measurement;
mod model;
mod report;
mod table;
mod workload;

use std::path::PathBuf;

use self::{
    check::checks,
    enlarge::{copies, write_enlarged},
    kind::ScalingKind,
    measurement::Measurement,
    model::{Network, Sample, ScalingModel},
    report::ScalingReport,
    table::{RunRow, ScalingTable},
    workload::{RankShares, Workload},
};
use super::command::{PetscOptions, SceneArguments, Study, positive};
use crate::{
    error::{Error, Result},
    experiment::{
        arguments::Start,
        folder::StudyFolder,
        launcher::{Job, Launcher, StartArguments, WITHOUT_PICTURE},
    },
    output::say,
    scene::Scene,
};

/// Most ranks that the model speaks of.
const MOST_RANKS: usize = 4096;

/// Most ranks that a run is started on.
const MOST_STARTED: usize = 65_536;

/// What to measure, and how.
#[derive(Debug, Clone, clap::Args)]
pub struct Scaling {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Numbers of ranks.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2])]
    pub ranks: Vec<usize>,
    /// How runs are started.
    #[command(flatten)]
    pub start: StartArguments,
    /// Folder for tables and chart (default: out/NAME-scaling of the scene).
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Cores that the launcher reaches (default: those of this machine); more ranks than these are marked.
    #[arg(long)]
    pub cores: Option<usize>,
    /// Model: gigabytes a second that a rank sends.
    #[arg(long, default_value_t = 5.0, value_parser = positive)]
    pub bandwidth: f64,
    /// Model: microseconds that a message takes.
    #[arg(long, default_value_t = 2.0, value_parser = positive)]
    pub latency: f64,
}

impl Study<PetscOptions> for Scaling {
    const NAME: &'static str = "scaling";
    const ABOUT: &'static str =
        "Seconds, shares and traffic of a scene on several numbers of ranks, with a model of more; starts the ranks itself";

    fn run(&self, petsc: &PetscOptions) -> Result<()> {
        let scene = Scene::read(&self.scene.scene, &self.scene.overrides)?;
        if scene.scalar() {
            let remedy = "scaling measures flows and dry runs; choose a scene with \"stokes\" or \"none\"";
            return Err(scene.refuse("flow.model", "\"scalar\"", remedy));
        }
        match scene.dimension() {
            2 => Measuring::<2>::new(self, petsc, scene)?.report(),
            _ => Measuring::<3>::new(self, petsc, scene)?.report(),
        }
    }
}

/// A scaling study of a scene of dimension `D`.
struct Measuring<'a, const D: usize> {
    options: &'a Scaling,
    scene: Scene,
    ranks: Vec<usize>,
    cores: usize,
    launcher: Launcher,
    workload: Workload<D>,
    folder: StudyFolder,
}

impl<'a, const D: usize> Measuring<'a, D> {
    fn new(options: &'a Scaling, petsc: &PetscOptions, scene: Scene) -> Result<Measuring<'a, D>> {
        let ranks = rank_counts(&options.ranks)?;
        let launcher = Launcher::new(&Start { launcher: &options.start.launcher, petsc, ranks: 1 })?;
        let workload = Workload::of(&scene)?;
        let folder = StudyFolder::take(options.out.clone().unwrap_or_else(|| format!("out/{}-scaling", scene.name).into()))?;
        let cores = options.cores.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        Ok(Measuring { options, scene, ranks, cores, launcher, workload, folder })
    }

    fn report(&self) -> Result<()> {
        let strong = self.measure(ScalingKind::Strong, &[])?;
        let (weak, weak_refusal) = match copies::<D>(&self.scene, 2) {
            Ok(_) => (Some(self.measure(ScalingKind::Weak, &strong)?), None),
            Err(reason) => (None, Some(reason.to_string())),
        };
        // on one rank both are the same run
        let grown = weak.iter().flatten().filter(|(ranks, _)| *ranks > 1).map(|run| (ScalingKind::Weak, run));
        let both = strong.iter().map(|run| (ScalingKind::Strong, run)).chain(grown);
        let runs: Vec<(ScalingKind, &Sample)> = both.filter_map(|(kind, (_, sample))| Some((kind, sample.as_ref().ok()?))).collect();
        let network = Network { bandwidth: self.options.bandwidth * 1e9, latency: self.options.latency * 1e-6 };
        let model = ScalingModel::fit(runs.iter().map(|(_, sample)| *sample), self.cores, network);
        let checks = checks(&runs, self.cores, network);
        let report = ScalingReport {
            scene: self.scene.shown_title().to_owned(),
            steps: self.scene.time.is_some(),
            launcher: self.options.start.launcher.clone(),
            repeat: self.options.start.repeat,
            cores: self.cores,
            strong: self.table(&strong, model.as_ref(), ScalingKind::Strong),
            weak: weak.map(|weak| self.table(&weak, model.as_ref(), ScalingKind::Weak)),
            weak_refusal,
            network,
            model,
            checks,
        };
        self.folder.write(&report.files())?;
        say(&format!("{}\n\nfiles: {}: scaling.json, scaling.csv, scaling.svg", report.markdown(), self.folder.path.display()))
    }

    /// A run for each rank count, or why there is none; that on one rank may be `known`.
    fn measure(&self, kind: ScalingKind, known: &[(usize, Result<Sample>)]) -> Result<Vec<(usize, Result<Sample>)>> {
        let mut samples = Vec::new();
        for &ranks in &self.ranks {
            if let (1, Some((1, Ok(sample)))) = (ranks, known.first()) {
                samples.push((ranks, Ok(sample.clone())));
                continue;
            }
            let shares = self.workload(kind, ranks).and_then(|workload| workload.shares(ranks));
            let sample = match shares {
                Ok(shares) => Ok(Sample { shares, measured: self.run(kind, ranks)? }),
                Err(reason) => Err(reason),
            };
            samples.push((ranks, sample));
        }
        Ok(samples)
    }

    /// Shares on any number of ranks. Copies of a cell share out evenly, bodies placed anew do not: as unevenly as in a measured run.
    fn expected_shares(&self, kind: ScalingKind, ranks: usize, like: &Sample) -> Result<RankShares> {
        let mut shares = self.workload(kind, ranks)?.shares(ranks)?;
        if kind == ScalingKind::Weak && ranks > 1 {
            shares.bodies.most = shares.bodies.most.max(shares.bodies.mean * like.measured.parallel.bodies.imbalance());
        }
        Ok(shares)
    }

    fn workload(&self, kind: ScalingKind, ranks: usize) -> Result<Workload<D>> {
        match kind {
            ScalingKind::Strong => Ok(self.workload.clone()),
            ScalingKind::Weak => Ok(self.workload.repeated(copies(&self.scene, ranks)?)),
        }
    }

    fn run(&self, kind: ScalingKind, ranks: usize) -> Result<Measurement> {
        let scratch = &self.folder.scratch.0;
        let (enlarged, overrides): (PathBuf, &[String]) = match kind {
            ScalingKind::Weak if ranks > 1 => (write_enlarged(&self.scene, copies::<D>(&self.scene, ranks)?, scratch)?, &[]),
            _ => (self.options.scene.scene.clone(), &self.options.scene.overrides),
        };
        let overrides = [overrides, &[WITHOUT_PICTURE.to_owned()]].concat();
        let folder = &scratch.join("out");
        let job = Job { scene: &enlarged, overrides: &overrides, folder, ranks, repeat: self.options.start.repeat };
        self.launcher.measure(&job, Measurement::read, Measurement::seconds)
    }

    fn table(&self, samples: &[(usize, Result<Sample>)], model: Option<&ScalingModel>, kind: ScalingKind) -> ScalingTable {
        let measured: Vec<RunRow> =
            samples.iter().map(|(ranks, sample)| RunRow::measured(*ranks, *ranks > self.cores, sample.as_ref())).collect();
        let last = samples.iter().rev().find_map(|(_, sample)| sample.as_ref().ok());
        let model = model.zip(last).map_or(Vec::new(), |(model, last)| {
            let powers = (0..).map(|power| 1 << power).take_while(|&ranks| ranks <= MOST_RANKS);
            let rows = powers.map(|ranks| RunRow::predicted(ranks, model, last, self.expected_shares(kind, ranks, last).as_ref()));
            up_to_the_first(rows, RunRow::absent)
        });
        ScalingTable::new(measured, model, kind == ScalingKind::Weak)
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
