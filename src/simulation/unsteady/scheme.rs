//! The backward differentiation formula of second order, with steps of any length; of first order in the first step.

/// Weights of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepWeights {
    /// Length of the step.
    pub step: f64,
    /// Of the new value, the last and the one before in the rate of change, over time.
    pub rate: [f64; 3],
    /// Of the last value and the one before in the value extrapolated to the new time.
    pub extrapolation: [f64; 2],
}

impl StepWeights {
    /// Those of a step after another one, if there was any.
    pub fn new(step: f64, last_step: Option<f64>) -> StepWeights {
        let Some(last_step) = last_step else {
            return StepWeights { step, rate: [1.0 / step, -1.0 / step, 0.0], extrapolation: [1.0, 0.0] };
        };
        let ratio = step / last_step;
        let rate = [(1.0 + 2.0 * ratio) / (1.0 + ratio), -(1.0 + ratio), ratio * ratio / (1.0 + ratio)];
        StepWeights { step, rate: rate.map(|weight| weight / step), extrapolation: [1.0 + ratio, -ratio] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabolas_have_their_exact_rates_with_unequal_steps() {
        let parabola = |t: f64| 3.0 - 2.0 * t + 5.0 * t * t;
        for (last, step) in [(0.1, 0.1), (0.1, 0.2), (0.3, 0.05)] {
            let StepWeights { rate, extrapolation, .. } = StepWeights::new(step, Some(last));
            let values = [parabola(step), parabola(0.0), parabola(-last)];
            let found: f64 = rate.iter().zip(values).map(|(weight, value)| weight * value).sum();
            assert!((found - (-2.0 + 10.0 * step)).abs() < 1e-12);
            let line = extrapolation[0] * 1.0 + extrapolation[1] * (1.0 - 4.0 * last);
            assert!((line - (1.0 + 4.0 * step)).abs() < 1e-12);
        }
    }
}
