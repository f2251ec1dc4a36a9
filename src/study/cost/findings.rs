//! From settings to findings: climb, refer, judge, turn the knobs.

use super::{
    CostOptions,
    axes::Axes,
    choice::Judge,
    knobs::Turned,
    lines::Line,
    reference::{Limit, Reference},
    report::{Findings, MethodFinding, Point},
    setting::Setting,
    sweep::Sweep,
    text,
};
use crate::{
    error::{Error, Result},
    scene::Scene,
};

/// Method whose limit counts as true unless another one is named.
const REFERENCE: &str = "sharp";

/// A study with its scene.
pub struct Study<'a> {
    /// What was asked for.
    pub options: &'a CostOptions,
    /// The scene as runs have it.
    pub scene: &'a Scene,
    /// Length of the whole scene over that of a run.
    pub times: f64,
    /// What measures.
    pub sweep: Sweep<'a>,
}

/// The settings of a method.
type Ladder = (String, Vec<Setting>);

impl Study<'_> {
    /// Measures all settings and says what they show.
    ///
    /// # Errors
    /// Runs cannot be started, or none came to its end.
    pub fn findings(&mut self, axes: &Axes) -> Result<Findings> {
        let (ladders, mut notes) = self.climb(axes)?;
        self.expect_some()?;
        let refined = self.finest(&ladders);
        let limit = refined.as_ref().map(|(_, limit)| limit.values.clone());
        let mut turned = Vec::new();
        if let Some((finest, _)) = &refined {
            turned.push(self.sweep.turn(finest, self.scene, limit.as_deref())?);
        }
        let reference = match self.options.exact.is_empty() {
            false => Some(self.exact()),
            true => refined.as_ref().zip(turned.first()).map(|((finest, limit), turned)| self.extrapolated(finest, limit, turned)),
        };
        let methods: Vec<MethodFinding> = ladders.iter().map(|ladder| self.method(ladder, reference.as_ref())).collect();
        notes.extend(self.faster());
        let settings = ladders.iter().flat_map(|(_, settings)| settings);
        let points = settings.filter_map(|setting| self.point(setting, reference.as_ref())).collect();
        let mut findings = Findings {
            title: self.scene.shown_title().to_owned(),
            quantity: self.sweep.quantity.words(&self.sweep.facts),
            name: self.sweep.quantity.kind.word(),
            ranks: self.options.ranks,
            repeat: self.options.repeat,
            wanted: self.options.error,
            reference,
            points,
            methods,
            written: Some(Setting::written(self.scene)),
            turned,
            notes,
        };
        let chosen = findings.cheapest().map(|cheapest| cheapest.setting.clone());
        if let Some(chosen) = chosen.filter(|chosen| findings.turned.iter().all(|turned| turned.at != *chosen)) {
            let limit = findings.reference.as_ref().map(|reference| reference.values.as_slice());
            let own = self.sweep.turn(&chosen, self.scene, limit)?;
            findings.turned.insert(0, own);
        }
        Ok(findings)
    }

    /// All methods that the scene allows, and why others or finer grids are left out.
    fn climb(&mut self, axes: &Axes) -> Result<(Vec<Ladder>, Vec<String>)> {
        let (mut ladders, mut notes) = (Vec::new(), Vec::new());
        for method in &axes.methods {
            let trial = [format!("method.constraint={method}"), "resolution.modes=auto".into()];
            if let Err(refusal) = self.sweep.scene_with(&trial) {
                notes.push(format!("{method} is left out: {refusal}"));
                continue;
            }
            let settings = axes.settings(method, (self.scene, self.sweep.radius()));
            notes.extend(self.sweep.climb(&settings)?);
            ladders.push((method.clone(), settings));
        }
        Ok((ladders, notes))
    }

    fn expect_some(&self) -> Result<()> {
        let records = self.sweep.store.records();
        if records.iter().any(|record| record.measured().is_some()) {
            return Ok(());
        }
        let reasons = records.iter().map(text::progress).collect::<Vec<_>>().join("\n");
        Err(Error::Refused(format!("no setting could be measured:\n{reasons}")))
    }

    /// The finest setting of the method that the others are referred to, and the limit of its line.
    fn finest(&self, ladders: &[Ladder]) -> Option<(Setting, Limit)> {
        let asked = self.options.reference.as_deref().unwrap_or(REFERENCE);
        let (first, others): (Vec<_>, Vec<_>) = ladders.iter().partition(|(method, _)| method == asked);
        let limit = |(method, settings): &&Ladder| {
            let line = Line::main(&Line::all(self.sweep.store.records(), settings))?;
            let order = self.sweep.quantity.kind.predicted_order(method);
            let limit = Limit::of(&line.measured(), (&self.sweep.quantity, &self.sweep.facts), order)?;
            Some((line.finest().0.clone(), limit))
        };
        first.iter().find_map(limit).or_else(|| others.iter().filter(|_| self.options.reference.is_none()).find_map(limit))
    }

    fn exact(&self) -> Reference {
        let values = self.options.exact.clone();
        let uncertainty = self.options.uncertainty / self.sweep.facts.scale(&self.sweep.quantity, &values);
        let given = values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let source = match uncertainty > 0.0 {
            true => format!("{given} +- {}, as given", self.options.uncertainty),
            false => format!("{given}, as given"),
        };
        Reference { values, uncertainty, source }
    }

    /// The limit with what modes, tolerance and step still change at the finest setting; all of it counts as uncertain.
    fn extrapolated(&self, finest: &Setting, limit: &Limit, turned: &Turned) -> Reference {
        let mut values = limit.values.clone();
        let mut uncertainty = limit.uncertainty + finest.solves_to(self.scene);
        let mut corrections = Vec::new();
        for knob in turned.knobs.iter().filter(|knob| knob.name != "grid") {
            let Some(change) = knob.change else { continue };
            values.iter_mut().zip(&knob.changes).for_each(|(value, change)| *value += change);
            uncertainty += change.abs();
            corrections.push(format!("{} {}", knob.name, text::percent(change)));
        }
        let scale = self.sweep.facts.scale(&self.sweep.quantity, &values);
        let shown = if let [value] = values[..] { format!("{value:.6} +- {:.2e}", uncertainty * scale) } else { "the limit".into() };
        let also = if corrections.is_empty() { String::new() } else { format!("; also uncertain: {}", corrections.join(", ")) };
        let source = format!(
            "{shown} ({}), extrapolated from {} up to {} with order {:.1}{also}",
            text::percent(uncertainty),
            finest.method,
            finest.words(),
            limit.order
        );
        Reference { values, uncertainty, source }
    }

    fn error(&self, values: &[f64], reference: &Reference) -> f64 {
        self.sweep.facts.error(&self.sweep.quantity, values, &reference.values)
    }

    fn method(&self, (method, settings): &Ladder, reference: Option<&Reference>) -> MethodFinding {
        let lines = Line::all(self.sweep.store.records(), settings);
        let main = Line::main(&lines);
        let judge = reference.map(|reference| Judge {
            error: |values: &[f64]| self.error(values, reference),
            uncertainty: reference.uncertainty,
            wanted: self.options.error,
            times: self.times,
        });
        let [order, seconds] = judge.as_ref().zip(main.as_ref()).map_or([None, None], |(judge, main)| judge.growth(main));
        let measured = judge.as_ref().and_then(|judge| judge.cheapest(&lines));
        let predicted = || judge.as_ref().zip(main.as_ref()).and_then(|(judge, main)| judge.predicted(main, self.sweep.radius()));
        MethodFinding {
            method: method.clone(),
            order: order.map(|power| power.exponent),
            predicted_order: self.sweep.quantity.kind.predicted_order(method),
            seconds_exponent: seconds.map(|power| power.exponent),
            cheapest: measured.or_else(predicted),
        }
    }

    fn point(&self, setting: &Setting, reference: Option<&Reference>) -> Option<Point> {
        let record = self.sweep.store.find(setting)?;
        let error = |values: &[f64]| reference.map(|reference| self.error(values, reference));
        Some(Point::of(record, self.sweep.facts.radius, error, reference.map_or(0.0, |reference| reference.uncertainty)))
    }

    /// A faster inverse that the runs could have taken.
    fn faster(&self) -> Option<String> {
        let runs = self.sweep.store.records().iter().filter_map(|record| record.measured());
        let (inverse, part) = runs.max_by(|one, two| one.unknowns.total_cmp(&two.unknowns))?.faster.clone()?;
        Some(format!(
            "method.inverse = {inverse:?} suits this box and would solve {:.1} times as fast: --set method.inverse={inverse}",
            1.0 / part
        ))
    }
}
