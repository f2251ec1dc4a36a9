//! The sections of the page, one function each.

use super::{Breakdown, Facts, Image, Page, Standing};
use crate::picture::{base64, escaped};

/// Colours of parts, those of the charts.
const COLOURS: [&str; 6] = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00"];

/// Everything between head and script.
pub fn body(page: &Page) -> String {
    let sections = [
        heading(page),
        page.images.first().map_or(String::new(), |first| format!("<h2>Picture</h2>\n{}", image(first))),
        charts(page),
        page.images.iter().skip(1).map(image).collect(),
        page.parts.iter().filter(|parts| !of_solver(parts.title)).map(parts).collect(),
        bodies(page),
        columns(page.facts.iter().filter(|facts| !of_solver(facts.title))),
        solver(page),
        files(page),
        format!("<h2>Scene</h2>\n<pre>{}</pre>\n", lines(&page.scene)),
        if page.log.is_empty() { String::new() } else { format!("<h2>Log</h2>\n<pre>{}</pre>\n", lines(&page.log)) },
    ];
    sections.concat()
}

/// What is said of the solver and of the run, folded.
fn solver(page: &Page) -> String {
    format!(
        "<details class=\"solver\">\n<summary>Solver and run</summary>\n<div class=\"charts\" id=\"solver\"></div>\n{}</details>\n",
        page.parts.iter().filter(|parts| of_solver(parts.title)).map(parts).collect::<String>()
            + &columns(page.facts.iter().filter(|facts| of_solver(facts.title)))
    )
}

/// Whether what has this title is about the solver and not about the suspension.
fn of_solver(title: &str) -> bool {
    ["Solver", "Run", "Seconds of wall time"].contains(&title)
}

fn columns<'a>(all: impl Iterator<Item = &'a Facts>) -> String {
    format!("<div class=\"columns\">\n{}</div>\n", all.map(facts).collect::<String>())
}

fn heading(page: &Page) -> String {
    let (class, word, sentence) = match &page.standing {
        Standing::Ended => ("state", "ended", String::new()),
        Standing::UnderWay => {
            ("state open", "has not ended", "the run is under way, or was killed; this page is renewed while it runs".into())
        }
        Standing::Broken(reason) => ("state open", "has not ended", reason.clone()),
    };
    let answers = page.answers.iter().map(|answer| item(answer.name, &answer.value)).collect::<String>();
    let answers = if answers.is_empty() { String::new() } else { format!("<dl class=\"answers\">\n{answers}</dl>\n") };
    format!(
        "<h1>{}</h1>\n<p><span class=\"{class}\">{word}</span> <span class=\"soft\">{} {}</span></p>\n{answers}",
        escaped(&page.title),
        escaped(&sentence),
        escaped(&page.written),
    )
}

fn item(name: &str, value: &str) -> String {
    format!("<dt>{}</dt><dd>{}</dd>\n", escaped(name), escaped(value))
}

fn image(image: &Image) -> String {
    let name = image.name;
    if image.bytes.is_empty() {
        return format!("<p class=\"soft\"><a href=\"{name}\">{name}</a> is too large to be shown on this page.</p>\n");
    }
    let shown = match std::str::from_utf8(&image.bytes) {
        Ok(text) if name.ends_with(".svg") => text.to_owned(),
        _ => format!("<img alt=\"{name}\" src=\"data:image/png;base64,{}\">\n", base64(&image.bytes)),
    };
    format!("<figure>\n{shown}<figcaption><a href=\"{name}\">{name}</a></figcaption>\n</figure>\n")
}

fn charts(page: &Page) -> String {
    if page.tables.is_empty() {
        return String::new();
    }
    let thinned = page.tables.iter().filter(|table| table.thinned()).map(|table| {
        format!(
            "<p class=\"soft\">{} has {} rows: of every {} of them the charts show the least and the largest value.</p>\n",
            escaped(&table.name),
            table.rows,
            table.stretch
        )
    });
    format!(
        "<h2>Charts</h2>\n<p class=\"soft\">Drag across a chart to zoom; a double click shows all of it again.</p>\n{}\
         <div class=\"charts\" id=\"charts\"></div>\n<noscript>The charts need JavaScript.</noscript>\n",
        thinned.collect::<String>()
    )
}

/// A bar of parts and a table of them, which adds up.
fn parts(Breakdown { title, parts, decimals }: &Breakdown) -> String {
    let total: f64 = parts.iter().map(|(_, value)| value).sum();
    let size: f64 = parts.iter().map(|(_, value)| value.abs()).sum();
    let coloured = || parts.iter().zip(COLOURS.iter().cycle());
    let bar = coloured().map(|((name, value), colour)| {
        format!("<span style=\"width: {:.2}%; background: {colour}\" title=\"{}\"></span>", 100.0 * value.abs() / size, escaped(name))
    });
    let row = |class: &str, name: String, value: f64| {
        let share = if total == 0.0 { String::new() } else { format!("{:.1} %", 100.0 * value / total) };
        format!("<tr{class}><td>{name}</td><td>{value:.decimals$}</td><td>{share}</td></tr>\n")
    };
    let rows =
        coloured().map(|((name, value), colour)| row("", format!("<i style=\"background: {colour}\"></i>{}", escaped(name)), *value));
    let sum = row(" class=\"total\"", "sum".into(), total);
    format!("<h2>{title}</h2>\n<div class=\"bar\">{}</div>\n<table>\n{}{sum}</table>\n", bar.collect::<String>(), rows.collect::<String>())
}

fn bodies(page: &Page) -> String {
    let Some((header, rows)) = &page.bodies else { return String::new() };
    let row = |tag: &str, cells: &[String]| {
        format!("<tr>{}</tr>\n", cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect::<String>())
    };
    let rows: String = rows.iter().map(|cells| row("td", cells)).collect();
    format!("<h2>Bodies</h2>\n<div class=\"wide\"><table>\n{}{rows}</table></div>\n", row("th", header))
}

fn facts(Facts { title, facts }: &Facts) -> String {
    let items: String = facts.iter().map(|(name, value)| item(name, value)).collect();
    format!("<section>\n<h2>{title}</h2>\n<dl>\n{items}</dl>\n</section>\n")
}

fn files(page: &Page) -> String {
    let file = |(name, what): &(String, &str)| format!("<dt><a href=\"{0}\">{0}</a></dt><dd>{what}</dd>\n", escaped(name));
    format!("<h2>Files</h2>\n<dl>\n{}</dl>\n", page.files.iter().map(file).collect::<String>())
}

/// Lines of a text; control characters other than their ends are left out.
fn lines(text: &str) -> String {
    text.lines().map(|line| escaped(line) + "\n").collect()
}
