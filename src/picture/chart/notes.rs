//! What may be written into a chart besides its lines: marks at points, levels across it, and error bars.

use std::fmt::Write;

use super::frame::{ChartFrame, finite};
use crate::picture::{INK, escaped};

/// Radius of a mark, and of the ring around it, in pixels.
const MARK: f64 = 4.0;
const RING: f64 = 9.0;

/// Half the width of the ends of a bar in pixels.
const END: f64 = 4.0;

/// Marks, levels and error bars of a chart.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    /// The marks.
    pub marks: Vec<Mark>,
    /// The levels.
    pub levels: Vec<Level>,
    /// The error bars.
    pub bars: Vec<Bar>,
    /// A mean with its interval.
    pub band: Option<Band>,
}

/// A mean over a part of the abscissa with its interval; what is before that part is left out of it.
#[derive(Clone, Debug)]
pub struct Band {
    /// Abscissas where the part begins and ends.
    pub from_to: [f64; 2],
    /// The mean.
    pub mean: f64,
    /// Lowest and highest value.
    pub interval: [f64; 2],
    /// Text on it.
    pub name: String,
    /// Text on what is left out.
    pub left_out: String,
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

impl Notes {
    /// Points that the ordinate must reach.
    pub fn extent(&self) -> impl Iterator<Item = (f64, f64)> {
        let levels = self.levels.iter().map(|level| (1.0, level.y));
        let band = self.band.iter().flat_map(|band| band.interval.map(|end| (band.from_to[1], end)));
        levels.chain(self.bars.iter().flat_map(|bar| bar.ends.map(|end| (bar.x, end)))).chain(band)
    }

    /// The band, below everything else.
    pub fn shades(&self, frame: &ChartFrame) -> String {
        let Some(band) = &self.band else { return String::new() };
        let place = |x: f64, y: f64| frame.place(frame.scale.of(&(x, y)));
        let ([from, low], [to, high]) = (place(band.from_to[0], band.interval[0]), place(band.from_to[1], band.interval[1]));
        let mean = place(band.from_to[0], band.mean)[1];
        if ![from, to, low, high, mean].iter().all(|place| place.is_finite()) {
            return String::new();
        }
        let [left, top, foot] = [frame.left, frame.top, frame.foot];
        let [name, left_out] = [&band.name, &band.left_out].map(|text| escaped(text));
        let label = match from - left > 7.0 * band.left_out.chars().count() as f64 {
            true => {
                format!("<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11\" fill-opacity=\"0.7\">{left_out}</text>\n", left + 5.0, foot - 7.0)
            }
            false => String::new(),
        };
        format!(
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{INK}\" fill-opacity=\"0.06\"/>\n\
             <rect x=\"{from:.1}\" y=\"{high:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#0072b2\" fill-opacity=\"0.22\"/>\n\
             <path d=\"M{from:.1} {mean:.1}H{to:.1}\" stroke=\"#0072b2\" stroke-width=\"1.4\" stroke-dasharray=\"6 4\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11\" text-anchor=\"end\" fill=\"#0b5c9c\">{name}</text>\n{label}",
            (from - left).max(0.0),
            foot - top,
            to - from,
            (low - high).max(1.0),
            to - 4.0,
            high - 5.0,
        )
    }

    /// The levels, below the lines.
    pub fn levels(&self, frame: &ChartFrame) -> String {
        let mut text = String::new();
        for level in &self.levels {
            let y = frame.place(frame.scale.of(&(1.0, level.y)))[1];
            if !y.is_finite() {
                continue;
            }
            let [left, right] = [frame.left, frame.right];
            let _ = writeln!(
                text,
                "<path d=\"M{left:.1} {y:.1}H{right:.1}\" stroke=\"{INK}\" stroke-opacity=\"0.6\" stroke-dasharray=\"6 5\"/>"
            );
            // lines that fall leave the upper right and the lower left free
            let (x, anchor) = if y < 0.5 * (frame.top + frame.foot) { (right - 4.0, "end") } else { (left + 4.0, "start") };
            let name = escaped(&level.name);
            let _ = writeln!(
                text,
                "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"11\" fill-opacity=\"0.7\" text-anchor=\"{anchor}\">{name}</text>",
                y - 5.0
            );
        }
        text
    }

    /// The marks, above the lines.
    pub fn marks(&self, frame: &ChartFrame, colour: impl Fn(usize) -> String) -> String {
        let mut text = String::new();
        for mark in &self.marks {
            let point = frame.scale.of(&mark.point);
            if !finite(&point) {
                continue;
            }
            let ([x, y], colour) = (frame.place(point), colour(mark.series));
            let fill = if mark.hollow { "#ffffff" } else { colour.as_str() };
            let _ = writeln!(
                text,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{MARK}\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.6\"/>"
            );
            if mark.ringed {
                let _ = writeln!(
                    text,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{RING}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.4\"/>"
                );
            }
            let above = if mark.ringed { RING } else { MARK } + 4.0;
            let label = escaped(&mark.label);
            let _ = writeln!(
                text,
                "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"10.5\" fill=\"{colour}\" text-anchor=\"middle\">{label}</text>",
                y - above
            );
        }
        text
    }
    /// The bars, above the lines.
    pub fn bars(&self, frame: &ChartFrame, colour: impl Fn(usize) -> String) -> String {
        let mut text = String::new();
        for bar in &self.bars {
            let ends = bar.ends.map(|end| frame.scale.of(&(bar.x, end)));
            if !ends.iter().all(finite) {
                continue;
            }
            let ([x, low], [_, high]) = (frame.place(ends[0]), frame.place(ends[1]));
            let (left, right, colour) = (x - END, x + END, colour(bar.series));
            let _ = writeln!(
                text,
                "<path d=\"M{x:.1} {low:.1}V{high:.1}M{left:.1} {low:.1}H{right:.1}M{left:.1} {high:.1}H{right:.1}\" \
                 fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>"
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Chart, Scale, Series};

    #[test]
    fn marks_and_levels_are_drawn_where_they_can_be() {
        let series = vec![Series { name: "a".into(), points: vec![(1.0, 0.1), (10.0, 0.01)] }];
        let chart = Chart { title: "A".into(), x: "x".into(), y: "y".into(), scale: Scale::Logarithmic, series };
        let mark = |point, hollow, ringed| Mark { series: 0, point, label: "8".into(), hollow, ringed };
        let marks = vec![mark((1.0, 0.1), false, true), mark((10.0, 0.01), true, false), mark((1.0, 0.0), false, false)];
        let levels = vec![Level { y: 1e-4, name: "a < b".into() }, Level { y: 0.0, name: "nowhere".into() }];
        let text = chart.annotated(&Notes { marks, levels, bars: Vec::new(), band: None });
        assert_eq!((text.matches("<circle").count(), text.matches("stroke-dasharray").count()), (3, 1));
        assert!(text.contains("a &lt; b") && text.contains(">0.0001<") && !text.contains("NaN"), "the ordinate reaches the level: {text}");
        assert_eq!(chart.svg(), chart.annotated(&Notes::default()));
    }

    #[test]
    fn a_mean_has_its_band_within_the_axes() {
        let series = vec![Series { name: "a".into(), points: vec![(0.0, 2.0), (10.0, 3.0)] }];
        let chart = Chart { title: String::new(), x: "x".into(), y: "y".into(), scale: Scale::Linear, series };
        let band = |mean: f64| Band {
            from_to: [4.0, 10.0],
            mean,
            interval: [mean - 1.0, mean + 1.0],
            name: "mean".into(),
            left_out: "left out".into(),
        };
        let with = |mean| chart.annotated(&Notes { band: Some(band(mean)), ..Notes::default() });
        assert!(with(8.0).contains(">mean</text>") && with(8.0).contains(">left out</text>") && with(8.0).contains(">8<"));
        assert!(!with(f64::NAN).contains("NaN"));
    }

    #[test]
    fn bars_are_drawn_where_they_are_finite_and_within_the_axes() {
        let series = vec![Series { name: "a".into(), points: vec![(1.0, 2.0), (2.0, 3.0)] }];
        let chart = Chart { title: String::new(), x: "x".into(), y: "y".into(), scale: Scale::Linear, series };
        let bar = |ends| Bar { series: 0, x: 1.0, ends };
        let bars = vec![bar([1.0, 9.0]), bar([f64::NAN, 2.0])];
        let text = chart.annotated(&Notes { bars: bars.clone(), ..Notes::default() });
        assert_eq!(text.matches("stroke-width=\"1.6\"").count(), 1);
        assert!(text.contains(">8<"), "the ordinate does not reach the end of the bar: {text}");
        assert!(!text.contains("NaN") && !chart.svg().contains(">8<"));
    }
}
