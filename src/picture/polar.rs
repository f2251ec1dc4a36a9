//! A map over distance and direction as one SVG text: rings and sectors in colours, of half a turn and the opposite one alike.

use std::{
    f64::consts::{FRAC_1_SQRT_2, PI},
    fmt::Write,
};

use super::{INK, bar::Bar, escaped};

/// Width, height, centre and largest radius in pixels.
const PAGE: [f64; 2] = [620.0, 540.0];
const CENTRE: [f64; 2] = [270.0, 290.0];
const RADIUS: f64 = 220.0;

/// Left edge, top, width and height of the colour bar, and how many colours it has.
const BAR: [f64; 4] = [535.0, 110.0, 16.0, 360.0];
const COLOURS: usize = 60;

/// A map that is the same in opposite directions.
#[derive(Clone, Debug)]
pub struct PolarMap {
    /// Line of text above.
    pub title: String,
    /// Names of the axes that point right and up.
    pub axes: [String; 2],
    /// Middles of rings of one thickness, with a disk inside the first one.
    pub radii: Vec<f64>,
    /// Of each ring the values in sectors of half a turn from the right on, counterclockwise; of either sign.
    pub values: Vec<Vec<f64>>,
    /// Name of what is shown.
    pub name: String,
}

impl PolarMap {
    /// The map as a complete SVG document; without a ring it shows the axes alone.
    pub fn svg(&self) -> String {
        let [width, height] = PAGE;
        let all: Vec<f64> = self.values.iter().flatten().copied().collect();
        let bar = Bar::signed(&all, 0.1);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" font-size=\"13\" fill=\"{INK}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
             <text x=\"20\" y=\"28\" font-size=\"15\">{}</text>\n",
            escaped(&self.title)
        );
        for (ring, values) in self.values.iter().enumerate() {
            for (sector, value) in values.iter().enumerate() {
                let turns = [0.0, PI].map(|turn| turn + PI * sector as f64 / values.len() as f64);
                turns.iter().for_each(|&turn| svg += &self.sector(ring, [turn, turn + PI / values.len() as f64], colour(&bar, *value)));
            }
        }
        svg += &self.axes_and_ticks();
        svg += &self.bar(&bar);
        svg + "</svg>\n"
    }

    /// Pixels from the centre to the inner and the outer edge of a ring.
    fn edges(&self, ring: usize) -> [f64; 2] {
        let half = self.half_thickness();
        let scale = RADIUS / self.farthest();
        [-half, half].map(|side| (self.radii[ring] + side) * scale)
    }

    fn half_thickness(&self) -> f64 {
        if let [first, second, ..] = self.radii[..] { 0.5 * (second - first) } else { 0.0 }
    }

    fn farthest(&self) -> f64 {
        self.radii.last().map_or(1.0, |last| last + self.half_thickness())
    }

    fn sector(&self, ring: usize, turns: [f64; 2], colour: String) -> String {
        let [inner, outer] = self.edges(ring);
        let point = |radius: f64, turn: f64| format!("{:.2} {:.2}", CENTRE[0] + radius * turn.cos(), CENTRE[1] - radius * turn.sin());
        let [from, to] = turns;
        format!(
            "<path d=\"M{} L{} A{outer:.2} {outer:.2} 0 0 0 {} L{} A{inner:.2} {inner:.2} 0 0 1 {} Z\" fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"0.3\"/>\n",
            point(inner, from),
            point(outer, from),
            point(outer, to),
            point(inner, to),
            point(inner, from)
        )
    }

    /// Axes through the centre, and circles at whole separations.
    fn axes_and_ticks(&self) -> String {
        let [x, y] = CENTRE;
        let mut svg = String::new();
        for whole in (1..).map(f64::from).take_while(|whole| *whole <= self.farthest()) {
            let radius = whole * RADIUS / self.farthest();
            writeln!(
                svg,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius:.2}\" fill=\"none\" stroke=\"{INK}\" stroke-opacity=\"0.45\" stroke-width=\"0.8\"/>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11\">{whole}</text>",
                x + FRAC_1_SQRT_2 * radius + 3.0,
                y + FRAC_1_SQRT_2 * radius + 10.0
            )
            .expect("memory can be written");
        }
        let [right, up] = [x + RADIUS + 8.0, y - RADIUS - 8.0];
        let [along, across] = [&self.axes[0], &self.axes[1]].map(|name| escaped(name));
        svg + &format!(
            "<path d=\"M{x} {y}H{right}M{x} {y}V{up}\" stroke=\"{INK}\" stroke-width=\"1\"/>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{along}</text>\n<text x=\"{:.1}\" y=\"{:.1}\">{across}</text>\n",
            right + 6.0,
            y - 6.0,
            x + 8.0,
            up + 2.0
        )
    }

    fn bar(&self, bar: &Bar) -> String {
        let [left, top, width, height] = BAR;
        let (step, mut svg) = (height / COLOURS as f64, String::new());
        for place in 0..COLOURS {
            let part = (place as f64 + 0.5) / COLOURS as f64;
            let colour = colour(bar, bar.bottom + part * (bar.top - bar.bottom));
            let y = top + height - step * (place + 1) as f64;
            writeln!(svg, "<rect x=\"{left}\" y=\"{y:.2}\" width=\"{width}\" height=\"{:.2}\" fill=\"{colour}\"/>", step + 0.3)
                .expect("memory can be written");
        }
        for tick in &bar.ticks {
            let y = top + height * (1.0 - bar.part(*tick)) + 4.0;
            writeln!(svg, "<text x=\"{:.1}\" y=\"{y:.1}\" font-size=\"12\">{}</text>", left + width + 6.0, bar.label(*tick))
                .expect("memory can be written");
        }
        let power = if bar.exponent == 0 { String::new() } else { format!(" / 1e{}", bar.exponent) };
        svg + &format!(
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}{power}</text>\n",
            left + 20.0,
            top - 14.0,
            escaped(&self.name)
        )
    }
}

fn colour(bar: &Bar, value: f64) -> String {
    let [red, green, blue] = bar.colours().shade(bar.part(if value.is_finite() { value } else { 0.0 }));
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(values: Vec<Vec<f64>>) -> String {
        let radii = (0..values.len()).map(|ring| 1.05 + 0.1 * ring as f64).collect();
        PolarMap { title: "a < b".into(), axes: ["flow".into(), "gradient".into()], radii, values, name: "g".into() }.svg()
    }

    /// A single sector that stands out is drawn twice, opposite to itself; all others have the colour of zero.
    #[test]
    fn opposite_sectors_have_one_colour() {
        let mut values = vec![vec![0.0; 6]; 4];
        values[2][1] = 1.0;
        let svg = map(values);
        let sectors: Vec<&str> = svg.lines().filter(|line| line.starts_with("<path d=\"M") && line.contains(" A")).collect();
        assert_eq!(sectors.len(), 2 * 24);
        let bright: Vec<&&str> = sectors.iter().filter(|line| !line.contains("#f7f7f7")).collect();
        assert_eq!(bright.len(), 2);
        // a sector from 30 degrees on, a third of the way up: its first corners mirror each other at the centre
        let corner = |line: &str| {
            let numbers: Vec<f64> = line[10..].split([' ', 'L']).filter_map(|number| number.parse().ok()).take(2).collect();
            [numbers[0] - CENTRE[0], numbers[1] - CENTRE[1]]
        };
        let [one, other] = [corner(bright[0]), corner(bright[1])];
        assert!((one[0] + other[0]).abs() < 0.02 && (one[1] + other[1]).abs() < 0.02, "{one:?} and {other:?}");
        assert!((-one[1]).atan2(one[0]).to_degrees() - 30.0 < 0.1);
        assert!(svg.contains("a &lt; b") && !svg.contains("NaN"));
    }

    #[test]
    fn no_ring_and_no_number_are_drawn_too() {
        assert!(map(Vec::new()).ends_with("</svg>\n"));
        assert!(!map(vec![vec![f64::NAN, f64::INFINITY], vec![1.0, 2.0]]).contains("NaN"));
    }
}
