//! What a sweep reads from one run.

use serde::{Deserialize, Serialize};

use crate::observe::statistics::{interval, mean_from, samples_from};

/// Part of a run in time that is left out of a mean where nothing says when it became steady.
const START_UP: f64 = 0.5;

/// Which part of a run a number is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Over {
    /// An instantaneous solve.
    Instant,
    /// The end of a run in time.
    End,
    /// A mean over its steady part.
    Steady,
    /// A mean over its second half, which need not be steady.
    SecondHalf,
    /// An entry of `summary.json`, which says itself what it is.
    Summary,
}

impl Over {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Over::Instant => "instant",
            Over::End => "end",
            Over::Steady => "steady part",
            Over::SecondHalf => "second half",
            Over::Summary => "summary",
        }
    }
}

/// A mean over a part of a run in time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TimeMean {
    /// The mean.
    pub value: f64,
    /// Half the width of its 95 % interval and the number of blocks of the run from which that comes; nothing for a few steps.
    pub spread: Option<(f64, usize)>,
}

impl TimeMean {
    /// Over the second half of a curve of times or strains and values; nothing of an empty one.
    pub fn of_second_half(curve: &[(f64, f64)]) -> Option<TimeMean> {
        let ([first, .., last] | [first @ last]) = curve else { return None };
        let from = first.0 + START_UP * (last.0 - first.0);
        let spread = interval(&samples_from(curve, from)).map(|interval| (interval.half_width, interval.blocks));
        Some(TimeMean { value: mean_from(curve, from), spread })
    }
}

/// A number that a run tells, and what is known of it besides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// The number.
    pub value: f64,
    /// Half the width of its 95 % interval over the time of the run and the number of blocks from which that comes, if it is a mean over time.
    pub spread: Option<(f64, usize)>,
    /// What it is from.
    pub over: Over,
    /// The mean over the second half of the run beside that over its steady part: to be averaged with runs that have not become steady.
    pub second_half: Option<TimeMean>,
}

impl Reading {
    /// A number without an interval.
    pub fn of(value: f64, over: Over) -> Reading {
        Reading { value, spread: None, over, second_half: None }
    }

    /// A mean over a steady part with its interval, beside that over the second half.
    pub fn steady(value: f64, spread: (f64, usize), second_half: TimeMean) -> Reading {
        Reading { value, spread: Some(spread), over: Over::Steady, second_half: Some(second_half) }
    }

    /// A mean over the second half.
    pub fn second_half(mean: TimeMean) -> Reading {
        Reading { value: mean.value, spread: mean.spread, over: Over::SecondHalf, second_half: None }
    }

    /// The same run, if it is not to be told apart from those that have not become steady.
    pub fn over_second_half(self) -> Reading {
        self.second_half.map_or(self, Reading::second_half)
    }
}
