//! The table of bodies, where they are few.

use serde_json::Value;

use crate::output::{Summary, vector};

/// Most bodies that the page lists.
const MOST: usize = 16;

/// Columns of a body.
const COLUMNS: [&str; 6] = ["center", "radius", "velocity", "spin", "force", "torque"];

/// Header and rows; nothing for more bodies than a page lists, or none.
pub fn bodies_table(summary: &Summary) -> Option<(Vec<String>, Vec<Vec<String>>)> {
    let count = summary.body_count();
    if count == 0 || count > MOST {
        return None;
    }
    let text = |value: &Value| match value {
        Value::Array(all) => vector(&all.iter().filter_map(Value::as_f64).collect::<Vec<_>>()),
        Value::Number(number) => number.to_string(),
        _ => String::new(),
    };
    let row =
        |(number, body): (usize, &Value)| [number.to_string()].into_iter().chain(COLUMNS.iter().map(|name| text(&body[name]))).collect();
    let bodies = serde_json::to_value(&summary.bodies).ok()?;
    let header = ["body"].iter().chain(&COLUMNS).map(|&name| name.to_owned()).collect();
    Some((header, bodies.as_array()?.iter().enumerate().map(row).collect()))
}
