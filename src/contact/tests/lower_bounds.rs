//! Contacts that may pull, down to a floor of their own.

use nalgebra::Vector2;

use super::*;
use crate::contact::{Contact, ContactForce, Partner};

/// A row of disks that is pulled apart, and the least force of each of its contacts.
fn pulled(count: usize, velocity: impl Fn(usize) -> f64, floor: impl Fn(usize) -> f64) -> Projection<2> {
    let scene = row(count, |body| Vector2::new(velocity(body), 0.0));
    let contact = |body: usize| Contact::again(&scene.domain, &scene.balls, (body, Partner::Body(body + 1), [0; 2]));
    let lower_bounds: Vec<_> = (0..count - 1).map(|body| ContactForce::normal(contact(body), floor(body))).collect();
    let problem = Problem { lower_bounds: &lower_bounds, ..scene.problem() };
    alone(&problem, &Memory::default(), &|problem, contacts, guess| solve_island(problem, contacts, guess)).unwrap()
}

fn assert_near(found: impl Iterator<Item = f64>, expected: &[f64]) {
    let found: Vec<f64> = found.collect();
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < EXACT), "{found:?} instead of {expected:?}");
}

#[test]
fn a_contact_that_may_pull_enough_stays_closed() {
    let projection = pulled(3, |body| body as f64 - 1.0, |_| -10.0);
    assert_near(projection.velocities.iter().map(|velocity| velocity[0]), &[0.0; 3]);
    assert_near(projection.forces.iter().map(|force| force.force), &[-1.0; 2]);
    assert_eq!((projection.kkt_report.active, projection.kkt_report.islands), (2, 1));
    assert!(projection.kkt_report.kkt_residual < EXACT);
}

#[test]
fn a_contact_that_may_not_opens_with_the_pull_that_it_has() {
    for count in [2, 3] {
        let projection = pulled(count, |body| body as f64 - 1.0, |body| if body == 0 { -0.25 } else { -10.0 });
        let (velocities, forces): (&[f64], &[f64]) =
            if count == 2 { (&[-0.75, -0.25], &[-0.25]) } else { (&[-0.75, 0.375, 0.375], &[-0.25, -0.625]) };
        assert_near(projection.velocities.iter().map(|velocity| velocity[0]), velocities);
        assert_near(projection.forces.iter().map(|force| force.force), forces);
        assert!(projection.kkt_report.kkt_residual < EXACT, "{:?}", projection.kkt_report);
    }
}

/// The forces in the middle are far above what moves a single contact, and the lower bounds far below them.
#[test]
fn a_long_row_that_may_pull_for_ever_stays_closed() {
    let projection = pulled(20, |body| 0.01 * (body as f64 - 9.5), |_| -1e6);
    assert_near(projection.velocities.iter().map(|velocity| velocity[0]), &[0.0; 20]);
    assert!((projection.forces[9].force + 0.5).abs() < EXACT, "{}", projection.forces[9].force);
}
