//! The longest steps in which explicit forces of interactions are stable.

use super::GranularBody;
use crate::{geometry::Protocol, interaction::Interactions, setup::Setup};

/// Largest step in units of `sqrt(m / k)`: a body between as many others as fit around it vibrates at up to `sqrt(24 k / m)`.
const GRANULAR_STEP: f64 = 0.4;

/// Largest step in units of resistance over `k`: such a body comes to rest at up to the rate `8 k / R` as if the others were far, and the
/// two-step rule is stable up to the rate `1 / step`; bodies that nearly touch resist several times as much.
const FLOW_STEP: f64 = 0.2;

/// Part of a cycle of an oscillating shear or drive that a step takes at most, without inertia and with it: the second-order formula of a flow that goes on from earlier
/// ones then shifts its phase by 0.2 degrees.
const PARTS_OF_CYCLE: [f64; 2] = [1.0 / 40.0, 1.0 / 128.0];

/// The longest step that follows the rate of the shear of a box, or what drives the flow; infinite where neither changes by itself.
pub fn longest_step_of_protocol<const D: usize>(setup: &Setup<D>) -> f64 {
    match setup.protocol() {
        Some(Protocol::Oscillation { frequency, .. }) => PARTS_OF_CYCLE[usize::from(setup.inertia.is_some())] / frequency,
        _ => f64::INFINITY,
    }
}

/// The longest stable step of dry bodies; infinite if no interaction limits it.
pub fn longest_granular_step<const D: usize>(interactions: &Interactions<D>, bodies: &[GranularBody<D>]) -> f64 {
    let [mass, radius] = [|body: &GranularBody<D>| body.mass, |body: &GranularBody<D>| body.radius]
        .map(|of| bodies.iter().map(of).fold(f64::INFINITY, f64::min));
    limited(interactions.steepest(radius), |steepest| GRANULAR_STEP * (mass / steepest).sqrt())
}

/// The longest stable step of bodies in a flow, of which each takes a force for a unit velocity; infinite if no interaction limits it.
pub fn longest_step_in_flow<const D: usize>(setup: &Setup<D>) -> f64 {
    let free = setup.bodies.iter().filter(|suspended| suspended.body.free());
    let radius = setup.bodies.iter().map(|suspended| suspended.body.ball.radius).fold(f64::INFINITY, f64::min);
    limited(setup.interactions.steepest(radius), |steepest| {
        FLOW_STEP * free.map(|suspended| setup.resistance(&suspended.body.ball)).fold(f64::INFINITY, f64::min) / steepest
    })
}

fn limited(steepest: f64, limit: impl FnOnce(f64) -> f64) -> f64 {
    if steepest > 0.0 { limit(steepest) } else { f64::INFINITY }
}
