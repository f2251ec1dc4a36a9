//! What a summary says of a quantity: its last value, and its mean over the steady part of a run.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Columns, curve::LEAST_STRAIN};
use crate::observe::statistics::{Interval, Steady, steady};

/// A quantity at the end of a run, and its mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantitySummary {
    /// Its unit in those of the scene; empty for a number without one.
    pub unit: String,
    /// What it is.
    pub meaning: String,
    /// At the last instant; nothing where it does not exist then.
    pub last: Option<f64>,
    /// Over its steady part; nothing while it has none, or in an instant.
    pub mean: Option<SteadyMean>,
}

/// A mean over the steady part of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SteadyMean {
    /// The mean.
    pub value: f64,
    /// Lowest and highest value that 95 % confidence leaves, for the time average of this run's bodies.
    pub interval: [f64; 2],
    /// What is averaged over: `strain` in simple shear, or else `time`.
    pub over: &'static str,
    /// Where the steady part begins, and where it ends.
    pub from_to: [f64; 2],
}

impl QuantitySummary {
    /// A quantity that has no mean yet.
    pub fn new(unit: &str, meaning: &str, last: Option<f64>) -> QuantitySummary {
        QuantitySummary { unit: unit.to_owned(), meaning: meaning.to_owned(), last, mean: None }
    }

    /// Its mean, or else its last value.
    pub fn representative(&self) -> Option<f64> {
        self.mean.map(|mean| mean.value).or(self.last)
    }
}

impl SteadyMean {
    /// Adds to quantities the means of their columns.
    pub fn attach(quantities: &mut BTreeMap<String, QuantitySummary>, series: &Columns) {
        quantities.iter_mut().for_each(|(name, quantity)| quantity.mean = SteadyMean::of(series, name));
    }

    /// Of a column of a series; nothing while it is too short or has not become steady. In a shear the steady part has a strain of twenty at least.
    fn of(series: &Columns, name: &str) -> Option<SteadyMean> {
        let (over, least) = if series.column("strain").is_some() { ("strain", LEAST_STRAIN) } else { ("time", 0.0) };
        // a negative rate shears as well
        let curve: Vec<(f64, f64)> = series.curve(over, name).into_iter().map(|(place, value)| (place.abs(), value)).collect();
        let Steady { from, to, interval: Interval { mean, half_width, .. } } = steady(&curve, least).ok()?;
        Some(SteadyMean { value: mean, interval: [mean - half_width, mean + half_width], over, from_to: [from, to] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::{CurvePoint, MeanViscosity};

    /// A viscosity that fluctuates, a start-up that fades, a quantity that grows, over a strain of 80 in the time 40.
    fn series() -> String {
        let row = |step: i32| {
            let strain = -0.1 * f64::from(step);
            let (viscosity, fading) = (2.0 + strain.sin(), 1.0 + (strain / 2.0).exp() + 0.01 * (7.0 * strain).sin());
            format!("{},{strain},{viscosity},{viscosity},{fading},{}\n", -0.5 * strain, 3.0 * strain)
        };
        let head = "time,strain,viscosity,viscosity_hydrodynamic,fading,growing\n".to_owned();
        head + &(0..=800).map(row).collect::<String>()
    }

    #[test]
    fn the_mean_of_the_viscosity_is_the_one_that_the_run_knows() {
        let (text, known) = (series(), |text: &str| MeanViscosity::of(&CurvePoint::read(text)).expect("is steady"));
        let mean = SteadyMean::of(&Columns::parse(&text), "viscosity").expect("is steady");
        assert_eq!((mean.value, mean.interval, mean.from_to), (known(&text).relative, known(&text).interval, known(&text).strains));
        assert_eq!(mean.over, "strain");
    }

    #[test]
    fn a_quantity_has_a_mean_once_it_is_steady() {
        let names = ["fading", "growing", "absent"];
        let mut quantities = names.map(|name| (name.to_owned(), QuantitySummary::new("", "", None))).into_iter().collect();
        SteadyMean::attach(&mut quantities, &Columns::parse(&series()));
        let mean = quantities["fading"].mean.expect("it fades within a strain of ten");
        assert!((mean.value - 1.0).abs() < 2e-3 && mean.from_to[0] >= 8.0, "{mean:?}");
        assert_eq!([quantities["growing"].mean, quantities["absent"].mean], [None, None]);
    }
}
