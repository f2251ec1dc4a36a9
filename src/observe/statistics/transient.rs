//! How much of the beginning of a record to leave out (MSER-5: White 1997, doi:10.1177/003754979706900601).

use crate::linalg::ROUNDING;

/// Samples that are averaged before they are looked at.
const BATCH: usize = 5;

/// Part of the samples that is left out of every record.
pub(super) const ALWAYS: f64 = 0.1;

/// To what part of itself the variance of the mean must fall for more to be left out: the quietest rest of a record without a start-up is quiet by chance,
/// and its interval too narrow.
const NOTABLY: f64 = 0.6;

/// How many samples at the beginning to leave out: a tenth, or as many as make `variance of the rest / number of the rest` smallest if that is notably
/// smaller.
///
/// Nothing if that would be half of them or more: the record has not become steady.
pub fn transient(samples: &[f64]) -> Option<usize> {
    let variances = variances(samples);
    let half = variances.len() / 2;
    let least = ((ALWAYS * variances.len() as f64).ceil() as usize).min(half);
    let best = (least..=half).min_by(|one, other| variances[*one].total_cmp(&variances[*other]))?;
    if variances[best] >= NOTABLY * variances[least] {
        return Some(least * BATCH);
    }
    (best < half).then_some(best * BATCH)
}

/// Estimates of the variance of the mean of what begins at each batch, as if batches were independent.
fn variances(samples: &[f64]) -> Vec<f64> {
    let batches = samples.chunks_exact(BATCH).map(|batch| batch.iter().sum::<f64>() / BATCH as f64);
    let (mut count, mut mean, mut squares) = (0.0, 0.0, 0.0);
    let of_the_rest = |batch: f64| {
        count += 1.0;
        let off = batch - mean;
        mean += off / count;
        squares += off * (batch - mean);
        (squares / count + (ROUNDING * mean).powi(2)) / count
    };
    let mut variances: Vec<f64> = batches.rev().map(of_the_rest).collect();
    variances.reverse();
    variances
}
