//! The resistance with all modes, for any ratio of radii.

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use super::{
    Resistance,
    axisymmetric::AxisymmetricBody,
    exact::Exact,
    pair::{self, Lift},
    ratios::{self, RatioNode},
    wall,
};
use crate::surface::highest_order;

/// Gaps at which it is computed.
const SAMPLES: usize = 20;

/// From the least to the largest of them, in radii of the first body.
const RANGE: f64 = 1.4;

/// Resistances as functions of the gap, at the nodes met so far.
#[derive(Default)]
pub struct ExactTables {
    /// No node is a wall.
    fits: RefCell<BTreeMap<Option<RatioNode>, Rc<Exact>>>,
}

impl ExactTables {
    /// The resistance of a body of radius 1 and one of a radius that is not smaller, or a wall.
    ///
    /// Beyond the largest ratio of balanced motions what is not singular is linear in the curvature.
    pub fn of<const D: usize>(&self, second: Option<(f64, Lift)>) -> Exact {
        let Some((radius, lift)) = second else { return Exact::clone(&self.at_node::<D>(None)) };
        let nodes = match lift {
            Lift::Balanced => ratios::nodes(radius).into_iter().map(|(node, weight)| (Some(node), weight)).collect(),
            Lift::First => {
                let part = ratios::LARGEST_BALANCED / radius;
                vec![(Some(RatioNode::FIRST), part), (None, 1.0 - part)]
            }
        };
        let fits: Vec<(Rc<Exact>, f64)> = nodes.into_iter().map(|(node, weight)| (self.at_node::<D>(node), weight)).collect();
        Exact::mean(radius, &fits)
    }

    fn at_node<const D: usize>(&self, node: Option<RatioNode>) -> Rc<Exact> {
        self.fits.borrow_mut().entry(node).or_insert_with(|| Rc::new(fit::<D>(node.map(|node| (node.ratio(), node.lift))))).clone()
    }
}

/// From gaps that the highest order resolves.
fn fit<const D: usize>(second: Option<(f64, Lift)>) -> Exact {
    let order = highest_order(D);
    let first = AxisymmetricBody::<D>::new(1.0, order);
    let other = second.map(|(radius, lift)| (AxisymmetricBody::<D>::new(radius, order), lift));
    let second = second.map(|(radius, _)| radius);
    let least = least_resolved(order, second);
    let sample = |number: usize| {
        // denser where the gap is small
        let gap = least + RANGE * (number as f64 / (SAMPLES - 1) as f64).powi(2);
        let found = match &other {
            Some((other, lift)) => pair::resistance([&first, other], gap, *lift),
            None => wall::resistance(&first, gap),
        };
        (gap, found)
    };
    let samples: Vec<(f64, Resistance)> = (0..SAMPLES).map(sample).collect();
    Exact::fit(D, second, &samples)
}

/// The gap at which modes up to an order err by some 1e-5: fields fall by `e^{-alpha}` from one mode to the next,
/// `a_2 sinh(alpha) = sqrt(2 r e)` with `r` the reduced radius and the larger body's radius `a_2`.
fn least_resolved(order: usize, second: Option<f64>) -> f64 {
    let sinh = (8.0 / order as f64).sinh();
    match second {
        Some(radius) => (radius * sinh).powi(2) * (1.0 + radius) / (2.0 * radius),
        None => 0.5 * sinh.powi(2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between_nodes<const D: usize>() {
        let tables = ExactTables::default();
        for ratio in [1.02, 1.13, 1.37, 1.62, 1.93] {
            let (found, direct) = (tables.of::<D>(Some((ratio, Lift::Balanced))), fit::<D>(Some((ratio, Lift::Balanced))));
            for gap in [1e-5, 1e-3, 0.03, 0.2, 0.7, 1.2] {
                let (found, direct) = (found.at(gap), direct.at(gap));
                let across = direct.slip.max(direct.roll);
                for (place, (one, other)) in found.numbers().iter().zip(direct.numbers()).enumerate() {
                    let kind = if Resistance::of_approach(place) { direct.approach } else { across };
                    assert!((one - other).abs() < 1e-5 * kind, "{D}D ratio {ratio}, gap {gap}, number {place}: {one} {other}");
                }
            }
        }
    }

    #[test]
    fn ratios_between_the_nodes_have_the_resistance_that_is_computed_there() {
        between_nodes::<2>();
        between_nodes::<3>();
    }
}
