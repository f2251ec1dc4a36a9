//! From settings to findings: measure, find a reference, judge, change the parameters of what was chosen.

use super::{
    cheapest::ErrorCriterion,
    findings::{Findings, MethodFinding, SettingFinding},
    format::percent,
    ranges::ParameterRanges,
    record::{CostRecord, Measured},
    reference::{Finest, Limit, Reference},
    sensitivity::Sensitivity,
    sequence::RefinementSequence,
    setting::CostSetting,
    sweep::Sweep,
};
use crate::{
    error::{Error, Result},
    run::STEADY,
};

/// Method whose limit counts as true unless another one is named.
const REFERENCE: &str = "sharp";

/// A study under way.
pub struct Analysis<'a> {
    /// Length of the whole scene over that of a run.
    pub times: f64,
    /// What measures.
    pub sweep: Sweep<'a>,
}

/// The settings of a method.
struct MethodSettings {
    method: String,
    settings: Vec<CostSetting>,
}

impl Analysis<'_> {
    /// Measures all settings and says what they show.
    ///
    /// # Errors
    /// Runs cannot be started, or none came to its end.
    pub fn findings(&mut self, ranges: &ParameterRanges) -> Result<Findings> {
        let (methods, mut notes) = self.measure(ranges)?;
        self.expect_some()?;
        let mut refined = self.finest(&methods);
        let sensitivities = match &mut refined {
            Some((finest, limit)) => vec![self.refined_in_time(&methods, finest, limit)?],
            None => Vec::new(),
        };
        let reference = match (self.sweep.options.exact.is_empty(), &refined) {
            (false, _) => Some(Reference::given(self.sweep.options, &self.sweep.metric)),
            (true, Some((finest, limit))) => Some(Reference::extrapolated(finest, limit, &sensitivities[0], &self.sweep.metric)),
            (true, None) => None,
        };
        notes.extend(refined.as_ref().and_then(|(finest, _)| self.steadiness(finest)));
        notes.extend(self.faster());
        let mut findings = Findings { sensitivities, notes, ..self.judged(&methods, reference) };
        self.change_the_chosen(&mut findings)?;
        Ok(findings)
    }

    /// Changes the parameters of the finest setting, and makes its limit one of vanishing steps where these follow the grid and one run tells their error:
    /// they change by factors of two, so that they do not vanish with the spacing.
    fn refined_in_time(&mut self, all: &[MethodSettings], finest: &mut Finest, limit: &mut Limit) -> Result<Sensitivity> {
        let sensitivity = self.sweep.sensitivity(&finest.setting, Some(&limit.values))?;
        let Some(without) = self.limit_of_vanishing_steps(all, finest, &sensitivity) else { return Ok(sensitivity) };
        (*limit, finest.without_step_error) = (without, true);
        self.sweep.sensitivity(&finest.setting, Some(&limit.values))
    }

    fn limit_of_vanishing_steps(&self, all: &[MethodSettings], finest: &Finest, sensitivity: &Sensitivity) -> Option<Limit> {
        let (metric, method) = (&self.sweep.metric, &finest.setting.method);
        let error = self.sweep.step_error(&finest.setting, sensitivity)?;
        let main = RefinementSequence::main(&self.sequences(all.iter().find(|own| own.method == *method)?))?;
        let runs: Vec<Measured> = main.measured().into_iter().map(|run| error.taken_from(run, self.sweep.scene.end())).collect();
        Limit::of(&runs.iter().collect::<Vec<_>>(), metric, metric.quantity.kind.predicted_order(method))
    }

    /// All settings and methods beside the reference.
    fn judged(&self, all: &[MethodSettings], reference: Option<Reference>) -> Findings {
        let Sweep { options, scene, metric, .. } = &self.sweep;
        let methods = all.iter().map(|own| self.method(own, reference.as_ref())).collect();
        let settings = all.iter().flat_map(|own| &own.settings);
        let points = settings.filter_map(|setting| self.point(setting, reference.as_ref())).collect();
        Findings {
            title: scene.shown_title().to_owned(),
            quantity: metric.words(),
            name: metric.quantity.kind.word(),
            ranks: options.ranks,
            repeat: options.start.repeat,
            wanted: options.error,
            times: self.times,
            reference,
            points,
            methods,
            written: Some(CostSetting::of_scene(scene)),
            sensitivities: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Changes the parameters of the cheapest setting, and tells what error each change leaves.
    fn change_the_chosen(&mut self, findings: &mut Findings) -> Result<()> {
        let chosen = findings.cheapest().map(|cheapest| cheapest.setting.clone());
        if let Some(chosen) = chosen.filter(|chosen| findings.sensitivities.iter().all(|known| known.at != *chosen)) {
            let limit = findings.reference.as_ref().map(|reference| reference.values.as_slice());
            let own = self.sweep.sensitivity(&chosen, limit)?;
            findings.sensitivities.insert(0, own);
        }
        if let Some(reference) = &findings.reference {
            let changes = findings.sensitivities.iter_mut().flat_map(|sensitivity| &mut sensitivity.parameters);
            let measured = changes.filter(|change| change.seconds.is_some());
            measured.for_each(|change| change.error = Some(self.sweep.metric.error(&change.values, &reference.values)));
        }
        Ok(())
    }

    /// Runs of all methods that the scene allows, and why others or finer grids are left out.
    fn measure(&mut self, ranges: &ParameterRanges) -> Result<(Vec<MethodSettings>, Vec<String>)> {
        let (mut all, mut notes) = (Vec::new(), Vec::new());
        for method in &ranges.methods {
            let trial = [format!("method.constraint={method}"), "resolution.modes=auto".into()];
            if let Err(refusal) = self.sweep.scene_with(&trial) {
                let reason = refusal.to_string();
                notes.push(format!("{method} is left out: {}", reason.strip_prefix("--set: ").unwrap_or(&reason)));
                continue;
            }
            let settings = ranges.settings(method, self.sweep.scene, self.sweep.metric.properties.unit());
            notes.extend(self.sweep.measure(&settings)?);
            all.push(MethodSettings { method: method.clone(), settings });
        }
        Ok((all, notes))
    }

    fn expect_some(&self) -> Result<()> {
        let records = self.sweep.experiment.store.records();
        if records.iter().any(|record| record.measured().is_some()) {
            return Ok(());
        }
        let reasons = records.iter().map(CostRecord::to_string).collect::<Vec<_>>().join("\n");
        Err(Error::refused(format!("no setting could be measured:\n{reasons}")))
    }

    /// The finest setting of the method that the others are referred to, and the limit of its sequence.
    fn finest(&self, all: &[MethodSettings]) -> Option<(Finest, Limit)> {
        let named = self.sweep.options.reference.as_deref();
        let (first, others): (Vec<_>, Vec<_>) = all.iter().partition(|own| own.method == named.unwrap_or(REFERENCE));
        let limit = |own: &&MethodSettings| {
            let main = RefinementSequence::main(&self.sequences(own))?;
            let order = self.sweep.metric.quantity.kind.predicted_order(&own.method);
            let limit = Limit::of(&main.measured(), &self.sweep.metric, order)?;
            Some((self.finest_of(&main), limit))
        };
        first.iter().find_map(limit).or_else(|| others.iter().filter(|_| named.is_none()).find_map(limit))
    }

    fn finest_of(&self, sequence: &RefinementSequence) -> Finest {
        let ((setting, run), scene) = (sequence.finest(), self.sweep.scene);
        Finest {
            setting: setting.clone(),
            tolerance: setting.tolerance_in(scene),
            without_step_error: false,
            still_to_come: run.still_to_come,
            boundary_layer: run.boundary_layer,
        }
    }

    /// Whether the flow is steady at the end of the finest run, where it may become so.
    fn steadiness(&self, finest: &Finest) -> Option<String> {
        let (to_come, Sweep { options, scene, metric, .. }) = (finest.still_to_come?, &self.sweep);
        let (end, name) = (scene.end(), metric.quantity.kind.word());
        let CostSetting { method, .. } = &finest.setting;
        let change = format!("{name} by {method}, {}, is to change by a further {} or so", finest.setting.words(), percent(to_come));
        Some(match to_come <= STEADY * options.error {
            true => format!("The flow is steady at time.end = {end}: {change}"),
            false => format!(
                "The flow is not steady at time.end = {end}: {change}, more than a tenth of the wanted {}; errors are those at that time. Give more \
                 time, --set time.end={}, unless the flow swings for ever",
                percent(options.error),
                2.0 * end
            ),
        })
    }

    fn sequences(&self, own: &MethodSettings) -> Vec<RefinementSequence<'_>> {
        RefinementSequence::all(self.sweep.experiment.store.records(), &own.settings)
    }

    fn method(&self, own: &MethodSettings, reference: Option<&Reference>) -> MethodFinding {
        let finding = MethodFinding {
            method: own.method.clone(),
            order: None,
            predicted_order: self.sweep.metric.quantity.kind.predicted_order(&own.method),
            seconds_exponent: None,
            cheapest: None,
        };
        let sequences = self.sequences(own);
        let Some((reference, main)) = reference.zip(RefinementSequence::main(&sequences)) else { return finding };
        let criterion = ErrorCriterion {
            error: |values: &[f64]| self.sweep.metric.error(values, &reference.values),
            uncertainty: reference.uncertainty,
            wanted: self.sweep.options.error,
            times: self.times,
        };
        let [order, seconds] = criterion.growth(&main).map(|power| power.map(|power| power.exponent));
        let predicted = || criterion.predicted(&main, self.sweep.metric.properties.unit());
        MethodFinding { order, seconds_exponent: seconds, cheapest: criterion.cheapest(&sequences).or_else(predicted), ..finding }
    }

    fn point(&self, setting: &CostSetting, reference: Option<&Reference>) -> Option<SettingFinding> {
        let record = self.sweep.experiment.store.find(setting)?;
        let error = |values: &[f64]| reference.map(|reference| self.sweep.metric.error(values, &reference.values));
        Some(SettingFinding::of(
            record,
            self.sweep.metric.properties.radius,
            error,
            reference.map_or(0.0, |reference| reference.uncertainty),
        ))
    }

    /// A faster inverse that the runs could have taken.
    fn faster(&self) -> Option<String> {
        let runs = self.sweep.experiment.store.records().iter().filter_map(|record| record.measured());
        let inverse = runs.max_by(|one, two| one.unknowns.total_cmp(&two.unknowns))?.faster.clone()?;
        Some(format!("method.inverse = {inverse:?} suits this box and would solve faster: --set method.inverse={inverse}"))
    }
}
