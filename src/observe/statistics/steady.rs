//! The steady part of a curve.

use super::{
    Interval, Shortage,
    blocks::{block_means, mean},
    interval, resampled,
    shortage::{FEWEST_SAMPLES, MOST_CORRELATED},
    transient,
    transient::ALWAYS,
};
use crate::linalg::ROUNDING;

/// Most samples that a curve is turned into.
const MOST_SAMPLES: usize = 4096;

/// Number of blocks that are looked at for drift and memory.
const SEVERAL: usize = 16;

/// Slope of block means, over its standard error, from which on a record drifts: five of 10,000 records of independent samples.
const STEEP: f64 = 5.0;

/// The steady part of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    /// Where it begins.
    pub from: f64,
    /// Where it ends: the end of the curve.
    pub to: f64,
    /// Mean over it, with its interval.
    pub interval: Interval,
}

/// The steady part of a curve of abscissas that grow and values, if it is longer than `least`.
///
/// A tenth of the curve at least, and a start-up that stands out, are left out; the interval of the rest comes from [`interval`].
///
/// # Errors
/// Why there is none: the curve is too short or has not become steady.
pub fn steady(curve: &[(f64, f64)], least: f64) -> std::result::Result<Steady, Shortage> {
    let [from, to] = [curve.first(), curve.last()].map(|point| point.map_or(0.0, |point| point.0));
    // whatever else it lacks, no curve that is shorter has such a part
    steady_part(curve, least).map_err(|shortage| shortage.or_more(Shortage::length((1.0 - ALWAYS) * (to - from), least)))
}

fn steady_part(curve: &[(f64, f64)], least: f64) -> std::result::Result<Steady, Shortage> {
    let samples = resampled(curve, curve.len().saturating_sub(1).min(MOST_SAMPLES));
    let [from, to] = [curve.first(), curve.last()].map(|point| point.map_or(0.0, |point| point.0));
    if samples.len() < FEWEST_SAMPLES {
        return Err(Shortage::samples(samples.len(), to - from));
    }
    let left_out = transient(&samples).ok_or(Shortage::Drift(to - from))?;
    let rest = &samples[left_out..];
    let start = from + (to - from) * left_out as f64 / samples.len() as f64;
    if to - start < least {
        return Err(Shortage::length(to - start, least));
    }
    let blocks = block_means(rest, SEVERAL);
    let (slope, correlation) = trend(&blocks);
    if slope > STEEP {
        return Err(Shortage::Drift(to - from));
    }
    match interval(rest) {
        Some(interval) if correlation <= MOST_CORRELATED => Ok(Steady { from: start, to, interval }),
        _ => Err(Shortage::memory(correlation, to - start)),
    }
}

/// The slope of numbers over its standard error, and the correlation of neighbours; both are 0 for numbers that are all the same.
fn trend(numbers: &[f64]) -> (f64, f64) {
    let (mean, middle) = (mean(numbers), 0.5 * (numbers.len() as f64 - 1.0));
    let off: Vec<f64> = numbers.iter().map(|number| number - mean).collect();
    let squares: f64 = off.iter().map(|off| off * off).sum();
    if squares <= (ROUNDING * mean).powi(2) * numbers.len() as f64 {
        return (0.0, 0.0);
    }
    let places = || (0..numbers.len()).map(|place| place as f64 - middle);
    let spread: f64 = places().map(|place| place * place).sum();
    let slope = places().zip(&off).map(|(place, off)| place * off).sum::<f64>() / spread;
    let beside: f64 = places().zip(&off).map(|(place, off)| (off - slope * place).powi(2)).sum();
    let error = (beside / (numbers.len() as f64 - 2.0) / spread).sqrt();
    let products: f64 = off.windows(2).map(|pair| pair[0] * pair[1]).sum();
    (slope.abs() / error, products / squares)
}
