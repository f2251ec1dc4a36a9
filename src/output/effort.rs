//! What the steps of a run cost, as `series.csv` holds it, drawn over time.

use super::Columns;
use crate::picture::{Chart, Scale, Series};

/// Columns that are drawn, what they are called, and a factor.
const COLUMNS: [(&str, &str, f64); 3] =
    [("seconds", "milliseconds", 1e3), ("iterations", "iterations", 1.0), ("contacts", "contacts", 1.0)];

/// Milliseconds, iterations of the flow's solver and contacts of each step over time; a column that a run has not is left out.
pub fn effort_chart(title: &str, series: &str) -> Chart {
    let drawn = |name: &str| name == "time" || COLUMNS.iter().any(|(column, ..)| *column == name);
    let table = Columns::chosen(series.lines(), drawn);
    let of_column = |(column, name, factor): (&str, &str, f64)| {
        let (times, values) = (table.column("time")?, table.column(column)?);
        // the first row has the set-up in it
        let points = times.iter().zip(values).skip(1).map(|(time, value)| (*time, factor * value)).collect();
        Some(Series { name: name.into(), points })
    };
    let series = COLUMNS.into_iter().filter_map(of_column).collect();
    Chart { title: title.into(), x: "time".into(), y: "a step".into(), scale: Scale::Linear, series }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_has_the_columns_of_the_run() {
        let chart = effort_chart("run", "step,time,contacts,seconds\n0,0.0,0,1.0\n1,0.5,3,0.25\n2,1.0,4,0.5\n");
        let names: Vec<&str> = chart.series.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["milliseconds", "contacts"]);
        assert_eq!(chart.series[0].points, [(0.5, 250.0), (1.0, 500.0)]);
    }
}
