//! A line chart as one SVG text: a total in ink, its parts in colours, names at the ends of the lines.
//!
//! A pure function of a [`Chart`]. Ranges follow the points, and reach down to zero only where that costs little of the height. The ordinate follows those
//! that a mean takes in, if there is one: lines that go beyond are clipped.

mod frame;
mod notes;

use std::fmt::Write;

use self::frame::{ChartFrame, PAGE, SIDE, finite};
pub use self::{
    frame::Scale,
    notes::{Band, Bar, Level, Mark, Notes},
};
use super::{INK, colour, escaped};

/// Least distance of names in pixels.
const LINE: f64 = 18.0;

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

/// One line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name.
    pub name: String,
    /// Abscissas and ordinates in the order to be joined; the line breaks where a value is not finite.
    pub points: Vec<(f64, f64)>,
}

impl Chart {
    /// The chart as a complete SVG document of 800 by 450 pixels; without a finite point it shows empty axes.
    pub fn svg(&self) -> String {
        self.annotated(&Notes::default())
    }

    /// The same with marks, levels and bars.
    pub fn annotated(&self, notes: &Notes) -> String {
        let (frame, colour) = (self.frame(notes), |k: usize| self.colour(k));
        let [width, height] = PAGE;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" font-size=\"13\" fill=\"{INK}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        );
        svg += &self.words(&frame);
        svg += &notes.shades(&frame);
        svg += &frame.grid();
        svg += &notes.levels(&frame);
        let lines: String = (0..self.series.len()).rev().map(|k| self.line(k, &frame)).collect();
        svg += &if self.points().all(|(_, point)| frame.reaches(&point)) { lines } else { frame.clipped(&lines) };
        svg += &notes.bars(&frame, colour);
        svg += &notes.marks(&frame, colour);
        svg += &self.names(&frame);
        svg + "</svg>\n"
    }

    /// The points of all lines that can be drawn: their abscissas, and as they are drawn.
    fn points(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        let points = self.series.iter().flat_map(|series| &series.points);
        points.map(|point| (point.0, self.scale.of(point))).filter(|(_, point)| finite(point))
    }

    /// Axes that hold all points, levels and bars; of the points that a mean leaves out, the abscissas only.
    fn frame(&self, notes: &Notes) -> ChartFrame {
        let start = notes.band.as_ref().map_or(f64::NEG_INFINITY, |band| band.from_to[0]);
        let x: Vec<f64> = self.points().map(|(_, point)| point[0]).collect();
        let mut y: Vec<f64> = self.points().filter(|(x, _)| *x >= start).map(|(_, point)| point[1]).collect();
        y.extend(notes.extent().map(|point| self.scale.of(&point)).filter(finite).map(|point| point[1]));
        let names: Vec<&str> = self.series.iter().map(|series| series.name.as_str()).collect();
        ChartFrame::new(self.scale, [&x, &y], &names, !self.title.is_empty())
    }

    fn words(&self, frame: &ChartFrame) -> String {
        let [left, right] = [frame.left, frame.right];
        let [title, x, y] = [&self.title, &self.x, &self.y].map(|text| escaped(text));
        let middle = (frame.top + frame.foot) / 2.0;
        format!(
            "<text x=\"{SIDE}\" y=\"34\" font-size=\"18\" font-weight=\"600\">{title}</text>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"14\">{x}</text>\n\
             <text transform=\"translate({:.1} {middle:.1}) rotate(-90)\" text-anchor=\"middle\" font-size=\"14\">{y}</text>\n",
            (left + right) / 2.0,
            PAGE[1] - SIDE + 4.0,
            SIDE + 10.0,
        )
    }

    /// The pieces of a line between values that are not finite; a lonely point becomes a dot, a stroke without length.
    fn line(&self, k: usize, frame: &ChartFrame) -> String {
        let points: Vec<[f64; 2]> = self.series[k].points.iter().map(|point| self.scale.of(point)).collect();
        let path: String = points.split(|point| !finite(point)).map(|piece| frame.path(piece)).collect();
        let width = if k == 0 { 2.4 } else { 1.8 };
        let dot = if points.iter().filter(|point| finite(point)).count() == 1 { 7.0 } else { width };
        format!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{dot}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n",
            self.colour(k)
        )
    }

    /// Ink for the first line, then colours that most eyes tell apart.
    fn colour(&self, k: usize) -> String {
        if k == 0 { INK.into() } else { colour::hexadecimal(colour::LINES[(k - 1) % colour::LINES.len()]) }
    }

    /// The names at the heights where their lines end, moved apart where they would touch.
    fn names(&self, frame: &ChartFrame) -> String {
        let mut text = String::new();
        if self.series.len() < 2 {
            return text;
        }
        for (k, level) in apart(self.ends(frame), frame) {
            let [x, colour, name] = [format!("{:.1}", frame.right + 12.0), self.colour(k), escaped(&self.series[k].name)];
            let _ = writeln!(text, "<path d=\"M{x} {level:.1}h18\" stroke=\"{colour}\" stroke-width=\"3\" stroke-linecap=\"round\"/>");
            let _ = writeln!(text, "<text x=\"{:.1}\" y=\"{:.1}\">{name}</text>", frame.right + 38.0, level + 4.6);
        }
        text
    }

    /// The number of each line and the height in pixels of its last point, from the top down.
    fn ends(&self, frame: &ChartFrame) -> Vec<(usize, f64)> {
        let end =
            |series: &Series| series.points.iter().rev().map(|point| self.scale.of(point)).find(finite).map(|point| frame.place(point)[1]);
        let mut ends: Vec<(usize, f64)> = self.series.iter().map(|series| end(series).unwrap_or(frame.foot)).enumerate().collect();
        ends.sort_by(|a, b| a.1.total_cmp(&b.1));
        ends
    }
}

/// Heights from the top down, each at least a line below the one before and none below the axes.
fn apart(mut ends: Vec<(usize, f64)>, frame: &ChartFrame) -> Vec<(usize, f64)> {
    for k in 1..ends.len() {
        ends[k].1 = ends[k].1.max(ends[k - 1].1 + LINE);
    }
    let mut floor = frame.foot;
    for end in ends.iter_mut().rev() {
        end.1 = end.1.min(floor);
        floor = end.1 - LINE;
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(lines: &[&[(f64, f64)]]) -> Chart {
        let series = lines.iter().map(|points| Series { name: "a < b".into(), points: points.to_vec() }).collect();
        Chart { title: "A & B".into(), x: "strain".into(), y: "viscosity".into(), scale: Scale::Linear, series }
    }

    fn assert_sound(chart: &Chart) {
        let text = chart.svg();
        assert!(text.starts_with("<svg xmlns=") && text.ends_with("</svg>\n"));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        assert_eq!(text.matches("<text").count(), text.matches("</text>").count());
        assert_eq!(text.matches('<').count(), text.matches('>').count());
        assert!(!text.contains("& "));
    }

    #[test]
    fn charts_without_a_range_can_be_drawn() {
        for points in [&[][..], &[(1.0, 2.0)], &[(0.0, 0.0)], &[(0.0, 3.0), (1.0, 3.0)], &[(0.0, -1e-300), (1.0, 1e-300)]] {
            assert_sound(&chart(&[points]));
            assert_sound(&chart(&[points, points]));
        }
        assert_sound(&chart(&[]));
    }

    #[test]
    fn the_ordinate_follows_what_a_mean_takes_in_and_lines_end_at_its_ends() {
        let spike = chart(&[&[(0.0, 900.0), (1.0, 2.0), (2.0, 2.5), (3.0, 2.2)], &[(0.0, -50.0), (1.0, 0.4), (2.0, 0.3), (3.0, 0.5)]]);
        let band = Band { from_to: [1.0, 3.0], mean: 2.2, interval: [2.1, 2.3], name: "mean".into(), left_out: String::new() };
        let notes = Notes { band: Some(band), ..Notes::default() };
        let frame = spike.frame(&notes);
        assert!(frame.y.part(2.5) < 1.0 && frame.y.part(2.5) > 0.9 && frame.y.part(900.0) > 1.0 && frame.y.part(-50.0) < 0.0);
        assert_eq!(frame.x.part(0.0), 0.0);
        let text = spike.annotated(&notes);
        let [open, first, last, close] =
            ["<g clip-path=\"url(#axes)\">", "stroke-width=\"1.8\"", "stroke-width=\"2.4\"", "</g>"].map(|part| text.find(part).unwrap());
        assert!(text.contains("<clipPath id=\"axes\">") && open < first && first < last && last < close, "{text}");
        let calm = chart(&[&[(0.0, 2.1), (1.0, 2.0), (2.0, 2.5), (3.0, 2.2)]]);
        assert!(!calm.annotated(&notes).contains("clip"), "{}", calm.annotated(&notes));
        assert!(!spike.svg().contains("clip"), "without a mean the ordinate holds all points");
    }

    #[test]
    fn a_line_breaks_where_a_value_is_not_finite() {
        let chart = chart(&[&[(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (f64::INFINITY, 1.0), (4.0, 1.0), (5.0, 2.0)]]);
        assert_sound(&chart);
        assert_eq!(chart.line(0, &chart.frame(&Notes::default())).matches('M').count(), 2);
    }

    #[test]
    fn names_are_shown_for_more_than_one_line() {
        let points = [(0.0, 1.0), (1.0, 2.0)];
        assert!(!chart(&[&points]).svg().contains("a &lt; b"));
        assert_eq!(chart(&[&points, &points]).svg().matches("a &lt; b").count(), 2);
    }

    #[test]
    fn names_keep_a_line_of_distance_within_the_axes() {
        let frame = chart(&[]).frame(&Notes::default());
        let levels: Vec<f64> = apart(vec![(0, 380.0), (1, 385.0), (2, 386.0)], &frame).iter().map(|end| end.1).collect();
        assert!(levels.windows(2).all(|pair| pair[1] - pair[0] >= LINE) && levels[2] <= frame.foot);
    }

    #[test]
    fn logarithmic_axes_have_powers_of_ten_and_leave_out_what_is_not_positive() {
        let mut chart = chart(&[&[(1.0, 20.0), (4096.0, 0.01), (3.0, 0.0), (-1.0, 2.0)]]);
        chart.scale = Scale::Logarithmic;
        assert_sound(&chart);
        let labels = |axis: crate::picture::axis::Axis| axis.ticks().iter().map(|&tick| axis.label(tick)).collect::<Vec<_>>();
        assert_eq!(labels(chart.frame(&Notes::default()).x), ["1", "10", "100", "1000"]);
        chart.series.clear();
        assert_sound(&chart);
    }

    #[test]
    fn the_same_chart_is_the_same_text() {
        let chart = chart(&[&[(0.0, 1.0), (1.0, 2.0)], &[(0.0, 0.5), (1.0, 0.7)]]);
        assert_eq!(chart.svg(), chart.svg());
    }
}
