//! What errors are measured against: a value that is given, or the limit that the finest settings point to.

use serde::Serialize;

use super::{
    format::percent,
    metric::{Metric, norm},
    options::CostStudy,
    record::Measured,
    sensitivity::Sensitivity,
    setting::CostSetting,
};
use crate::run::unresolved;

/// Observed orders beyond these parts of the predicted one are not believed.
const BELIEVED: [f64; 2] = [0.5, 2.0];

/// The value that counts as true.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// The quantity.
    pub values: Vec<f64>,
    /// How far it may be from the truth, as a relative error.
    pub uncertainty: f64,
    /// Where it comes from.
    pub source: String,
}

/// The finest setting of a sequence, from which its limit is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Finest {
    /// The setting.
    pub setting: CostSetting,
    /// Tolerance of its solves.
    pub tolerance: f64,
    /// Whether its limit is one of vanishing steps too.
    pub without_step_error: bool,
    /// Relative change that is still to come after the end of its run, where its flow may become steady.
    pub still_to_come: Option<f64>,
    /// Cells that the thinnest boundary layer of such a flow has, where it is measured.
    pub boundary_layer: Option<f64>,
}

/// A limit of vanishing spacing.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// The quantity there.
    pub values: Vec<f64>,
    /// Order that it was extrapolated with.
    pub order: f64,
    /// Relative difference between the finest grid and the limit, or what grids before it let expect, if that is more.
    pub uncertainty: f64,
}

impl Reference {
    /// The values that are given.
    pub fn given(options: &CostStudy, metric: &Metric) -> Reference {
        let values = options.exact.clone();
        let given = values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let source = match options.uncertainty > 0.0 {
            true => format!("{given} +- {}, as given", options.uncertainty),
            false => format!("{given}, as given"),
        };
        Reference { uncertainty: options.uncertainty / metric.scale(&values), values, source }
    }

    /// The limit of the finest setting, which solves to a tolerance, with what modes, tolerance, step and more time still change there;
    /// all of it counts as uncertain. In a limit of vanishing steps nothing is left for shorter ones to change.
    pub fn extrapolated(finest: &Finest, limit: &Limit, sensitivity: &Sensitivity, metric: &Metric) -> Reference {
        let mut values = limit.values.clone();
        let unresolved = finest.boundary_layer.map_or(0.0, unresolved);
        let mut uncertainty = limit.uncertainty.max(unresolved) + finest.tolerance;
        let mut also = Vec::new();
        if unresolved > limit.uncertainty {
            also.push(format!("boundary layer {}", percent(unresolved)));
        }
        for parameter in sensitivity.parameters.iter().filter(|parameter| parameter.name != "grid") {
            let Some(change) = parameter.change else { continue };
            if !(parameter.name == "step" && finest.without_step_error) {
                values.iter_mut().zip(&parameter.changes).for_each(|(value, change)| *value += change);
            }
            uncertainty += change.abs();
            also.push(format!("{} {}", parameter.name, percent(change)));
        }
        if let Some(to_come) = finest.still_to_come {
            uncertainty += to_come;
            also.push(format!("time {}", percent(to_come)));
        }
        let off = uncertainty * metric.scale(&values);
        let shown = if let [value] = values[..] { format!("{value:.6} +- {off:.2e}") } else { "the limit".into() };
        let also = if also.is_empty() { String::new() } else { format!("; what else it may be off by: {}", also.join(", ")) };
        let (method, words, order) = (&finest.setting.method, finest.setting.words(), limit.order);
        let source = format!("{shown} ({}), extrapolated from {method} up to {words} with order {order:.1}{also}", percent(uncertainty));
        Reference { values, uncertainty, source }
    }
}

impl Limit {
    /// Of runs on ever finer grids, from the last three if there are so many; nothing if there are not two.
    ///
    /// The order is the observed one, if it is near to what is predicted; with inertia, where errors depend on how bodies lie on the grid, if it is no higher.
    /// With it each pair of grids predicts what is left on
    /// the finest one, and the larger prediction counts as uncertain, because two grids may agree by chance.
    pub fn of(runs: &[&Measured], metric: &Metric, predicted: f64) -> Option<Limit> {
        let [.., middle, finest] = runs else { return None };
        let coarse = runs.len().checked_sub(3).map(|place| runs[place]);
        let middle_values = metric.near(&middle.values, &finest.values);
        let scale = metric.scale(&finest.values);
        let distance = |one: &Measured, two: &Measured| {
            let near = metric.near(&one.values, &two.values);
            norm(&near.iter().zip(&two.values).map(|(one, two)| one - two).collect::<Vec<_>>()) / scale
        };
        let order = coarse.and_then(|coarse| {
            let ratio = distance(coarse, middle) / distance(middle, finest);
            observed([coarse.spacing, middle.spacing, finest.spacing], ratio)
        });
        let most = if metric.properties.inertia { 1.0 } else { BELIEVED[1] };
        let order = order.filter(|order| (BELIEVED[0] * predicted..=most * predicted).contains(order)).unwrap_or(predicted);
        let left = |coarser: f64, finer: f64| finest.spacing.powf(order) / (coarser.powf(order) - finer.powf(order));
        let factor = left(middle.spacing, finest.spacing);
        let values = finest.values.iter().zip(&middle_values).map(|(finest, middle)| finest + factor * (finest - middle)).collect();
        let correction = factor * distance(middle, finest);
        let before = coarse.map_or(0.0, |coarse| left(coarse.spacing, middle.spacing) * distance(coarse, middle));
        Some(Limit { values, order, uncertainty: correction.max(before) })
    }
}

/// The order p at which differences between three grids have a ratio: `(a^p - b^p) / (b^p - c^p) = ratio`, by bisection.
fn observed([coarse, middle, fine]: [f64; 3], ratio: f64) -> Option<f64> {
    let excess = |p: f64| (coarse.powf(p) - middle.powf(p)) / (middle.powf(p) - fine.powf(p)) - ratio;
    let (mut low, mut high) = (0.05, 12.0);
    if !(excess(low) < 0.0 && excess(high) > 0.0) {
        return None;
    }
    for _ in 0..60 {
        let centre = 0.5 * (low + high);
        if excess(centre) < 0.0 { low = centre } else { high = centre }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::cost::{
        properties::SceneProperties,
        quantity::{CostQuantity, QuantityKind},
        record::tests::run,
    };

    fn limit(value: impl Fn(f64) -> f64, spacings: &[f64], predicted: f64) -> Option<Limit> {
        let runs: Vec<Measured> = spacings.iter().map(|&spacing| run(spacing, value(spacing))).collect();
        let quantity = CostQuantity { kind: QuantityKind::Drag, body: None, probe: None };
        let metric = Metric { quantity, properties: SceneProperties::default() };
        Limit::of(&runs.iter().collect::<Vec<_>>(), &metric, predicted)
    }

    #[test]
    fn a_power_law_is_extrapolated_to_its_limit() {
        let limit = limit(|h| 10.0 + 3.0 * h.powf(1.7), &[0.5, 0.4, 0.25, 0.2], 2.0).expect("there are four");
        assert!((limit.values[0] - 10.0).abs() < 1e-9 && (limit.order - 1.7).abs() < 1e-9, "{limit:?}");
        let left = 3.0 * 0.2_f64.powf(1.7);
        assert!((limit.uncertainty - left / (10.0 + left)).abs() < 1e-9, "all that is left: {limit:?}");
    }

    #[test]
    fn what_is_erratic_is_uncertain() {
        let values = [(0.4, 10.4), (0.2, 9.9), (0.1, 9.901)];
        let erratic = limit(|h| values.iter().find(|(spacing, _)| *spacing == h).map_or(0.0, |(_, value)| *value), &[0.4, 0.2, 0.1], 2.0);
        let erratic = erratic.expect("there are three");
        assert_eq!(erratic.order, 2.0, "an observed order of 9 is not believed");
        assert!(erratic.uncertainty > 4e-3, "the last two agree by chance: {erratic:?}");
    }

    #[test]
    fn two_grids_do_and_one_does_not() {
        let two = limit(|h| 1.0 + h, &[0.2, 0.1], 1.0).expect("two do");
        assert!((two.values[0] - 1.0).abs() < 1e-12 && two.order == 1.0);
        assert_eq!(limit(|h| h, &[0.1], 1.0), None);
    }
}
