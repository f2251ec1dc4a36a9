//! `report.html`: a run on one page that needs nothing else, neither a network nor the other files.
//!
//! A pure function of a [`Page`]; no simulation is known.

mod bodies;
mod charts;
mod page;
mod sections;
mod table;

use crate::picture::escaped;
pub use bodies::bodies_table;
pub use page::{Breakdown, Facts, Image, Page, Standing};
pub use table::Table;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("charts.js");

impl Page {
    /// The page as an HTML document.
    pub fn html(&self) -> String {
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n\
             <body>\n{body}<script id=\"data\" type=\"application/json\">{data}</script>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
            title = escaped(&self.title),
            body = sections::body(self),
            data = self.data(),
        )
    }

    /// Tables and charts as the script reads them.
    fn data(&self) -> String {
        let data = serde_json::json!({ "tables": self.tables, "charts": charts::charts(&self.tables, self.mean.as_ref()) });
        // a text within a script ends at the first closing tag
        data.to_string().replace('<', "\\u003c")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Answer;

    fn page() -> Page {
        let table =
            |name: &str| Table { name: name.into(), columns: vec!["time".into()], values: vec![vec![Some(0.5)]], rows: 9, stretch: 1 };
        Page {
            title: "A < B & C".into(),
            standing: Standing::Ended,
            written: "now".into(),
            answers: vec![Answer { name: "relative viscosity", value: "1.5".into() }],
            tables: vec![table("</script>.csv")],
            mean: None,
            images: vec![Image { name: "picture.png", bytes: vec![1, 2, 3] }],
            parts: vec![Breakdown { title: "Viscosity", parts: vec![("flow", 1.0), ("contacts", 0.5)], decimals: 4 }],
            bodies: None,
            facts: vec![Facts { title: "Run", facts: vec![("command", "turbid run a&b".into())] }],
            scene: "title = \"<b>\"".into(),
            log: String::new(),
            files: vec![("series.csv".into(), "a row a step")],
        }
    }

    #[test]
    fn the_page_is_one_document_that_loads_nothing() {
        let html = page().html();
        assert!(html.starts_with("<!DOCTYPE html>") && html.ends_with("</html>\n"));
        assert!(!html.contains("http") && !html.contains("src=\"p") && html.contains("data:image/png;base64,AQID"));
        assert_eq!(html.matches("</script>").count(), 2, "a text of the run ends a script");
        assert!(html.contains("A &lt; B &amp; C") && html.contains("turbid run a&amp;b") && html.contains("\"&lt;b&gt;\""));
        assert!(html.contains("<a href=\"series.csv\">"));
    }

    #[test]
    fn a_run_that_has_not_ended_says_so() {
        let page_of = |standing| Page { standing, ..page() }.html();
        assert!(page_of(Standing::UnderWay).contains("has not ended"));
        assert!(page_of(Standing::Broken("stopped by a signal".into())).contains("stopped by a signal"));
        assert!(!page_of(Standing::Ended).contains("has not ended"));
    }
}
