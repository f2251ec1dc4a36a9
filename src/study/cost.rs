//! What accuracy costs in time, on a scene of the user: error against seconds for every method, on grids from coarse to fine, and what to choose.
//!
//! Every setting is a run of its own, started by a launcher, so that its memory and its failure are its own; all that was measured is
//! kept in `cost.json` after every run, and a study that is started again measures only what is missing.

mod analysis;
mod apply;
mod chart;
mod cheapest;
mod findings;
mod format;
mod inertia;
mod metric;
mod options;
mod page;
mod perturb;
mod properties;
mod quantity;
mod ranges;
mod record;
mod reference;
mod sensitivity;
mod sequence;
mod setting;
mod steadiness;
mod step_error;
mod suitable_quantity;
mod sweep;
mod table;
mod text;

pub use self::options::CostStudy;
pub use self::properties::SceneProperties;
use self::{analysis::Analysis, metric::Metric, ranges::ParameterRanges, sweep::Sweep};
use super::command::{PetscOptions, SceneArguments, Study};
use crate::{
    error::{Error, Result},
    experiment::{Experiment, arguments::Start, folder::sweep_out, store::StudyIdentity, table::csv},
    output::say,
    scene::Scene,
};

impl Study<PetscOptions> for CostStudy {
    const NAME: &'static str = "cost";
    const ABOUT: &'static str =
        "Error against seconds on a scene: every method on grids from coarse to fine, and the cheapest setting for a wanted error";

    /// Measures, judges, prints and writes what was found.
    fn run(&self, petsc: &PetscOptions) -> Result<()> {
        let whole = Scene::read(&self.scene.scene, &self.scene.overrides)?;
        if whole.dry() {
            let remedy = "accuracy is that of the flow, and a dry scene has none; choose a scene with a flow";
            return Err(whole.refuse("flow.model", "\"none\"", remedy));
        }
        let (options, times) = self.shortened(&whole)?;
        let scene = &Scene::read(&options.scene.scene, &options.scene.overrides)?;
        inertia::check(scene)?;
        let metric = Metric::of(&options, scene)?;
        let ranges = ParameterRanges::of(&options, scene, metric.properties.radius)?;
        options.check_names(&ranges.methods)?;
        let start = Start { launcher: &options.start.launcher, petsc, ranks: options.ranks };
        let identity = StudyIdentity::of_scene(scene, "quantity", metric.quantity, &start)?;
        let folder = options.out.clone().unwrap_or_else(|| format!("out/{}-cost", scene.name).into());
        let experiment = Experiment::open(&start, folder, "cost.json", identity, options.fresh)?;
        say(&format!("{}\nquantity: {}\n", scene.shown_title(), metric.words()))?;
        let mut analysis = Analysis { times, sweep: Sweep { options: &options, scene, metric, experiment, measured: Vec::new() } };
        let findings = analysis.findings(&ranges)?;
        let experiment = &analysis.sweep.experiment;
        // a run that outlived the study which started it has made its folder anew
        sweep_out(&experiment.folder.path);
        let table = csv(&table::numbers(&findings));
        let files = [("cost.csv", table), ("cost.svg", chart::svg(&findings)), ("cost.html", page::html(&findings))];
        let written = experiment.write(Some(&findings), &files)?;
        say(&format!("\n{}\n\n{written}", text::report(&findings)))?;
        options.apply.as_ref().map_or(Ok(()), |file| apply::apply(file, &whole, &findings))
    }
}

impl CostStudy {
    /// Options whose runs end when they are told, and how many times as long the scene is.
    fn shortened(&self, whole: &Scene) -> Result<(CostStudy, f64)> {
        let Some(until) = self.until else { return Ok((self.clone(), 1.0)) };
        if whole.time.is_none() {
            return Err(Error::refused(format!("--until {until}: the scene is one instant; leave the flag out")));
        }
        if !(until > 0.0 && until <= whole.end()) {
            return Err(Error::refused(format!("--until {until}: must lie above 0 and not above time.end = {}", whole.end())));
        }
        let overrides = [&self.scene.overrides[..], &[format!("time.end={until:?}")]].concat();
        let scene = SceneArguments { overrides, ..self.scene.clone() };
        Ok((CostStudy { scene, ..self.clone() }, whole.end() / until))
    }
}
