//! The axes of a picture: ticks with numbers below and to the left of the box, and the names of the axes.

use std::fmt::Write;

use super::axis::Axis;
use super::frame::{INK, PictureFrame};

/// Length of a tick, and the distance of its number from the box, beyond the wall.
const TICK: f64 = 5.0;
const NUMBER: f64 = 8.0;

/// Ticks, numbers and names.
pub fn axes(names: [&str; 2], size: [f64; 2], frame: &PictureFrame) -> String {
    let [across, up] = size.map(|length| Axis::tight(&[0.0, length]));
    let foot = frame.top + frame.size[1] + frame.wall;
    let (mut ticks, mut words) = (String::new(), String::new());
    for tick in across.ticks() {
        let x = frame.left + across.part(tick) * frame.size[0];
        let _ = write!(ticks, "M{x:.1} {foot:.1}v{TICK}");
        let _ =
            writeln!(words, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>", foot + NUMBER + 11.0, across.label(tick));
    }
    let left = frame.left - frame.wall;
    for tick in up.ticks() {
        let y = frame.top + (1.0 - up.part(tick)) * frame.size[1];
        let _ = write!(ticks, "M{left:.1} {y:.1}h-{TICK}");
        let _ = writeln!(words, "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>", left - NUMBER, y + 4.4, up.label(tick));
    }
    let (middle, level) = (frame.left + frame.size[0] / 2.0, frame.top + frame.size[1] / 2.0);
    format!(
        "<path d=\"{ticks}\" fill=\"none\" stroke=\"{INK}\" stroke-opacity=\"0.7\" stroke-width=\"0.9\"/>\n<g font-size=\"12.5\">\n{words}</g>\n\
         <text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"14\" font-style=\"italic\">{}</text>\n\
         <text transform=\"translate({:.1} {level:.1}) rotate(-90)\" text-anchor=\"middle\" font-size=\"14\" font-style=\"italic\">{}</text>\n",
        foot + 37.0,
        names[0],
        left - 44.0,
        names[1],
    )
}
