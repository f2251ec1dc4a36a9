//! A simulation in time: look, write, step, until the end or a signal.

use std::{path::Path, time::Instant};

use super::{
    folder,
    outputs::{Outputs, frame_bodies, held},
    signals::Signals,
};
use crate::{
    error::{Error, Result},
    observe::{self, Plane},
    output::{self, Chart, Checkpoint, ContactSummary, MotionSummary, Series, Summary, TimeProgress},
    parallel::World,
    petsc::Session,
    scene::{ContactModel, Scene},
    simulation::{Simulation, StepReport, View},
};

/// Runs a scene of dimension `D` from its start or from a checkpoint.
pub fn run<const D: usize>(session: &Session, scene: &Scene, folder: &Path, checkpoint: Option<&Checkpoint>) -> Result<()> {
    let world = session.world();
    let mut simulation = Simulation::<D>::new(session, scene)?;
    if let Some(checkpoint) = checkpoint {
        output::restore(checkpoint, &mut simulation)?;
    }
    let prepare = || if checkpoint.is_some() { folder::reclaim(folder, scene) } else { folder::claim(folder, scene) };
    world.agree(if world.rank() == 0 { prepare() } else { Ok(()) })?;
    let outputs = Outputs::open(world, scene, folder, &mut simulation)?;
    let mut march = March { world, scene, folder, simulation, outputs, account: Account::default() };
    let outcome = march.reach_the_end();
    if let (Err(Error::Contact { island, .. }), 0) = (&outcome, world.rank()) {
        output::write_whole(&folder.join("island.json"), island.as_bytes())?;
    }
    outcome
}

/// Width in pixels of the picture of dry bodies.
const STILL_WIDTH: usize = 800;

struct March<'a, const D: usize> {
    world: &'a World,
    scene: &'a Scene,
    folder: &'a Path,
    simulation: Simulation<D>,
    outputs: Outputs<D>,
    account: Account,
}

/// What all steps of this run together cost and kept.
#[derive(Default)]
struct Account {
    motion: MotionSummary,
    smallest_gap: Option<f64>,
    kkt_residual: f64,
    pairs: usize,
    last_step: Option<f64>,
}

impl<const D: usize> March<'_, D> {
    fn reach_the_end(&mut self) -> Result<()> {
        let (signals, start) = (Signals::listen()?, Instant::now());
        let end = self.scene.time.as_ref().map_or(0.0, |time| time.end);
        let progress = TimeProgress::new(self.world.rank(), self.simulation.state().time, end);
        let mut last = None;
        let view = loop {
            self.outputs.checkpoint(self.world, &mut self.simulation, signals.take_checkpoint())?;
            let view = self.look(last.as_ref())?;
            progress.show(self.simulation.state().time, self.simulation.state().steps);
            if self.simulation.over() {
                break view;
            }
            let report = self.simulation.step(&view, &mut |_, _| {})?;
            self.account.add(&view, &report);
            last = Some(report);
            if self.world.max(f64::from(signals.stop())) > 0.0 {
                progress.end();
                return self.stop();
            }
        };
        progress.end();
        self.account.motion.seconds = start.elapsed().as_secs_f64();
        self.account.motion.output_seconds = self.outputs.seconds;
        self.finish(&view)
    }

    /// What happens now, written down.
    fn look(&mut self, last: Option<&StepReport>) -> Result<View<D>> {
        let view = self.simulation.look(&mut |_, _| {})?;
        let shear = match (self.simulation.suspension(), &view.solution) {
            (Some(suspension), Some(solution)) => {
                let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), solution, &view.contacts)?;
                observe::shear_rate(suspension.setup()).zip(viscosity)
            }
            _ => None,
        };
        self.outputs.write(self.world, &mut self.simulation, (&view, last), shear)?;
        Ok(view)
    }

    fn stop(&mut self) -> Result<()> {
        self.outputs.checkpoint(self.world, &mut self.simulation, true)?;
        let (time, folder) = (self.simulation.state().time, self.folder.display());
        Err(Error::Stopped(format!("stopped by a signal at time {time}; `turbid resume {folder}` goes on")))
    }

    #[allow(clippy::print_stdout)]
    fn finish(&mut self, view: &View<D>) -> Result<()> {
        let mut summary = self.summary(view)?;
        let pictures = self.pictures(view)?;
        let first = self.world.rank() == 0;
        let write = || pictures.iter().try_for_each(|(name, bytes)| output::write_whole(&self.folder.join(name), bytes));
        self.world.agree(if first { write() } else { Ok(()) })?;
        summary.motion = Some(self.account.motion.clone());
        self.world.agree(if first { folder::complete(self.folder, &summary) } else { Ok(()) })?;
        if first {
            println!("{}", output::report(&summary));
            if let Some(line) = output::sparkline(self.outputs.curve().iter().map(|(_, hydrodynamic, contact)| hydrodynamic + contact)) {
                println!("viscosity over time  {line}");
            }
            let names: Vec<&str> = pictures.iter().map(|(name, _)| *name).collect();
            let names = [&["series.csv", "run.h5", "bodies.xdmf"], &names[..], &["summary.json"]].concat();
            println!("files                {}: {}", self.folder.display(), names.join(", "));
        }
        Ok(())
    }

    fn summary(&mut self, view: &View<D>) -> Result<Summary> {
        let named = (self.scene.name.as_str(), self.scene.title.as_str());
        let (state, radii) = (self.simulation.state().clone(), self.simulation.radii().to_vec());
        let domain = self.simulation.domain().clone();
        let mut summary = match (self.simulation.suspension(), &view.solution) {
            (Some(suspension), Some(solution)) => {
                let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), solution, &view.contacts)?;
                Summary::of_flow(named, suspension, (solution, viscosity), self.world)
            }
            _ => Summary::of_dry(named, &domain, (&state, &radii), self.world),
        };
        (summary.time, summary.steps) = (state.time, state.steps);
        summary.contact = (self.scene.contact.model != ContactModel::None).then(|| {
            let held = held(&state, view);
            ContactSummary {
                pairs: self.account.pairs,
                active: held.len(),
                smallest_gap: self.account.smallest_gap,
                kkt_residual: self.account.kkt_residual,
                total_force: held.iter().map(|held| held.force).sum(),
            }
        });
        Ok(summary)
    }

    /// Pictures of the last state and the curve of the viscosity, by name; collective.
    fn pictures(&mut self, view: &View<D>) -> Result<Vec<(&'static str, Vec<u8>)>> {
        let mut pictures = Vec::new();
        let curve = self.outputs.curve();
        if curve.len() > 1 {
            pictures.push(("viscosity.svg", viscosity_chart(self.scene.shown_title(), curve).svg().into_bytes()));
        }
        if !self.scene.output.picture {
            return Ok(pictures);
        }
        let bodies = frame_bodies(self.simulation.state(), self.simulation.radii(), view);
        pictures.push(match (self.simulation.suspension(), &view.solution) {
            (Some(suspension), Some(solution)) => {
                ("picture.svg", observe::picture(self.scene.shown_title(), suspension, solution)?.svg().into_bytes())
            }
            _ => {
                let plane = Plane::of(self.scene);
                let still = plane.frame(self.simulation.state().time, bodies);
                ("picture.png", plane.film(self.scene, vec![still]).apng(STILL_WIDTH, 1.0))
            }
        });
        Ok(pictures)
    }
}

impl Account {
    fn add<const D: usize>(&mut self, view: &View<D>, report: &StepReport) {
        let (motion, effort) = (&mut self.motion, view.effort + report.effort);
        let [shortest, longest] = motion.steps;
        motion.steps =
            if self.last_step.is_none() { [report.length; 2] } else { [shortest.min(report.length), longest.max(report.length)] };
        motion.grown += usize::from(self.last_step.is_some_and(|last| report.length > last * (1.0 + 1e-9)));
        motion.shrunk += usize::from(self.last_step.is_some_and(|last| report.length < last * (1.0 - 1e-9)));
        self.last_step = Some(report.length);
        motion.solves += effort.solves;
        motion.iterations += effort.iterations;
        motion.assembly_seconds += effort.assembly;
        motion.solve_seconds += effort.solving;
        motion.contact_seconds += effort.contact;
        if let Some(certificate) = report.certificate {
            let smallest = certificate.smallest_gap;
            if smallest.is_finite() {
                self.smallest_gap = Some(self.smallest_gap.map_or(smallest, |gap| gap.min(smallest)));
            }
            self.kkt_residual = self.kkt_residual.max(certificate.kkt_residual);
            self.pairs = certificate.pairs;
        }
    }
}

fn viscosity_chart(title: &str, curve: &[(f64, f64, f64)]) -> Chart {
    let series = |name: &str, value: fn(&(f64, f64, f64)) -> f64| Series {
        name: name.into(),
        points: curve.iter().map(|row| (row.0, value(row))).collect(),
    };
    let mut all = vec![series("total", |row| row.1 + row.2)];
    if curve.iter().any(|row| row.2 != 0.0) {
        all.push(series("flow", |row| row.1));
    }
    Chart { title: title.into(), x: "strain".into(), y: "relative viscosity".into(), series: all }
}
