//! Bodies of given motion on their way over a step: no contact force keeps them apart, neither from each other nor from walls.

use std::cmp::Ordering;

use nalgebra::SVector;

use super::{
    Contact, Identity, Partner, Problem,
    paths::{Motions, Path, common_motion, paths},
};
use crate::parallel::Peers;

/// Gap, in radii of the smaller body, up to which pairs are looked at.
const NEARNESS: f64 = 0.2;

/// Overlap, in radii of the smaller body, that is rounding of places.
const OVERLAP: f64 = 1e-6;

/// Two bodies of given motion that meet in a step, or one and a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting<const D: usize> {
    /// Who meets, by numbers of bodies.
    pub identity: Identity<D>,
    /// When they touch, after the beginning of the step.
    pub time: f64,
    /// Their largest overlap in the step.
    pub overlap: f64,
}

/// What becomes of bodies of given motion in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenPaths<const D: usize> {
    /// Smallest gap after the step, in radii of the smaller body, of those that move past each other or a wall and come near; infinite without any.
    pub smallest_gap: f64,
    /// Those that meet first.
    pub meeting: Option<Meeting<D>>,
}

impl<const D: usize> GivenPaths<D> {
    /// Of bodies that all move as they want to in this problem.
    pub fn of(problem: &Problem<D>) -> GivenPaths<D> {
        let velocities = problem.velocities;
        let motions = Motions { velocities, common: common_motion(Peers::Alone, problem, velocities) };
        let mut found = GivenPaths { smallest_gap: f64::INFINITY, meeting: None };
        for path in paths(problem, &motions, NEARNESS, |_| true).iter().filter(|path| moves(problem, &path.contact)) {
            let radius = path.contact.smaller_radius(problem.balls);
            found.smallest_gap = found.smallest_gap.min(path.last_gap / radius);
            if path.smallest_gap < -OVERLAP * radius {
                let meeting = Meeting::of(problem, path);
                found.meeting = Some(found.meeting.map_or(meeting, |first| first.or(meeting)));
            }
        }
        found
    }
}

impl<const D: usize> Meeting<D> {
    fn of(problem: &Problem<D>, path: &Path<D>) -> Meeting<D> {
        let contact = path.contact.renamed(|place| problem.number(place));
        Meeting { identity: contact.identity(), time: time_of_touch(problem, path), overlap: -path.smallest_gap }
    }

    /// The one of two that comes first.
    pub fn or(self, other: Meeting<D>) -> Meeting<D> {
        let order = self.time.total_cmp(&other.time).then(self.identity.cmp(&other.identity));
        if order == Ordering::Greater { other } else { self }
    }

    /// Who meets, in words.
    pub fn names(&self) -> String {
        match self.identity {
            (body, Partner::Body(other), _) => format!("bodies {body} and {other}"),
            (body, Partner::Wall { axis, upper }, _) => {
                format!("body {body} and the {} wall along {}", if upper { "upper" } else { "lower" }, ["x", "y", "z"][axis])
            }
        }
    }
}

/// Whether a body moves as seen from what it may meet.
fn moves<const D: usize>(problem: &Problem<D>, contact: &Contact<D>) -> bool {
    let partner = contact.other().map_or_else(SVector::zeros, |other| problem.velocities[other] + contact.sliding);
    partner != problem.velocities[contact.body]
}

/// When the gap closes on straight ways, after the beginning of the step.
fn time_of_touch<const D: usize>(problem: &Problem<D>, path: &Path<D>) -> f64 {
    let contact = &path.contact;
    if contact.gap <= 0.0 {
        return 0.0;
    }
    let Some(other) = contact.other() else { return -contact.gap / contact.opening(problem.velocities) };
    let relative = problem.velocities[other] + contact.sliding - problem.velocities[contact.body];
    let (square, closing) = (relative.norm_squared(), -contact.opening(problem.velocities) * contact.separation);
    let touching = contact.separation - contact.gap;
    let apart = contact.separation.powi(2) - touching.powi(2);
    // the smaller root of |separation + relative t| = touching, in the form that cancels nothing
    apart / (closing + (closing * closing - square * apart).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::geometry::{Axis, Ball, Domain, LeesEdwards};

    fn domain(y: Axis<2>) -> Domain<2> {
        Domain { size: [8.0, 6.0].into(), axes: [Axis::Periodic, y] }
    }

    fn walls() -> Axis<2> {
        Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() }
    }

    fn found(domain: &Domain<2>, centers: &[[f64; 2]], velocities: &[[f64; 2]], step: f64) -> GivenPaths<2> {
        let balls: Vec<Ball<2>> = centers.iter().map(|&center| Ball { center: center.into(), radius: 0.5 }).collect();
        let velocities: Vec<Vector2<f64>> = velocities.iter().map(|&velocity| velocity.into()).collect();
        let weights = vec![1.0; balls.len()];
        GivenPaths::of(&Problem::new(domain, &balls, &weights, &velocities, step))
    }

    #[test]
    fn bodies_that_pass_through_each_other_in_one_step_meet_on_the_way() {
        let found = found(&domain(walls()), &[[1.0, 3.0], [4.0, 3.0]], &[[1.0, 0.0], [-1.0, 0.0]], 3.0);
        let meeting = found.meeting.unwrap();
        assert_eq!((meeting.names().as_str(), meeting.overlap), ("bodies 0 and 1", 1.0));
        assert!((meeting.time - 1.0).abs() < 1e-14, "{}", meeting.time);
        // across the periodic side, and off the line of centres by .6: they touch .8 before they pass
        let found = self::found(&domain(walls()), &[[1.0, 3.0], [7.0, 3.6]], &[[-1.0, 0.0], [0.0, 0.0]], 2.0);
        assert!((found.meeting.unwrap().time - 1.2).abs() < 1e-14);
    }

    #[test]
    fn a_wall_is_met_where_the_surface_reaches_it() {
        let found = found(&domain(walls()), &[[1.0, 5.0], [4.0, 2.0]], &[[1.0, 2.0], [-1.0, -1.0]], 1.0);
        let meeting = found.meeting.unwrap();
        assert_eq!((meeting.names().as_str(), meeting.time, meeting.overlap), ("body 0 and the upper wall along y", 0.25, 1.5));
    }

    #[test]
    fn bodies_that_only_come_near_have_a_smallest_gap_and_those_at_rest_none() {
        let apart = found(&domain(walls()), &[[1.0, 3.0], [2.15, 3.0]], &[[0.1, 0.0], [0.0, 0.0]], 1.0);
        assert!((apart.smallest_gap - 0.1).abs() < 1e-14 && apart.meeting.is_none());
        let together = found(&domain(walls()), &[[1.0, 3.0], [1.9, 3.0]], &[[0.1, 0.0], [0.1, 0.0]], 1.0);
        assert_eq!(together, GivenPaths { smallest_gap: f64::INFINITY, meeting: None });
    }

    #[test]
    fn images_that_slide_meet_bodies_that_rest() {
        let sheared = domain(Axis::Sheared(LeesEdwards::steady(0.0, 6.0, 0.0)));
        // the image of the lower body above the box is at x = 1 + 6 t
        let found = found(&sheared, &[[1.0, 0.2], [4.0, 5.8]], &[[0.0, 0.0], [0.0, 0.0]], 1.0);
        let meeting = found.meeting.unwrap();
        assert_eq!(meeting.names(), "bodies 0 and 1");
        assert!((meeting.time - (3.0 - 0.84_f64.sqrt()) / 6.0).abs() < 1e-12, "{}", meeting.time);
    }
}
