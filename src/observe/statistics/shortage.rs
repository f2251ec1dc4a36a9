//! How much longer a record must be for its mean to be known.

use super::{
    blocking::{FEWEST_BLOCKS, block_means, correlation},
    resampled,
    steady::{FEWEST_SAMPLES, MOST_SAMPLES},
    transient,
};

/// Correlation of neighbouring blocks up to which they count as independent of each other.
const INDEPENDENT: f64 = 0.5;

/// Why a curve has no steady mean, and about how much further it must go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shortage {
    /// There are too few samples.
    FewSamples(Option<f64>),
    /// The curve drifts over its first half at least.
    Drift(f64),
    /// The curve remembers itself for so long that there are fewer independent stretches than an interval needs.
    Memory(f64),
}

impl Shortage {
    /// Of a curve of abscissas that grow and values without a steady part; how much further is in units of the abscissa.
    pub fn of(curve: &[(f64, f64)]) -> Shortage {
        let samples = resampled(curve, curve.len().saturating_sub(1).min(MOST_SAMPLES));
        if samples.len() < FEWEST_SAMPLES {
            let further = |length: f64| length * (FEWEST_SAMPLES as f64 / samples.len() as f64 - 1.0);
            return Shortage::FewSamples((!samples.is_empty()).then(|| further(curve[curve.len() - 1].0 - curve[0].0)));
        }
        let length = curve[curve.len() - 1].0 - curve[0].0;
        let Some(left_out) = transient(&samples) else { return Shortage::Drift(length) };
        let rest = &samples[left_out..];
        let block = 1 << (rest.len() / FEWEST_BLOCKS).ilog2();
        let blocks = rest.len() / block;
        let factor = lengthening(correlation(&block_means(rest, blocks, block)));
        let wanted = factor * (FEWEST_BLOCKS * block) as f64 - rest.len() as f64;
        Shortage::Memory(wanted.max(block as f64) * length / samples.len() as f64)
    }

    /// How much further the curve must go, at least, if that can be told.
    pub fn further(self) -> Option<f64> {
        match self {
            Shortage::FewSamples(further) => further,
            Shortage::Drift(further) | Shortage::Memory(further) => Some(further),
        }
    }
}

/// By what factor blocks of which neighbours have this correlation must be longer to be independent, if memory fades exponentially.
fn lengthening(correlation: f64) -> f64 {
    let length = |wanted: f64| {
        let (mut short, mut long) = (1e-6, 1e3);
        for _ in 0..100 {
            let middle: f64 = 0.5 * (short + long);
            if of_blocks(middle) > wanted { short = middle } else { long = middle }
        }
        short
    };
    length(INDEPENDENT) / length(correlation.clamp(INDEPENDENT, 0.98))
}

/// The correlation of neighbouring blocks of a length in units of the correlation time.
fn of_blocks(length: f64) -> f64 {
    let faded = -(-length).exp_m1();
    if length < 1e-3 { 1.0 - 2.0 * length / 3.0 } else { faded * faded / (2.0 * (length - faded)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(count: usize, value: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..count).map(|step| 0.01 * step as f64).map(|strain| (strain, value(strain))).collect()
    }

    #[test]
    fn a_record_says_why_it_is_too_short() {
        let few = Shortage::of(&curve(21, |_| 1.0));
        assert!(matches!(few, Shortage::FewSamples(Some(further)) if (further - 0.2).abs() < 1e-9), "{few:?}");
        assert_eq!(Shortage::of(&[]).further(), None);
        let drift = Shortage::of(&curve(401, |strain| strain));
        assert!(matches!(drift, Shortage::Drift(further) if (further - 4.0).abs() < 1e-9), "{drift:?}");
    }

    #[test]
    fn blocks_of_a_faster_memory_need_less_lengthening() {
        assert!((lengthening(INDEPENDENT) - 1.0).abs() < 1e-6);
        assert!((1.5..6.0).contains(&lengthening(0.75)) && lengthening(0.9) > lengthening(0.75));
        assert!((of_blocks(1e-3) - of_blocks(1.001e-3)).abs() < 1e-5);
        assert!((of_blocks(1.15) - 0.5).abs() < 0.01);
    }
}
