//! Contact: the projection of velocities, shared by the ranks.

use nalgebra::{SVector, Vector2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use turbid::{
    body::Regions,
    contact::{Memory, Problem, ProblemShare, Projection, Solver, Spanning, project, project_share},
    error::{Error, Result},
    geometry::{Axis, Ball, Domain, LeesEdwards},
    parallel::Peers,
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
        Test::of(crowds_move_alike_on_any_number_of_ranks),
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
    let problem = Problem::new(&domain, balls, weights, velocities, 1.0);
    project(session.world(), &problem, session.into())
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
    let Error::Contact { text, island, .. } = error else { panic!("{error:?}") };
    assert!(text.starts_with("contact of 2 bodies (1, 2) at 2 places failed: bodies are squeezed"), "{text}");
    let bytes = island.as_bytes();
    assert!(session.world().gather(bytes).chunks(bytes.len()).all(|other| other == bytes));
}

/// Bodies with their weights and the velocities that they want.
type RandomBodies<const D: usize> = (Vec<Ball<D>>, Vec<f64>, Vec<SVector<f64, D>>);

/// Balls of several sizes that do not overlap, some of them held, with random velocities.
fn random_bodies<const D: usize>(domain: &Domain<D>, tries: usize, speed: f64, seed: u64) -> RandomBodies<D> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut balls: Vec<Ball<D>> = Vec::new();
    for _ in 0..tries {
        let radius = 0.3 + 0.5 * random.random::<f64>();
        let place = |axis: usize, part: f64| match domain.periodic(axis) {
            true => part * domain.size[axis],
            false => radius + part * (domain.size[axis] - 2.0 * radius),
        };
        let center = SVector::from_fn(|axis, _| place(axis, random.random()));
        if balls.iter().all(|ball| domain.nearest_image(ball.center - center).norm() >= ball.radius + radius) {
            balls.push(Ball { center, radius });
        }
    }
    let weights: Vec<f64> =
        balls.iter().enumerate().map(|(body, ball)| if body % 11 == 3 { f64::INFINITY } else { ball.volume() }).collect();
    // a body that no contact moves must not press others against one like it
    let speed = |weight: &f64| if weight.is_infinite() { 0.01 * speed } else { speed };
    let velocities = weights.iter().map(|weight| SVector::from_fn(|_, _| random.random::<f64>() - 0.5) * speed(weight)).collect();
    (balls, weights, velocities)
}

/// Islands that lie on one rank, that span some, and that span all; pairs across seams and across images that slide; bodies that give no way.
fn crowds_move_alike_on_any_number_of_ranks(session: &Session) {
    let slide = |start| Axis::Sheared(LeesEdwards::steady(start, 3.0, 0.25));
    let periodic = |size: [f64; 2]| Domain { size: size.into(), axes: [Axis::Periodic; 2] };
    let sheared = |start| Domain { size: [20.0, 14.0].into(), axes: [Axis::Periodic, slide(start)] };
    let domains = [channel([20.0, 14.0]), channel([10.0, 30.0]), periodic([20.0, 14.0]), sheared(0.7), sheared(13.0)];
    let mut together = false;
    for (seed, domain) in domains.iter().enumerate() {
        for speed in [0.3, 4.0] {
            together |= assert_moves_alike(session, domain, &random_bodies(domain, 400, speed, seed as u64));
        }
    }
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let room = Domain { size: [7.0, 6.0, 5.0].into(), axes: [Axis::Periodic, Axis::Periodic, wall] };
    together |= assert_moves_alike(session, &room, &random_bodies(&room, 400, 2.0, 9));
    assert_eq!(together, session.world().size() > 1);
}

/// However islands that span ranks are solved, the answer is that of one rank; tells whether ranks solved one together.
fn assert_moves_alike<const D: usize>(session: &Session, domain: &Domain<D>, (balls, weights, velocities): &RandomBodies<D>) -> bool {
    let problem = Problem::new(domain, balls, weights, velocities, 1.0);
    let share = ProblemShare { problem, regions: &Regions::new(domain, 1), spanning: Spanning::Gathered };
    let alone = project_share(Peers::Alone, &share, &Memory::default()).unwrap().projection;
    assert!(alone.kkt_report.active > 3, "{:?}", alone.kkt_report);
    let mut together = false;
    for most_gathered in [0, 8, usize::MAX] {
        let shared = project(session.world(), &problem, Spanning::Together { session, most_gathered }).unwrap();
        for (one, other) in alone.velocities.iter().zip(&shared.velocities) {
            assert!((one - other).norm() < 1e-9, "{most_gathered}: {one} and {other}");
        }
        let [one, other] = [&alone, &shared].map(|found| found.kkt_report);
        assert_eq!((one.pairs, one.active, one.islands, one.rounds), (other.pairs, other.active, other.islands, other.rounds));
        assert!(
            (one.smallest_gap - other.smallest_gap).abs() < 1e-9 && (one.total_force - other.total_force).abs() < 1e-7 * one.total_force
        );
        assert!(alone.forces.iter().map(|force| force.contact.identity()).eq(shared.forces.iter().map(|force| force.contact.identity())));
        assert!(other.solver != Solver::Distributed || most_gathered < usize::MAX);
        together |= other.solver == Solver::Distributed;
    }
    together
}
