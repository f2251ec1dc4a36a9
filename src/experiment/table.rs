//! Tables of text. A row is a list of cells, each with the head of its column.

/// Heads and cells of a row.
pub type TableRow<'a> = Vec<(&'a str, String)>;

/// A table in Markdown, a line for each row below the heads of the first one.
pub fn markdown(rows: &[TableRow]) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let line = |cells: Vec<&str>| format!("| {} |", cells.join(" | "));
    let cells = rows.iter().map(|row| line(row.iter().map(|(_, cell)| cell.as_str()).collect()));
    let heads = [line(first.iter().map(|(head, _)| *head).collect()), format!("|{}", "-|".repeat(first.len()))];
    heads.into_iter().chain(cells).collect::<Vec<_>>().join("\n")
}

/// The same for other programs, with commas.
pub fn csv(rows: &[TableRow]) -> String {
    let heads = rows.first().map_or(Vec::new(), |row| row.iter().map(|(head, _)| *head).collect());
    let lines = rows.iter().map(|row| row.iter().map(|(_, cell)| cell.as_str()).collect());
    std::iter::once(heads).chain(lines).map(|cells| cells.join(",") + "\n").collect()
}

/// The same for a terminal: names, if they have a width, to the left, then cells to the right.
pub fn aligned(name_width: usize, rows: &[TableRow]) -> String {
    let named = usize::from(name_width > 0);
    let cell = |(place, text): (usize, &str)| match place {
        0 if named == 1 => format!("{text:<name_width$}"),
        place if place == named => format!("{text:>8}"),
        _ => format!("{text:>12}"),
    };
    let line = |cells: Vec<&str>| cells.into_iter().enumerate().map(cell).collect::<String>();
    let heads = rows.iter().take(1).map(|row| line(row.iter().map(|(head, _)| *head).collect()));
    let lines = rows.iter().map(|row| line(row.iter().map(|(_, cell)| cell.as_str()).collect()));
    heads.chain(lines).collect::<Vec<_>>().join("\n")
}

/// A number, or an empty cell.
pub fn number<T: ToString>(number: Option<T>) -> String {
    number.map_or(String::new(), |number| number.to_string())
}

/// Text in quotes, which may hold commas.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "'"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_markdown_or_commas_or_aligned() {
        let rows = [vec![("a", "1".to_owned()), ("b", number(None::<f64>))], vec![("a", "2".into()), ("b", number(Some(0.5)))]];
        assert_eq!(markdown(&rows), "| a | b |\n|-|-|\n| 1 |  |\n| 2 | 0.5 |");
        assert_eq!(csv(&rows), "a,b\n1,\n2,0.5\n");
        assert_eq!(aligned(0, &rows), "       a           b\n       1            \n       2         0.5");
        assert!(aligned(3, &rows).starts_with("a         b\n1"));
    }
}
