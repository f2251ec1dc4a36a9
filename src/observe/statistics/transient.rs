//! How much of the beginning of a record to leave out (MSER-5: White 1997, doi:10.1177/003754979706900601).

use super::blocking::ROUNDING;

/// Samples that are averaged before they are looked at.
const BATCH: usize = 5;

/// How many samples at the beginning to leave out: as many as make `variance of the rest / number of the rest` smallest.
///
/// Nothing if that would be half of them or more: the record has not become steady.
pub fn transient(samples: &[f64]) -> Option<usize> {
    let batches: Vec<f64> = samples.chunks_exact(BATCH).map(|batch| batch.iter().sum::<f64>() / BATCH as f64).collect();
    let (mut best, mut smallest) = (0, f64::INFINITY);
    let (mut count, mut mean, mut squares) = (0.0, 0.0, 0.0);
    for (place, batch) in batches.iter().enumerate().rev() {
        count += 1.0;
        let off = batch - mean;
        mean += off / count;
        squares += off * (batch - mean);
        let uncertainty = (squares / count + (ROUNDING * mean).powi(2)) / count;
        if place <= batches.len() / 2 && uncertainty <= smallest {
            (best, smallest) = (place, uncertainty);
        }
    }
    (best < batches.len() / 2).then_some(best * BATCH)
}
