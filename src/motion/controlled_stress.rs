//! A shear whose rate a stress decides: the rate is found with the flow and the contacts of each instant, by secants of the stress over the rate, which
//! is a line as long as the same contacts press.

use super::{
    quasi_static::{Agreed, QuasiStatic},
    shift_period::ShiftPeriod,
    stepper::Effort,
};
use crate::{
    error::{Error, Result},
    mechanics::shear_stress,
    scene::Scheme,
    setup::{FoundShear, State},
    system::ResidualMonitor,
};

/// Rates that are tried at an instant.
const MOST_TRIALS: usize = 20;

/// Part of the stress that may be missed, in tolerances of the solves of the step.
const MISSED: f64 = 3.0;

/// Part of the rate of a fluid without bodies below which nothing flows.
const STOPPED: f64 = 1e-9;

/// The shear over a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ShearOfStep {
    /// Its mean rate.
    pub mean_rate: f64,
    /// What is known of it at the end.
    pub found: FoundShear,
}

/// A rate that was tried, and the stress that goes with it.
#[derive(Debug, Clone, Copy)]
struct RateTrial {
    rate: f64,
    stress: f64,
}

/// A search for the rate that goes with a stress.
#[derive(Debug, Clone, Copy)]
struct Search {
    wanted: f64,
    last: Option<RateTrial>,
    /// The fastest that bears too little, and the slowest that bears too much.
    bracket: [Option<RateTrial>; 2],
}

impl Search {
    fn new(wanted: f64) -> Search {
        Search { wanted, last: None, bracket: [None; 2] }
    }

    /// The rate to try after one: on the line through it and the one before, or else through nothing at rest; halfway where that is known to be wrong.
    fn next(&mut self, now: RateTrial) -> f64 {
        self.bracket[usize::from(now.stress > self.wanted)] = Some(now);
        let secant = self.last.replace(now).and_then(|before| now.towards(before, self.wanted));
        let rate = secant.unwrap_or_else(|| now.in_proportion(self.wanted));
        match self.bracket {
            [Some(low), Some(high)] if low.rate < high.rate && !(low.rate < rate && rate < high.rate) => 0.5 * (low.rate + high.rate),
            _ => rate,
        }
    }
}

impl RateTrial {
    /// Where the line through this and another trial has a stress, if that is near.
    fn towards(self, other: RateTrial, wanted: f64) -> Option<f64> {
        let slope = (self.stress - other.stress) / (self.rate - other.rate);
        let rate = self.rate + (wanted - self.stress) / slope;
        (slope.is_finite() && slope > 0.0 && rate > 0.1 * self.rate && rate < 10.0 * self.rate).then_some(rate)
    }

    /// Where the line through nothing at rest has it.
    fn in_proportion(self, wanted: f64) -> f64 {
        if self.stress > 0.0 { self.rate * (wanted / self.stress).clamp(0.1, 10.0) } else { 2.0 * self.rate }
    }
}

impl<const D: usize> QuasiStatic<D> {
    /// Velocities, contacts and the rate on which flow, contacts and the stress agree.
    pub(super) fn agree_at_stress(
        &mut self,
        stress: f64,
        state: &State<D>,
        tried: Option<f64>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Agreed<D>> {
        let (size, unit) = (stress.abs(), stress / self.suspension.setup().viscosity);
        // a stress the other way shears the other way
        let (mut rate, mut search) = (if state.shear.rate == 0.0 { unit.abs() } else { state.shear.rate.abs() }, Search::new(size));
        let (tolerance, mut step) = (MISSED * self.solve_tolerance(state), 0.0);
        for trial in 0..MOST_TRIALS {
            self.try_rate(state, rate * unit.signum());
            let agreed = self.agree_at_rate(state, tried, trial > 0, effort, monitor)?;
            let found = shear_stress(self.suspension.setup(), &agreed.solution, &agreed.contacts) * unit.signum();
            if (found - size).abs() <= tolerance * size {
                return Ok(agreed);
            }
            step = agreed.step_size.natural;
            rate = search.next(RateTrial { rate, stress: found });
            if rate < STOPPED * unit.abs() {
                let text =
                    format!("at time {} nothing flows at flow.drive.shear_stress = {stress}: bodies are jammed; raise it", state.time);
                return Err(Error::Diverged(text));
            }
        }
        Err(Error::StepTooLong { text: format!("at time {} no rate goes with flow.drive.shear_stress = {stress}", state.time), step })
    }

    /// From now on box, drive and steps are those of a rate.
    fn try_rate(&mut self, state: &State<D>, rate: f64) {
        self.tried_rate = Some(rate);
        self.step_control.shift_period = ShiftPeriod::of(&self.domain_at(state), self.suspension.grid());
    }

    /// The time that a step takes in which the shear is followed as motions are, and the shear over it. Where images slide it is the strain that stays as it was
    /// chosen, as they slide by whole cells, unless the stress jumps at its end.
    pub(super) fn shear_over(&self, state: &State<D>, step: f64) -> (f64, ShearOfStep) {
        let Some(rate) = self.tried_rate else { return (step, ShearOfStep::default()) };
        let follows = self.step_control.time.scheme != Scheme::Euler && self.last_step(state) > 0.0;
        let factor = if follows { self.looks_back(state, step) } else { 0.0 };
        let mean_rate = rate + factor * (rate - state.shear.rate);
        // a rate that changes by its own size in a step is not followed
        let mean_rate = if mean_rate * rate > 0.0 { mean_rate } else { rate };
        let slides = self.suspension.setup().domain.slide().is_some() && !self.step_control.ends_at_jump(state.time, step);
        let step = if slides { step * rate / mean_rate } else { step };
        (step, ShearOfStep { mean_rate, found: FoundShear { strain: state.shear.strain + mean_rate * step, rate } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rates that are tried until a stress is met within a part of a thousandth.
    fn tried(stress_of: impl Fn(f64) -> f64, wanted: f64) -> Vec<f64> {
        let (mut rates, mut search) = (vec![1.0], Search::new(wanted));
        loop {
            let rate = *rates.last().unwrap();
            let now = RateTrial { rate, stress: stress_of(rate) };
            if (now.stress - wanted).abs() < 1e-3 * wanted || rates.len() > 30 {
                return rates;
            }
            rates.push(search.next(now));
        }
    }

    #[test]
    fn a_stress_on_a_line_is_met_at_the_third_rate_at_most() {
        assert_eq!(tried(|rate| 3.0 * rate, 6.0), [1.0, 2.0]);
        assert_eq!(tried(|rate| 1.0 + 3.0 * rate, 7.0).len(), 3);
    }

    #[test]
    fn stresses_with_kinks_and_pulls_are_met() {
        assert!(tried(|rate| if rate < 2.0 { 3.0 * rate } else { 6.0 + 30.0 * (rate - 2.0) }, 9.0).len() < 12);
        assert!(tried(|rate| -5.0 + rate, 6.0).len() < 12);
    }
}
