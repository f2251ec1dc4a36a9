//! `cost.html`: chart, table and sentences on one page that needs nothing else.

use super::{chart, findings::Findings, sensitivity::ParameterChange, table, text};
use crate::{experiment::table::TableRow, picture::escaped};

/// Light paper or dark, as the reader has it; the chart stays on light paper.
const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#14171f;--paper:#fff;--faint:#667085;--line:#dfe3e9;--tint:#f4f6f9;--good:#e3f3e6}
@media (prefers-color-scheme:dark){:root{--ink:#e6e9ef;--paper:#14171f;--faint:#9aa4b2;--line:#2e3440;--tint:#1c212b;--good:#1d3a26}}
body{margin:2.5rem auto;max-width:62rem;padding:0 1.2rem;background:var(--paper);color:var(--ink);font:15px/1.55 Helvetica,Arial,'Liberation Sans','DejaVu Sans',sans-serif}
h1{font-size:1.6rem;margin-bottom:.2rem}h2{font-size:1.15rem;margin-top:2rem}
p.lead{color:var(--faint);margin-top:0}
figure{margin:1.5rem 0;padding:.5rem;background:#fff;border:1px solid var(--line);border-radius:8px}
figure svg{display:block;width:100%;height:auto}
div.wide{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums;width:100%}
th,td{padding:.3rem .6rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{color:var(--faint);font-weight:600}th:first-child,td:first-child{text-align:left}
td.remark{white-space:normal;text-align:left;color:var(--faint)}tr.chosen td{background:var(--good)}
ul{padding-left:1.2rem}li{margin:.25rem 0}";

/// The page.
pub fn html(findings: &Findings) -> String {
    let title = escaped(&findings.title);
    let sentences: String = text::sentences(findings).iter().map(|sentence| format!("<li>{}</li>\n", escaped(sentence))).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>What accuracy costs: {title}</title>\n<style>\n{STYLE}\n</style>\n</head>\n<body>\n\
         <h1>What accuracy costs</h1>\n<p class=\"lead\">{title}: {}.</p>\n\
         <figure>\n{}</figure>\n<ul>\n{sentences}</ul>\n<h2>Every setting</h2>\n<div class=\"wide\">{}</div>\n{}\
         <p class=\"lead\">turbid {}, {} rank{}, the fastest of {} runs each.</p>\n</body>\n</html>\n",
        escaped(&findings.quantity),
        chart::svg(findings),
        table(findings),
        parameters(findings),
        env!("CARGO_PKG_VERSION"),
        findings.ranks,
        if findings.ranks == 1 { "" } else { "s" },
        findings.repeat,
    )
}

fn table(findings: &Findings) -> String {
    let chosen = findings.cheapest().map(|cheapest| &cheapest.setting);
    let class = |place: usize| if chosen == Some(&findings.points[place].setting) { " class=\"chosen\"" } else { "" };
    let remark = |place: usize| if findings.points[place].remark.is_some() { " class=\"remark\"" } else { "" };
    rows(&table::settings(findings), class, remark)
}

/// A table, with the attributes of its rows and of their last cells.
fn rows(rows: &[TableRow], class: impl Fn(usize) -> &'static str, last: impl Fn(usize) -> &'static str) -> String {
    let head: String = rows.iter().take(1).flatten().map(|(name, _)| format!("<th>{}</th>", escaped(name))).collect();
    let body = rows.iter().enumerate().map(|(number, row)| {
        let attribute = |place: usize| if place + 1 == row.len() { last(number) } else { "" };
        let cells = row.iter().enumerate().map(|(place, (_, cell))| format!("<td{}>{}</td>", attribute(place), escaped(cell)));
        format!("<tr{}>{}</tr>\n", class(number), cells.collect::<String>())
    });
    format!("<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{}</tbody>\n</table>", body.collect::<String>())
}

fn parameters(findings: &Findings) -> String {
    let known = findings.sensitivities.iter().filter(|sensitivity| !sensitivity.parameters.is_empty());
    let tables = known.map(|sensitivity| {
        let row = |change: &ParameterChange| {
            vec![
                ("parameter", change.name.to_owned()),
                ("set to", change.to.clone()),
                ("changes the quantity by", text::change_words(change)),
                ("and leaves an error of", text::left(change, findings.uncertainty())),
            ]
        };
        let table = rows(&sensitivity.parameters.iter().map(row).collect::<Vec<_>>(), |_| "", |_| "");
        let verdict = text::dominating(sensitivity).map_or(String::new(), |verdict| format!("<p>Here {}</p>\n", escaped(&verdict)));
        let (method, words) = (&sensitivity.at.method, escaped(&sensitivity.at.words()));
        format!("<h2>Parameters of {method}, {words}</h2>\n<div class=\"wide\">{table}</div>\n{verdict}")
    });
    tables.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        experiment::record::RunOutcome,
        study::cost::{
            findings::SettingFinding,
            quantity::QuantityKind,
            record::{CostRecord, tests::run},
            setting::{CostSetting, Resolution},
        },
    };

    fn findings() -> Findings {
        let setting = |cells| CostSetting {
            method: "sharp".into(),
            grid: Resolution::CellsPerRadius(cells),
            modes: None,
            tolerance: None,
            step: None,
        };
        let measured = CostRecord { setting: setting(4.0), outcome: RunOutcome::Measured(run(0.25, 1.02)) };
        let failed = CostRecord { setting: setting(8.0), outcome: RunOutcome::Failed("no <memory>".into()) };
        Findings {
            title: "a & b".into(),
            quantity: "drag".into(),
            name: QuantityKind::Drag.word(),
            ranks: 1,
            repeat: 2,
            wanted: 1e-2,
            times: 1.0,
            reference: None,
            points: [measured, failed].iter().map(|record| SettingFinding::of(record, Some(1.0), |_| Some(0.02), 0.0)).collect(),
            methods: Vec::new(),
            written: Some(setting(4.0)),
            sensitivities: Vec::new(),
            notes: vec!["a < b".into()],
        }
    }

    #[test]
    fn a_page_is_whole_and_says_nothing_that_is_read_as_markup() {
        let page = html(&findings());
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
        for part in ["a &amp; b: drag.", "no &lt;memory&gt;", "a &lt; b.", "+2.0 %", "No reference"] {
            assert!(page.contains(part), "no {part:?} in {page}");
        }
        for tag in ["table", "tr", "td", "ul", "li", "figure", "svg", "style", "body"] {
            assert_eq!(page.matches(&format!("<{tag}")).count(), page.matches(&format!("</{tag}>")).count(), "{tag}");
        }
    }
}
