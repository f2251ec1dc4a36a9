//! The range of a chart along one coordinate, its ticks and their labels.

use super::bar::{decade, round_step};

/// The range of one coordinate.
pub struct Axis {
    low: f64,
    high: f64,
    /// Values are logarithms: ticks are powers of ten.
    powers: bool,
}

impl Axis {
    /// From the least to the largest value, or some range around values that are all the same.
    pub fn tight(values: &[f64]) -> Self {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        match high - low {
            span if span > 1e-9 * low.abs().max(high.abs()) && span > 1e-290 => Axis { low, high, powers: false },
            _ if low.abs() > 1e-280 && low.is_finite() => Axis { low: low - 0.1 * low.abs(), high: low + 0.1 * low.abs(), powers: false },
            _ => Axis { low: 0.0, high: 1.0, powers: false },
        }
    }

    /// With some air on either side, or down to zero if that is not far.
    pub fn loose(values: &[f64]) -> Self {
        let Axis { low, high, .. } = Axis::tight(values);
        let air = 0.06 * (high - low);
        Axis { low: if low >= 0.0 && low < 0.4 * high { 0.0 } else { low - air }, high: high + air, powers: false }
    }

    /// Of logarithms, with some air on either side.
    pub fn decades(values: &[f64]) -> Self {
        let Axis { low, high, .. } = Axis::tight(values);
        let air = 0.04 * (high - low);
        Axis { low: low - air, high: high + air, powers: true }
    }

    /// Where a value lies between the ends, from 0 to 1.
    pub fn part(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    fn step(&self) -> f64 {
        round_step(self.high - self.low)
    }

    /// Round values within the range.
    pub fn ticks(&self) -> Vec<f64> {
        if self.powers {
            return self.powers_of_ten();
        }
        let step = self.step();
        let [first, last] = [(self.low / step - 1e-6).ceil(), (self.high / step + 1e-6).floor()];
        (0..=(last - first) as usize).map(|k| (first + k as f64) * step + 0.0).collect()
    }

    /// Powers of ten, with twice and five times as much between them where these alone are few.
    fn powers_of_ten(&self) -> Vec<f64> {
        let digits: &[f64] = if self.high - self.low < 3.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let powers = self.low.floor() as i32..=self.high.floor() as i32;
        let ticks = powers.flat_map(|power| digits.iter().map(move |digit| f64::from(power) + digit.log10()));
        ticks.filter(|tick| (self.low..=self.high).contains(tick)).collect()
    }

    /// A tick with as many digits as tell it from the next, and a power of ten if it is very large or small.
    pub fn label(&self, tick: f64) -> String {
        if self.powers {
            let value = 10f64.powf(tick);
            let decimals = (-tick.floor()).max(0.0) as usize;
            return if tick.abs() < 5.0 { format!("{value:.decimals$}") } else { format!("{value:.0e}").replace('-', "\u{2212}") };
        }
        let largest = decade(self.low.abs().max(self.high.abs()));
        let decimals = |unit: i32| (unit - decade(self.step())).max(0) as usize;
        let text = if tick == 0.0 && !(-3..5).contains(&largest) {
            "0".into()
        } else if (-3..5).contains(&largest) {
            format!("{tick:.*}", decimals(0))
        } else {
            format!("{:.*}e{largest}", decimals(largest), tick / 10f64.powi(largest))
        };
        text.replace('-', "\u{2212}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ordinate_starts_at_zero_only_where_the_curve_stays_steep() {
        assert_eq!(Axis::loose(&[0.3, 2.0]).low, 0.0);
        assert!(Axis::loose(&[1.8, 2.0]).low > 1.7);
    }

    #[test]
    fn ticks_are_round_and_told_apart() {
        let labels = |low, high| {
            Axis { low, high, powers: false }.ticks().iter().map(|&tick| Axis { low, high, powers: false }.label(tick)).collect::<Vec<_>>()
        };
        assert_eq!(labels(0.0, 2.1), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(labels(-1.0, 1.0), ["\u{2212}1.0", "\u{2212}0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(1.2e-7, 3.1e-7), ["1.5e\u{2212}7", "2.0e\u{2212}7", "2.5e\u{2212}7", "3.0e\u{2212}7"]);
    }

    #[test]
    fn powers_of_ten_have_others_between_them_where_they_are_few() {
        let labels = |low: f64, high: f64| {
            Axis::decades(&[low, high]).ticks().iter().map(|&tick| Axis::decades(&[low, high]).label(tick)).collect::<Vec<_>>()
        };
        assert_eq!(labels(-1.1, 0.4), ["0.1", "0.2", "0.5", "1", "2"]);
        assert_eq!(labels(-6.0, 1.0), ["1e\u{2212}6", "1e\u{2212}5", "0.0001", "0.001", "0.01", "0.1", "1", "10"]);
    }
}
