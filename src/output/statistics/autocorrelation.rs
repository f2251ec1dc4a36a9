//! `velocity-autocorrelation.csv`: how long bodies keep their velocities.

use std::fmt::Write;

use nalgebra::SVector;
use serde::Serialize;

use crate::output::AXES;
use crate::{
    observe::{Autocorrelation, CorrelationTime, Correlations},
    picture::{Chart, Level, Notes, Scale, Series},
};

/// What a summary says of the velocity autocorrelation.
#[derive(Debug, Clone, Serialize)]
pub struct AutocorrelationSummary {
    /// Mean squares and correlation times along each axis; nothing where the run has too few frames.
    pub axes: Option<Vec<CorrelationTime>>,
    /// Time of the first frame that counts.
    pub from_time: f64,
}

impl AutocorrelationSummary {
    /// Of frames from a time on.
    pub fn new<const D: usize>(found: &Autocorrelation<D>, from_time: f64) -> AutocorrelationSummary {
        AutocorrelationSummary { axes: found.correlation_times().map(|along| along.to_vec()), from_time }
    }
}

/// The files by name.
pub fn autocorrelation_files<const D: usize>(title: &str, found: &Autocorrelation<D>) -> [(&'static str, Vec<u8>); 2] {
    let rows = found.correlations();
    [("velocity-autocorrelation.csv", table(&rows).into_bytes()), ("velocity-autocorrelation.svg", chart(title, &rows).into_bytes())]
}

fn table<const D: usize>(rows: &[Correlations<D>]) -> String {
    let columns = AXES[..D].iter().map(|axis| format!(",autocorrelation_{axis},autocorrelation_{axis}_half_width"));
    let mut text = format!("lag{}\n", columns.collect::<String>());
    for Correlations { lag, values, half_widths } in rows {
        let width = |widths: &SVector<f64, D>, axis: usize| format!("{:?}", widths[axis]);
        let along = (0..D).map(|axis| format!(",{:?},{}", values[axis], half_widths.map_or(String::new(), |widths| width(&widths, axis))));
        writeln!(text, "{lag:?}{}", along.collect::<String>()).expect("memory can be written");
    }
    text
}

/// Over the lag, each axis over its value at zero.
fn chart<const D: usize>(title: &str, rows: &[Correlations<D>]) -> String {
    let along = |axis: usize| Series {
        name: format!("along {}", AXES[axis]),
        points: rows.iter().map(|row| (row.lag, row.values[axis] / rows[0].values[axis])).collect(),
    };
    let (x, y) = ("lag (time)", "velocity autocorrelation over that without lag");
    let notes = Notes { levels: vec![Level { y: 0.0, name: String::new() }], ..Notes::default() };
    Chart { title: title.into(), x: x.into(), y: y.into(), scale: Scale::Linear, series: (0..D).map(along).collect() }.annotated(&notes)
}
