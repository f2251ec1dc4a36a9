//! A problem that all ranks hold, cut into the parts that they own, and what they found put together again.

use nalgebra::SVector;

use super::{
    Contact, ContactForce, Problem, Projection, ProjectionShare, bodies_of,
    identity::{pack, packed_length, unpack},
};
use crate::{body::Regions, geometry::Ball, parallel::Peers};

/// A rank's own bodies of a problem.
pub(super) struct OwnPart<const D: usize> {
    numbers: Vec<usize>,
    balls: Vec<Ball<D>>,
    weights: Vec<f64>,
    velocities: Vec<SVector<f64, D>>,
    lower_bounds: Vec<ContactForce<D>>,
}

/// The bodies of which this rank owns the centre, with the lower bounds of their contacts.
pub(super) fn own_part<const D: usize>(peers: Peers, problem: &Problem<D>, regions: &Regions<D>) -> OwnPart<D> {
    let owns = |body: usize| regions.owner(problem.domain, &problem.balls[body].center) == peers.rank();
    let numbers: Vec<usize> = (0..problem.balls.len()).filter(|&body| peers.count() == 1 || owns(body)).collect();
    let concerns = |bound: &&ContactForce<D>| bodies_of(bound.contact.identity()).any(|body| numbers.binary_search(&body).is_ok());
    OwnPart {
        balls: numbers.iter().map(|&body| problem.balls[body]).collect(),
        weights: numbers.iter().map(|&body| problem.weights[body]).collect(),
        velocities: numbers.iter().map(|&body| problem.velocities[body]).collect(),
        lower_bounds: problem.lower_bounds.iter().filter(concerns).copied().collect(),
        numbers,
    }
}

impl<const D: usize> OwnPart<D> {
    /// The problem of these bodies.
    pub fn problem<'a>(&'a self, whole: &Problem<'a, D>) -> Problem<'a, D> {
        let OwnPart { numbers, balls, weights, velocities, lower_bounds } = self;
        Problem { numbers: Some(numbers), balls, weights, velocities, lower_bounds, ..*whole }
    }
}

/// The projection of the whole problem on every rank. Collective.
pub(super) fn gathered<const D: usize>(peers: Peers, problem: &Problem<D>, own: &OwnPart<D>, found: ProjectionShare<D>) -> Projection<D> {
    let ProjectionShare { projection, view } = found;
    if peers.count() == 1 {
        return projection;
    }
    let own = own.numbers.iter().zip(&projection.velocities);
    let numbers: Vec<f64> = own.flat_map(|(&body, velocity)| [&[body as f64], velocity.as_slice()].concat()).collect();
    let mut velocities = problem.velocities.to_vec();
    for record in peers.gather(&numbers).chunks(1 + D) {
        velocities[record[0] as usize] = SVector::from_column_slice(&record[1..]);
    }
    let answered = projection.forces.iter().filter(|force| view.answers(force.contact.identity()));
    let numbers: Vec<f64> = answered.flat_map(|force| pack(view.identity(&force.contact), force.force)).collect();
    let again = |record: &[f64]| {
        let (identity, force) = unpack(record);
        ContactForce::normal(Contact::again(problem.domain, problem.balls, identity), force)
    };
    let mut forces: Vec<_> = peers.gather(&numbers).chunks(packed_length::<D>()).map(again).collect();
    forces.sort_unstable_by_key(|force| force.contact.identity());
    Projection { velocities, forces, ..projection }
}
