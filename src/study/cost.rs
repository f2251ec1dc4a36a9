//! What accuracy costs in time, on a scene of the user: error against seconds for every method, on grids from coarse to fine, and what to choose.
//!
//! Every setting is a run of its own, started by a launcher, so that its memory and its failure are its own; all that was measured is
//! kept in `cost.json` after every run, and a study that is started again measures only what is missing.

mod apply;
mod axes;
mod chart;
mod choice;
mod digits;
mod facts;
mod findings;
mod knobs;
mod lines;
mod page;
mod quantity;
mod record;
mod reference;
mod report;
mod setting;
mod store;
mod suited;
mod sweep;
mod table;
mod text;

use std::path::PathBuf;

use self::{
    axes::Axes,
    facts::Facts,
    findings::Study,
    report::Findings,
    store::{Identity, Store},
    sweep::Sweep,
};
use crate::{
    error::{Error, Result},
    output::{FolderLock, prepare_folder, say, write_whole},
    scene::Scene,
    study::launcher::sweep_out,
};

/// What to measure, and how; empty lists leave the choice to the scene.
#[derive(Debug, Clone)]
pub struct CostOptions {
    /// Scene file.
    pub scene: PathBuf,
    /// What is set in it.
    pub overrides: Vec<String>,
    /// Words of constraint methods.
    pub methods: Vec<String>,
    /// Grids, in cells per radius of the smallest body.
    pub resolutions: Vec<f64>,
    /// Grids, as spacings.
    pub spacings: Vec<f64>,
    /// Orders of surface modes.
    pub modes: Vec<usize>,
    /// Relative residuals at which solves end.
    pub tolerances: Vec<f64>,
    /// Time steps.
    pub steps: Vec<f64>,
    /// Parts of their radius that bodies move in a step.
    pub travels: Vec<f64>,
    /// Word of the quantity.
    pub quantity: Option<String>,
    /// The body whose quantity it is; all of them if there is none.
    pub body: Option<usize>,
    /// Points along each axis of the lattice on which fields are compared.
    pub probe: Option<usize>,
    /// True values of the quantity; the limit of the finest grids if there are none.
    pub exact: Vec<f64>,
    /// How far these may be off.
    pub uncertainty: f64,
    /// Method whose limit counts as true.
    pub reference: Option<String>,
    /// Wanted relative error.
    pub error: f64,
    /// Seconds of runs that a method may take.
    pub budget: f64,
    /// Time at which runs in time end.
    pub until: Option<f64>,
    /// Ranks of each run.
    pub ranks: usize,
    /// Command line that starts a run, with `{ranks}` in it.
    pub launcher: String,
    /// Runs of each setting, of which the fastest counts.
    pub repeat: usize,
    /// Folder of the results, `out/NAME-cost` if there is none.
    pub out: Option<PathBuf>,
    /// Scene file to write with the cheapest setting.
    pub apply: Option<PathBuf>,
    /// Whether what was measured before is forgotten.
    pub fresh: bool,
    /// Options for PETSc.
    pub petsc: Vec<String>,
}

impl Default for CostOptions {
    fn default() -> CostOptions {
        CostOptions {
            scene: PathBuf::new(),
            overrides: Vec::new(),
            methods: Vec::new(),
            resolutions: Vec::new(),
            spacings: Vec::new(),
            modes: Vec::new(),
            tolerances: Vec::new(),
            steps: Vec::new(),
            travels: Vec::new(),
            quantity: None,
            body: None,
            probe: None,
            exact: Vec::new(),
            uncertainty: 0.0,
            reference: None,
            error: 1e-2,
            budget: 60.0,
            until: None,
            ranks: 1,
            launcher: "mpirun --oversubscribe -n {ranks}".into(),
            repeat: 2,
            out: None,
            apply: None,
            fresh: false,
            petsc: Vec::new(),
        }
    }
}

/// Measures, judges, prints and writes what was found; to be called outside of MPI.
///
/// # Errors
/// The scene, a flag or the launcher cannot be used, no setting could be measured, or none that could be applied was found.
pub fn cost(options: &CostOptions) -> Result<()> {
    let whole = Scene::read(&options.scene, &options.overrides)?;
    if whole.dry() {
        let remedy = "accuracy is that of the flow, and a dry scene has none; choose a scene with a flow";
        return Err(whole.refuse("flow.model", "\"none\"", remedy));
    }
    let (options, times) = shortened(options, &whole)?;
    let scene = Scene::read(&options.scene, &options.overrides)?;
    let facts = Facts::of(&scene)?;
    let axes = Axes::of(&options, &scene, facts.radius)?;
    let quantity = facts.quantity(&options, &scene)?;
    facts.check_exact(&options, &quantity)?;
    options.check_names(&axes)?;
    let folder = options.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{}-cost", scene.name)));
    prepare_folder(&folder)?;
    let _lock = FolderLock::take(&folder)?;
    let identity = Identity::of(&scene, quantity, (options.ranks, &options.launcher, &options.petsc))?;
    let store = Store::open(&folder, identity, options.fresh)?;
    say(&format!("{}\nquantity: {}\n", scene.shown_title(), quantity.words(&facts)))?;
    let sweep = Sweep::new(&options, &scene, (facts, quantity, store), &folder)?;
    let mut study = Study { options: &options, scene: &scene, times, sweep };
    let findings = study.findings(&axes)?;
    // a run that outlived the study which started it has made its folder anew
    sweep_out(&folder);
    study.sweep.store.write(Some(&findings))?;
    for (name, text) in files(&findings) {
        write_whole(&folder.join(name), text.as_bytes())?;
    }
    say(&format!("\n{}\n\nfiles: {}: cost.json, cost.csv, cost.svg, cost.html", text::report(&findings), folder.display()))?;
    match &options.apply {
        Some(file) => apply::apply(file, &whole, &findings),
        None => Ok(()),
    }
}

/// Options whose runs end when they are told, and how many times as long the scene is.
fn shortened(options: &CostOptions, whole: &Scene) -> Result<(CostOptions, f64)> {
    let Some(until) = options.until else { return Ok((options.clone(), 1.0)) };
    if whole.time.is_none() {
        return Err(Error::refused(format!("--until {until}: the scene is one instant; leave the flag out")));
    }
    if !(until > 0.0 && until <= whole.end()) {
        return Err(Error::refused(format!("--until {until}: must lie above 0 and not above time.end = {}", whole.end())));
    }
    let overrides = [&options.overrides[..], &[format!("time.end={until:?}")]].concat();
    Ok((CostOptions { overrides, ..options.clone() }, whole.end() / until))
}

/// Names and contents of the files for people and other programs.
fn files(findings: &Findings) -> [(&'static str, String); 3] {
    [("cost.csv", findings.csv()), ("cost.svg", chart::svg(findings)), ("cost.html", page::html(findings))]
}

impl CostOptions {
    /// Refuses names that lead nowhere before anything is run.
    fn check_names(&self, axes: &Axes) -> Result<()> {
        if let Some(method) = self.reference.as_ref().filter(|method| !axes.methods.contains(method)) {
            let known = axes.methods.join(", ");
            return Err(Error::refused(format!("--reference {method}: must be one of the methods that are swept, {known}")));
        }
        let folder =
            |path: &PathBuf| path.parent().map(|folder| if folder.as_os_str().is_empty() { ".".into() } else { folder.to_owned() });
        match self.apply.as_ref().and_then(|path| Some((path, folder(path)?))) {
            Some((path, folder)) if !folder.is_dir() => {
                Err(Error::refused(format!("--apply {}: there is no folder {}; make it first", path.display(), folder.display())))
            }
            _ => Ok(()),
        }
    }
}
