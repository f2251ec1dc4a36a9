//! The interval of the mean of correlated samples by blocking (Flyvbjerg & Petersen 1989, doi:10.1063/1.457480).

/// Fewest blocks whose scatter counts.
pub const FEWEST_BLOCKS: usize = 8;

/// A mean and the half width of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The mean.
    pub mean: f64,
    /// Half the width.
    pub half_width: f64,
    /// Number of blocks from whose scatter it comes.
    pub blocks: usize,
}

/// The mean of samples at equal distances, with its 95 % interval; nothing for fewer samples than [`FEWEST_BLOCKS`].
///
/// Blocks of 1, 2, 4, .. samples whose means have the scatter `s` give the half width `t s / sqrt(blocks)`, which grows with the blocks until
/// they are longer than the correlation. The widest counts: a short record then errs on the safe side.
pub fn interval(samples: &[f64]) -> Option<Interval> {
    if samples.len() < FEWEST_BLOCKS {
        return None;
    }
    let mean = mean(samples);
    let mut widest = Interval { mean, half_width: 0.0, blocks: samples.len() };
    let mut length = 1;
    while samples.len() / length >= FEWEST_BLOCKS {
        let blocks = samples.len() / length;
        let half_width = half_width(&block_means(samples, blocks, length));
        if half_width > widest.half_width {
            widest = Interval { mean, half_width, blocks };
        }
        length *= 2;
    }
    Some(widest)
}

/// Means of the last so many blocks of a length.
fn block_means(samples: &[f64], blocks: usize, length: usize) -> Vec<f64> {
    samples[samples.len() - blocks * length..].chunks(length).map(mean).collect()
}

/// Half width of the 95 % interval of the mean of independent samples.
fn half_width(samples: &[f64]) -> f64 {
    let (mean, count) = (mean(samples), samples.len() as f64);
    let variance = samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / (count - 1.0);
    student(count - 1.0) * (variance / count).sqrt()
}

fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
}

/// The 97.5 % quantile of Student's distribution, to a thousandth from six degrees of freedom on (Abramowitz & Stegun 26.7.5).
pub(super) fn student(freedom: f64) -> f64 {
    let z = 1.959_963_984_540_054_f64;
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| (sum + term) / freedom) + z
}
