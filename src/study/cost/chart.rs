//! Error against seconds, one line a method.

use super::{
    findings::{Findings, SettingFinding},
    format::percent,
    sequence::by_grid,
};
use crate::picture::{Chart, Level, Mark, Notes, Scale, Series};

/// The chart as an SVG document.
pub fn svg(findings: &Findings) -> String {
    let methods: Vec<&str> = findings.methods.iter().map(|method| method.method.as_str()).collect();
    let uncertainty = findings.uncertainty();
    let place = |point: &SettingFinding| {
        let error = point.error?.abs().max(uncertainty);
        Some((point.measured.as_ref()?.seconds(), error)).filter(|_| error > 0.0)
    };
    let chosen = findings.cheapest().map(|cheapest| &cheapest.setting);
    let (mut series, mut marks) = (Vec::new(), Vec::new());
    for method in methods {
        let own: Vec<&SettingFinding> =
            findings.points.iter().filter(|point| point.setting.method == method && place(point).is_some()).collect();
        if own.is_empty() {
            continue;
        }
        marks.extend(own.iter().filter_map(|point| {
            let (label, hollow) = (point.resolution(), point.within_uncertainty);
            Some(Mark { series: series.len(), point: place(point)?, label, hollow, ringed: chosen == Some(&point.setting) })
        }));
        series.push(Series { name: method.to_owned(), points: joined(&own, place) });
    }
    let mut levels = vec![Level { y: findings.wanted, name: format!("wanted: {}", percent(findings.wanted)) }];
    if uncertainty > 0.0 {
        levels.push(Level { y: uncertainty, name: format!("uncertainty of the reference: {}", percent(uncertainty)) });
    }
    let chart = Chart {
        title: findings.title.clone(),
        x: format!("seconds on {} rank{}; numbers are cells per radius", findings.ranks, if findings.ranks == 1 { "" } else { "s" }),
        y: format!("relative error of {}", findings.name),
        scale: Scale::Logarithmic,
        series,
    };
    chart.annotated(&Notes { marks, levels, ..Notes::default() })
}

/// Points of settings that differ in the grid alone, joined from the coarsest to the finest, with a gap between such lines.
fn joined(own: &[&SettingFinding], place: impl Fn(&SettingFinding) -> Option<(f64, f64)>) -> Vec<(f64, f64)> {
    let lines = by_grid(own.iter().copied(), |point| &point.setting);
    let gap = || std::iter::once((f64::NAN, f64::NAN));
    lines.iter().flat_map(|line| line.iter().filter_map(|point| place(point)).chain(gap())).collect()
}
