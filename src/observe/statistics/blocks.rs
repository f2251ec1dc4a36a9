//! The interval of the mean of correlated samples from the scatter of few long blocks.
//!
//! The mean of a block that is much longer than the correlation of the samples is nearly independent of its neighbours (Conway 1963,
//! doi:10.1287/mnsc.10.1.47), and as there are few blocks, Student's distribution replaces the normal one. How many blocks are few enough cannot be
//! chosen on the samples without making the interval too narrow: two numbers are fixed, and the wider of the two intervals counts.

/// Numbers of blocks that the samples are divided into.
pub const BLOCKS: [usize; 2] = [3, 6];

/// Fewest samples that have an interval.
pub const FEWEST: usize = 8;

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

/// The mean of samples at equal distances, with its 95 % interval; nothing for fewer samples than [`FEWEST`].
///
/// `K` blocks whose means have the scatter `s` give the half width `t s / sqrt(K)`, `t` the quantile of `K - 1` degrees of freedom; the wider of those of
/// [`BLOCKS`] counts. It holds the mean of 97 in 100 records of independent samples and of 93 that are 20 correlation times long (integrals of the
/// correlation function).
pub fn interval(samples: &[f64]) -> Option<Interval> {
    if samples.len() < FEWEST {
        return None;
    }
    let mean = mean(samples);
    let [few, many] = BLOCKS.map(|blocks| Interval { mean, half_width: half_width(&block_means(samples, blocks)), blocks });
    Some(if few.half_width > many.half_width { few } else { many })
}

/// Means of so many blocks, equally long but for a sample.
pub(super) fn block_means(samples: &[f64], blocks: usize) -> Vec<f64> {
    let edge = |number: usize| samples.len() * number / blocks;
    (0..blocks).map(|number| mean(&samples[edge(number)..edge(number + 1)])).collect()
}

/// Half width of the 95 % interval of the mean of independent samples.
fn half_width(samples: &[f64]) -> f64 {
    let (mean, count) = (mean(samples), samples.len() as f64);
    let variance = samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / (count - 1.0);
    student(count - 1.0) * (variance / count).sqrt()
}

/// The mean; not a number without samples.
pub fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
}

/// The standard error of the mean of independent samples; not a number for fewer than two.
pub fn standard_error(samples: &[f64]) -> f64 {
    let (mean, count) = (mean(samples), samples.len() as f64);
    let squares: f64 = samples.iter().map(|sample| (sample - mean).powi(2)).sum();
    (squares / (count * (count - 1.0))).sqrt()
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
