//! Steps of bodies in a shear whose rate changes: where motions do not go on from those before, and how far images slide in a step.

use super::quasi_static::QuasiStatic;
use crate::{body::Twist, geometry::Domain, setup::State};

impl<const D: usize> QuasiStatic<D> {
    /// The box of a state, sheared at the rate that is tried, if a stress decides it.
    pub(super) fn domain_at(&self, state: &State<D>) -> Domain<D> {
        let domain = self.suspension.setup().domain.clone().at(state.time);
        match self.tried_rate {
            Some(rate) => domain.sheared_to(state.time, state.shear.strain, rate),
            None => domain,
        }
    }

    /// Lets free bodies go along with images whose speed changes as far as these do in a step, for which a rule took their rates now and before the last step.
    pub(super) fn follow_images(&self, state: &State<D>, length: f64, factor: f64, moves: &mut [Twist<D>]) {
        let domain = self.domain_at(state);
        // what a stress decides is found as motions are, and followed as these are
        if domain.slide().is_none_or(|slide| slide.protocol.steady() || slide.protocol.stresses().is_some()) {
            return;
        }
        let (now, before) = (domain.shear_rate(), domain.clone().at(state.time - state.last_step).shear_rate());
        let missing = domain.over(length).shear_rate() - now - factor * (now - before);
        let bodies = self.suspension.setup().bodies.iter().zip(&state.bodies);
        for (twist, (_, body)) in moves.iter_mut().zip(bodies).filter(|(_, (suspended, _))| suspended.body.free()) {
            twist.velocity[0] += missing * body.center[1];
            twist.spin[(0, 1)] += 0.5 * missing;
            twist.spin[(1, 0)] -= 0.5 * missing;
        }
    }

    /// The last step, 0 where motions do not go on from it: in the first one, and where the rate of the shear jumps.
    pub(super) fn last_step(&self, state: &State<D>) -> f64 {
        let anew = !self.evolves() && self.step_control.jumped(state.time, state.last_step);
        if anew { 0.0 } else { state.last_step }
    }

    /// Whether a step from a state is a first one that has no middle.
    pub(super) fn starts(&self, state: &State<D>) -> bool {
        (self.evolves() || self.step_control.wanders()) && self.last_step(state) == 0.0
    }
}
