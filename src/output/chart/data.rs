//! What a chart shows.

use crate::output::picture::{INK, colour};

/// A chart of lines over a common abscissa, ready to be drawn.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Line of text above the axes; an empty one takes no room.
    pub title: String,
    /// Name of the abscissa, with its unit.
    pub x: String,
    /// Name of the ordinate, with its unit.
    pub y: String,
    /// How both coordinates are drawn.
    pub scale: Scale,
    /// The lines; the first stands out, and names are shown if there is more than one.
    pub series: Vec<Series>,
}

/// How coordinates are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// As they are.
    Linear,
    /// By their logarithms; what is not positive is left out.
    Logarithmic,
}

impl Scale {
    pub(super) fn of(self, point: &(f64, f64)) -> [f64; 2] {
        match self {
            Scale::Linear => [point.0, point.1],
            Scale::Logarithmic => [point.0.log10(), point.1.log10()],
        }
    }
}

/// One line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name.
    pub name: String,
    /// Abscissas and ordinates in the order to be joined; the line breaks where a value is not finite.
    pub points: Vec<(f64, f64)>,
}

impl Chart {
    /// Where finite points are drawn, in the scale of the chart.
    pub(super) fn finite_points(&self) -> impl Iterator<Item = [f64; 2]> {
        self.series.iter().flat_map(|series| &series.points).map(|point| self.scale.of(point)).filter(finite)
    }

    /// Ink for the first line, then the map of the speed without its palest end.
    pub(super) fn colour(&self, k: usize) -> String {
        let parts = self.series.len().max(3) - 2;
        if k == 0 { INK.into() } else { colour::hexadecimal(0.2 + 0.65 * (k - 1) as f64 / parts as f64) }
    }
}

/// Whether a point has a place.
pub(super) fn finite(point: &[f64; 2]) -> bool {
    point.iter().all(|value| value.is_finite())
}

/// Marks, levels and error bars of a chart.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    /// The marks.
    pub marks: Vec<Mark>,
    /// The levels.
    pub levels: Vec<Level>,
    /// The error bars.
    pub bars: Vec<Bar>,
}

/// A disk at a point of a line.
#[derive(Clone, Debug)]
pub struct Mark {
    /// Number of the line whose colour it has.
    pub series: usize,
    /// The point.
    pub point: (f64, f64),
    /// Small text above it.
    pub label: String,
    /// Whether it is a circle only.
    pub hollow: bool,
    /// Whether a ring singles it out.
    pub ringed: bool,
}

/// A dashed line from side to side, which the ordinate reaches.
#[derive(Clone, Debug)]
pub struct Level {
    /// Its ordinate.
    pub y: f64,
    /// Text on it.
    pub name: String,
}

/// An interval at an abscissa, which the ordinate reaches.
#[derive(Clone, Copy, Debug)]
pub struct Bar {
    /// Number of the line whose colour it has.
    pub series: usize,
    /// Abscissa.
    pub x: f64,
    /// Lowest and highest ordinate; nothing is drawn unless both are finite.
    pub ends: [f64; 2],
}
