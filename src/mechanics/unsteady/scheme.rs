//! The backward differentiation formula of second order, with steps of any length; of first order in the first step.

/// Part of the second difference of convection that is added to its linear extrapolation. All of it would make that of third order; with this part errors are
/// a third of those of the linear one, and where there is no viscosity waves that move up to 0.7 cells a step do not grow. By the linear one
/// alone they grow, at half a cell by 7 % a step.
const SECOND_DIFFERENCE: f64 = 2.0 / 3.0;

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

    /// Earlier times at most from which convection is extrapolated: in a step of first order the last one alone.
    pub fn levels(&self) -> usize {
        if self.rate[2] == 0.0 { 1 } else { 3 }
    }

    /// Weights of the last flow and the one before in that of which a part of the viscous flux is taken, in a step in which viscosity passes so many `cells`, squared. In longer
    /// steps what is extrapolated would grow, and the last flow alone says it well enough.
    pub fn of_known_flux(&self, cells: f64) -> [f64; 2] {
        let change = self.extrapolation[1] / (1.0 + 10.0 * cells);
        [1.0 - change, change]
    }

    /// What the formula makes of a unit of the mean force of contacts over the step, which is an impulse.
    pub fn of_impulse(&self) -> f64 {
        self.rate[0] * self.step
    }
}

/// Weights of convection at up to three earlier times, the last one first, in that at a time.
pub fn convection_weights(time: f64, earlier: &[f64]) -> [f64; 3] {
    let &[last, before, ..] = earlier else { return [1.0, 0.0, 0.0] };
    let (step, last_step) = (time - last, last - before);
    let linear = [1.0 + step / last_step, -step / last_step, 0.0];
    let Some(first_step) = earlier.get(2).map(|first| before - first) else { return linear };
    let both = last_step + first_step;
    let part = SECOND_DIFFERENCE * step * (step + last_step);
    let divided = [1.0 / (last_step * both), -1.0 / (last_step * first_step), 1.0 / (first_step * both)];
    std::array::from_fn(|level| linear[level] + part * divided[level])
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

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

    #[test]
    fn convection_is_extrapolated_to_second_order_and_with_more_levels_better() {
        let (parabola, times) = (|t: f64| 3.0 - 2.0 * t + 5.0 * t * t, [0.0, -0.1, -0.25]);
        let error = |levels: usize| {
            let weights = convection_weights(0.2, &times[..levels]);
            weights.iter().zip(times).map(|(weight, time)| weight * parabola(time)).sum::<f64>() - parabola(0.2)
        };
        assert!((error(1) - (parabola(0.0) - parabola(0.2))).abs() < 1e-14);
        let linear = error(2);
        assert!(linear.abs() > 0.1 && (error(3) - (1.0 - SECOND_DIFFERENCE) * linear).abs() < 1e-14);
    }

    /// The largest factor by which a wave that moves so many cells a step grows in a step, from one step to the next.
    fn growth(cells: f64) -> f64 {
        let weights = [StepWeights::new(1.0, Some(1.0)).rate, convection_weights(1.0, &[0.0, -1.0, -2.0])];
        let mut levels = [Complex::new(1.0, 0.0), Complex::new(0.3, 0.4), Complex::new(-0.2, 0.1)];
        let mut size = 1.0;
        for step in 0..400 {
            let history: Complex<f64> = (0..2).map(|level| levels[level] * weights[0][level + 1]).sum();
            let convection: Complex<f64> = (0..3).map(|level| levels[level] * weights[1][level]).sum();
            let next = -(history + convection * Complex::new(0.0, cells)) / weights[0][0];
            levels = [next, levels[0], levels[1]];
            if step == 200 {
                size = next.norm();
            }
        }
        (levels[0].norm() / size).powf(1.0 / 200.0)
    }

    #[test]
    fn waves_without_viscosity_do_not_grow_at_courant_number_one_half() {
        for cells in [0.05, 0.2, 0.4, 0.5, 0.6] {
            let growth = growth(cells);
            assert!(growth <= 1.0, "{cells}: {growth}");
        }
        assert!(growth(0.8) > 1.01);
    }

    #[test]
    fn a_known_flux_is_extrapolated_in_short_steps_and_does_not_grow_in_long_ones() {
        let weights = StepWeights::new(0.2, Some(0.1));
        let line = |[last, before]: [f64; 2]| last * 1.0 + before * (1.0 - 4.0 * 0.1);
        assert!((line(weights.of_known_flux(0.0)) - (1.0 + 4.0 * 0.2)).abs() < 1e-14);
        assert_eq!(weights.of_known_flux(f64::INFINITY), [1.0, 0.0]);
        // the shortest wave, whose fourth-order flux is 4/3 of that of second order, in one dimension
        for cells in [0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0] {
            let StepWeights { rate, .. } = StepWeights::new(1.0, Some(1.0));
            let known = StepWeights::new(1.0, Some(1.0)).of_known_flux(cells);
            let mut values = [1.0, -0.5_f64];
            for _ in 0..200 {
                let explicit: f64 = (0..2).map(|level| (rate[level + 1] + 4.0 / 3.0 * cells * known[level]) * values[level]).sum();
                values = [-explicit / (rate[0] + 4.0 * cells), values[0]];
            }
            assert!(values[0].abs() < 0.1, "{cells}: {values:?}");
        }
    }
}
