//! What may be written into a chart besides its lines: marks at points, levels across it, and error bars.

use std::fmt::Write;

use super::{
    data::{Chart, Notes, finite},
    frame::Frame,
};
use crate::output::picture::{INK, escaped};

/// Radius of a mark, and of the ring around it, in pixels.
const MARK: f64 = 4.0;
const RING: f64 = 9.0;

impl Chart {
    /// The levels, below the lines.
    pub(super) fn levels(&self, notes: &Notes, frame: &Frame) -> String {
        let mut text = String::new();
        for level in &notes.levels {
            let y = frame.place(self.scale.of(&(1.0, level.y)))[1];
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
    pub(super) fn marks(&self, notes: &Notes, frame: &Frame) -> String {
        let mut text = String::new();
        for mark in &notes.marks {
            let point = self.scale.of(&mark.point);
            if !finite(&point) {
                continue;
            }
            let ([x, y], colour) = (frame.place(point), self.colour(mark.series));
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
}

#[cfg(test)]
mod tests {
    use super::{
        super::data::{Level, Mark},
        *,
    };
    use crate::output::{Scale, Series};

    #[test]
    fn marks_and_levels_are_drawn_where_they_can_be() {
        let series = vec![Series { name: "a".into(), points: vec![(1.0, 0.1), (10.0, 0.01)] }];
        let chart = Chart { title: "A".into(), x: "x".into(), y: "y".into(), scale: Scale::Logarithmic, series };
        let mark = |point, hollow, ringed| Mark { series: 0, point, label: "8".into(), hollow, ringed };
        let marks = vec![mark((1.0, 0.1), false, true), mark((10.0, 0.01), true, false), mark((1.0, 0.0), false, false)];
        let levels = vec![Level { y: 1e-4, name: "a < b".into() }, Level { y: 0.0, name: "nowhere".into() }];
        let text = chart.annotated(&Notes { marks, levels, bars: Vec::new() });
        assert_eq!((text.matches("<circle").count(), text.matches("stroke-dasharray").count()), (3, 1));
        assert!(text.contains("a &lt; b") && text.contains(">0.0001<") && !text.contains("NaN"), "the ordinate reaches the level: {text}");
        assert_eq!(chart.svg(), chart.annotated(&Notes::default()));
    }
}
