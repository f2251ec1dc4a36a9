//! The drawing itself: frame, colours, streamlines, bodies, walls and colour bar as SVG text.

use std::fmt::Write;

use super::axes::axes;
use super::bar::Bar;
use super::colour::{distinct, hexadecimal};
use super::frame::{AXIS, BAR_ROOM, INK, LARGEST, PictureFrame, SIDE, WALL};
use super::streamlines::{PlanePoint, pieces, separation, streamlines};
use super::{Disk, Picture, raster};

/// Most groups of bodies that are named.
const MOST_IN_LEGEND: usize = 5;
const RASTER_WIDTH: f64 = 450.0;

/// The whole document.
pub fn drawing(picture: &Picture) -> String {
    let frame = PictureFrame::new(picture);
    let bar = bar(picture);
    let [width, height] = frame.page;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" fill=\"{INK}\">\n"
    );
    svg += &definitions(&frame, &bar);
    let _ = writeln!(svg, "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>");
    svg += &words(picture, &frame);
    svg += "<g clip-path=\"url(#box)\">\n";
    svg += &field(picture, &frame, &bar);
    svg += &lines(picture, &frame);
    svg += &ties(picture, &frame);
    svg += &bodies(picture, &frame);
    svg += &contacts(picture, &frame);
    svg += "</g>\n";
    svg += &edges(picture, &frame);
    svg += &axes(picture.axes, picture.size, &frame);
    svg += &colour_bar(&picture.quantity, &frame, &bar);
    svg + "</svg>\n"
}

fn bar(picture: &Picture) -> Bar {
    if picture.signed { Bar::signed(&picture.coloured, picture.least) } else { Bar::new(&picture.coloured, picture.least) }
}

fn definitions(frame: &PictureFrame, bar: &Bar) -> String {
    let colour = |part: f64| format!("<stop offset=\"{part}\" stop-color=\"{}\"/>", bar.colours().hexadecimal(part));
    let stop = |k: u32| colour(f64::from(k) / 16.0);
    let stops: String = (0..=16).map(stop).collect();
    format!(
        "<defs><clipPath id=\"box\"><rect {}/></clipPath>\n\
         <linearGradient id=\"colours\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">{stops}</linearGradient></defs>\n",
        frame.rectangle()
    )
}

/// Title, subtitle and legend.
fn words(picture: &Picture, frame: &PictureFrame) -> String {
    let fitting = |text: &str, largest: f64| (1.75 * (frame.page[0] - 2.0 * SIDE) / text.chars().count().max(1) as f64).clamp(6.0, largest);
    let mut text = String::new();
    if !picture.title.is_empty() {
        let (font, title) = (fitting(&picture.title, 19.0), escaped(&picture.title));
        let _ = writeln!(text, "<text x=\"{SIDE}\" y=\"34\" font-size=\"{font:.1}\" font-weight=\"600\">{title}</text>");
    }
    if !picture.subtitle.is_empty() {
        let (font, subtitle) = (fitting(&picture.subtitle, 14.0), escaped(&picture.subtitle));
        let _ = writeln!(text, "<text x=\"{SIDE}\" y=\"58\" font-size=\"{font:.1}\" fill-opacity=\"0.75\">{subtitle}</text>");
    }
    let mut right = frame.page[0] - SIDE;
    for (group, name) in picture.legend.iter().take(MOST_IN_LEGEND).rev() {
        right -= 24.0 + 6.6 * name.chars().count() as f64;
        let (fill, name) = (hexadecimal(distinct(*group)), escaped(name));
        let _ = writeln!(text, "<circle cx=\"{:.1}\" cy=\"53.5\" r=\"5\" fill=\"{fill}\"/>", right + 5.0);
        let _ = writeln!(text, "<text x=\"{:.1}\" y=\"58\" font-size=\"12.5\">{name}</text>", right + 14.0);
    }
    text
}

/// A text as the content of an SVG element.
pub fn escaped(text: &str) -> String {
    let plain = text.chars().filter(|letter| !letter.is_control()).collect::<String>();
    plain.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn field(picture: &Picture, frame: &PictureFrame, bar: &Bar) -> String {
    let density = RASTER_WIDTH / (LARGEST[0] - AXIS[0] - BAR_ROOM);
    let pixels = frame.size.map(|length| (length * density).round().max(1.0) as usize);
    let image = raster::data_uri(picture, pixels, bar);
    format!("<image {} preserveAspectRatio=\"none\" href=\"{image}\"/>\n", frame.rectangle())
}

fn lines(picture: &Picture, frame: &PictureFrame) -> String {
    let moves = |velocity: &PlanePoint| velocity[0].hypot(velocity[1]) > picture.least_speed;
    if !picture.velocity.iter().any(moves) {
        return String::new();
    }
    let lines = streamlines(picture);
    let strokes: String = lines.iter().flat_map(|line| pieces(picture, line)).map(|piece| path(&piece, frame)).collect();
    let heads: String = lines.iter().flat_map(|line| arrows(picture, frame, line)).collect();
    // colours that part at zero are light there
    let (stroke, opacity) = if picture.signed { (INK, 0.45) } else { ("#ffffff", 0.8) };
    format!(
        "<g opacity=\"{opacity}\"><path d=\"{strokes}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"1.1\" stroke-linejoin=\"round\" \
         stroke-linecap=\"round\"/>\n<path d=\"{heads}\" fill=\"{stroke}\"/></g>\n"
    )
}

fn path(points: &[PlanePoint], frame: &PictureFrame) -> String {
    let mut text = String::new();
    for (index, &point) in points.iter().enumerate() {
        let [x, y] = frame.place(point);
        let letter = ["M", "L", " "][index.min(2)];
        let _ = write!(text, "{letter}{x:.1} {y:.1}");
    }
    text
}

/// Arrow heads along a line, one in the middle of every ten separations.
fn arrows(picture: &Picture, frame: &PictureFrame, line: &[PlanePoint]) -> Vec<String> {
    let count = (line.len() / 100).max(usize::from(line.len() > 24));
    let head = |k: usize| {
        let index = ((2 * k + 1) * line.len() / (2 * count)).clamp(1, line.len() - 1);
        let [before, tip] = [line[index - 1], line[index]];
        let (window, turns) = (picture.window(), picture.window().turns(tip));
        let [before, tip] = [before, tip].map(|p| frame.place(window.back(p, turns)));
        arrow(before, tip, (0.36 * separation(picture) * frame.scale).clamp(5.0, 9.5))
    };
    (0..count).map(head).collect()
}

fn arrow(before: PlanePoint, tip: PlanePoint, length: f64) -> String {
    let step = [tip[0] - before[0], tip[1] - before[1]];
    let along = step.map(|component| component / step[0].hypot(step[1]).max(1e-12) * length);
    let point = |a: f64, b: f64| format!("{:.1} {:.1}", tip[0] + a * along[0] - b * along[1], tip[1] + a * along[1] + b * along[0]);
    format!("M{}L{} {} {}Z", point(0.6, 0.0), point(-0.4, 0.38), point(-0.2, 0.0), point(-0.4, -0.38))
}

fn ties(picture: &Picture, frame: &PictureFrame) -> String {
    let lines = strokes(picture.ties(&picture.bonds), frame);
    if lines.is_empty() { lines } else { format!("<g fill=\"none\" stroke=\"{INK}\">\n{lines}</g>\n") }
}

/// Colour of contact forces, light and dark.
const FORCE: &str = "#ff5a1f";

fn contacts(picture: &Picture, frame: &PictureFrame) -> String {
    let lines = strokes(picture.ties(&picture.contacts), frame);
    let style = format!("<g fill=\"none\" stroke=\"{FORCE}\" stroke-linecap=\"round\">");
    if lines.is_empty() { lines } else { format!("{style}\n{lines}</g>\n") }
}

fn strokes(lines: Vec<([PlanePoint; 2], f64)>, frame: &PictureFrame) -> String {
    let line = |(ends, width): ([PlanePoint; 2], f64)| {
        let width = (width * frame.scale).max(0.5);
        format!("<path d=\"{}\" stroke-width=\"{width:.1}\"/>\n", path(&ends, frame))
    };
    lines.into_iter().map(line).collect()
}

/// Most bodies that are drawn as circles; more of them become an image of a pixel a pixel.
const MOST_CIRCLES: usize = 10_000;

fn bodies(picture: &Picture, frame: &PictureFrame) -> String {
    let disks = picture.disks();
    if disks.len() > MOST_CIRCLES { many_circles(&disks, frame) } else { circles(&disks, picture.least_speed, frame) }
}

/// Bodies too many to be told apart.
fn many_circles(disks: &[Disk], frame: &PictureFrame) -> String {
    let pixels = frame.size.map(|length| length.round().max(1.0) as usize);
    let place = |disk: &Disk| {
        let [x, y] = frame.place(disk.center);
        ([x - frame.left, y - frame.top], disk.radius * frame.scale, disk.group.map(distinct))
    };
    let image = raster::disks_uri(disks.iter().map(place), pixels);
    format!("<image {} preserveAspectRatio=\"none\" href=\"{image}\"/>\n", frame.rectangle())
}

fn circles(disks: &[Disk], least_speed: f64, frame: &PictureFrame) -> String {
    let largest = disks.iter().map(|disk| disk.radius * frame.scale).fold(0.0, f64::max);
    let outline = (0.08 * largest).clamp(0.25, 1.2);
    let fastest = disks.iter().map(speed).filter(|speed| speed.is_finite()).fold(least_speed, f64::max);
    let mut text = format!("<g fill=\"{INK}\" stroke=\"#ffffff\" stroke-opacity=\"0.85\" stroke-width=\"{outline:.2}\">\n");
    for disk in disks {
        let [x, y] = frame.place(disk.center);
        let fill = disk.group.map_or(String::new(), |group| format!(" fill=\"{}\"", hexadecimal(distinct(group))));
        let _ = writeln!(text, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"{fill}/>", disk.radius * frame.scale);
    }
    let ticks: String = disks.iter().filter_map(|disk| tick(disk, frame, fastest)).collect();
    let width = (0.1 * largest).clamp(0.6, 2.2);
    let _ = writeln!(text, "<path d=\"{ticks}\" fill=\"none\" stroke-width=\"{width:.2}\" stroke-linecap=\"round\"/></g>");
    text
}

/// A stroke from the center along the velocity, none where it would be too small to be seen.
fn tick(disk: &Disk, frame: &PictureFrame, fastest: f64) -> Option<String> {
    let part = 0.8 * disk.radius / fastest;
    let length = part * speed(disk) * frame.scale;
    let end = [disk.center[0] + part * disk.velocity[0], disk.center[1] + part * disk.velocity[1]];
    (length.is_finite() && length > 1.5 && disk.radius * frame.scale > 4.0).then(|| path(&[disk.center, end], frame))
}

fn speed(disk: &Disk) -> f64 {
    disk.velocity[0].hypot(disk.velocity[1])
}

/// Thick walls outside the box, and a thin line where it repeats.
fn edges(picture: &Picture, frame: &PictureFrame) -> String {
    let [width, height] = frame.size;
    let mut text = format!("<rect {} fill=\"none\" stroke=\"{INK}\" stroke-opacity=\"0.55\" stroke-width=\"0.8\"/>\n", frame.rectangle());
    let reach = picture.walls.map(|wall| if wall { WALL } else { 0.4 });
    let mut wall = |x: f64, y: f64, size: PlanePoint| {
        let [x, y] = [frame.left + x, frame.top + y];
        let _ = writeln!(text, "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>", size[0], size[1]);
    };
    if picture.walls[0] {
        let size = [WALL, height + 2.0 * reach[1]];
        [-WALL, width].into_iter().for_each(|x| wall(x, -reach[1], size));
    }
    if picture.walls[1] {
        let size = [width + 2.0 * reach[0], WALL];
        [-WALL, height].into_iter().for_each(|y| wall(-reach[0], y, size));
    }
    text
}

fn colour_bar(quantity: &str, frame: &PictureFrame, bar: &Bar) -> String {
    let [x, y] = [frame.left + frame.size[0] + 26.0, frame.top];
    let height = frame.size[1];
    let mut text = format!(
        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"14\" height=\"{height:.1}\" fill=\"url(#colours)\" stroke=\"{INK}\" \
         stroke-opacity=\"0.55\" stroke-width=\"0.8\"/>\n<g font-size=\"13\">\n"
    );
    for &tick in &bar.ticks {
        let level = y + height * (1.0 - bar.part(tick));
        let _ = writeln!(text, "<path d=\"M{:.1} {level:.1}h5\" stroke=\"{INK}\" stroke-width=\"0.8\"/>", x + 14.0);
        let _ = writeln!(text, "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>", x + 23.0, level + 4.6, bar.label(tick));
    }
    let letters = bar.ticks.iter().map(|&tick| bar.label(tick).len()).max().unwrap_or(0);
    let [x, y] = [x + 42.0 + 7.5 * letters as f64, y + height / 2.0];
    let unit = power(bar.exponent);
    let font = (1.8 * frame.page[1] / quantity.chars().count() as f64).clamp(7.0, 13.5);
    let quantity = escaped(quantity);
    let _ = writeln!(
        text,
        "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\" font-size=\"{font:.1}\">{quantity}{unit}</text>\n</g>"
    );
    text
}

fn power(exponent: i32) -> String {
    if exponent == 0 {
        return String::new();
    }
    let sign = if exponent < 0 { "\u{2212}" } else { "" };
    let digits = exponent.abs();
    format!(" (10<tspan dy=\"-5\" font-size=\"10\">{sign}{digits}</tspan><tspan dy=\"5\">)</tspan>")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::tests::{disk, uniform_flow};
    use super::*;

    /// The document without its image, whose base64 may spell anything.
    fn text(picture: &Picture) -> String {
        let svg = picture.svg();
        let start = svg.find("base64,").unwrap();
        let end = start + svg[start..].find('"').unwrap();
        format!("{}{}", &svg[..start], &svg[end..])
    }

    fn assert_sound(picture: &Picture) {
        let text = text(picture);
        assert!(text.starts_with("<svg xmlns=") && text.ends_with("</svg>\n"));
        assert!(!text.contains("NaN") && !text.contains("inf"));
        assert_eq!(text.matches("<g").count(), text.matches("</g").count());
        assert_eq!(text.matches('<').count(), text.matches('>').count());
    }

    #[test]
    fn a_picture_is_one_document_of_finite_numbers() {
        let mut picture = uniform_flow([1.0, 0.2]);
        picture.bodies = vec![disk([0.0, 0.5], 0.2), disk([1.0, 0.4], 0.1)];
        assert_sound(&picture);
    }

    #[test]
    fn a_fluid_at_rest_and_values_that_are_not_finite_can_be_drawn() {
        assert_sound(&uniform_flow([0.0, 0.0]));
        let mut picture = uniform_flow([f64::NAN, f64::INFINITY]);
        picture.bodies = vec![disk([0.5, 0.5], f64::NAN), Disk { velocity: [f64::NAN, 0.0], ..disk([0.5, 0.5], 0.1) }];
        assert_sound(&picture);
    }

    #[test]
    fn what_has_either_sign_is_drawn_from_below_zero_on() {
        let signed =
            Picture { coloured: (0..512).map(|place| f64::from(place % 3 - 1)).collect(), signed: true, ..uniform_flow([1.0, 0.2]) };
        assert_sound(&signed);
        let text = text(&signed);
        assert!(text.contains(">-0.8</text>") && text.contains(">0.8</text>"), "{text}");
    }

    #[test]
    fn one_sample_and_long_boxes_can_be_drawn() {
        for size in [[4.0, 1.0], [1.0, 4.0], [1e-6, 1e-6], [1e5, 3e5]] {
            assert_sound(&Picture { size, ..uniform_flow([1e-5, 1e-5]) });
        }
        assert_sound(&Picture { samples: [1, 1], velocity: vec![[1.0, 0.0]], coloured: vec![1.0], ..uniform_flow([0.0, 0.0]) });
    }

    #[test]
    fn a_crowd_is_an_image_of_bounded_size() {
        let mut picture = uniform_flow([1.0, 0.2]);
        let row = |k: usize| disk([2.0 * k as f64 / MOST_CIRCLES as f64, 0.25], 0.01);
        picture.bodies = (0..MOST_CIRCLES / 2).map(row).collect();
        assert!(picture.svg().contains("<circle"));
        let few = Picture { bodies: vec![disk([0.5, 0.5], 0.1)], ..picture.clone() }.svg().len();
        picture.bodies = (0..10 * MOST_CIRCLES).map(row).collect();
        let svg = picture.svg();
        assert!(!svg.contains("<circle") && svg.matches("<image").count() == 2 && svg.len() < few + 20_000, "{}", svg.len());
    }

    #[test]
    fn bodies_of_one_chain_have_one_colour_and_others_are_dark() {
        let mut picture = uniform_flow([1.0, 0.2]);
        let chained = |x: f64, chain: usize| Disk { group: Some(chain), ..disk([x, 0.5], 0.1) };
        picture.bodies = vec![chained(0.3, 0), chained(0.6, 0), chained(1.2, 1), disk([1.6, 0.5], 0.1)];
        let text = text(&picture);
        let fills: Vec<&str> =
            text.lines().filter(|line| line.starts_with("<circle")).map(|line| line.split(' ').nth(4).unwrap_or("")).collect();
        assert_eq!(fills, ["fill=\"#e69f00\"/>", "fill=\"#e69f00\"/>", "fill=\"#56b4e9\"/>", ""]);
    }

    #[test]
    fn the_title_is_escaped() {
        assert!(text(&uniform_flow([1.0, 0.0])).contains(">A &lt; B &amp; C</text>"));
    }

    #[test]
    fn the_page_keeps_to_its_largest_size() {
        for size in [[4.0, 1.0], [1.0, 1.0], [1.0, 4.0]] {
            let page = PictureFrame::new(&Picture { size, ..uniform_flow([1.0, 0.0]) }).page;
            assert!(page[0] <= LARGEST[0] && page[1] <= LARGEST[1], "{page:?}");
        }
    }

    #[test]
    fn walls_lie_along_the_edges_that_do_not_repeat() {
        let count = |periodic: [bool; 2]| {
            edges(
                &Picture { walls: periodic.map(|periodic| !periodic), ..uniform_flow([1.0, 0.0]) },
                &PictureFrame::new(&uniform_flow([1.0, 0.0])),
            )
            .matches("<rect")
            .count()
        };
        assert_eq!([[true, true], [true, false], [false, false]].map(count), [1, 3, 5]);
    }
}
