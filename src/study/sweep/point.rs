//! Means over the seeds of a point of a sweep.

use serde::Serialize;

use super::{
    reading::{Over, Reading},
    record::{Measured, SweepRecord},
    vary::Assignment,
};
use crate::observe::statistics::{mean, standard_error, student};

/// Ratio of the variance of a mean by the scatter of runs to that by their scatter in time above which runs are not alike.
const UNLIKE: f64 = 4.0;

/// What is known of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepPoint {
    /// Keys with their values.
    pub point: Vec<Assignment>,
    /// The quantities, in the order of the command line.
    pub quantities: Vec<Estimate>,
    /// Part of the box that bodies fill, as they were placed, in the mean; nothing if all runs failed.
    pub fraction: Option<f64>,
    /// Runs that came to their end.
    pub runs: usize,
    /// Runs that failed.
    pub failed: usize,
    /// Seconds of a run, in the mean; nothing if all runs failed.
    pub seconds: Option<f64>,
    /// Why runs failed.
    pub remarks: Vec<String>,
}

/// A quantity at a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Name of the quantity.
    pub name: String,
    /// Mean over the runs; nothing if all failed.
    pub mean: Option<f64>,
    /// Standard error of the mean, from the scatter of the runs and that in time of each of them; nothing where neither is known.
    pub standard_error: Option<f64>,
    /// Its 95 % interval by Student's distribution.
    pub interval: Option<[f64; 2]>,
    /// Which part of the runs it is from: the same of all of them.
    pub over: Option<Over>,
    /// How many of the runs have become steady.
    pub steady: usize,
}

impl SweepPoint {
    /// Of its runs.
    pub fn of(point: &[Assignment], names: &[String], records: &[&SweepRecord]) -> SweepPoint {
        let measured: Vec<&Measured> = records.iter().filter_map(|record| record.measured()).collect();
        let mean = |number: fn(&Measured) -> f64| known(mean(&measured.iter().map(|run| number(run)).collect::<Vec<_>>()));
        let estimate = |(place, name): (usize, &String)| {
            Estimate::of(name, &measured.iter().filter_map(|run| run.readings[place]).collect::<Vec<_>>())
        };
        let failure = |record: &&SweepRecord| {
            let reason = record.failure()?;
            Some(record.setting.seed.map_or(reason.to_owned(), |seed| format!("seed {seed}: {reason}")))
        };
        SweepPoint {
            point: point.to_vec(),
            quantities: names.iter().enumerate().map(estimate).collect(),
            fraction: mean(|run| run.fraction),
            runs: measured.len(),
            failed: records.len() - measured.len(),
            seconds: mean(|run| run.seconds),
            remarks: records.iter().filter_map(failure).collect(),
        }
    }
}

impl Estimate {
    /// Of the readings of several runs. A steady mean is not averaged with the second half of a run that is not steady: second halves are then taken of all.
    fn of(name: &str, readings: &[Reading]) -> Estimate {
        let steady = readings.iter().filter(|reading| reading.over == Over::Steady).count();
        let alike = |reading: &Reading| if steady < readings.len() { reading.over_second_half() } else { *reading };
        let alike: Vec<Reading> = readings.iter().map(alike).collect();
        let mean = known(mean(&alike.iter().map(|reading| reading.value).collect::<Vec<_>>()));
        let uncertainty = Uncertainty::of(&alike);
        let interval = mean.zip(uncertainty).map(|(mean, uncertainty)| [mean - uncertainty.half_width(), mean + uncertainty.half_width()]);
        let standard_error = uncertainty.map(|uncertainty| uncertainty.variance.sqrt());
        Estimate { name: name.into(), mean, standard_error, interval, over: alike.first().map(|reading| reading.over), steady }
    }

    /// Which part of so many runs it is from, in words.
    pub fn over_words(&self, runs: usize) -> String {
        match self.over {
            None => "-".into(),
            Some(over) if self.steady > 0 && self.steady < runs => format!("{} ({} of {runs} runs steady)", over.words(), self.steady),
            Some(over) => over.words().into(),
        }
    }
}

/// What is not known of a mean over runs.
#[derive(Debug, Clone, Copy)]
struct Uncertainty {
    /// Variance of the mean.
    variance: f64,
    /// Degrees of freedom of that.
    freedom: f64,
}

impl Uncertainty {
    /// From the scatter of the runs and that in time of each of them: both estimate the same variance where runs are long beside the memory of what
    /// they measure, and are pooled by their degrees of freedom. Where runs differ by more than [`UNLIKE`] times what their times explain, their own scatter
    /// counts alone.
    fn of(readings: &[Reading]) -> Option<Uncertainty> {
        let count = readings.len() as f64;
        let values: Vec<f64> = readings.iter().map(|reading| reading.value).collect();
        let between = (readings.len() > 1).then(|| Uncertainty { variance: standard_error(&values).powi(2), freedom: count - 1.0 });
        let spreads: Option<Vec<(f64, usize)>> = readings.iter().map(|reading| reading.spread).collect();
        let within = spreads.filter(|spreads| !spreads.is_empty()).map(|spreads| {
            let freedom = |blocks: usize| blocks as f64 - 1.0;
            let variances = spreads.iter().map(|&(half_width, blocks)| (half_width / student(freedom(blocks)) / count).powi(2));
            Uncertainty { variance: variances.sum(), freedom: spreads.iter().map(|&(_, blocks)| freedom(blocks)).sum() }
        });
        match (between, within) {
            (Some(between), Some(within)) if between.variance <= UNLIKE * within.variance => {
                let freedom = between.freedom + within.freedom;
                let variance = (between.variance * between.freedom + within.variance * within.freedom) / freedom;
                Some(Uncertainty { variance, freedom })
            }
            (between, within) => between.or(within),
        }
    }

    fn half_width(&self) -> f64 {
        student(self.freedom) * self.variance.sqrt()
    }
}

/// A number, if it is one.
fn known(number: f64) -> Option<f64> {
    (!number.is_nan()).then_some(number)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::{
        experiment::record::RunOutcome,
        study::sweep::{reading::TimeMean, record::SweepSetting},
    };

    fn record(seed: u64, reading: Option<Reading>) -> SweepRecord {
        let setting = SweepSetting { point: vec![("a".into(), "1".into())], seed: Some(seed) };
        let measured =
            |reading| RunOutcome::Measured(Measured { readings: vec![Some(reading)], fraction: 0.3, seconds: 2.0, folder: None });
        SweepRecord { setting, outcome: reading.map_or(RunOutcome::Failed("no room".into()), measured) }
    }

    fn point(records: &[SweepRecord]) -> SweepPoint {
        SweepPoint::of(&records[0].setting.point, &["viscosity".into()], &records.iter().collect::<Vec<_>>())
    }

    fn steady(value: f64, half_width: f64) -> Reading {
        Reading::steady(value, (half_width, 3), TimeMean { value: 10.0 * value, spread: None })
    }

    #[test]
    fn a_point_has_the_interval_of_students_distribution_and_tells_of_failures() {
        let records = [1.0, 2.0, 3.0].map(|value| record(value as u64, Some(Reading::of(value, Over::End))));
        let point = point(&[&records[..], &[record(4, None)]].concat());
        let estimate = &point.quantities[0];
        assert_eq!((point.runs, point.failed, estimate.mean, point.fraction), (3, 1, Some(2.0), Some(0.3)));
        let (error, [low, high]) = (1.0 / 3f64.sqrt(), estimate.interval.unwrap_or_default());
        assert!((estimate.standard_error.unwrap_or(0.0) - error).abs() < 1e-12);
        assert!((high - low - 2.0 * 4.3027 * error).abs() < 1e-3, "{low} {high}");
        assert_eq!((point.remarks, estimate.over_words(3)), (vec!["seed 4: no room".to_owned()], "end".into()));
    }

    #[test]
    fn a_single_run_has_the_interval_of_its_time_and_several_pool_both() {
        let estimate = |readings: &[Reading]| Estimate::of("a", readings);
        let single = estimate(&[steady(1.0, 0.5)]);
        assert!(single.interval.is_some_and(|[low, high]| (low - 0.5).abs() < 1e-9 && (high - 1.5).abs() < 1e-9));
        // standard errors in time of 1 each, and runs that differ as much as these say
        let pooled = estimate(&[steady(-1.0, student(2.0)), steady(1.0, student(2.0))]);
        assert!(pooled.standard_error.is_some_and(|error| (error * error - (1.0 + 4.0 * 0.5) / 5.0).abs() < 1e-9), "{pooled:?}");
        // ten times as far apart: their scatter alone
        let apart = estimate(&[steady(-10.0, student(2.0)), steady(10.0, student(2.0))]);
        assert_eq!(apart.standard_error, Some(10.0));
    }

    /// Runs of an autoregressive process whose correlation falls by `exp(-1/20)` a sample, 50 correlation times long, of mean 0.
    #[test]
    fn intervals_of_several_runs_hold_the_mean_as_often_as_they_say() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let mut run = || {
            let (memory, mut value) = ((-1.0_f64 / 20.0).exp(), normal());
            let curve: Vec<(f64, f64)> = (0..4000)
                .map(|time| {
                    value = memory * value + (1.0 - memory * memory).sqrt() * normal();
                    (f64::from(time), value)
                })
                .collect();
            TimeMean::of_second_half(&curve).map(Reading::second_half)
        };
        for seeds in [1, 2, 3, 5] {
            let held = (0..400).filter(|_| {
                let readings: Vec<Reading> = (0..seeds).filter_map(|_| run()).collect();
                Estimate::of("a", &readings).interval.is_some_and(|[low, high]| low < 0.0 && 0.0 < high)
            });
            let part = held.count() as f64 / 400.0;
            assert!((0.92..0.99).contains(&part), "{seeds} runs: {part}");
        }
    }

    #[test]
    fn steady_means_are_not_averaged_with_halves_of_runs_that_are_not_steady() {
        let half = |value: f64| TimeMean { value, spread: None };
        let unsteady = Some(Reading::second_half(half(4.0)));
        let point = point(&[record(1, Some(Reading::steady(1.0, (0.5, 3), half(2.0)))), record(2, unsteady)]);
        assert_eq!(point.quantities[0].mean, Some(3.0));
        assert_eq!(point.quantities[0].over_words(2), "second half (1 of 2 runs steady)");
    }
}
