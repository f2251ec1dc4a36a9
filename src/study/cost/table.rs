//! The settings of a study as a table.

use super::{
    choice::Cheapest,
    digits::{percent, seconds, signed, thousands, two_digits},
    record::Measured,
    report::{Findings, Point},
    setting::Fineness,
};

/// Heads and rows of the table.
pub fn table(findings: &Findings) -> Vec<Vec<String>> {
    let in_time = findings.points.iter().any(|point| point.setting.step.is_some());
    let swept = findings.points.iter().any(|point| point.setting.tolerance.is_some());
    let head = |name: &str, shown: bool| shown.then(|| name.to_owned());
    let heads = [
        head("method", true),
        head("cells/radius", true),
        head("modes", true),
        head("tolerance", swept),
        head("step", in_time),
        head("unknowns", true),
        head("iterations", true),
        head("set-up s", true),
        head("solve s", true),
        head("MB", true),
        head(findings.name, true),
        head("error", true),
    ];
    let mut rows = vec![heads.into_iter().flatten().collect::<Vec<_>>()];
    rows.extend(findings.points.iter().map(|point| row(point, findings, (swept, in_time))));
    rows
}

/// What each method takes for the wanted error; heads and rows.
pub fn at_wanted(findings: &Findings) -> Vec<Vec<String>> {
    let heads = [&format!("for {}", percent(findings.wanted)), "spacing", "unknowns", "seconds", "times the cheapest", ""];
    let best = findings.cheapest().map(|cheapest| cheapest.seconds);
    let row = |(method, found): (&str, &Cheapest)| {
        let ratio = best.map_or("-".to_owned(), |best| two_digits(found.seconds / best));
        let how = if found.measured { "measured" } else { "predicted by its fits" };
        let numbers = [format!("{:.5}", found.spacing), thousands(found.unknowns), seconds(found.seconds), ratio];
        [vec![method.to_owned()], numbers.to_vec(), vec![how.to_owned()]].concat()
    };
    let found = findings.methods.iter().filter_map(|method| Some((method.method.as_str(), method.cheapest.as_ref()?)));
    std::iter::once(heads.map(str::to_owned).to_vec()).chain(found.map(row)).collect()
}

fn row(point: &Point, findings: &Findings, (swept, in_time): (bool, bool)) -> Vec<String> {
    let none = || "-".to_owned();
    let of = |read: &dyn Fn(&Measured) -> String| point.measured.as_ref().map_or_else(none, read);
    let setting = &point.setting;
    let modes = point.measured.as_ref().and_then(|run| run.modes).or(setting.modes);
    let mut cells = vec![setting.method.clone(), cells_per_radius(point), modes.map_or_else(none, |modes| modes.to_string())];
    if swept {
        cells.push(setting.tolerance.map_or_else(none, |tolerance| format!("{tolerance:.0e}")));
    }
    if in_time {
        cells.push(setting.step.map_or_else(none, |step| step.length().to_string()));
    }
    cells.extend([
        of(&|run| thousands(run.unknowns)),
        of(&|run| format!("{:.0}", run.iterations)),
        of(&|run| seconds(run.setup_seconds)),
        of(&|run| seconds(run.solve_seconds)),
        of(&|run| format!("{:.0}", run.memory_bytes / 1e6)),
        point.value.map_or_else(none, |value| format!("{value:.6}")),
        error(point, findings.uncertainty()),
    ]);
    cells
}

fn error(point: &Point, uncertainty: f64) -> String {
    match (point.error, &point.remark) {
        (_, Some(remark)) => remark.clone(),
        (None, None) => "-".into(),
        (Some(_), None) if point.within_uncertainty => format!("within {}", percent(uncertainty)),
        (Some(error), None) if point.value.is_some() => signed(error),
        (Some(error), None) => percent(error),
    }
}

/// Cells across the smallest radius, or the spacing where there are no bodies.
pub fn cells_per_radius(point: &Point) -> String {
    match (point.cells_per_radius, point.setting.grid) {
        (Some(cells), _) | (None, Fineness::CellsPerRadius(cells)) => format!("{cells:.1}").trim_end_matches(".0").to_owned(),
        (None, Fineness::Spacing(spacing)) => format!("h = {spacing:.4}"),
    }
}
