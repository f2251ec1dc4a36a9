//! `displacements.csv`: how far bodies go besides what carries all of them along.

use std::fmt::Write;

use nalgebra::SVector;
use serde::Serialize;

use crate::output::AXES;
use crate::{
    observe::{Diffusivity, Displacements, MeanSquares},
    picture::{Chart, Scale, Series},
};

/// What a summary says of displacements.
#[derive(Debug, Clone, Serialize)]
pub struct DisplacementSummary {
    /// Half the growth of mean-square displacements over time, along each axis; nothing where the run has too few frames.
    pub diffusivity: Option<Vec<Diffusivity>>,
    /// Time of the first frame that counts.
    pub from_time: f64,
}

impl DisplacementSummary {
    /// Of frames from a time on.
    pub fn new<const D: usize>(found: &Displacements<D>, from_time: f64) -> DisplacementSummary {
        DisplacementSummary { diffusivity: found.diffusivities().map(|along| along.to_vec()), from_time }
    }
}

/// The files by name.
pub fn displacement_files<const D: usize>(title: &str, found: &Displacements<D>) -> [(&'static str, Vec<u8>); 2] {
    let rows = found.mean_squares();
    [("displacements.csv", table(&rows).into_bytes()), ("displacements.svg", chart(title, &rows).into_bytes())]
}

fn table<const D: usize>(rows: &[MeanSquares<D>]) -> String {
    let columns = AXES[..D].iter().map(|axis| format!(",mean_square_{axis},mean_square_{axis}_half_width"));
    let mut text = format!("lag,strain{}\n", columns.collect::<String>());
    for MeanSquares { lag, strain, squares, half_widths } in rows {
        let strain = strain.map_or(String::new(), |strain| format!("{strain:?}"));
        let width = |widths: &SVector<f64, D>, axis: usize| format!("{:?}", widths[axis]);
        let along = (0..D).map(|axis| format!(",{:?},{}", squares[axis], half_widths.map_or(String::new(), |widths| width(&widths, axis))));
        writeln!(text, "{lag:?},{strain}{}", along.collect::<String>()).expect("memory can be written");
    }
    text
}

/// Mean squares over lags, both logarithmic.
fn chart<const D: usize>(title: &str, rows: &[MeanSquares<D>]) -> String {
    let along = |axis: usize| Series {
        name: format!("along {}", AXES[axis]),
        points: rows.iter().map(|row| (row.lag, row.squares[axis])).filter(|(_, square)| *square > 0.0).collect(),
    };
    let (x, y) = ("lag (time)", "mean-square displacement (area)");
    Chart { title: title.into(), x: x.into(), y: y.into(), scale: Scale::Logarithmic, series: (0..D).map(along).collect() }.svg()
}
