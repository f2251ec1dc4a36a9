//! The text of the page: its elements, its looks and its program, in the order in which the program's files build on each other.

use std::io::{self, Write};

use serde_json::Value;

use crate::picture::escaped;

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
const PROGRAM: [&str; 13] = [
    include_str!("page/frames.js"),
    include_str!("page/colours.js"),
    include_str!("page/quantities.js"),
    include_str!("page/camera.js"),
    include_str!("page/graphics.js"),
    include_str!("page/bodies.js"),
    include_str!("page/lines.js"),
    include_str!("page/flow.js"),
    include_str!("page/labels.js"),
    include_str!("page/charts.js"),
    include_str!("page/selection.js"),
    include_str!("page/controls.js"),
    include_str!("page/player.js"),
];

/// All that stands before the frames.
pub fn write_head(out: &mut impl Write, title: &str) -> io::Result<()> {
    let title = escaped(title);
    write!(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n")?;
    writeln!(out, "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>")?;
    writeln!(out, "<link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n</head>\n{PAGE}")
}

/// The facts and the program, which stand after the frames.
pub fn write_foot(out: &mut impl Write, index: &Value) -> io::Result<()> {
    // a title may hold what would end the element
    let index = index.to_string().replace('<', "\\u003c");
    writeln!(out, "<script type=\"application/json\" id=\"index\">{index}</script>\n<script>\n\"use strict\";")?;
    PROGRAM.iter().try_for_each(|file| writeln!(out, "{file}"))?;
    writeln!(out, "</script>\n</body>\n</html>")
}
