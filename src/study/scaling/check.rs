//! How well the model tells a run that it was not fitted to: each measured row is left out in turn.

use serde::Serialize;

use super::{
    kind::ScalingKind,
    model::{Network, Sample, ScalingModel, Work},
};
use crate::experiment::table::{TableRow, markdown};

/// A measured run, and what the model says of it that was fitted to all others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Check {
    kind: ScalingKind,
    ranks: usize,
    /// Whether its ranks took turns on the cores.
    beyond_cores: bool,
    /// Of the instant, or of a step.
    measured: f64,
    /// Of the same.
    predicted: f64,
}

/// A check of each run without which there is a model. A run with more ranks than cores is never fitted; its ranks are taken to compute
/// by turns, as many on each core.
pub fn checks(runs: &[(ScalingKind, &Sample)], cores: usize, network: Network) -> Vec<Check> {
    let check = |left_out: usize| {
        let (kind, Sample { shares, measured }) = runs[left_out];
        let others = || runs.iter().enumerate().filter(|&(place, _)| place != left_out).map(|(_, run)| run);
        let model = ScalingModel::fit(others().map(|(_, sample)| *sample), cores, network)?;
        // iterations and contacts of the other run that has the most ranks, one of the same kind before any other
        let (_, like) = others().max_by_key(|(other, sample)| (*other == kind, sample.shares.ranks))?;
        let turns = (shares.ranks as f64 / cores as f64).max(1.0);
        let (per_step, work) = (measured.steps as f64 / like.measured.steps as f64, Work::like(like, shares));
        let predicted = model.predict(shares, &work, turns).seconds * per_step;
        let steps = measured.steps as f64;
        Some(Check {
            kind,
            ranks: shares.ranks,
            beyond_cores: shares.ranks > cores,
            measured: measured.seconds(),
            predicted: predicted / steps,
        })
    };
    (0..runs.len()).filter_map(check).collect()
}

/// The checks as a table.
pub fn table(checks: &[Check]) -> String {
    let cells = |check: &Check| -> TableRow<'static> {
        let mark = if check.beyond_cores { "*" } else { "" };
        vec![
            ("left out", format!("{}, {}{mark}", check.kind.name(), check.ranks)),
            ("seconds", format!("{:.3e}", check.measured)),
            ("predicted", format!("{:.3e}", check.predicted)),
            ("error", format!("{:+.0} %", 100.0 * (check.predicted / check.measured - 1.0))),
        ]
    };
    markdown(&checks.iter().map(cells).collect::<Vec<_>>())
}
