//! How much longer a record must be for its mean to be known.

use super::transient::ALWAYS;

/// Fewest samples of which anything can be said.
pub(super) const FEWEST_SAMPLES: usize = 40;

/// Correlation of neighbouring blocks from which on a record is shorter than its memory.
pub(super) const MOST_CORRELATED: f64 = 0.7;

/// Why a curve has no steady mean, and about how much further it must go, in units of its abscissa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shortage {
    /// There are too few samples.
    FewSamples(Option<f64>),
    /// What is left of the curve without its beginning is shorter than asked for.
    Length(f64),
    /// The curve drifts over its first half at least.
    Drift(f64),
    /// The curve remembers itself for so long that even long blocks are alike.
    Memory(f64),
}

impl Shortage {
    /// Of so many samples over a length.
    pub(super) fn samples(count: usize, length: f64) -> Shortage {
        Shortage::FewSamples((count > 0).then(|| length * (FEWEST_SAMPLES as f64 / count as f64 - 1.0)))
    }

    /// Of a steady part of this length where another is wanted.
    pub(super) fn length(length: f64, least: f64) -> Shortage {
        Shortage::Length((least - length) / (1.0 - ALWAYS))
    }

    /// Of a steady part of a length whose neighbouring blocks have this correlation.
    pub(super) fn memory(correlation: f64, length: f64) -> Shortage {
        Shortage::Memory(length * (lengthening(correlation) - 1.0).max(0.1))
    }

    /// The same, with what another asks for if that is more.
    pub(super) fn or_more(self, other: Shortage) -> Shortage {
        let more = other.further().unwrap_or(0.0);
        match self {
            Shortage::FewSamples(further) => Shortage::FewSamples(further.map(|further| further.max(more))),
            Shortage::Length(further) => Shortage::Length(further.max(more)),
            Shortage::Drift(further) => Shortage::Drift(further.max(more)),
            Shortage::Memory(further) => Shortage::Memory(further.max(more)),
        }
    }

    /// How much further the curve must go, at least, if that can be told.
    pub fn further(self) -> Option<f64> {
        match self {
            Shortage::FewSamples(further) => further,
            Shortage::Length(further) | Shortage::Drift(further) | Shortage::Memory(further) => Some(further),
        }
    }
}

/// By what factor blocks of which neighbours have this correlation must be longer to count, if memory fades exponentially.
fn lengthening(correlation: f64) -> f64 {
    let length = |wanted: f64| {
        let (mut short, mut long) = (1e-6, 1e3);
        for _ in 0..100 {
            let middle: f64 = 0.5 * (short + long);
            if of_blocks(middle) > wanted { short = middle } else { long = middle }
        }
        short
    };
    length(MOST_CORRELATED) / length(correlation.clamp(MOST_CORRELATED, 0.98))
}

/// The correlation of neighbouring blocks of a length in units of the correlation time.
fn of_blocks(length: f64) -> f64 {
    let faded = -(-length).exp_m1();
    if length < 1e-3 { 1.0 - 2.0 * length / 3.0 } else { faded * faded / (2.0 * (length - faded)) }
}

#[cfg(test)]
mod tests {
    use super::{super::steady, *};

    fn shortage(count: usize, least: f64, value: impl Fn(f64) -> f64) -> Shortage {
        let curve: Vec<(f64, f64)> = (0..count).map(|step| 0.01 * step as f64).map(|strain| (strain, value(strain))).collect();
        steady(&curve, least).expect_err("the curve is too short")
    }

    #[test]
    fn a_record_says_why_it_is_too_short() {
        let few = shortage(21, 0.0, |_| 1.0);
        assert!(matches!(few, Shortage::FewSamples(Some(further)) if (further - 0.2).abs() < 1e-9), "{few:?}");
        assert_eq!(shortage(0, 0.0, |_| 1.0).further(), None);
        let drift = shortage(401, 0.0, |strain| strain);
        assert!(matches!(drift, Shortage::Drift(further) if (further - 4.0).abs() < 1e-9), "{drift:?}");
        let memory = shortage(401, 0.0, |strain| (1.7 * strain).cos());
        assert!(matches!(memory, Shortage::Memory(further) if further > 0.3), "{memory:?}");
    }

    /// A constant over 4 has 3.6 without its first tenth, and needs 10 / 0.9 in all for 10.
    #[test]
    fn a_steady_part_that_is_too_short_tells_what_it_lacks() {
        let length = shortage(401, 10.0, |_| 1.0);
        assert!(matches!(length, Shortage::Length(further) if (4.0 + further - 10.0 / 0.9).abs() < 1e-9), "{length:?}");
    }

    #[test]
    fn a_curve_with_too_few_samples_tells_the_length_that_it_lacks_too() {
        let few = shortage(21, 10.0, |_| 1.0);
        assert!(matches!(few, Shortage::FewSamples(Some(further)) if (0.2 + further - 10.0 / 0.9).abs() < 1e-9), "{few:?}");
        let drift = shortage(401, 10.0, |strain| strain);
        assert!(matches!(drift, Shortage::Drift(further) if (4.0 + further - 10.0 / 0.9).abs() < 1e-9), "{drift:?}");
    }

    #[test]
    fn blocks_of_a_faster_memory_need_less_lengthening() {
        assert!((lengthening(MOST_CORRELATED) - 1.0).abs() < 1e-6);
        assert!((1.1..3.0).contains(&lengthening(0.8)) && lengthening(0.9) > lengthening(0.8));
        assert!((of_blocks(1e-3) - of_blocks(1.001e-3)).abs() < 1e-5);
        assert!((of_blocks(1.15) - 0.5).abs() < 0.01);
    }
}
