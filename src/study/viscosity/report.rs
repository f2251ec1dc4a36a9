//! What the study says: for people, as numbers, as charts.

use super::{
    laws::{known, laws},
    record::{MeasuredViscosity, SuspensionSetting, ViscosityRecord},
};
use crate::{
    experiment::{
        store::Store,
        table::{TableRow, csv, markdown},
    },
    observe::statistics::{mean, standard_error},
    picture::{Bar, Chart, Mark, Notes, Scale, Series},
};

/// Fractions at which laws are drawn between 0 and the largest measured one.
const LAW_POINTS: usize = 60;

/// Largest viscosity of a law that is drawn, over the largest measured one: the ordinate reaches no farther.
const TALLEST: f64 = 1.3;

/// All points and curves.
pub struct ViscosityReport {
    points: Vec<FractionPoint>,
    curves: Vec<(SuspensionSetting, MeasuredViscosity)>,
}

/// A fraction at an instant.
struct FractionPoint {
    dimension: usize,
    fraction: f64,
    configurations: usize,
    mean: f64,
    /// Standard error of the mean; not a number for one configuration.
    error: f64,
}

impl ViscosityReport {
    /// Of the settings that were measured.
    pub fn new(settings: &[SuspensionSetting], store: &Store<ViscosityRecord>) -> ViscosityReport {
        let mut report = ViscosityReport { points: Vec::new(), curves: Vec::new() };
        let measured: Vec<&ViscosityRecord> = settings.iter().filter_map(|setting| store.find(setting)).collect();
        for ViscosityRecord { setting, measured: result } in &measured {
            let of_point = |point: &FractionPoint| (point.dimension, point.fraction) == (setting.dimension, setting.fraction);
            if setting.strain.is_some() {
                report.curves.push((setting.clone(), result.clone()));
            } else if !report.points.iter().any(of_point) {
                let alike = measured.iter().filter(|ViscosityRecord { setting: other, .. }| {
                    other.strain.is_none() && (other.dimension, other.fraction) == (setting.dimension, setting.fraction)
                });
                report.points.push(FractionPoint::of(setting, &alike.map(|record| record.measured.relative).collect::<Vec<_>>()));
            }
        }
        report
    }

    /// The tables.
    pub fn markdown(&self) -> String {
        let tables = [2, 3].into_iter().filter(|&dimension| self.points_of(dimension).next().is_some()).map(|dimension| {
            let (head, (source, values)) = (format!("{dimension}D fraction"), known(dimension));
            let row = |FractionPoint { fraction, mean, error, .. }: &FractionPoint| {
                let known = values.iter().find(|(there, _)| there == fraction).map_or(String::new(), |(_, value)| value.to_string());
                let mut row: TableRow = vec![(&head, fraction.to_string())];
                row.extend([("viscosity", format!("{mean:.4}")), ("standard error", format!("{error:.4}"))]);
                row.extend(laws(dimension).iter().map(|law| (law.name, format!("{:.4}", (law.value)(*fraction)))));
                row.push((source, known));
                row
            };
            markdown(&self.points_of(dimension).map(row).collect::<Vec<_>>()) + "\n\n"
        });
        let curves = self.curves.iter().map(|(setting, measured)| {
            let mean = match &measured.mean {
                Some(mean) => {
                    let [from, to] = mean.strains;
                    format!("mean {:.4} ± {:.4} (95 %) from strain {from:.2} to {to:.2}", mean.relative, mean.half_width())
                }
                None => "too short a strain for a mean".into(),
            };
            format!("{setting}: {:.4} at the end, {mean}\n", measured.relative)
        });
        tables.chain(curves).collect()
    }

    /// Names and contents of the files.
    pub fn files(&self) -> Vec<(&'static str, String)> {
        let mut files = vec![("viscosity.csv", self.csv())];
        for (dimension, name) in [(2, "viscosity-2d.svg"), (3, "viscosity-3d.svg")] {
            if self.points_of(dimension).next().is_some() {
                files.push((name, self.chart(dimension)));
            }
        }
        if !self.curves.is_empty() {
            files.extend([("strain.csv", self.curves_csv()), ("strain.svg", self.evolution())]);
        }
        files
    }

    fn points_of(&self, dimension: usize) -> impl Iterator<Item = &FractionPoint> {
        self.points.iter().filter(move |point| point.dimension == dimension)
    }

    fn csv(&self) -> String {
        let row = |FractionPoint { dimension, fraction, configurations, mean, error }: &FractionPoint| {
            let counts = [("dimension", dimension.to_string()), ("fraction", format!("{fraction:?}"))];
            let numbers = [("viscosity", format!("{mean:?}")), ("standard_error", format!("{error:?}"))];
            [&counts[..], &[("configurations", configurations.to_string())], &numbers].concat()
        };
        csv(&self.points.iter().map(row).collect::<Vec<_>>())
    }

    fn curves_csv(&self) -> String {
        let row = |SuspensionSetting { dimension, fraction, .. }: &SuspensionSetting, strain: f64, viscosity: f64| {
            let number = |number: f64| format!("{number:?}");
            let place = [("dimension", dimension.to_string()), ("fraction", number(*fraction))];
            [place, [("strain", number(strain)), ("viscosity", number(viscosity))]].concat()
        };
        let rows = |(setting, measured): &(SuspensionSetting, MeasuredViscosity)| {
            measured.curve.iter().map(|&(strain, viscosity)| row(setting, strain, viscosity)).collect::<Vec<_>>()
        };
        csv(&self.curves.iter().flat_map(rows).collect::<Vec<_>>())
    }

    /// Viscosity against fraction: points with bars of two standard errors, laws as lines, and known values as circles.
    fn chart(&self, dimension: usize) -> String {
        let points: Vec<&FractionPoint> = self.points_of(dimension).collect();
        let largest = points.iter().map(|point| point.fraction).fold(0.0, f64::max);
        let tallest = TALLEST * points.iter().map(|point| point.mean).fold(1.0, f64::max);
        // points joined to nothing: only their marks show
        let lonely = |points: &[(f64, f64)]| points.iter().flat_map(|&point| [point, (f64::NAN, f64::NAN)]).collect();
        let own: Vec<(f64, f64)> = points.iter().map(|point| (point.fraction, point.mean)).collect();
        let mut series = vec![Series { name: "this study".into(), points: lonely(&own) }];
        series.extend(laws(dimension).iter().map(|law| {
            let at = |place: usize| largest * place as f64 / LAW_POINTS as f64;
            let values = (0..=LAW_POINTS).map(|place| (at(place), (law.value)(at(place))));
            Series { name: law.name.into(), points: values.filter(|(_, value)| *value <= tallest).collect() }
        }));
        let (source, values) = known(dimension);
        let shown: Vec<(f64, f64)> = values.iter().copied().filter(|(fraction, _)| *fraction <= largest).collect();
        let mark = |series, point, hollow| Mark { series, point, label: String::new(), hollow, ringed: false };
        let mut marks: Vec<Mark> = shown.iter().map(|&point| mark(series.len(), point, true)).collect();
        marks.extend(own.iter().map(|&point| mark(0, point, false)));
        if !shown.is_empty() {
            series.push(Series { name: source.into(), points: lonely(&shown) });
        }
        let bar = |point: &&FractionPoint| Bar {
            series: 0,
            x: point.fraction,
            ends: [point.mean - 2.0 * point.error, point.mean + 2.0 * point.error],
        };
        let notes = Notes { marks, bars: points.iter().map(bar).collect(), ..Notes::default() };
        let bodies = if dimension == 2 { "disks" } else { "spheres" };
        let title = format!("{bodies} in equilibrium at an instant: mean and two standard errors");
        Chart { title, x: "fraction φ".into(), y: "relative viscosity".into(), scale: Scale::Linear, series }.annotated(&notes)
    }

    /// Viscosity against strain.
    fn evolution(&self) -> String {
        let line = |(setting, measured): &(SuspensionSetting, MeasuredViscosity)| Series {
            name: format!("{}D, fraction {}", setting.dimension, setting.fraction),
            points: measured.curve.clone(),
        };
        let series = self.curves.iter().map(line).collect();
        let title = "sheared between sliding images, with lubrication and contacts".into();
        Chart { title, x: "strain".into(), y: "relative viscosity".into(), scale: Scale::Linear, series }.svg()
    }
}

impl FractionPoint {
    fn of(setting: &SuspensionSetting, values: &[f64]) -> FractionPoint {
        FractionPoint {
            dimension: setting.dimension,
            fraction: setting.fraction,
            configurations: values.len(),
            mean: mean(values),
            error: standard_error(values),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::experiment::store::StudyIdentity;

    #[test]
    fn a_report_has_means_errors_and_charts_of_what_was_measured() {
        let folder = std::env::temp_dir().join(format!("turbid-viscosity-report-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mut store = Store::open(&folder, "viscosity.json", StudyIdentity::of_version(), true).unwrap();
        let setting =
            |fraction, seed| SuspensionSetting { dimension: 2, fraction, bodies: 4, cells_per_radius: 4.0, gap: 0.02, seed, strain: None };
        let settings = [setting(0.1, 1), setting(0.1, 2), setting(0.3, 1), setting(0.1, 1).sheared(2.0), setting(0.4, 1)];
        for (setting, relative) in settings.iter().zip([1.2, 1.4, 2.0, 1.3]) {
            let curve = if setting.strain.is_some() { vec![(0.0, 1.2), (1.0, 1.3)] } else { Vec::new() };
            let measured = MeasuredViscosity { relative, mean: None, curve, seconds: 1.0 };
            store.add(ViscosityRecord { setting: setting.clone(), measured }).unwrap();
        }
        let report = ViscosityReport::new(&settings, &store);
        std::fs::remove_dir_all(&folder).unwrap();
        let points: Vec<(f64, usize, f64)> = report.points.iter().map(|point| (point.fraction, point.configurations, point.mean)).collect();
        assert!((points[0].2 - 1.3).abs() < 1e-12);
        assert_eq!((points[0].1, points[1..].to_vec()), (2, vec![(0.3, 1, 2.0)]));
        assert!((report.points[0].error - 0.1).abs() < 1e-12 && report.points[1].error.is_nan());
        let files = report.files();
        let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["viscosity.csv", "viscosity-2d.svg", "strain.csv", "strain.svg"]);
        assert!(files[1].1.contains("Krieger-Dougherty") && !files[1].1.contains("NaN"), "{}", files[1].1);
        assert!(report.markdown().contains("| 0.1 | 1.3000 | 0.1000 | 1.2000 |"), "{}", report.markdown());
    }
}
