//! Where a chart lies on its page.

use std::fmt::Write;

use crate::picture::{INK, axis::Axis};

/// The page in pixels, and the room at its sides.
pub const PAGE: [f64; 2] = [800.0, 450.0];
pub const SIDE: f64 = 22.0;
/// Width of a letter in pixels, about.
const LETTER: f64 = 7.2;

/// How coordinates are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// As they are.
    Linear,
    /// By their logarithms; what is not positive is left out.
    Logarithmic,
    /// Ordinates by their logarithms; what is not positive is left out.
    LogarithmicOrdinate,
}

impl Scale {
    /// A point as it is drawn.
    pub fn of(self, point: &(f64, f64)) -> [f64; 2] {
        match self {
            Scale::Linear => [point.0, point.1],
            Scale::Logarithmic => [point.0.log10(), point.1.log10()],
            Scale::LogarithmicOrdinate => [point.0, point.1.log10()],
        }
    }
}

/// Where the axes lie on the page and what they span.
pub struct ChartFrame {
    /// How coordinates are drawn.
    pub scale: Scale,
    /// Edges of the axes in pixels.
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub foot: f64,
    pub x: Axis,
    pub y: Axis,
}

impl ChartFrame {
    /// Around points, with room for the names of lines and, if there is one, a title.
    pub fn new(scale: Scale, [x, y]: [&[f64]; 2], names: &[&str], title: bool) -> ChartFrame {
        let [x, y] = match scale {
            Scale::Linear => [Axis::tight(x), Axis::loose(y)],
            Scale::Logarithmic => [Axis::decades(x), Axis::decades(y)],
            Scale::LogarithmicOrdinate => [Axis::tight(x), Axis::decades(y)],
        };
        let longest = |texts: &mut dyn Iterator<Item = usize>| LETTER * texts.max().unwrap_or(0) as f64;
        let labels = longest(&mut y.ticks().iter().map(|&tick| y.label(tick).chars().count()));
        let width = longest(&mut names.iter().map(|name| name.chars().count())).min(260.0);
        let right = if names.len() > 1 { 38.0 + width } else { 8.0 };
        let top = if title { 58.0 } else { SIDE };
        ChartFrame { scale, left: SIDE + 30.0 + labels.min(120.0), right: PAGE[0] - SIDE - right, top, foot: PAGE[1] - SIDE - 40.0, x, y }
    }

    /// Pixels of a point.
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.left + self.x.part(x) * (self.right - self.left), self.foot - self.y.part(y) * (self.foot - self.top)]
    }

    /// Whether the ordinate reaches a point.
    pub fn reaches(&self, point: &[f64; 2]) -> bool {
        (0.0..=1.0).contains(&self.y.part(point[1]))
    }

    /// Lines without what is above or below the axes.
    pub fn clipped(&self, lines: &str) -> String {
        let (width, height) = (PAGE[0], self.foot - self.top);
        format!(
            "<clipPath id=\"axes\"><rect x=\"0\" y=\"{:.1}\" width=\"{width}\" height=\"{height:.1}\"/></clipPath>\n\
             <g clip-path=\"url(#axes)\">\n{lines}</g>\n",
            self.top
        )
    }

    /// A line through points, without those less than half a pixel from the one before.
    pub fn path(&self, points: &[[f64; 2]]) -> String {
        let mut places: Vec<[f64; 2]> = points.iter().map(|&point| self.place(point)).collect();
        places.dedup_by(|next, last| (next[0] - last[0]).hypot(next[1] - last[1]) < 0.5);
        let letter = |k: usize| if k == 0 { "M" } else { "L" };
        let mut path: String = places.iter().enumerate().map(|(k, [x, y])| format!("{}{x:.1} {y:.1}", letter(k))).collect();
        if places.len() == 1 {
            path += "h0";
        }
        path
    }

    /// Lines at the ticks with their labels, and the axes.
    pub fn grid(&self) -> String {
        let [left, right, top, foot] = [self.left, self.right, self.top, self.foot];
        let [mut lines, mut labels] = [String::new(), String::new()];
        for tick in self.x.ticks() {
            let x = left + self.x.part(tick) * (right - left);
            let _ = write!(lines, "M{x:.1} {top:.1}V{foot:.1}");
            let _ = writeln!(labels, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>", foot + 19.0, self.x.label(tick));
        }
        for tick in self.y.ticks() {
            let y = foot - self.y.part(tick) * (foot - top);
            let _ = write!(lines, "M{left:.1} {y:.1}H{right:.1}");
            let _ =
                writeln!(labels, "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>", left - 9.0, y + 4.6, self.y.label(tick));
        }
        format!(
            "<path d=\"{lines}\" fill=\"none\" stroke=\"#dfe3e9\" stroke-width=\"0.8\"/>\n{labels}\
             <path d=\"M{left:.1} {top:.1}V{foot:.1}H{right:.1}\" fill=\"none\" stroke=\"{INK}\" stroke-opacity=\"0.55\"/>\n"
        )
    }
}

/// Whether a point can be drawn.
pub fn finite(point: &[f64; 2]) -> bool {
    point.iter().all(|value| value.is_finite())
}
