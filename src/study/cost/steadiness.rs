//! How far a flow with inertia past bodies that stay where they are is from steady when its run ends.
//!
//! The quantity is followed over the second half of the run ([`still_to_come`](crate::run::still_to_come)).

use std::path::Path;

use super::{metric::Metric, quantity::QuantityKind};
use crate::{error::Result, experiment::summary::RunSummary, output::Columns, run};

/// The relative change that is still to come after the end of a run, where its flow may become steady; nothing elsewhere.
///
/// # Errors
/// The tables of the run cannot be read.
pub fn still_to_come(metric: &Metric, summary: &RunSummary, folder: &Path) -> Result<Option<f64>> {
    if !(metric.properties.steady && summary.in_time()) {
        return Ok(None);
    }
    Ok(run::still_to_come(&history(metric, folder)?))
}

/// Times and the quantity as far as tables tell it, or else the kinetic energy of the flow.
fn history(metric: &Metric, folder: &Path) -> Result<Vec<(f64, f64)>> {
    let (series, forces) = (Columns::read(&folder.join("series.csv"))?, folder.join("forces.csv"));
    let force = |body: usize| move |axis: &str| format!("force_{axis}_{body}");
    // tables of forces have room for so many bodies only
    let forces = if forces.exists() {
        Columns::read(&forces)?.mean_lengths(&metric.counted().into_iter().map(force).collect::<Vec<_>>())
    } else {
        None
    };
    let velocities = series.lengths(|axis| format!("mean_velocity_{axis}"));
    let values = match (metric.quantity.kind, forces, velocities) {
        (QuantityKind::Drag, Some(forces), _) => Some(forces),
        (QuantityKind::Resistance, Some(forces), Some(velocities)) => {
            Some(forces.iter().zip(&velocities).map(|(force, velocity)| force / velocity).collect())
        }
        (QuantityKind::MeanVelocity, _, Some(velocities)) => Some(velocities),
        _ => series.column("kinetic_energy").map(<[f64]>::to_vec),
    };
    let times = series.column("time").unwrap_or_default();
    Ok(times.iter().copied().zip(values.unwrap_or_default()).filter(|(_, value)| value.is_finite()).collect())
}
