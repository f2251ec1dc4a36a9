//! Each parameter of a setting is changed on its own, and the change of the quantity compared.

use super::{
    metric::norm,
    properties::SceneProperties,
    record::Measured,
    sensitivity::{ParameterChange, Sensitivity},
    setting::{CostSetting, TimeStep, has_modes},
    step_error::StepError,
    sweep::Sweep,
};
use crate::{
    error::Result,
    experiment::record::RunOutcome,
    scene::{Scene, Tolerance},
};

impl Sweep<'_> {
    /// Changes every parameter of a setting that was measured; `limit` stands in where half the spacing is beyond the budget.
    ///
    /// # Errors
    /// Runs cannot be started.
    pub fn sensitivity(&mut self, setting: &CostSetting, limit: Option<&[f64]>) -> Result<Sensitivity> {
        let Some(base) = self.record(setting)?.measured().cloned() else {
            return Ok(Sensitivity { at: setting.clone(), parameters: Vec::new() });
        };
        let fixed = CostSetting { modes: setting.modes.or(base.modes), ..setting.clone() };
        let half = half_the_spacing(setting, &base);
        let mut parameters = vec![self.parameter("grid", "half the spacing".into(), &base, Some(half.clone()))?];
        if let (None, Some(limit)) = (parameters[0].change, limit) {
            parameters[0] = self.extrapolated(&base, limit);
        }
        if has_modes(&setting.method) {
            let raised = base.modes.and_then(|modes| self.raised(&fixed, modes));
            let to = raised.as_ref().and_then(|raised| raised.modes).map_or("more".into(), |modes| format!("{modes} modes"));
            parameters.push(self.parameter("modes", to, &base, raised)?);
        }
        let tighter = tighter(setting, self.scene);
        let to = format!("tolerance {:.0e}", tighter.tolerance.unwrap_or(0.0));
        parameters.push(self.parameter("tolerance", to, &base, Some(tighter))?);
        if let Some(step) = setting.step {
            let shorter = CostSetting { step: Some(self.shorter(step, &base, &half)), ..setting.clone() };
            let change = self.parameter("step", "half the step".into(), &base, Some(shorter))?;
            if step.follows_grid(self.scene) {
                parameters[0] = self.at_equal_steps(&parameters[0], &change, &base);
            }
            parameters.push(change);
        }
        Ok(Sensitivity { at: setting.clone(), parameters })
    }

    /// The error of steps that follow the grid, if a run with shorter ones was made beside that of the setting.
    pub fn step_error(&self, setting: &CostSetting, sensitivity: &Sensitivity) -> Option<StepError> {
        let step = setting.step.filter(|step| step.follows_grid(self.scene))?;
        let change = sensitivity.parameters.iter().find(|parameter| parameter.name == "step" && parameter.change.is_some())?;
        let base = self.experiment.store.find(setting)?.measured()?;
        let lengths = [base.mean_step(self.scene.end()), self.shorter(step, base, &half_the_spacing(setting, base))];
        Some(StepError::of(&change.changes, lengths.map(TimeStep::length)))
    }

    /// Half a step; of one that follows the grid what it is in the mean on the grid of half the spacing, if that is measured, or half of what it is here.
    fn shorter(&self, step: TimeStep, base: &Measured, half: &CostSetting) -> TimeStep {
        let end = self.scene.end();
        match self.experiment.store.find(half).and_then(|record| record.measured()) {
            _ if !step.follows_grid(self.scene) => step.times(0.5),
            Some(finer) => finer.mean_step(end),
            None => base.mean_step(end).times(0.5),
        }
    }

    /// What the grid alone changes, where steps were shorter on the finer one: without what shorter steps change. In a limit they vanish, which changes
    /// a third more than half of them, as they are of second order.
    fn at_equal_steps(&self, grid: &ParameterChange, step: &ParameterChange, base: &Measured) -> ParameterChange {
        if grid.change.is_none() || step.change.is_none() {
            return grid.clone();
        }
        let (part, remark) = if grid.seconds.is_some() { (1.0, "at equal steps") } else { (4.0 / 3.0, "extrapolated, at equal steps") };
        let changes: Vec<f64> = grid.changes.iter().zip(&step.changes).map(|(both, step)| both - part * step).collect();
        ParameterChange { change: Some(self.size(&changes, base)), changes, remark: Some(remark.into()), ..grid.clone() }
    }

    fn parameter(&mut self, name: &'static str, to: String, base: &Measured, changed: Option<CostSetting>) -> Result<ParameterChange> {
        let none = |remark: String| ParameterChange { name, to: to.clone(), remark: Some(remark), ..ParameterChange::default() };
        let Some(changed) = changed else { return Ok(none("no more of them suit this grid".into())) };
        if !self.affordable(&changed) {
            return Ok(none("takes longer than the sweep, or than --budget".into()));
        }
        Ok(match self.record(&changed)?.outcome.clone() {
            RunOutcome::Failed(reason) => none(reason),
            RunOutcome::Measured(measured) => {
                let near = self.metric.near(&measured.values, &base.values);
                ParameterChange { seconds: Some(measured.seconds()), ..self.changed(name, to, base, &near) }
            }
        })
    }

    /// What the limit of vanishing spacing would change.
    fn extrapolated(&self, base: &Measured, limit: &[f64]) -> ParameterChange {
        ParameterChange { remark: Some("extrapolated".into()), ..self.changed("grid", "vanishing spacing".into(), base, limit) }
    }

    fn changed(&self, name: &'static str, to: String, base: &Measured, values: &[f64]) -> ParameterChange {
        let changes: Vec<f64> = values.iter().zip(&base.values).map(|(new, old)| new - old).collect();
        ParameterChange {
            name,
            to,
            change: Some(self.size(&changes, base)),
            changes,
            values: values.to_vec(),
            ..ParameterChange::default()
        }
    }

    /// Changes relative to the values of a run, with their sign where there is one.
    fn size(&self, changes: &[f64], base: &Measured) -> f64 {
        let size = if let [change] = changes[..] { change } else { norm(changes) };
        size / self.metric.scale(&base.values)
    }

    /// Half as many modes again, or as many more as the grid carries.
    fn raised(&self, setting: &CostSetting, modes: usize) -> Option<CostSetting> {
        let wanted = (modes + modes.div_ceil(2)).max(modes + 2);
        (modes + 1..=wanted)
            .rev()
            .map(|modes| CostSetting { modes: Some(modes), ..setting.clone() })
            .find(|raised| self.scene_with(&raised.overrides()).is_ok_and(|scene| SceneProperties::of(&scene).is_ok()))
    }
}

/// A setting on the grid of half the spacing, with as many modes as it had in a run.
fn half_the_spacing(setting: &CostSetting, run: &Measured) -> CostSetting {
    CostSetting { grid: setting.grid.finer(2.0), modes: setting.modes.or(run.modes), ..setting.clone() }
}

/// A tenth of the tolerance; what is automatic in time becomes the tightest that it ever is.
fn tighter(setting: &CostSetting, scene: &Scene) -> CostSetting {
    let now = setting.tolerance_in(scene);
    let automatic_in_time = setting.tolerance.is_none() && scene.time.is_some() && scene.method.tolerance == Tolerance::Auto;
    CostSetting { tolerance: Some(if automatic_in_time { now } else { 0.1 * now }), ..setting.clone() }
}
