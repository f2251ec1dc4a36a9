//! Which columns of a run's tables share a chart.

use serde::Serialize;

use super::Table;
use crate::output::MeanViscosity;

/// A chart of a table's columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChartOfTable {
    /// What it shows.
    pub title: &'static str,
    /// Number of the table.
    pub table: usize,
    /// Column of the abscissa.
    pub x: &'static str,
    /// Columns that are shown at first; others can be chosen.
    pub y: Vec<String>,
    /// What these are called in its key.
    pub words: Vec<String>,
    /// Whether it is about the solver and not about the suspension.
    pub of_solver: bool,
    /// Whether the ordinate is logarithmic at first.
    pub logarithmic: bool,
    /// A mean with its interval over a part of the abscissa.
    pub band: Option<MeanBand>,
}

/// A mean with its interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeanBand {
    /// Abscissas where the part that is averaged over begins and ends.
    pub from_to: [f64; 2],
    /// The mean.
    pub mean: f64,
    /// Lowest and highest value.
    pub interval: [f64; 2],
}

/// A chart by title: the columns whose names begin so.
struct ChartGroup {
    title: &'static str,
    beginnings: &'static [&'static str],
    logarithmic: bool,
    of_solver: bool,
}

const fn group(title: &'static str, beginnings: &'static [&'static str]) -> ChartGroup {
    ChartGroup { title, beginnings, logarithmic: false, of_solver: false }
}

const fn of_solver(title: &'static str, beginnings: &'static [&'static str]) -> ChartGroup {
    ChartGroup { of_solver: true, ..group(title, beginnings) }
}

/// Charts in the order of the page; a column is in the first that takes it.
const GROUPS: [ChartGroup; 23] = [
    group("Parts of the relative viscosity", &["viscosity_"]),
    group("Relative viscosity", &["viscosity"]),
    group("Parts of the normal stresses", &["first_normal_difference_", "second_normal_difference_", "particle_pressure_"]),
    group("Normal stresses over viscosity and rate", &["first_normal", "second_normal", "particle_pressure"]),
    group("Stress", &["stress"]),
    group("Force coefficients", &["drag_", "lift_"]),
    group("Forces on bodies", &["force_"]),
    group("Torques on bodies", &["torque_"]),
    group("Velocities of bodies", &["body_", "settling", "velocity"]),
    group("Flow", &["flow_rate", "mean_velocity", "pressure_gradient", "shear_rate"]),
    group("Energies", &["kinetic_energy", "bond_energy"]),
    group("Reynolds, Stokes and Courant numbers", &["reynolds", "stokes", "courant"]),
    group("Size of chains", &["end_to_end", "gyration", "curvature"]),
    group("Orientation of chains", &["chain_"]),
    group("Orientation of clusters", &["orientation_"]),
    group("Red cells", &["enclosed", "surface", "area", "volume", "inclination", "tread"]),
    group("Contacts", &["contacts", "stuck"]),
    group("Sum of contact forces", &["contact_force"]),
    group("Smallest gap in radii", &["smallest_gap"]),
    of_solver("Length of steps", &["last_step"]),
    of_solver("Solves and iterations of a step", &["iterations", "solves", "contact_iterations", "friction_sweeps", "friction_iterations"]),
    of_solver("Seconds of wall time of a step", &["seconds"]),
    ChartGroup { logarithmic: true, ..of_solver("Residuals of contacts", &["kkt_residual", "friction_residual"]) },
];

/// Columns that are shown only if they are chosen.
const HIDDEN: [&str; 5] = ["step", "time", "strain", "separation", "contact_solver"];

/// The charts of tables, those of the first table first.
pub fn charts(tables: &[Table], mean: Option<&MeanViscosity>) -> Vec<ChartOfTable> {
    tables.iter().enumerate().flat_map(|(number, table)| of_table(number, table, mean)).collect()
}

fn of_table(number: usize, table: &Table, mean: Option<&MeanViscosity>) -> Vec<ChartOfTable> {
    let has = |name: &str| table.columns.iter().any(|column| column == name);
    if has("separation") {
        let (title, x, y) = ("Pair distribution g(r)", "separation", vec!["distribution".to_owned()]);
        return vec![ChartOfTable { title, table: number, x, words: y.clone(), y, of_solver: false, logarithmic: false, band: None }];
    }
    let group_of = |column: &str| GROUPS.iter().position(|group| group.beginnings.iter().any(|beginning| column.starts_with(beginning)));
    let ordinates = || table.columns.iter().filter(|column| !HIDDEN.contains(&column.as_str()));
    let chart = |place: Option<usize>| {
        let y: Vec<String> = ordinates().filter(|column| group_of(column) == place).cloned().collect();
        let title = place.map_or("Other columns", |place| GROUPS[place].title);
        let strained = place.is_some_and(|place| place < 5) && has("strain");
        let band = mean.filter(|_| place == Some(1) && strained).map(|mean| MeanBand {
            from_to: mean.strains,
            mean: mean.relative,
            interval: mean.interval,
        });
        let group = place.map(|place| &GROUPS[place]);
        let (logarithmic, of_solver) = group.map_or((false, false), |group| (group.logarithmic, group.of_solver));
        let (x, words) = (if strained { "strain" } else { "time" }, y.iter().map(|column| in_words(column, group)).collect());
        (!y.is_empty()).then_some(ChartOfTable { title, table: number, x, y, words, of_solver, logarithmic, band })
    };
    // the whole before its parts
    [1, 0, 3, 2].into_iter().chain(4..GROUPS.len()).map(Some).chain([None]).filter_map(chart).collect()
}

/// A column in words, without what the title says of all.
fn in_words(column: &str, group: Option<&ChartGroup>) -> String {
    let common = group.and_then(|group| if let [only] = group.beginnings { only.strip_suffix('_').map(|_| *only) } else { None });
    common.and_then(|common| column.strip_prefix(common)).unwrap_or(column).replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(columns: &[&str]) -> Table {
        let columns: Vec<String> = columns.iter().map(|&column| column.to_owned()).collect();
        Table { name: "series.csv".into(), values: vec![vec![Some(0.0)]; columns.len()], columns, rows: 1, stretch: 1 }
    }

    #[test]
    fn every_column_has_a_chart() {
        let tables = [
            table(&["step", "time", "strain", "viscosity", "viscosity_contact", "contacts", "contact_force", "new"]),
            table(&["separation", "distribution"]),
        ];
        let charts = charts(&tables, None);
        let found: Vec<(&str, &str, usize)> = charts.iter().map(|chart| (chart.title, chart.x, chart.y.len())).collect();
        let expected = [
            ("Relative viscosity", "strain", 1),
            ("Parts of the relative viscosity", "strain", 1),
            ("Contacts", "time", 1),
            ("Sum of contact forces", "time", 1),
            ("Other columns", "time", 1),
            ("Pair distribution g(r)", "separation", 1),
        ];
        assert_eq!(found, expected);
        assert_eq!((&charts[1].words[..], &charts[3].words[..]), (&["contact".to_owned()][..], &["contact force".to_owned()][..]));
    }

    #[test]
    fn what_is_about_the_solver_is_told_apart() {
        let charts = charts(&[table(&["time", "viscosity", "seconds", "kkt_residual", "iterations"])], None);
        let of_solver: Vec<&str> = charts.iter().filter(|chart| chart.of_solver).map(|chart| chart.title).collect();
        assert_eq!(of_solver, ["Solves and iterations of a step", "Seconds of wall time of a step", "Residuals of contacts"]);
    }
}
