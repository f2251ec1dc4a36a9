//! The frame of a chart: its axes on the page.

use std::fmt::Write;

use super::{
    axis::Axis,
    data::{Chart, Notes, Scale, finite},
};
use crate::output::picture::INK;

/// Width and height of the page in pixels.
pub(super) const PAGE: [f64; 2] = [800.0, 450.0];
/// Margin of the page in pixels.
pub(super) const SIDE: f64 = 22.0;
/// Width of a letter in pixels, about.
const LETTER: f64 = 7.2;

/// Where the axes lie on the page and what they span.
pub(super) struct Frame {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub foot: f64,
    pub x: Axis,
    pub y: Axis,
}

impl Frame {
    pub fn new(chart: &Chart, notes: &Notes) -> Self {
        let [x, mut y] = [0, 1].map(|axis| chart.finite_points().map(|point| point[axis]).collect::<Vec<f64>>());
        let levels = notes.levels.iter().map(|level| chart.scale.of(&(1.0, level.y)));
        y.extend(levels.filter(finite).map(|point| point[1]));
        let ends = notes.bars.iter().flat_map(|bar| bar.ends.map(|end| chart.scale.of(&(bar.x, end))));
        y.extend(ends.filter(finite).map(|point| point[1]));
        let [x, y] = match chart.scale {
            Scale::Linear => [Axis::tight(&x), Axis::loose(&y)],
            Scale::Logarithmic => [Axis::decades(&x), Axis::decades(&y)],
        };
        let longest = |texts: &mut dyn Iterator<Item = usize>| LETTER * texts.max().unwrap_or(0) as f64;
        let labels = longest(&mut y.ticks().iter().map(|&tick| y.label(tick).chars().count()));
        let names = longest(&mut chart.series.iter().map(|series| series.name.chars().count())).min(260.0);
        let right = if chart.series.len() > 1 { 38.0 + names } else { 8.0 };
        let top = if chart.title.is_empty() { SIDE } else { 58.0 };
        Frame { left: SIDE + 30.0 + labels.min(120.0), right: PAGE[0] - SIDE - right, top, foot: PAGE[1] - SIDE - 40.0, x, y }
    }

    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.left + self.x.part(x) * (self.right - self.left), self.foot - self.y.part(y) * (self.foot - self.top)]
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
