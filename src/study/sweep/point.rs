//! Means over the seeds of a point of a sweep.

use serde::Serialize;

use super::{
    reading::{Over, Reading},
    record::{Measured, SweepRecord},
    vary::Assignment,
};
use crate::observe::statistics::{mean, standard_error, student};

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
    /// Standard error of the mean; nothing for fewer than two runs.
    pub standard_error: Option<f64>,
    /// Its 95 % interval: over seeds by Student's distribution, or over the time of a single run.
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
        let estimate =
            |(place, name): (usize, &String)| Estimate::of(name, &measured.iter().map(|run| run.readings[place]).collect::<Vec<_>>());
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
        let values: Vec<f64> = alike.iter().map(|reading| reading.value).collect();
        let [mean, standard_error] = [mean(&values), standard_error(&values)].map(known);
        let over_time = || if let [run] = alike[..] { run.half_width } else { None };
        let half_width = standard_error.map(|error| student(values.len() as f64 - 1.0) * error).or_else(over_time);
        let interval = mean.zip(half_width).map(|(mean, half)| [mean - half, mean + half]);
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

/// A number, if it is one.
fn known(number: f64) -> Option<f64> {
    (!number.is_nan()).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{experiment::record::Outcome, study::sweep::record::SweepSetting};

    fn record(seed: u64, reading: Option<Reading>) -> SweepRecord {
        let setting = SweepSetting { point: vec![("a".into(), "1".into())], seed: Some(seed) };
        let measured = |reading| Outcome::Measured(Measured { readings: vec![reading], fraction: 0.3, seconds: 2.0, folder: None });
        SweepRecord { setting, outcome: reading.map_or(Outcome::Failed("no room".into()), measured) }
    }

    fn point(records: &[SweepRecord]) -> SweepPoint {
        SweepPoint::of(&records[0].setting.point, &["viscosity".into()], &records.iter().collect::<Vec<_>>())
    }

    #[test]
    fn a_point_has_the_interval_of_students_distribution_and_tells_of_failures() {
        let steady = |value: f64| Some(Reading::steady(value, 0.5, 10.0 * value));
        let records = [record(1, steady(1.0)), record(2, steady(2.0)), record(3, steady(3.0)), record(4, None)];
        let point = point(&records);
        let estimate = &point.quantities[0];
        assert_eq!((point.runs, point.failed, estimate.mean, point.fraction), (3, 1, Some(2.0), Some(0.3)));
        let (error, [low, high]) = (1.0 / 3f64.sqrt(), estimate.interval.unwrap_or_default());
        assert!((estimate.standard_error.unwrap_or(0.0) - error).abs() < 1e-12);
        assert!((high - low - 2.0 * 4.3027 * error).abs() < 1e-3, "{low} {high}");
        assert_eq!((point.remarks, estimate.over_words(3)), (vec!["seed 4: no room".to_owned()], "steady part".into()));
        let single = self::point(&records[..1]);
        assert_eq!((single.quantities[0].standard_error, single.quantities[0].interval), (None, Some([0.5, 1.5])));
    }

    #[test]
    fn steady_means_are_not_averaged_with_halves_of_runs_that_are_not_steady() {
        let unsteady = Some(Reading::of(4.0, Over::SecondHalf));
        let point = point(&[record(1, Some(Reading::steady(1.0, 0.5, 2.0))), record(2, unsteady)]);
        assert_eq!(point.quantities[0].mean, Some(3.0));
        assert_eq!(point.quantities[0].over_words(2), "second half (1 of 2 runs steady)");
    }
}
