//! What a sweep reads from one run.

use serde::{Deserialize, Serialize};

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

/// A number that a run tells, and what is known of it besides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// The number.
    pub value: f64,
    /// Half the width of its 95 % interval over the time of the run, if it is a mean over a steady part.
    pub half_width: Option<f64>,
    /// What it is from.
    pub over: Over,
    /// The mean over the second half of the run beside that over its steady part: to be averaged with runs that have not become steady.
    pub second_half: Option<f64>,
}

impl Reading {
    /// A number without an interval.
    pub fn of(value: f64, over: Over) -> Reading {
        Reading { value, half_width: None, over, second_half: None }
    }

    /// A mean over a steady part, beside that over the second half.
    pub fn steady(value: f64, half_width: f64, second_half: f64) -> Reading {
        Reading { value, half_width: Some(half_width), over: Over::Steady, second_half: Some(second_half) }
    }

    /// The same run, if it is not to be told apart from those that have not become steady.
    pub fn over_second_half(self) -> Reading {
        self.second_half.map_or(self, |value| Reading::of(value, Over::SecondHalf))
    }
}
