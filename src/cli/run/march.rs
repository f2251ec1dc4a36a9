//! A simulation in time: look, write, step, until the end or a signal.

use std::path::Path;

use super::{
    account::Account,
    calibration::Calibrated,
    folder::RunFolder,
    outputs::{Outputs, frame_bodies, held},
    pairs::{self, Crowd, Pairs},
    signals::Signals,
};
use crate::{
    error::{Error, Result},
    observe::{self, Plane, Shear, Viscosity},
    output::{self, Chart, Checkpoint, ContactSummary, CurvePoint, GlueSummary, Scale, Series, Summary, TimeProgress},
    parallel::World,
    petsc::{Session, Stage, enter},
    scene::{ContactModel, Scene},
    simulation::{Simulation, View},
};

/// Rounding of a time that is a sum of steps.
const ROUNDING: f64 = 1e-9;

/// Runs a scene of dimension `D` from its start or from a checkpoint, at the resolution that `resolved` has.
pub fn run<const D: usize>(
    session: &Session,
    (scene, resolved): (&Scene, &Scene),
    folder: &mut RunFolder,
    (checkpoint, calibrated): (Option<&Checkpoint>, Option<&Calibrated>),
) -> Result<()> {
    let (world, signals) = (session.world(), Signals::listen()?);
    let mut simulation = Simulation::<D>::new(session, resolved)?;
    let account = match checkpoint {
        Some(checkpoint) => Account::from_numbers(&output::restore(checkpoint, &mut simulation)?)?,
        None => Account::new(),
    };
    refuse_the_past(scene, simulation.state().time)?;
    if checkpoint.is_some() {
        folder.reclaim(scene)?
    } else {
        folder.claim(scene)?
    }
    let outputs = Outputs::open(world, scene, folder, &simulation)?;
    let folder = &*folder;
    let mut march = March { world, scene, folder, calibrated, simulation, outputs, account };
    let outcome = march.reach_the_end(&signals);
    keep_island(world, folder.path(), outcome)
}

/// Writes the island that was not solved beside the other files, and says so.
fn keep_island(world: &World, folder: &Path, outcome: Result<()>) -> Result<()> {
    let Err(Error::Contact { text, island }) = outcome else { return outcome };
    let path = folder.join("contact-island.json");
    world.agree(if world.rank() == 0 { output::write_whole(&path, island.as_bytes()) } else { Ok(()) })?;
    Err(Error::Contact { text: format!("{text}; the problem is in {}", path.display()), island })
}

/// Width in pixels of the picture of dry bodies.
const STILL_WIDTH: usize = 800;

struct March<'a, const D: usize> {
    world: &'a World,
    scene: &'a Scene,
    folder: &'a RunFolder<'a>,
    calibrated: Option<&'a Calibrated>,
    simulation: Simulation<D>,
    outputs: Outputs<D>,
    account: Account,
}

impl<const D: usize> March<'_, D> {
    fn reach_the_end(&mut self, signals: &Signals) -> Result<()> {
        let progress = TimeProgress::new(self.world.rank(), self.simulation.state().time, self.scene.end());
        let view = loop {
            self.checkpoint(signals.take_checkpoint())?;
            let view = self.look()?;
            progress.show(self.simulation.state().time, self.simulation.state().steps, self.outputs.mean());
            if self.simulation.over() || self.outputs.satisfied() {
                break view;
            }
            let report = self.simulation.step(&view, &mut |_, _| {})?;
            self.account.add(&view, &report);
            if self.world.max(f64::from(signals.stop())) > 0.0 {
                progress.end();
                return self.stop();
            }
        };
        progress.end();
        self.finish(&view)
    }

    /// What happens now, written down.
    fn look(&mut self) -> Result<View<D>> {
        let view = self.simulation.look(&mut |_, _| {})?;
        let viscosity = self.viscosity(&view)?;
        let spent = self.outputs.write(self.world, &self.simulation, (&view, self.account.last()), viscosity)?;
        self.account.add_output(spent);
        Ok(view)
    }

    fn viscosity(&self, view: &View<D>) -> Result<Option<Viscosity>> {
        match (self.simulation.suspension(), &view.solution) {
            (Some(suspension), Some(solution)) => observe::viscosity(suspension.setup(), suspension.grid(), solution, &view.contacts),
            _ => Ok(None),
        }
    }

    fn checkpoint(&mut self, asked: bool) -> Result<()> {
        let spent = self.outputs.checkpoint(self.world, &self.simulation, (&self.account, asked))?;
        self.account.add_output(spent);
        Ok(())
    }

    fn stop(&mut self) -> Result<()> {
        self.checkpoint(true)?;
        let (time, folder) = (self.simulation.state().time, self.folder.path().display());
        Err(Error::Stopped(format!("stopped by a signal at time {time}; `turbid resume {folder}` goes on")))
    }

    fn finish(&mut self, view: &View<D>) -> Result<()> {
        let mut summary = self.summary(view)?;
        let output = enter(Stage::Output);
        self.outputs.finish(self.world)?;
        let mut pictures = self.pictures(view)?;
        if let Some(pairs) = self.pairs()? {
            summary.pairs = Some(pairs.summary);
            pictures.extend(pairs.files);
        }
        let first = self.world.rank() == 0;
        let write = || pictures.iter().try_for_each(|(name, bytes)| output::write_whole(&self.folder.path().join(name), bytes));
        self.world.agree(if first { write() } else { Ok(()) })?;
        summary.motion = Some(self.account.motion());
        self.folder.complete(&summary)?;
        drop(output);
        if first {
            output::say(&output::report(&summary))?;
            if let Some(line) = output::sparkline(self.outputs.curve().iter().map(CurvePoint::relative)) {
                output::say(&format!("viscosity over time  {line}"))?;
            }
            let names: Vec<&str> = pictures.iter().map(|(name, _)| *name).collect();
            let indices = ["series.csv", "run.h5", "bodies.xdmf", "contacts.xdmf", "fields.xdmf"];
            let indices = indices.into_iter().filter(|name| self.folder.path().join(name).exists());
            let names: Vec<&str> = indices.chain(names).chain(["summary.json"]).collect();
            output::say(&format!("files                {}: {}", self.folder.path().display(), names.join(", ")))?;
        }
        Ok(())
    }

    fn summary(&self, view: &View<D>) -> Result<Summary> {
        let named = (self.scene.name.as_str(), self.scene.title.as_str());
        let state = self.simulation.state();
        let viscosity = self.viscosity(view)?;
        let mut summary = match (self.simulation.suspension(), &view.solution) {
            (Some(suspension), Some(solution)) => Summary::of_flow(named, suspension, (solution, viscosity), self.world)?,
            _ => Summary::of_dry(named, self.simulation.domain(), (state, self.simulation.radii()), self.world),
        };
        (summary.time, summary.steps) = (state.time, state.steps);
        if let (Some(calibrated), Some(suspension), Some(solution)) = (self.calibrated, self.simulation.suspension(), &view.solution) {
            calibrated.attach(&mut summary, (suspension, solution))?;
        }
        if self.scene.contact.model != ContactModel::None {
            summary.contact = Some(self.contacts(view));
            if let (Some(parts), Some(viscosity)) = (&mut summary.viscosity, viscosity) {
                parts.contact = Some(viscosity.contact);
                parts.particle_pressure_contact = Some(viscosity.normal.contact_pressure);
            }
        }
        if let Some(parts) = &mut summary.viscosity {
            parts.mean = self.outputs.mean().copied();
        }
        Ok(summary)
    }

    /// How bodies lie to each other, if the scene asks for it; on the first rank. Collective.
    fn pairs(&self) -> Result<Option<Pairs>> {
        if !self.scene.output.pairs {
            return Ok(None);
        }
        let shear = self.simulation.suspension().and_then(|suspension| Shear::of(&suspension.setup().domain, &suspension.setup().drive));
        let crowd = Crowd { domain: self.simulation.domain(), radii: self.simulation.radii(), shear };
        pairs::of_a_run(self.world, self.folder.path(), crowd, (self.simulation.state().time, self.outputs.mean()))
    }

    /// Contacts now, and how well they were kept on the way.
    fn contacts(&self, view: &View<D>) -> ContactSummary {
        let (model, state) = (self.scene.contact.model, self.simulation.state());
        let (held, (pairs, smallest_gap, kkt_residual)) = (held(state, view), self.account.contacts());
        let glue = || GlueSummary { stuck: state.stuck.len(), gamma: state.stuck.iter().map(|stuck| stuck.gamma).fold(0.0, f64::min) };
        ContactSummary {
            model: model.word(),
            pairs,
            active: held.len(),
            smallest_gap,
            kkt_residual: (!matches!(model, ContactModel::Repulsion { .. })).then_some(kkt_residual),
            total_force: held.iter().map(|held| held.force).sum(),
            glue: matches!(model, ContactModel::Gluey { .. }).then(glue),
        }
    }

    /// Pictures and samples of the last state and the curve of the viscosity, by name; collective.
    fn pictures(&self, view: &View<D>) -> Result<Vec<(&'static str, Vec<u8>)>> {
        let mut pictures = Vec::new();
        let curve = self.outputs.curve();
        if curve.len() > 1 {
            pictures.push(("viscosity.svg", viscosity_chart(self.scene.shown_title(), curve).svg().into_bytes()));
        }
        if let (Some(points), Some(suspension), Some(solution)) = (self.scene.output.probe, self.simulation.suspension(), &view.solution) {
            pictures.push(("probe.csv", observe::velocity_probe(suspension, solution, points)?.csv().into_bytes()));
        }
        if !self.scene.output.picture {
            return Ok(pictures);
        }
        // the first rank writes what it reads here
        let rows = std::fs::read_to_string(self.folder.path().join("series.csv")).unwrap_or_default();
        pictures.push(("effort.svg", output::effort_chart(self.scene.shown_title(), &rows).svg().into_bytes()));
        pictures.push(match (self.simulation.suspension(), &view.solution) {
            (Some(suspension), Some(solution)) => {
                ("picture.svg", observe::picture(self.scene.shown_title(), suspension, solution)?.svg().into_bytes())
            }
            _ => {
                let (plane, state) = (Plane::of(self.scene), self.simulation.state());
                let still = plane.frame(state.time, frame_bodies(state, self.simulation.radii(), view));
                ("picture.png", plane.film(self.scene, vec![still]).apng(STILL_WIDTH, 1.0))
            }
        });
        Ok(pictures)
    }
}

/// A run that goes on cannot end before it does.
fn refuse_the_past(scene: &Scene, time: f64) -> Result<()> {
    if scene.end() >= time * (1.0 - ROUNDING) {
        return Ok(());
    }
    let remedy = format!("the checkpoint is at time {time}; set a later end, or start anew with turbid run in another folder");
    Err(scene.refuse("time.end", scene.end(), &remedy))
}

fn viscosity_chart(title: &str, curve: &[CurvePoint]) -> Chart {
    let series = |name: &str, value: fn(&CurvePoint) -> f64| Series {
        name: name.into(),
        points: curve.iter().map(|point| (point.strain, value(point))).collect(),
    };
    let mut all = vec![series("total", CurvePoint::relative)];
    let lubricated = curve.iter().any(|point| point.lubrication.is_some());
    if lubricated || curve.iter().any(|point| point.contact.is_some_and(|contact| contact != 0.0)) {
        all.push(series("flow", |point| point.hydrodynamic));
    }
    if lubricated {
        all.push(series("lubrication", |point| point.lubrication.unwrap_or(0.0)));
    }
    Chart { title: title.into(), x: "strain".into(), y: "relative viscosity".into(), scale: Scale::Linear, series: all }
}
