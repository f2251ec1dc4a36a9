//! The settings of a study as tables.

use super::{
    findings::{Findings, SettingFinding},
    format::{percent, seconds, signed, thousands, two_digits},
    record::Measured,
};
use crate::experiment::table::{TableRow, number, quoted};

/// The table of all settings for people.
pub fn settings(findings: &Findings) -> Vec<TableRow<'_>> {
    let in_time = findings.points.iter().any(|point| point.setting.step.is_some());
    let swept = findings.points.iter().any(|point| point.setting.tolerance.is_some());
    let row = |point| {
        let mut row = cells(point, findings);
        row.retain(|(head, _)| (*head != "tolerance" || swept) && (!["step", "steps"].contains(head) || in_time));
        row
    };
    findings.points.iter().map(row).collect()
}

fn cells<'a>(point: &SettingFinding, findings: &Findings) -> TableRow<'a> {
    let none = || "-".to_owned();
    let of = |read: fn(&Measured) -> String| point.measured.as_ref().map_or_else(none, read);
    let setting = &point.setting;
    vec![
        ("method", setting.method.clone()),
        ("cells/radius", point.resolution()),
        ("modes", point.modes().map_or_else(none, |modes| modes.to_string())),
        ("tolerance", setting.tolerance.map_or_else(none, |tolerance| format!("{tolerance:.0e}"))),
        ("step", setting.step.map_or_else(none, |step| step.length().to_string())),
        ("steps", of(|run| run.steps.to_string())),
        ("unknowns", of(|run| thousands(run.unknowns))),
        ("iterations", of(|run| format!("{:.0}", run.iterations))),
        ("set-up s", of(|run| seconds(run.setup_seconds))),
        ("solve s", of(|run| seconds(run.solve_seconds))),
        ("MB", of(|run| format!("{:.0}", run.memory_bytes / 1e6))),
        (findings.name, point.value.map_or_else(none, |value| format!("{value:.6}"))),
        ("error", error(point, findings.uncertainty())),
    ]
}

/// The same for `cost.csv`.
pub fn numbers(findings: &Findings) -> Vec<TableRow<'static>> {
    let row = |point: &SettingFinding| {
        let of = |read: fn(&Measured) -> f64| number(point.measured.as_ref().map(read));
        vec![
            ("method", point.setting.method.clone()),
            ("cells_per_radius", point.resolution()),
            ("spacing", of(|run| run.spacing)),
            ("modes", number(point.modes())),
            ("tolerance", number(point.setting.tolerance)),
            ("step", number(point.setting.step.map(|step| step.length()))),
            ("steps", number(point.measured.as_ref().map(|run| run.steps))),
            ("unknowns", of(|run| run.unknowns)),
            ("iterations", of(|run| run.iterations)),
            ("setup_seconds", of(|run| run.setup_seconds)),
            ("solve_seconds", of(|run| run.solve_seconds)),
            ("memory_bytes", of(|run| run.memory_bytes)),
            ("value", number(point.value)),
            ("error", number(point.error)),
            ("still_to_come", number(point.measured.as_ref().and_then(|run| run.still_to_come))),
            ("boundary_layer", number(point.measured.as_ref().and_then(|run| run.boundary_layer))),
            ("within_uncertainty", point.within_uncertainty.to_string()),
            ("remark", quoted(point.remark.as_deref().unwrap_or_default())),
        ]
    };
    findings.points.iter().map(row).collect()
}

/// What each method takes for the wanted error, which is the first head.
pub fn at_wanted<'a>(findings: &Findings, wanted: &'a str) -> Vec<TableRow<'a>> {
    let best = findings.cheapest().map(|cheapest| cheapest.seconds);
    let found = findings.methods.iter().filter_map(|method| Some((&method.method, method.cheapest.as_ref()?)));
    let row = found.map(|(method, found)| {
        vec![
            (wanted, method.clone()),
            ("spacing", format!("{:.5}", found.spacing)),
            ("unknowns", thousands(found.unknowns)),
            ("seconds", seconds(found.seconds)),
            ("times the cheapest", best.map_or("-".to_owned(), |best| two_digits(found.seconds / best))),
            ("", if found.measured { "measured" } else { "predicted by its fits" }.to_owned()),
        ]
    });
    row.collect()
}

fn error(point: &SettingFinding, uncertainty: f64) -> String {
    match (point.error, &point.remark) {
        (_, Some(remark)) => remark.clone(),
        (None, None) => "-".into(),
        (Some(_), None) if point.within_uncertainty => format!("within {}", percent(uncertainty)),
        (Some(error), None) if point.value.is_some() => signed(error),
        (Some(error), None) => percent(error),
    }
}
