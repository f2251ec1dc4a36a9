//! What a sweep says: for people, as numbers, as a chart.

use serde::Serialize;

use super::{
    record::{Outcome, Record, Setting},
    vary::{Assignment, Vary},
};
use crate::{
    observe::statistics::student,
    output::{Bar, Chart, Mark, Notes, Scale, Series},
    study::{
        store::Store,
        table::{Row, csv, markdown, quoted},
    },
};

/// Means over seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Keys with their values.
    pub point: Vec<Assignment>,
    /// Runs that came to their end.
    pub runs: usize,
    /// Runs that failed.
    pub failed: usize,
    /// Mean of the quantity; nothing if all runs failed.
    pub mean: Option<f64>,
    /// Standard error of the mean; nothing for fewer than two runs.
    pub standard_error: Option<f64>,
    /// Its 95 % interval: over seeds by Student's distribution, or over the time of a single run.
    pub interval: Option<[f64; 2]>,
    /// Seconds of a run, in the mean; nothing if all runs failed.
    pub seconds: Option<f64>,
    /// What to bear in mind.
    pub remarks: Vec<String>,
}

/// All points of a sweep.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Name of the quantity.
    quantity: String,
    /// The points in the order of the command line.
    pub points: Vec<Point>,
    #[serde(skip)]
    title: String,
    #[serde(skip)]
    keys: Vec<Vary>,
}

impl Report {
    /// Of the settings of a sweep, those of a point next to each other.
    pub fn new(title: &str, quantity: &str, keys: &[Vary], settings: &[Setting], store: &Store<Record>) -> Report {
        let points = settings.chunk_by(|one, other| one.point == other.point);
        let records = |settings: &[Setting]| settings.iter().filter_map(|setting| store.find(setting)).collect::<Vec<_>>();
        let points = points.map(|settings| Point::of(&settings[0].point, &records(settings))).collect();
        Report { quantity: quantity.into(), points, title: title.into(), keys: keys.to_vec() }
    }

    /// The table and what is to be said about it.
    pub fn markdown(&self) -> String {
        let table = markdown(&self.points.iter().map(|point| self.shown(point)).collect::<Vec<_>>());
        let remarks =
            self.points.iter().flat_map(|point| point.remarks.iter().map(|remark| format!("\n{}: {remark}", words(&point.point))));
        let remarks: String = remarks.collect();
        if remarks.is_empty() { table } else { format!("{table}\n{remarks}") }
    }

    /// Names and contents of the files.
    pub fn files(&self) -> Vec<(&'static str, String)> {
        vec![("sweep.csv", self.csv()), ("sweep.md", self.markdown() + "\n"), ("sweep.svg", self.chart())]
    }

    fn csv(&self) -> String {
        csv(&self.points.iter().map(|point| self.numbers(point)).collect::<Vec<_>>())
    }

    /// A point for people.
    fn shown<'a>(&'a self, point: &'a Point) -> Row<'a> {
        let shown = |number: Option<f64>| number.map_or("-".into(), |number| format!("{number:.6}"));
        let mut row: Row = point.point.iter().map(|(key, value)| (key.as_str(), value.clone())).collect();
        row.extend([(self.quantity.as_str(), shown(point.mean)), ("standard error", shown(point.standard_error))]);
        let interval = point.interval.map_or("-".into(), |[low, high]| format!("{low:.6} to {high:.6}"));
        row.extend([("95 % interval", interval), ("runs", point.runs.to_string()), ("failed", point.failed.to_string())]);
        row.push(("seconds a run", point.seconds.map_or("-".into(), |seconds| format!("{seconds:.1}"))));
        row
    }

    /// A point for other programs.
    fn numbers<'a>(&'a self, point: &'a Point) -> Row<'a> {
        let number = |number: Option<f64>| number.map_or(String::new(), |number| format!("{number:?}"));
        let cell = |value: &String| if value.contains([',', '"']) { quoted(value) } else { value.clone() };
        let mut row: Row = point.point.iter().map(|(key, value)| (key.as_str(), cell(value))).collect();
        row.extend([(self.quantity.as_str(), number(point.mean)), ("standard_error", number(point.standard_error))]);
        row.extend([("low", number(point.interval.map(|[low, _]| low))), ("high", number(point.interval.map(|[_, high]| high)))]);
        row.extend([("runs", point.runs.to_string()), ("failed", point.failed.to_string()), ("seconds", number(point.seconds))]);
        row
    }

    /// The quantity against the first key, a line for each combination of the others; a key of words is drawn by the places of its values.
    fn chart(&self) -> String {
        let first = &self.keys[0];
        let numeric = first.values.iter().all(|value| value.parse::<f64>().is_ok_and(f64::is_finite));
        let place = |value: &str| first.values.iter().position(|own| own == value).map_or(f64::NAN, |place| place as f64 + 1.0);
        let abscissa = |point: &Point| match numeric {
            true => point.point[0].1.parse().unwrap_or(f64::NAN),
            false => place(&point.point[0].1),
        };
        let x = match numeric {
            true => first.key.clone(),
            false => format!(
                "{}: {}",
                first.key,
                (1..).zip(&first.values).map(|(n, value)| format!("{n} {value}")).collect::<Vec<_>>().join(", ")
            ),
        };
        let mut lines: Vec<(&[Assignment], Vec<&Point>)> = Vec::new();
        for point in &self.points {
            match lines.iter_mut().find(|(rest, _)| *rest == &point.point[1..]) {
                Some((_, points)) => points.push(point),
                None => lines.push((&point.point[1..], vec![point])),
            }
        }
        let (mut series, mut notes) = (Vec::new(), Notes::default());
        for (number, (rest, points)) in lines.iter_mut().enumerate() {
            points.sort_by(|one, other| abscissa(one).total_cmp(&abscissa(other)));
            let own: Vec<(f64, f64)> = points.iter().map(|point| (abscissa(point), point.mean.unwrap_or(f64::NAN))).collect();
            let mark = |&point| Mark { series: number, point, label: String::new(), hollow: false, ringed: false };
            notes.marks.extend(own.iter().map(mark));
            notes.bars.extend(points.iter().filter_map(|point| Some(Bar { series: number, x: abscissa(point), ends: point.interval? })));
            series.push(Series { name: words(rest), points: own });
        }
        let title = format!("{}: mean and 95 % interval", self.title);
        Chart { title, x, y: self.quantity.clone(), scale: Scale::Linear, series }.annotated(&notes)
    }
}

impl Point {
    fn of(point: &[Assignment], records: &[&Record]) -> Point {
        let measured: Vec<_> = records.iter().filter_map(|record| record.measured()).collect();
        let count = measured.len() as f64;
        let mean = (count > 0.0).then(|| measured.iter().map(|run| run.value).sum::<f64>() / count);
        let standard_error = mean.filter(|_| count > 1.0).map(|mean| {
            let squares: f64 = measured.iter().map(|run| (run.value - mean).powi(2)).sum();
            (squares / (count * (count - 1.0))).sqrt()
        });
        let over_time = || if let [run] = measured[..] { run.half_width } else { None };
        let half_width = standard_error.map(|error| student(count - 1.0) * error).or_else(over_time);
        let mut remarks = Vec::new();
        for record in records {
            let seed = record.setting.seed.map_or(String::new(), |seed| format!("seed {seed}: "));
            match &record.outcome {
                Outcome::Failed(reason) => remarks.push(format!("{seed}{reason}")),
                Outcome::Measured(run) => remarks.extend(run.remark.iter().map(|remark| format!("{seed}{remark}"))),
            }
        }
        Point {
            point: point.to_vec(),
            runs: measured.len(),
            failed: records.len() - measured.len(),
            mean,
            standard_error,
            interval: mean.zip(half_width).map(|(mean, half)| [mean - half, mean + half]),
            seconds: (count > 0.0).then(|| measured.iter().map(|run| run.seconds).sum::<f64>() / count),
            remarks,
        }
    }
}

fn words(point: &[Assignment]) -> String {
    point.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::sweep::record::Measured;

    fn record(seed: u64, value: Option<f64>) -> Record {
        let setting = Setting { point: vec![("a".into(), "1".into()), ("b".into(), "[1, 2]".into())], seed: Some(seed) };
        let measured = |value| Outcome::Measured(Measured { value, half_width: Some(0.5), remark: None, seconds: 2.0 });
        Record { setting, outcome: value.map_or(Outcome::Failed("no room".into()), measured) }
    }

    #[test]
    fn a_point_has_the_interval_of_students_distribution_and_tells_of_failures() {
        let records = [record(1, Some(1.0)), record(2, Some(2.0)), record(3, Some(3.0)), record(4, None)];
        let point = Point::of(&records[0].setting.point, &records.iter().collect::<Vec<_>>());
        assert_eq!((point.runs, point.failed, point.mean), (3, 1, Some(2.0)));
        let (error, [low, high]) = (1.0 / 3f64.sqrt(), point.interval.unwrap_or_default());
        assert!((point.standard_error.unwrap_or(0.0) - error).abs() < 1e-12);
        assert!((high - low - 2.0 * 4.3027 * error).abs() < 1e-3, "{low} {high}");
        assert_eq!(point.remarks, ["seed 4: no room"]);
        let single = Point::of(&records[0].setting.point, &[&records[0]]);
        assert_eq!((single.standard_error, single.interval), (None, Some([0.5, 1.5])));
        let keys = vec![Vary { key: "a".into(), values: vec!["1".into()] }, Vary { key: "b".into(), values: vec!["[1, 2]".into()] }];
        let report = Report { quantity: "viscosity".into(), points: vec![point], title: "disks".into(), keys };
        assert!(report.csv().contains("\n1,\"[1, 2]\",2.0,"), "{}", report.csv());
        assert!(report.markdown().contains("a = 1, b = [1, 2]: seed 4: no room"), "{}", report.markdown());
        assert!(!report.chart().contains("NaN"));
    }
}
