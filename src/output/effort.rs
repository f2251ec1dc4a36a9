//! What the steps of a run cost, as `series.csv` holds it, drawn over time.

use super::{Chart, Scale, Series};

/// Columns that are drawn, what they are called, and a factor.
const COLUMNS: [(&str, &str, f64); 3] =
    [("seconds", "milliseconds", 1e3), ("iterations", "iterations", 1.0), ("contacts", "contacts", 1.0)];

/// Milliseconds, iterations of the flow's solver and contacts of each step over time; a column that a run has not is left out.
pub fn effort_chart(title: &str, series: &str) -> Chart {
    let mut lines = series.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap_or_default();
    let rows: Vec<Vec<f64>> = lines.map(|line| line.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    let place = |name: &str| header.iter().position(|column| *column == name);
    let time = place("time").unwrap_or(0);
    let of_column = |(column, name, factor): (&str, &str, f64)| {
        let column = place(column)?;
        // the first row has the set-up in it
        let points = rows.iter().skip(1).filter_map(|row| Some((*row.get(time)?, factor * row.get(column)?))).collect();
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
