//! `turbid columns`: the columns of `series.csv`, from the quantities that a run measures.

use clap::Args;

use crate::{
    error::Result,
    output::say,
    run::{SeriesColumn, columns},
};

/// The words after `turbid columns`.
#[derive(Debug, Args)]
pub struct ColumnsArguments {
    /// Print them as a table of Markdown.
    #[arg(long, hide = true)]
    markdown: bool,
}

/// Prints columns.
///
/// # Errors
/// The terminal is gone.
pub fn list(arguments: &ColumnsArguments) -> Result<()> {
    say(if arguments.markdown { table() } else { lines() }.trim_end())
}

fn lines() -> String {
    let of_column = |column: &SeriesColumn| {
        let unit = if column.unit.is_empty() { String::new() } else { format!(" [{}]", column.unit) };
        format!("{}{unit}\n    {}\n", column.name, column.meaning)
    };
    columns().iter().map(|column| of_column(column)).collect()
}

/// A row for each meaning.
fn table() -> String {
    let mut rows: Vec<(String, SeriesColumn)> = Vec::new();
    for column in columns() {
        let name = format!("`{}`", column.name);
        match rows.iter_mut().find(|(_, row)| (&row.unit, &row.meaning) == (&column.unit, &column.meaning)) {
            Some((names, _)) => *names += &format!(", {name}"),
            None => rows.push((name, (*column).clone())),
        }
    }
    let cell = |text: &str| if text.is_empty() { " |".to_owned() } else { format!(" {text} |") };
    let row =
        |(names, SeriesColumn { unit, meaning, .. }): &(String, SeriesColumn)| format!("|{}{}{}\n", cell(names), cell(unit), cell(meaning));
    format!("| column | unit | meaning |\n|-|-|-|\n{}", rows.iter().map(row).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_with_one_meaning_share_a_row() {
        let table = table();
        assert!(table.contains("| `step` | | number of the step; 0 is the start |\n"), "{table}");
        assert!(table.contains("| `mean_velocity_x`, `mean_velocity_y`, `mean_velocity_z` | length/time | "), "{table}");
        assert!(lines().contains("\nlast_step [time]\n    length of the step that led there\n"));
        assert!(columns().iter().all(|column| table.contains(&format!("`{}`", column.name))));
    }
}
