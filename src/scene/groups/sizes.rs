//! How the radii of the bodies of a group differ.

use std::f64::consts::SQRT_2;

use toml_edit::Value;

use crate::{
    error::Result,
    scene::{
        entry::Entry,
        groups::keys::{LOGNORMAL, SIZES_KEYS},
        table::Table,
    },
};

/// Largest ratio of a radius to that of its group, or of that to a radius: grids and tables of pairs are made for no more.
const WIDEST: f64 = 100.0;

/// The distribution of the radii of bodies that are placed at random, in units of the radius of their group.
#[derive(Debug, Clone, PartialEq)]
pub enum SizeDistribution {
    /// These radii, each of which fills the same part of the volume of the bodies.
    List(Vec<f64>),
    /// The radius of the group, and `ratio` times that, which fills the part `share` of the volume of the bodies.
    Bidisperse {
        /// The other radius.
        ratio: f64,
        /// Between 0 and 1.
        share: f64,
    },
    /// Log-normal by number about the radius of the group as median, without what lies beyond `smallest` and `largest`.
    LogNormal {
        /// Standard deviation of the logarithm.
        deviation: f64,
        /// Least radius.
        smallest: f64,
        /// Greatest radius.
        largest: f64,
    },
}

impl SizeDistribution {
    pub(in crate::scene) fn read(entry: &Entry) -> Result<SizeDistribution> {
        let ratio = |entry: &Entry| {
            let ratio = entry.positive()?;
            entry.expect(
                ratio,
                (1.0 / WIDEST..=WIDEST).contains(&ratio),
                &format!("must be from {} to {WIDEST} times the radius", 1.0 / WIDEST),
            )
        };
        if let Value::Array(_) = entry.value {
            let radii = entry.list()?;
            entry.expect((), !radii.is_empty(), "must hold at least one radius")?;
            return Ok(SizeDistribution::List(radii.iter().map(ratio).collect::<Result<_>>()?));
        }
        if !entry.value.is_inline_table() {
            return Err(
                entry.mistyped("a list of radii, { ratio = 1.4, share = 0.5 } or { deviation = 0.2, smallest = 0.5, largest = 2.0 }")
            );
        }
        if Table::of(entry, &SIZES_KEYS)?.get("ratio").is_some() {
            let table = Table::of(entry, &SIZES_KEYS[..LOGNORMAL])?;
            let part = |entry: Entry| {
                let share = entry.number()?;
                entry.expect(share, share > 0.0 && share < 1.0, "must lie between 0 and 1")
            };
            let share = table.get("share").map_or(Ok(0.5), part)?;
            return Ok(SizeDistribution::Bidisperse { ratio: ratio(&table.require("ratio", "1.4")?)?, share });
        }
        let table = Table::of(entry, &SIZES_KEYS[LOGNORMAL..])?;
        let bound = |name, example| ratio(&table.require(name, example)?);
        let (smallest, largest) = (bound("smallest", "0.5")?, bound("largest", "2.0")?);
        entry.expect((), smallest < largest, "needs smallest below largest")?;
        let deviation = table.require("deviation", "0.2")?;
        let wide = deviation.positive()?;
        deviation.expect((), wide <= 2.0, "must be 2 at most")?;
        Ok(SizeDistribution::LogNormal { deviation: wide, smallest, largest })
    }

    /// The radii of so many bodies, ascending: each is the middle of an equal part of the distribution, so that they depend on no seed.
    pub fn radii(&self, dimension: usize, count: usize) -> Vec<f64> {
        (0..count).map(|body| self.radius_of(dimension, body, count)).collect()
    }

    /// That of one of them.
    pub fn radius_of(&self, dimension: usize, body: usize, count: usize) -> f64 {
        let part = (body as f64 + 0.5) / count as f64;
        match self {
            SizeDistribution::LogNormal { deviation, smallest, largest } => {
                let below = |radius: f64| 0.5 * libm::erfc(-radius.ln() / (deviation * SQRT_2));
                let [first, last] = [*smallest, *largest].map(below);
                bisect(below, first + (last - first) * part, [*smallest, *largest])
            }
            SizeDistribution::List(_) | SizeDistribution::Bidisperse { .. } => {
                let size_classes = self.size_classes(dimension);
                size_classes[size_classes.partition_point(|class| class.until < part).min(size_classes.len() - 1)].radius
            }
        }
    }

    /// The least radius that is possible.
    pub fn smallest(&self) -> f64 {
        match self {
            SizeDistribution::List(radii) => radii.iter().copied().fold(f64::INFINITY, f64::min),
            SizeDistribution::Bidisperse { ratio, .. } => ratio.min(1.0),
            SizeDistribution::LogNormal { smallest, .. } => *smallest,
        }
    }

    /// The mean volume of many bodies, over that of one of the group's radius.
    pub fn mean_volume(&self, dimension: usize) -> f64 {
        let power = |radius: &f64| radius.powi(dimension as i32);
        match self {
            SizeDistribution::LogNormal { deviation, smallest, largest } => {
                // the moments of a log-normal distribution are those of one whose logarithm is shifted
                let shift = dimension as f64 * deviation;
                let between = |shift: f64| {
                    let [first, last] = [smallest, largest].map(|radius| libm::erfc((shift - radius.ln() / deviation) / SQRT_2));
                    last - first
                };
                (0.5 * shift * shift).exp() * between(shift) / between(0.0)
            }
            SizeDistribution::List(_) | SizeDistribution::Bidisperse { .. } => {
                let size_classes = self.size_classes(dimension);
                let before = std::iter::once(0.0).chain(size_classes.iter().map(|class| class.until));
                size_classes.iter().zip(before).map(|(class, before)| (class.until - before) * power(&class.radius)).sum()
            }
        }
    }

    /// Few radii, ascending, with the part by number of the bodies that are no larger.
    fn size_classes(&self, dimension: usize) -> Vec<SizeClass> {
        let shares = match self {
            SizeDistribution::List(radii) => radii.iter().map(|radius| (*radius, 1.0)).collect(),
            SizeDistribution::Bidisperse { ratio, share } => vec![(1.0, 1.0 - share), (*ratio, *share)],
            SizeDistribution::LogNormal { .. } => Vec::new(),
        };
        let mut numbers: Vec<(f64, f64)> =
            shares.into_iter().map(|(radius, share)| (radius, share / radius.powi(dimension as i32))).collect();
        numbers.sort_by(|one, other| one.0.total_cmp(&other.0));
        let all: f64 = numbers.iter().map(|(_, number)| number).sum();
        let mut until = 0.0;
        let class = |(radius, number): (f64, f64)| {
            until += number / all;
            SizeClass { radius, until }
        };
        numbers.into_iter().map(class).collect()
    }
}

/// A radius, and the part of all bodies that are no larger.
struct SizeClass {
    radius: f64,
    until: f64,
}

/// Where a function that grows takes a value between two places.
fn bisect(function: impl Fn(f64) -> f64, value: f64, [mut low, mut high]: [f64; 2]) -> f64 {
    // as many halvings as a mantissa has bits
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if function(middle) < value { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_fill_the_parts_of_the_volume_that_they_are_given() {
        for dimension in [2, 3] {
            let power = |radius: &f64| radius.powi(dimension as i32);
            let radii = SizeDistribution::Bidisperse { ratio: 1.4, share: 0.25 }.radii(dimension, 10_000);
            let large: f64 = radii.iter().filter(|radius| **radius > 1.2).map(power).sum();
            assert!((large / radii.iter().map(power).sum::<f64>() - 0.25).abs() < 1e-3);
            let sizes = SizeDistribution::List(vec![2.0, 1.0, 3.0]);
            let radii = sizes.radii(dimension, 10_000);
            let volume: f64 = radii.iter().map(power).sum();
            for size in [1.0, 2.0, 3.0] {
                let part = radii.iter().filter(|radius| **radius == size).map(power).sum::<f64>() / volume;
                assert!((part - 1.0 / 3.0).abs() < 2e-3, "{size}: {part}");
            }
            assert!((volume / 10_000.0 / sizes.mean_volume(dimension) - 1.0).abs() < 2e-3);
        }
    }

    /// Moments of a log-normal distribution that is hardly cut: mean of `r^n` is `exp(n^2 s^2 / 2)`.
    #[test]
    fn log_normal_radii_have_the_moments_of_their_distribution() {
        let sizes = SizeDistribution::LogNormal { deviation: 0.2, smallest: 0.2, largest: 5.0 };
        let radii = sizes.radii(3, 20_000);
        let moment = |power: i32| radii.iter().map(|radius| radius.powi(power)).sum::<f64>() / radii.len() as f64;
        for power in 1..4 {
            let exact = (0.5 * f64::from(power * power) * 0.04).exp();
            assert!((moment(power) / exact - 1.0).abs() < 1e-3, "{power}: {} for {exact}", moment(power));
        }
        let cut = SizeDistribution::LogNormal { deviation: 0.5, smallest: 0.8, largest: 1.25 }.radii(2, 101);
        assert!(cut[0] > 0.8 && cut[100] < 1.25 && (cut[50] - 1.0).abs() < 1e-9);
        assert!((sizes.mean_volume(3) / moment(3) - 1.0).abs() < 1e-3);
        let narrow = SizeDistribution::LogNormal { deviation: 0.5, smallest: 0.8, largest: 1.25 };
        let mean = narrow.radii(2, 20_000).iter().map(|radius| radius * radius).sum::<f64>() / 20_000.0;
        assert!((narrow.mean_volume(2) / mean - 1.0).abs() < 1e-6, "{} for {mean}", narrow.mean_volume(2));
    }
}
