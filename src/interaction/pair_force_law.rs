//! A force between two bodies along the line of their centres, given by an expression in their distance and radii.

use nalgebra::SMatrix;

use super::{
    Arrangement, Forces, Interaction, PairForce,
    expression::{Dual, Expression},
};
use crate::contact::Contact;

/// Gaps at which the force is sampled for its steepest slope.
const SAMPLES: u32 = 400;

/// Overlap up to which it is sampled, in radii of the smaller body.
const OVERLAP: f64 = 0.02;

/// A force `f(r, gap, a, b)` between bodies whose centres are `r` apart, with radii `a`, that of the smaller, and `b`; positive ones push apart. It acts up to a gap,
/// between bodies, not between bodies and walls.
#[derive(Debug, Clone, PartialEq)]
pub struct PairForceLaw {
    name: String,
    force: Expression,
    reach: f64,
    steepest: f64,
}

impl PairForceLaw {
    /// What the force is an expression of, in this order.
    pub const VARIABLES: [&str; 4] = ["r", "gap", "a", "b"];

    /// The law of a name between bodies whose radii are between the smallest and the largest of these, up to a gap.
    ///
    /// Its steepest slope is the larger of `|df/dgap|` and `|f| / r` over 400 gaps from an overlap of 0.02 radii to `reach`, denser near contact, for both radii.
    ///
    /// # Errors
    /// Where the force or its slope is not finite.
    pub fn new(name: String, force: Expression, reach: f64, [smallest, largest]: [f64; 2]) -> Result<PairForceLaw, String> {
        let law = PairForceLaw { name, force, reach, steepest: 0.0 };
        let far = |sample: u32| reach * (f64::from(sample) / f64::from(SAMPLES)).powi(2);
        let mut steepest = 0.0_f64;
        for [a, b] in [[smallest, smallest], [smallest, largest], [largest, largest]] {
            for gap in [0.0, -OVERLAP * a].into_iter().chain((1..=SAMPLES).map(far)) {
                let force = law.force(gap, [a, b]);
                if !force.is_finite() {
                    return Err(format!("is not finite, or infinitely steep, at a gap of {gap} between radii of {a} and {b}"));
                }
                steepest = steepest.max(force.slope.abs()).max(force.value.abs() / (gap + a + b));
            }
        }
        Ok(PairForceLaw { steepest, ..law })
    }

    /// The force at a gap between bodies of these radii, and its slope over the gap.
    pub fn force(&self, gap: f64, [one, other]: [f64; 2]) -> Dual {
        let (a, b) = (one.min(other), one.max(other));
        self.force.evaluate(&[Dual::varying(gap + a + b), Dual::varying(gap), Dual::fixed(a), Dual::fixed(b)])
    }
}

impl<const D: usize> Interaction<D> for PairForceLaw {
    fn name(&self) -> &str {
        &self.name
    }

    fn describe(&self) -> String {
        format!("pair force {} up to gaps of {}", self.force.text(), self.reach)
    }

    fn reach(&self, _: f64) -> f64 {
        self.reach
    }

    fn steepest(&self, _: f64) -> f64 {
        self.steepest
    }

    fn forces(&self, arrangement: &Arrangement<D>) -> Forces<D> {
        let force = |contact: Contact<D>| {
            let radii = [contact.body, contact.other()?].map(|body| arrangement.balls[body].radius);
            let force = contact.normal * self.force(contact.gap, radii).value;
            Some(PairForce { contact, force, torques: [SMatrix::zeros(); 2] })
        };
        arrangement.near(self.reach).into_iter().filter_map(force).collect::<Vec<_>>().into()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn law(force: &str, reach: f64, radii: [f64; 2]) -> Result<PairForceLaw, String> {
        let constants = BTreeMap::from([("k".to_owned(), 3.0)]);
        PairForceLaw::new("law".into(), Expression::parse(force, &PairForceLaw::VARIABLES, &constants).unwrap(), reach, radii)
    }

    #[test]
    fn force_and_slope_are_those_of_the_formula_for_either_order_of_radii() {
        let (dipoles, screened) =
            (law("-12*k*(a + b)/r^4", 2.0, [0.5, 1.0]).unwrap(), law("k*exp(-gap/0.1)*a/b", 1.0, [0.5, 1.0]).unwrap());
        for gap in [0.0, 0.01, 0.3, 1.7_f64] {
            let (r, screening) = (gap + 1.5, 1.5 * (-gap / 0.1).exp());
            for radii in [[0.5, 1.0], [1.0, 0.5]] {
                let (found, other) = (dipoles.force(gap, radii), screened.force(gap, radii));
                assert!((found.value + 54.0 / r.powi(4)).abs() < 1e-14 && (found.slope - 216.0 / r.powi(5)).abs() < 1e-13, "{found:?}");
                assert!((other.value - screening).abs() < 1e-14 && (other.slope + 10.0 * screening).abs() < 1e-13, "{other:?}");
            }
        }
    }

    #[test]
    fn the_steepest_slope_is_that_of_the_pair_for_which_it_is_largest() {
        let steepest = |law: &PairForceLaw| Interaction::<2>::steepest(law, 1.0);
        // at the overlap up to which it is sampled, between the smallest bodies
        let dipoles = law("k/r^4", 2.0, [0.5, 1.0]).unwrap();
        assert!((steepest(&dipoles) - 12.0 / 0.99_f64.powi(5)).abs() < 1e-10, "{}", steepest(&dipoles));
        // a force that does not depend on the distance turns with the line of centres
        let constant = law("k", 2.0, [0.5, 1.0]).unwrap();
        assert!((steepest(&constant) - 3.0 / 0.99).abs() < 1e-12, "{}", steepest(&constant));
        let narrow = law("k*exp(-gap/1e-3)", 2.0, [0.5, 1.0]).unwrap();
        assert!(steepest(&narrow) >= 3e3, "{}", steepest(&narrow));
    }

    #[test]
    fn what_is_not_finite_between_bodies_that_touch_is_refused_with_its_place() {
        let refusal = |force: &str| law(force, 1.0, [0.5, 1.0]).unwrap_err();
        assert_eq!(refusal("k/gap"), "is not finite, or infinitely steep, at a gap of 0 between radii of 0.5 and 0.5");
        assert!(refusal("sqrt(gap)").ends_with("at a gap of 0 between radii of 0.5 and 0.5"));
        assert!(refusal("1/(b - a)").starts_with("is not finite"));
        assert!(refusal("log(r - 1.25)").ends_with("at a gap of 0 between radii of 0.5 and 0.5"));
        assert!(law("k/max(gap, 1e-3)", 1.0, [0.5, 1.0]).is_ok());
    }
}
