//! Each parameter of a setting is changed on its own, and the change of the quantity compared.

use super::{
    metric::norm,
    properties::SceneProperties,
    record::{Measured, Outcome},
    sensitivity::{ParameterChange, Sensitivity},
    setting::{Setting, has_modes},
    sweep::Sweep,
};
use crate::{
    error::Result,
    scene::{Scene, Tolerance},
};

impl Sweep<'_> {
    /// Changes every parameter of a setting that was measured; `limit` stands in where half the spacing is beyond the budget.
    ///
    /// # Errors
    /// Runs cannot be started.
    pub fn sensitivity(&mut self, setting: &Setting, limit: Option<&[f64]>) -> Result<Sensitivity> {
        let Some(base) = self.record(setting)?.measured().cloned() else {
            return Ok(Sensitivity { at: setting.clone(), parameters: Vec::new() });
        };
        let fixed = Setting { modes: setting.modes.or(base.modes), ..setting.clone() };
        let half = Setting { grid: setting.grid.finer(2.0), ..fixed.clone() };
        let mut parameters = vec![self.parameter("grid", "half the spacing".into(), &base, Some(half))?];
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
            let step = if step.follows_grid(self.scene) { base.mean_step(self.scene.end()) } else { step };
            let shorter = Setting { step: Some(step.times(0.5)), ..setting.clone() };
            parameters.push(self.parameter("step", "half the step".into(), &base, Some(shorter))?);
        }
        Ok(Sensitivity { at: setting.clone(), parameters })
    }

    fn parameter(&mut self, name: &'static str, to: String, base: &Measured, changed: Option<Setting>) -> Result<ParameterChange> {
        let none = |remark: String| ParameterChange { name, to: to.clone(), remark: Some(remark), ..ParameterChange::default() };
        let Some(changed) = changed else { return Ok(none("no more of them suit this grid".into())) };
        if !self.affordable(&changed) {
            return Ok(none("takes longer than the sweep, or than --budget".into()));
        }
        let outcome = self.record(&changed)?.outcome.clone();
        Ok(match outcome {
            Outcome::Failed(reason) => none(reason),
            Outcome::Measured(measured) => {
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
        let size = if let [change] = changes[..] { change } else { norm(&changes) };
        let change = Some(size / self.metric.scale(&base.values));
        ParameterChange { name, to, change, changes, values: values.to_vec(), ..ParameterChange::default() }
    }

    /// Half as many modes again, or as many more as the grid carries.
    fn raised(&self, setting: &Setting, modes: usize) -> Option<Setting> {
        let wanted = (modes + modes.div_ceil(2)).max(modes + 2);
        (modes + 1..=wanted)
            .rev()
            .map(|modes| Setting { modes: Some(modes), ..setting.clone() })
            .find(|raised| self.scene_with(&raised.overrides()).is_ok_and(|scene| SceneProperties::of(&scene).is_ok()))
    }
}

/// A tenth of the tolerance; what is automatic in time becomes the tightest that it ever is.
fn tighter(setting: &Setting, scene: &Scene) -> Setting {
    let now = setting.tolerance_in(scene);
    let automatic_in_time = setting.tolerance.is_none() && scene.time.is_some() && scene.method.tolerance == Tolerance::Auto;
    Setting { tolerance: Some(if automatic_in_time { now } else { 0.1 * now }), ..setting.clone() }
}
