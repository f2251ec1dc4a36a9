//! The ticks of the colour bar: its range, the round values on it and their labels.

use super::colour::{ColourMap, DIVERGING, SEQUENTIAL};

/// Parts of the values that a colour bar shows; the rest takes the colours at its ends. Vorticity is largest in thin layers on walls and bodies.
const SHOWN: f64 = 0.995;
const SHOWN_OF_SIGNED: f64 = 0.98;

/// The range and the labels of a colour bar.
#[derive(Clone, Debug)]
pub struct Bar {
    /// The value at the bottom: zero, or minus that at the top.
    pub bottom: f64,
    /// The value at the top, positive.
    pub top: f64,
    /// Round values, about five.
    pub ticks: Vec<f64>,
    /// Power of ten the labels are to be multiplied by.
    pub exponent: i32,
    decimals: usize,
}

impl Bar {
    /// The bar for values that are not negative: it goes from zero to their 99.5th percentile, or to one if they all vanish, but to `least` at least.
    pub fn new(values: &[f64], least: f64) -> Self {
        let top = robust_maximum(values.to_vec(), SHOWN).max(least);
        Bar::between(0.0, top, round_step(top))
    }

    /// The bar for values of either sign: it goes as far below zero as above, to the 98th percentile of their magnitudes, but to `least` at least.
    pub fn signed(values: &[f64], least: f64) -> Self {
        let top = robust_maximum(values.iter().map(|value| value.abs()).collect(), SHOWN_OF_SIGNED).max(least);
        Bar::between(-top, top, 2.0 * round_step(top))
    }

    fn between(bottom: f64, top: f64, step: f64) -> Self {
        let whole = |value: f64| (value / step * (1.0 + 1e-9)) as i64;
        let ticks = (whole(bottom)..=whole(top)).map(|k| k as f64 * step).collect();
        let exponent = decade(top);
        let exponent = if (-3..4).contains(&exponent) { 0 } else { exponent };
        Bar { bottom, top, ticks, exponent, decimals: (exponent - decade(step)).max(0) as usize }
    }

    /// Where a value lies on the bar, from zero at the bottom to one at the top.
    pub fn part(&self, value: f64) -> f64 {
        ((value - self.bottom) / (self.top - self.bottom)).clamp(0.0, 1.0)
    }

    /// Its colours.
    pub fn colours(&self) -> &'static ColourMap {
        if self.bottom < 0.0 { &DIVERGING } else { &SEQUENTIAL }
    }

    /// The label of a tick, in units of the power of ten.
    pub fn label(&self, tick: f64) -> String {
        format!("{:.*}", self.decimals, tick / 10f64.powi(self.exponent))
    }
}

/// A value that is not exceeded by a part of them.
fn robust_maximum(mut values: Vec<f64>, part: f64) -> f64 {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    let percentile = values.get((part * last as f64).ceil() as usize).copied();
    let maximum = values.last().copied();
    [percentile, maximum].into_iter().flatten().find(|&value| value > 1e-300).unwrap_or(1.0)
}

/// The step of the form 1, 2 or 5 times a power of ten that cuts a range into nearly four parts.
pub fn round_step(range: f64) -> f64 {
    let steps = (-2..=0).flat_map(|shift| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(decade(range) + shift)));
    let misfit = |step: &f64| ((range / step).floor() - 4.0).abs();
    steps.min_by(|a, b| misfit(a).total_cmp(&misfit(b))).expect("there are nine steps")
}

/// The power of ten below a positive value.
pub fn decade(value: f64) -> i32 {
    (value.log10() + 1e-9).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(top: f64) -> Vec<String> {
        let bar = Bar::new(&[top], 0.0);
        bar.ticks.iter().map(|&tick| bar.label(tick)).collect()
    }

    #[test]
    fn ticks_are_about_five_round_numbers() {
        assert_eq!(labels(1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(4.3), ["0", "1", "2", "3", "4"]);
        assert_eq!(labels(0.023), ["0.000", "0.005", "0.010", "0.015", "0.020"]);
        assert_eq!(labels(3.1e-7), ["0", "1", "2", "3"]);
        for top in [1e-9, 0.13, 0.77, 1.5, 1.99, 6.0, 7.9, 9.9, 350.0, 8.8e12] {
            assert!((3..=7).contains(&labels(top).len()), "{top}: {:?}", labels(top));
        }
    }

    #[test]
    fn a_signed_bar_reaches_as_far_below_zero_as_above() {
        let bar = Bar::signed(&[-3.0, 0.5, 1.0], 0.0);
        assert_eq!((bar.bottom, bar.top, bar.ticks.as_slice()), (-3.0, 3.0, &[-2.0, 0.0, 2.0][..]));
        assert_eq!([-3.0, 0.0, 1.5, 9.0].map(|value| bar.part(value)), [0.0, 0.5, 0.75, 1.0]);
        for top in [1e-9, 0.13, 0.77, 1.5, 1.99, 6.0, 7.9, 9.9, 350.0, 8.8e12] {
            let ticks = Bar::signed(&[top], 0.0).ticks.len();
            assert!((3..=9).contains(&ticks), "{top}: {ticks}");
        }
    }

    #[test]
    fn the_range_ignores_a_few_outliers_and_values_that_are_not_finite() {
        let mut values = vec![1.0; 1000];
        values.extend([50.0, f64::NAN, f64::INFINITY]);
        assert_eq!(Bar::new(&values, 0.0).top, 1.0);
    }

    #[test]
    fn what_is_at_rest_is_not_scaled_to_its_noise() {
        assert_eq!(Bar::new(&[1e-14, 2e-14], 1e-5).top, 1e-5);
        assert_eq!(Bar::signed(&[1e-14, -2e-14], 1e-5).bottom, -1e-5);
    }

    #[test]
    fn a_field_at_rest_has_a_range_all_the_same() {
        assert_eq!(Bar::new(&[0.0; 4], 0.0).top, 1.0);
        assert_eq!(Bar::new(&[f64::NAN], 0.0).top, 1.0);
        assert_eq!(Bar::new(&[1e-290, 1e-290], 0.0).ticks[0], 0.0);
    }
}
