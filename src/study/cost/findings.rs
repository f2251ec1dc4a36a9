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
        let turned = match &refined {
            Some((finest, limit)) => vec![self.sweep.turn(finest, self.scene, Some(&limit.values))?],
            None => Vec::new(),
        };
        let (facts, quantity) = (&self.sweep.facts, &self.sweep.quantity);
        let reference = match (self.options.exact.is_empty(), &refined) {
            (false, _) => Some(Reference::given(self.options, (quantity, facts))),
            (true, Some((finest, limit))) => {
                let finest = (finest, finest.solves_to(self.scene));
                Some(Reference::extrapolated(finest, (limit, &turned[0]), (quantity, facts)))
            }
            (true, None) => None,
        };
        notes.extend(self.faster());
        let mut findings = self.judged(&ladders, reference, (turned, notes));
        self.turn_the_chosen(&mut findings)?;
        Ok(findings)
    }

    /// All settings and methods beside the reference.
    fn judged(&self, ladders: &[Ladder], reference: Option<Reference>, (turned, notes): (Vec<Turned>, Vec<String>)) -> Findings {
        let methods = ladders.iter().map(|ladder| self.method(ladder, reference.as_ref())).collect();
        let settings = ladders.iter().flat_map(|(_, settings)| settings);
        let points = settings.filter_map(|setting| self.point(setting, reference.as_ref())).collect();
        Findings {
            title: self.scene.shown_title().to_owned(),
            quantity: self.sweep.quantity.words(&self.sweep.facts),
            name: self.sweep.quantity.kind.word(),
            ranks: self.options.ranks,
            repeat: self.options.repeat,
            wanted: self.options.error,
            times: self.times,
            reference,
            points,
            methods,
            written: Some(Setting::written(self.scene)),
            turned,
            notes,
        }
    }

    /// Turns the knobs of the cheapest setting, and tells what error each knob that was turned leaves.
    fn turn_the_chosen(&mut self, findings: &mut Findings) -> Result<()> {
        let chosen = findings.cheapest().map(|cheapest| cheapest.setting.clone());
        if let Some(chosen) = chosen.filter(|chosen| findings.turned.iter().all(|turned| turned.at != *chosen)) {
            let limit = findings.reference.as_ref().map(|reference| reference.values.as_slice());
            let own = self.sweep.turn(&chosen, self.scene, limit)?;
            findings.turned.insert(0, own);
        }
        if let Some(reference) = &findings.reference {
            let measured = findings.turned.iter_mut().flat_map(|turned| &mut turned.knobs).filter(|knob| knob.seconds.is_some());
            measured.for_each(|knob| knob.error = Some(self.error(&knob.values, reference)));
        }
        Ok(())
    }

    /// All methods that the scene allows, and why others or finer grids are left out.
    fn climb(&mut self, axes: &Axes) -> Result<(Vec<Ladder>, Vec<String>)> {
        let (mut ladders, mut notes) = (Vec::new(), Vec::new());
        for method in &axes.methods {
            let trial = [format!("method.constraint={method}"), "resolution.modes=auto".into()];
            if let Err(refusal) = self.sweep.scene_with(&trial) {
                let reason = refusal.to_string();
                notes.push(format!("{method} is left out: {}", reason.strip_prefix("--set: ").unwrap_or(&reason)));
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
        Err(Error::refused(format!("no setting could be measured:\n{reasons}")))
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
