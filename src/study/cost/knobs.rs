//! Which knob dominates the error of a setting: each is turned on its own, and the change of the quantity compared.

use serde::Serialize;

use super::{
    facts,
    quantity::norm,
    record::{Measured, Outcome},
    setting::{Setting, has_modes},
    sweep::Sweep,
};
use crate::{
    error::Result,
    scene::{Scene, Tolerance},
};

/// A knob that was turned.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Knob {
    /// Which.
    pub name: &'static str,
    /// To where.
    pub to: String,
    /// Relative change of the quantity, with its sign where that is one value.
    pub change: Option<f64>,
    /// Why there is none, or where it comes from.
    pub remark: Option<String>,
    /// Relative error that is left, once there is a reference.
    pub error: Option<f64>,
    /// Seconds of the run.
    pub seconds: Option<f64>,
    /// Change of each value.
    #[serde(skip)]
    pub changes: Vec<f64>,
    /// The values.
    #[serde(skip)]
    pub values: Vec<f64>,
}

/// A setting whose knobs were turned.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Turned {
    /// The setting.
    pub at: Setting,
    /// Its knobs.
    pub knobs: Vec<Knob>,
}

impl Turned {
    /// The knob that changes most.
    pub fn dominating(&self) -> Option<&Knob> {
        let sized = self.knobs.iter().filter(|knob| knob.change.is_some_and(|change| change != 0.0));
        sized.max_by(|one, two| one.change.map(f64::abs).partial_cmp(&two.change.map(f64::abs)).unwrap_or(std::cmp::Ordering::Equal))
    }
}

impl Sweep<'_> {
    /// Turns every knob of a setting that was measured; `limit` stands in where half the spacing is beyond the budget.
    ///
    /// # Errors
    /// Runs cannot be started.
    pub fn turn(&mut self, setting: &Setting, scene: &Scene, limit: Option<&[f64]>) -> Result<Turned> {
        let Some(base) = self.record(setting)?.measured().cloned() else {
            return Ok(Turned { at: setting.clone(), knobs: Vec::new() });
        };
        let fixed = Setting { modes: setting.modes.or(base.modes), ..setting.clone() };
        let half = Setting { grid: setting.grid.finer(2.0), ..fixed.clone() };
        let mut knobs = vec![self.knob(("grid", "half the spacing".into()), &base, Some(half))?];
        if let (None, Some(limit)) = (knobs[0].change, limit) {
            knobs[0] = self.extrapolated(&base, limit);
        }
        if has_modes(&setting.method) {
            let raised = base.modes.and_then(|modes| self.raised(&fixed, modes));
            let to = raised.as_ref().and_then(|raised| raised.modes).map_or("more".into(), |modes| format!("{modes} modes"));
            knobs.push(self.knob(("modes", to), &base, raised)?);
        }
        let tighter = tighter(setting, scene);
        let to = format!("tolerance {:.0e}", tighter.tolerance.unwrap_or(0.0));
        knobs.push(self.knob(("tolerance", to), &base, Some(tighter))?);
        if let Some(step) = setting.step {
            let shorter = Setting { step: Some(step.times(0.5)), ..setting.clone() };
            knobs.push(self.knob(("step", "half the step".into()), &base, Some(shorter))?);
        }
        Ok(Turned { at: setting.clone(), knobs })
    }

    fn knob(&mut self, (name, to): (&'static str, String), base: &Measured, turned: Option<Setting>) -> Result<Knob> {
        let none = |remark: String| Knob { name, to: to.clone(), remark: Some(remark), ..Knob::default() };
        let Some(turned) = turned else { return Ok(none("no more of them suit this grid".into())) };
        if !self.affordable(&turned) {
            return Ok(none("takes longer than the sweep, or than --budget".into()));
        }
        let outcome = self.record(&turned)?.outcome.clone();
        Ok(match outcome {
            Outcome::Failed(reason) => none(reason),
            Outcome::Measured(measured) => {
                let near = self.facts.near(&self.quantity, &measured.values, &base.values);
                Knob { seconds: Some(measured.seconds()), ..self.changed((name, to), base, &near) }
            }
        })
    }

    /// What the limit of vanishing spacing would change.
    fn extrapolated(&self, base: &Measured, limit: &[f64]) -> Knob {
        Knob { remark: Some("extrapolated".into()), ..self.changed(("grid", "vanishing spacing".into()), base, limit) }
    }

    fn changed(&self, (name, to): (&'static str, String), base: &Measured, values: &[f64]) -> Knob {
        let changes: Vec<f64> = values.iter().zip(&base.values).map(|(new, old)| new - old).collect();
        let size = if let [change] = changes[..] { change } else { norm(&changes) };
        let change = Some(size / self.facts.scale(&self.quantity, &base.values));
        Knob { name, to, change, changes, values: values.to_vec(), ..Knob::default() }
    }

    /// Half as many modes again, or as many more as the grid carries.
    fn raised(&self, setting: &Setting, modes: usize) -> Option<Setting> {
        let wanted = (modes + modes.div_ceil(2)).max(modes + 2);
        (modes + 1..=wanted)
            .rev()
            .map(|modes| Setting { modes: Some(modes), ..setting.clone() })
            .find(|raised| self.scene_with(&raised.overrides()).is_ok_and(|scene| facts::modes(&scene).is_ok()))
    }
}

/// A tenth of the tolerance; what is automatic in time becomes the tightest that it ever is.
fn tighter(setting: &Setting, scene: &Scene) -> Setting {
    let now = setting.solves_to(scene);
    let automatic_in_time = setting.tolerance.is_none() && scene.time.is_some() && scene.method.tolerance == Tolerance::Auto;
    Setting { tolerance: Some(if automatic_in_time { now } else { 0.1 * now }), ..setting.clone() }
}
