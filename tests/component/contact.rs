//! Contact: the projection of velocities, shared by the ranks.

use nalgebra::{SVector, Vector2};
use turbid::{
    contact::{Problem, Projection, project},
    error::{Error, Result},
    geometry::{Axis, Ball, Domain},
    petsc::Session,
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(all_ranks_hold_the_same_answer),
        Test::of(columns_stand_on_any_number_of_ranks),
        Test::of(a_row_shares_an_impact_on_any_number_of_ranks),
        Test::of(a_squeeze_is_the_same_error_on_all_ranks),
    ]
}

const COLUMNS: usize = 7;

/// Columns of 1 to 7 disks that fall on the floor a little aslant.
fn columns() -> Vec<Ball<2>> {
    let disk = |column: usize, row: usize| {
        let center = Vector2::new(2.0 + 4.0 * column as f64 + 0.1 * (row % 2) as f64, 1.1 + 2.1 * row as f64);
        Ball { center, radius: 1.0 }
    };
    (0..COLUMNS).flat_map(|column| (0..=column).map(move |row| disk(column, row))).collect()
}

fn channel(size: [f64; 2]) -> Domain<2> {
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    Domain { size: size.into(), axes: [Axis::Periodic, wall] }
}

fn solve(session: &Session, balls: &[Ball<2>], weights: &[f64], velocities: &[Vector2<f64>]) -> Result<Projection<2>> {
    let domain = channel([4.0 * COLUMNS as f64, 40.0]);
    project(session.world(), &Problem { domain: &domain, balls, weights, velocities, step: 1.0, lower_bounds: &[] })
}

fn fall(session: &Session) -> Projection<2> {
    let balls = columns();
    solve(session, &balls, &vec![1.0; balls.len()], &vec![Vector2::new(0.01, -1.5); balls.len()]).unwrap()
}

fn all_ranks_hold_the_same_answer(session: &Session) {
    let projection = fall(session);
    let velocities = projection.velocities.iter().flat_map(|velocity| velocity.iter().copied());
    let forces = projection.forces.iter().map(|force| force.force);
    let own: Vec<u64> = velocities.chain(forces).map(f64::to_bits).collect();
    for other in session.world().gather(&own).chunks(own.len()) {
        assert_eq!(other, own);
    }
}

fn columns_stand_on_any_number_of_ranks(session: &Session) {
    let kkt_report = fall(session).kkt_report;
    assert_eq!(kkt_report.islands, COLUMNS);
    assert!(kkt_report.kkt_residual < 1e-12, "{kkt_report:?}");
    assert!(kkt_report.smallest_gap > -1e-12, "{kkt_report:?}");
    assert!(kkt_report.iterations > 0 && kkt_report.iterations < 50, "{kkt_report:?}");
}

fn a_row_shares_an_impact_on_any_number_of_ranks(session: &Session) {
    let disks: Vec<_> = (0..5).map(|place| Ball { center: Vector2::new(3.0 + 2.0 * f64::from(place), 20.0), radius: 1.0 }).collect();
    let mut velocities = vec![Vector2::zeros(); 5];
    velocities[0] = Vector2::new(1.0, 0.0);
    for velocity in solve(session, &disks, &[1.0; 5], &velocities).unwrap().velocities {
        assert!((velocity - Vector2::new(0.2, 0.0)).norm() < 1e-12, "{velocity}");
    }
}

/// Each rank solves an island or two, and one of them has no solution.
fn a_squeeze_is_the_same_error_on_all_ranks(session: &Session) {
    let mut balls = columns();
    let mut weights = vec![1.0; balls.len()];
    let mut velocities = vec![Vector2::new(0.0, -1.5); balls.len()];
    // the second column: the upper disk is driven down on the lower, straight below
    balls[2].center[0] = balls[1].center[0];
    weights[2] = f64::INFINITY;
    velocities[2] = Vector2::new(0.0, -3.0);
    let error = solve(session, &balls, &weights, &velocities).unwrap_err();
    let Error::Contact { text, island } = error else { panic!("{error:?}") };
    assert!(text.starts_with("contact of 2 bodies (1, 2) at 2 places failed: bodies are squeezed"), "{text}");
    let bytes = island.as_bytes();
    assert!(session.world().gather(bytes).chunks(bytes.len()).all(|other| other == bytes));
}
