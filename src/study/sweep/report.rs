//! What a sweep says: for people, as numbers, as a chart.

use serde::Serialize;

use super::{
    point::{Estimate, SweepPoint},
    reading::Over,
    record::{SweepRecord, SweepSetting},
    vary::{Assignment, Vary},
};
use crate::{
    experiment::{
        store::Store,
        table::{TableRow, csv, markdown, quoted},
    },
    picture::{Bar, Chart, Mark, Notes, Scale, Series},
};

/// All points of a sweep.
#[derive(Debug, Serialize)]
pub struct SweepReport {
    /// Names of the quantities.
    quantities: Vec<String>,
    /// The points in the order of the command line.
    pub points: Vec<SweepPoint>,
    #[serde(skip)]
    title: String,
    #[serde(skip)]
    keys: Vec<Vary>,
}

impl SweepReport {
    /// Of the settings of a sweep, those of a point next to each other.
    pub fn new(title: &str, quantities: Vec<String>, keys: &[Vary], settings: &[SweepSetting], store: &Store<SweepRecord>) -> SweepReport {
        let points = settings.chunk_by(|one, other| one.point == other.point);
        let records = |settings: &[SweepSetting]| settings.iter().filter_map(|setting| store.find(setting)).collect::<Vec<_>>();
        let points = points.map(|settings| SweepPoint::of(&settings[0].point, &quantities, &records(settings))).collect();
        SweepReport { quantities, points, title: title.into(), keys: keys.to_vec() }
    }

    /// The table and what is to be said about it.
    pub fn markdown(&self) -> String {
        let table = markdown(&self.points.iter().map(|point| self.shown(point)).collect::<Vec<_>>());
        let remarks =
            self.points.iter().flat_map(|point| point.remarks.iter().map(|remark| format!("\n{}: {remark}", words(&point.point))));
        let remarks: String = remarks.collect();
        if remarks.is_empty() { table } else { format!("{table}\n{remarks}") }
    }

    /// Names and contents of the files: a chart for each quantity.
    pub fn files(&self) -> Vec<(String, String)> {
        let chart = |place: usize| match &self.quantities[..] {
            [_] => ("sweep.svg".to_owned(), self.chart(place)),
            names => (format!("sweep-{}.svg", names[place]), self.chart(place)),
        };
        let tables = [("sweep.csv".to_owned(), self.csv()), ("sweep.md".to_owned(), self.markdown() + "\n")];
        tables.into_iter().chain((0..self.quantities.len()).map(chart)).collect()
    }

    fn csv(&self) -> String {
        let rows: Vec<_> = self.points.iter().map(numbers).collect();
        csv(&rows.iter().map(|row| row_of(row)).collect::<Vec<_>>())
    }

    /// A point for people.
    fn shown<'a>(&'a self, point: &'a SweepPoint) -> TableRow<'a> {
        let mut row: TableRow = point.point.iter().map(|(key, value)| (key.as_str(), value.clone())).collect();
        row.push(("fraction placed", point.fraction.map_or("-".into(), |fraction| format!("{fraction:.4}"))));
        for estimate in &point.quantities {
            let interval = estimate.interval.map_or("-".into(), |[low, high]| format!("{low:.6} to {high:.6}"));
            row.extend([(estimate.name.as_str(), shown(estimate.mean)), ("standard error", shown(estimate.standard_error))]);
            row.extend([("95 % interval", interval), ("mean over", estimate.over_words(point.runs))]);
        }
        row.extend([("runs", point.runs.to_string()), ("failed", point.failed.to_string())]);
        row.push(("seconds a run", point.seconds.map_or("-".into(), |seconds| format!("{seconds:.1}"))));
        row
    }

    /// Points that differ in the first key alone, with the values that the other keys have there.
    fn lines(&self) -> Vec<(&[Assignment], Vec<&SweepPoint>)> {
        let mut lines: Vec<(&[Assignment], Vec<&SweepPoint>)> = Vec::new();
        for point in &self.points {
            match lines.iter_mut().find(|(rest, _)| *rest == &point.point[1..]) {
                Some((_, points)) => points.push(point),
                None => lines.push((&point.point[1..], vec![point])),
            }
        }
        lines
    }

    /// The quantity against the first key, a line for each combination of the others; a key of words is drawn by the places of its values.
    fn chart(&self, quantity: usize) -> String {
        let estimate = |point: &SweepPoint| point.quantities[quantity].clone();
        let first = &self.keys[0];
        let numeric = first.values.iter().all(|value| value.parse::<f64>().is_ok_and(f64::is_finite));
        let place = |value: &str| first.values.iter().position(|own| own == value).map_or(f64::NAN, |place| place as f64 + 1.0);
        let abscissa = |point: &SweepPoint| match numeric {
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
        let mut lines = self.lines();
        // circles are hollow where others are means over a steady part
        let steady = self.points.iter().any(|point| estimate(point).over == Some(Over::Steady));
        let (mut series, mut notes) = (Vec::new(), Notes::default());
        for (number, (rest, points)) in lines.iter_mut().enumerate() {
            points.sort_by(|one, other| abscissa(one).total_cmp(&abscissa(other)));
            let own: Vec<(f64, f64)> = points.iter().map(|point| (abscissa(point), estimate(point).mean.unwrap_or(f64::NAN))).collect();
            let hollow = |point: &SweepPoint| steady && estimate(point).over == Some(Over::SecondHalf);
            let mark = |(&point, own): (&(f64, f64), &&SweepPoint)| Mark {
                series: number,
                point,
                label: String::new(),
                hollow: hollow(own),
                ringed: false,
            };
            notes.marks.extend(own.iter().zip(points.iter()).map(mark));
            let bar = |point: &&SweepPoint| Some(Bar { series: number, x: abscissa(point), ends: estimate(point).interval? });
            notes.bars.extend(points.iter().filter_map(bar));
            series.push(Series { name: words(rest), points: own });
        }
        let title = format!("{}: mean and 95 % interval", self.title);
        Chart { title, x, y: self.quantities[quantity].clone(), scale: scale(&series), series }.annotated(&notes)
    }
}

/// A point for other programs: the heads of a quantity begin with its name.
fn numbers(point: &SweepPoint) -> Vec<(String, String)> {
    let number = |number: Option<f64>| number.map_or(String::new(), |number| format!("{number:?}"));
    let cell = |value: &String| if value.contains([',', '"']) { quoted(value) } else { value.clone() };
    let mut row: Vec<(String, String)> = point.point.iter().map(|(key, value)| (key.clone(), cell(value))).collect();
    row.push(("fraction_placed".into(), number(point.fraction)));
    for Estimate { name, mean, standard_error, interval, over, steady } in &point.quantities {
        let [low, high] = [0, 1].map(|end| number(interval.map(|ends| ends[end])));
        row.extend([(name.clone(), number(*mean)), (format!("{name}.standard_error"), number(*standard_error))]);
        row.extend([(format!("{name}.low"), low), (format!("{name}.high"), high)]);
        row.extend([
            (format!("{name}.over"), over.map_or(String::new(), |over| over.words().into())),
            (format!("{name}.steady"), steady.to_string()),
        ]);
    }
    let counts = [("runs", point.runs.to_string()), ("failed", point.failed.to_string()), ("seconds", number(point.seconds))];
    row.extend(counts.map(|(head, cell)| (head.to_owned(), cell)));
    row
}

fn row_of(cells: &[(String, String)]) -> TableRow<'_> {
    cells.iter().map(|(head, cell)| (head.as_str(), cell.clone())).collect()
}

fn shown(number: Option<f64>) -> String {
    number.map_or("-".into(), |number| format!("{number:.6}"))
}

fn words(point: &[Assignment]) -> String {
    point.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
}

/// By logarithms where the largest number is so many times the least, and all are positive.
fn scale(series: &[Series]) -> Scale {
    const WIDE: f64 = 30.0;
    let numbers = series.iter().flat_map(|series| &series.points).map(|point| point.1).filter(|number| number.is_finite());
    let [least, most] = numbers.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], number| [least.min(number), most.max(number)]);
    if least > 0.0 && most >= WIDE * least { Scale::LogarithmicOrdinate } else { Scale::Linear }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_several_decades_are_drawn_by_their_logarithms() {
        let line = |numbers: &[f64]| Series { name: String::new(), points: numbers.iter().map(|&number| (number, number)).collect() };
        assert_eq!(scale(&[line(&[1.0, 2.0]), line(&[f64::NAN, 40.0])]), Scale::LogarithmicOrdinate);
        assert_eq!(scale(&[line(&[1.0, 20.0])]), Scale::Linear);
        assert_eq!(scale(&[line(&[-1.0, 200.0])]), Scale::Linear);
    }

    #[test]
    fn a_table_has_the_columns_of_each_quantity_and_says_what_its_means_are_over() {
        let estimate = |name: &str, mean, over, steady| Estimate {
            name: name.into(),
            mean: Some(mean),
            standard_error: Some(0.5),
            interval: Some([mean - 1.0, mean + 1.0]),
            over: Some(over),
            steady,
        };
        let point = |value: &str, over, steady| SweepPoint {
            point: vec![("a".into(), value.into()), ("b".into(), "[1, 2]".into())],
            quantities: vec![estimate("viscosity", 2.0, over, steady), estimate("series.contacts", 7.0, Over::SecondHalf, 0)],
            fraction: Some(0.29),
            runs: 3,
            failed: 1,
            seconds: Some(2.0),
            remarks: vec!["seed 4: no room".into()],
        };
        let keys = vec![Vary { key: "a".into(), values: vec!["1".into(), "2".into()] }, Vary { key: "b".into(), values: vec!["1".into()] }];
        let points = vec![point("1", Over::Steady, 3), point("2", Over::SecondHalf, 2)];
        let report = SweepReport { quantities: vec!["viscosity".into(), "series.contacts".into()], points, title: "disks".into(), keys };
        let table = report.csv();
        let head = "a,b,fraction_placed,viscosity,viscosity.standard_error,viscosity.low,viscosity.high,viscosity.over,viscosity.steady,series.contacts,\
                    series.contacts.standard_error,series.contacts.low,series.contacts.high,series.contacts.over,series.contacts.steady,runs,failed,seconds";
        assert_eq!(table.lines().next(), Some(head));
        assert!(table.contains("\n1,\"[1, 2]\",0.29,2.0,0.5,1.0,3.0,steady part,3,7.0,"), "{table}");
        let text = report.markdown();
        assert!(text.contains("a = 1, b = [1, 2]: seed 4: no room") && text.contains("| second half (2 of 3 runs steady) |"), "{text}");
        let files = report.files();
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["sweep.csv", "sweep.md", "sweep-viscosity.svg", "sweep-series.contacts.svg"]);
        assert!(!report.chart(0).contains("NaN"));
    }
}
