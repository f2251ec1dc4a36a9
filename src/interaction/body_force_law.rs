//! A force and a torque on single bodies, given by expressions in place, radius and time.

use nalgebra::SVector;

use super::{
    Arrangement, Forces, Interaction, Wrench,
    expression::{Dual, Expression},
};
use crate::{body::skew, geometry::Ball};

/// Places along each axis, and times, at which forces are sampled for their steepest slope.
const SAMPLES: usize = 9;

/// Where bodies are, how large they are, and how long.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceRange {
    /// Lowest and highest coordinate of their centres along each axis.
    pub ends: Vec<[f64; 2]>,
    /// Smallest and largest radius.
    pub radii: [f64; 2],
    /// Time at which the run ends.
    pub end: f64,
}

/// A force `f(x, y, z, radius, time)` on each free body, and a torque; the place is that of its centre in the box.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyForceLaw {
    name: String,
    /// An expression an axis.
    force: Vec<Expression>,
    /// An expression a component, if there is a torque: one in 2D, three in 3D.
    torque: Vec<Expression>,
    steepest: f64,
}

impl BodyForceLaw {
    /// What force and torque are expressions of, in this order.
    pub fn variables(dimension: usize) -> Vec<&'static str> {
        [&["x", "y", "z"][..dimension], &["radius", "time"]].concat()
    }

    /// The law of a name with a force on bodies of a range.
    ///
    /// Its steepest slope is the largest norm of the gradient of the force at 9 places along each axis and 9 times, for the smallest and the largest body.
    ///
    /// # Errors
    /// Where the force or its slope is not finite.
    pub fn new(name: String, force: Vec<Expression>, range: &ForceRange) -> Result<BodyForceLaw, String> {
        let mut law = BodyForceLaw { name, force, torque: Vec::new(), steepest: 0.0 };
        for variables in range.samples() {
            let slope = law.gradient(&variables, range.ends.len());
            if !slope.is_finite() || !are_finite(&law.force, &variables) {
                return Err(range.unbounded("is not finite, or infinitely steep,", &variables));
            }
            law.steepest = law.steepest.max(slope);
        }
        Ok(law)
    }

    /// The same with a torque on bodies of a range: an expression in 2D, three in 3D.
    ///
    /// # Errors
    /// Where the torque is not finite.
    pub fn with_torque(self, torque: Vec<Expression>, range: &ForceRange) -> Result<BodyForceLaw, String> {
        match range.samples().find(|variables| !are_finite(&torque, variables)) {
            Some(variables) => Err(range.unbounded("is not finite", &variables)),
            None => Ok(BodyForceLaw { torque, ..self }),
        }
    }

    /// The norm of the gradient of the force.
    fn gradient(&self, variables: &[f64], dimension: usize) -> f64 {
        let along = |axis| evaluate(&self.force, variables, Some(axis));
        (0..dimension).flat_map(along).map(|force| force.slope * force.slope).sum::<f64>().sqrt()
    }

    fn wrench<const D: usize>(&self, center: &SVector<f64, D>, radius: f64, time: f64) -> Wrench<D> {
        let variables: Vec<f64> = center.iter().copied().chain([radius, time]).collect();
        let values = |of: &[Expression]| evaluate(of, &variables, None).iter().map(|component| component.value).collect::<Vec<_>>();
        Wrench { force: SVector::from_vec(values(&self.force)), torque: skew(&values(&self.torque)) }
    }
}

fn are_finite(expressions: &[Expression], variables: &[f64]) -> bool {
    evaluate(expressions, variables, None).iter().all(Dual::is_finite)
}

/// Values of expressions with their slopes along one of their variables, if it is given.
fn evaluate(expressions: &[Expression], variables: &[f64], along: Option<usize>) -> Vec<Dual> {
    let dual = |(place, &value): (usize, &f64)| if along == Some(place) { Dual::varying(value) } else { Dual::fixed(value) };
    let variables: Vec<Dual> = variables.iter().enumerate().map(dual).collect();
    expressions.iter().map(|expression| expression.evaluate(&variables)).collect()
}

impl ForceRange {
    /// What is wrong there, with the place.
    fn unbounded(&self, wrong: &str, variables: &[f64]) -> String {
        let (place, instant) = variables.split_at(self.ends.len());
        format!("{wrong} at {place:?} for a radius of {} at time {}", instant[0], instant[1])
    }

    /// Places, radii and times all over it.
    fn samples(&self) -> impl Iterator<Item = Vec<f64>> {
        let between = |[low, high]: [f64; 2], sample: usize| low + (high - low) * sample as f64 / (SAMPLES - 1) as f64;
        let dimension = self.ends.len();
        let instants =
            self.radii.into_iter().flat_map(move |radius| (0..SAMPLES).map(move |sample| [radius, between([0.0, self.end], sample)]));
        instants.flat_map(move |instant| {
            (0..SAMPLES.pow(dimension as u32)).map(move |place| {
                let along = |axis: usize| between(self.ends[axis], place / SAMPLES.pow(axis as u32) % SAMPLES);
                (0..dimension).map(along).chain(instant).collect()
            })
        })
    }
}

impl<const D: usize> Interaction<D> for BodyForceLaw {
    fn name(&self) -> &str {
        &self.name
    }

    fn describe(&self) -> String {
        let texts = |of: &[Expression]| of.iter().map(Expression::text).collect::<Vec<_>>().join(", ");
        let torque = if self.torque.is_empty() { String::new() } else { format!(", torque {}", texts(&self.torque)) };
        format!("force ({}){torque} on each free body", texts(&self.force))
    }

    fn steepest(&self, _: f64) -> f64 {
        self.steepest
    }

    fn forces(&self, arrangement: &Arrangement<D>) -> Forces<D> {
        let free = arrangement.balls.iter().enumerate().filter(|(place, _)| arrangement.weights[*place].is_finite());
        let on =
            |(place, ball): (usize, &Ball<D>)| (place, self.wrench(&arrangement.domain.wrap(ball.center), ball.radius, arrangement.time));
        Forces { single: free.map(on).collect(), ..Forces::default() }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeMap;

    use nalgebra::{Vector2, Vector3};

    use super::*;
    use crate::geometry::{Axis, Domain};

    fn law(force: &[&str], torque: &[&str], end: f64) -> Result<BodyForceLaw, String> {
        let constants = BTreeMap::from([("k".to_owned(), 3.0)]);
        let variables = BodyForceLaw::variables(force.len());
        let parse = |text: &&str| Expression::parse(text, &variables, &constants).unwrap();
        let range = ForceRange { ends: vec![[0.0, 8.0]; force.len()], radii: [0.5, 1.0], end };
        BodyForceLaw::new("law".into(), force.iter().map(parse).collect(), &range)?.with_torque(torque.iter().map(parse).collect(), &range)
    }

    #[test]
    fn force_and_torque_are_those_of_the_formulas_in_the_box() {
        let law = law(&["k*x*time", "-radius^2*y"], &["k*sin(time)"], 1.0).unwrap();
        let domain = Domain { size: Vector2::new(8.0, 8.0), axes: [Axis::Periodic; 2] };
        // the second one is seen where it is in the box, the third one's motion is given
        let balls = [[1.0, 2.0], [9.0, -6.0], [1.0, 2.0]].map(|center| Ball { center: center.into(), radius: 0.5 });
        let (weights, reach) = ([1.0, 1.0, f64::INFINITY], f64::INFINITY);
        let arrangement =
            Arrangement { domain: &domain, numbers: None, balls: &balls, weights: &weights, viscosity: None, reach, time: 0.5 };
        let forces = law.forces(&arrangement);
        assert_eq!(forces.single.iter().map(|(place, _)| *place).collect::<Vec<_>>(), [0, 1]);
        for (_, wrench) in &forces.single {
            assert!((wrench.force - Vector2::new(1.5, -0.5)).norm() < 1e-14, "{}", wrench.force);
            assert!((wrench.torque - skew::<2>(&[3.0 * 0.5_f64.sin()])).norm() < 1e-14, "{}", wrench.torque);
        }
        let space = self::law(&["0", "z", "x"], &["x", "y", "z"], 0.0).unwrap();
        let wrench = space.wrench(&Vector3::new(1.0, 2.0, 3.0), 0.5, 0.0);
        assert_eq!((wrench.force, wrench.torque), (Vector3::new(0.0, 3.0, 1.0), skew::<3>(&[1.0, 2.0, 3.0])));
    }

    #[test]
    fn the_steepest_slope_is_the_largest_gradient_over_box_radii_and_times() {
        let steepest = |law: &BodyForceLaw| Interaction::<2>::steepest(law, 1.0);
        let trap = law(&["-k*radius*(x - 4)", "-k*radius*(y - 4)*time"], &[], 2.0).unwrap();
        assert!((steepest(&trap) - 3.0 * 5.0_f64.sqrt()).abs() < 1e-12, "{}", steepest(&trap));
        assert_eq!(steepest(&law(&["k*time", "radius"], &["x"], 2.0).unwrap()), 0.0);
    }

    #[test]
    fn what_is_not_finite_in_the_box_is_refused_with_its_place() {
        let refusal = |force: &[&str], torque: &[&str]| law(force, torque, 1.0).unwrap_err();
        let place = "at [4.0, 0.0] for a radius of 0.5 at time 0";
        assert_eq!(refusal(&["1/(x - 4)", "0"], &[]), format!("is not finite, or infinitely steep, {place}"));
        assert_eq!(refusal(&["0", "0"], &["1/(x - 4)"]), format!("is not finite {place}"));
        assert!(refusal(&["0", "log(1 - time)"], &[]).ends_with("at time 1"));
    }
}
