//! The interval of the mean of correlated samples by blocking (Flyvbjerg & Petersen 1989, doi:10.1063/1.457480).

/// Scatter over the mean that is rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// Fewest blocks whose scatter counts.
pub const FEWEST_BLOCKS: usize = 8;

/// Largest correlation of neighbours among the longest blocks: more is rare by chance, so the record is shorter than its own memory.
const MOST_CORRELATED: f64 = 0.5;

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

/// The mean of samples at equal distances, with its 95 % interval; nothing for fewer samples than [`FEWEST_BLOCKS`], or if even the longest
/// blocks are correlated.
///
/// Blocks of 1, 2, 4, .. samples whose means have the scatter `s` give the half width `t s / sqrt(blocks)`, which grows with the blocks until
/// they are longer than the correlation. The widest counts: a short record then errs on the safe side.
pub fn interval(samples: &[f64]) -> Option<Interval> {
    if samples.len() < FEWEST_BLOCKS {
        return None;
    }
    let mean = mean(samples);
    let mut widest = Interval { mean, half_width: 0.0, blocks: samples.len() };
    let (mut length, mut last) = (1, (0.0, 0.0));
    while samples.len() / length >= FEWEST_BLOCKS {
        let blocks = samples.len() / length;
        let means = block_means(samples, blocks, length);
        let half_width = half_width(&means);
        if half_width > widest.half_width {
            widest = Interval { mean, half_width, blocks };
        }
        last = (half_width, correlation(&means));
        length *= 2;
    }
    // blocks that hardly scatter any more may be correlated
    let (half_width, correlation) = last;
    let too_short = correlation > MOST_CORRELATED && half_width > 0.5 * widest.half_width && half_width > ROUNDING * mean.abs();
    (!too_short).then_some(widest)
}

/// Means of the last so many blocks of a length.
pub(super) fn block_means(samples: &[f64], blocks: usize, length: usize) -> Vec<f64> {
    samples[samples.len() - blocks * length..].chunks(length).map(mean).collect()
}

/// Half width of the 95 % interval of the mean of independent samples.
fn half_width(samples: &[f64]) -> f64 {
    let (mean, count) = (mean(samples), samples.len() as f64);
    let variance = samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / (count - 1.0);
    student(count - 1.0) * (variance / count).sqrt()
}

/// Correlation of neighbours; 0 for samples that are all the same.
pub(super) fn correlation(samples: &[f64]) -> f64 {
    let mean = mean(samples);
    let squares: f64 = samples.iter().map(|sample| (sample - mean).powi(2)).sum();
    let products: f64 = samples.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum();
    if squares > 0.0 { products / squares } else { 0.0 }
}

fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
}

/// The 97.5 % quantile of Student's distribution for one to five degrees of freedom.
const FEW: [f64; 5] = [12.706_205, 4.302_653, 3.182_446, 2.776_445, 2.570_582];

/// The 97.5 % quantile of Student's distribution with a whole number of degrees of freedom, to three digits (Abramowitz & Stegun 26.7.5).
pub fn student(freedom: f64) -> f64 {
    if let Some(quantile) = FEW.get((freedom as usize).wrapping_sub(1)) {
        return *quantile;
    }
    let z = 1.959_963_984_540_054_f64;
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
        (79.0 * z.powi(9) + 776.0 * z.powi(7) + 1482.0 * z.powi(5) - 1920.0 * z.powi(3) - 945.0 * z) / 92160.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| (sum + term) / freedom) + z
}
