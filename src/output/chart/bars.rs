//! Error bars of a chart.

use std::fmt::Write;

use super::{
    data::{Bar, Chart, finite},
    frame::Frame,
};

/// Half the width of the ends of a bar in pixels.
const END: f64 = 4.0;

impl Chart {
    /// The bars, above the lines.
    pub(super) fn bars(&self, bars: &[Bar], frame: &Frame) -> String {
        let mut text = String::new();
        for bar in bars {
            let ends = bar.ends.map(|end| self.scale.of(&(bar.x, end)));
            if !ends.iter().all(finite) {
                continue;
            }
            let ([x, low], [_, high]) = (frame.place(ends[0]), frame.place(ends[1]));
            let (left, right, colour) = (x - END, x + END, self.colour(bar.series));
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
    use crate::output::{Notes, Scale, Series};

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
