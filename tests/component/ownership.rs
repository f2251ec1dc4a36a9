//! Granular bodies and the ranks that own them.

use nalgebra::{SMatrix, SVector, Vector2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use turbid::{
    body::{Regions, Twist, pack},
    geometry::{Axis, Domain},
    interaction::{Gluey, Inelastic, Interaction, Interactions, Repulsion},
    motion::{GranularBody, GranularSetup, Simulation},
    petsc::Session,
    scene::{Scheme, Step, TimeSection},
    setup::Share,
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![Test::of(bodies_go_to_the_ranks_that_own_their_places), Test::of(forces_across_ranks_are_opposite)]
}

const COUNT: usize = 80;

/// Disks of two sizes that fly about in a periodic box.
fn gas(session: &Session, contact: impl Interaction<2> + 'static, step: f64) -> Simulation<2> {
    let domain = Domain { size: SVector::from([12.0, 10.0]), axes: [Axis::Periodic; 2] };
    let radii: Vec<f64> = (0..COUNT).map(|body| if body % 3 == 0 { 0.5 } else { 0.4 }).collect();
    let centers = pack(&domain, &[], &radii, 0.05, 7).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut number = || 2.0 * random.random::<f64>() - 1.0;
    let body = |(center, radius): (SVector<f64, 2>, f64)| GranularBody {
        radius,
        center,
        twist: Twist { velocity: Vector2::new(number(), number()), spin: SMatrix::zeros() },
        mass: radius * radius,
        inertia: 0.5 * radius.powi(4),
        acceleration: SVector::zeros(),
        spin_up: SMatrix::zeros(),
    };
    let bodies = centers.into_iter().zip(radii).map(body).collect();
    let time = TimeSection { step: Step::Fixed(step), end: 40.0 * step, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None };
    Simulation::granular(
        session,
        GranularSetup { domain, bodies, trajectories: Default::default(), interactions: Interactions::default().with(contact), load: None },
        time,
    )
}

fn step(simulation: &mut Simulation<2>) {
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap();
}

/// Numbers of the bodies that this rank has.
fn own(simulation: &Simulation<2>) -> Vec<u64> {
    let state = simulation.state();
    (0..state.bodies.len()).map(|place| state.number(place) as u64).collect()
}

fn bodies_go_to_the_ranks_that_own_their_places(session: &Session) {
    let world = session.world();
    let mut simulation = gas(session, Inelastic, 0.1);
    let regions = Regions::new(simulation.domain(), world.size());
    let (first, mut moved) = (own(&simulation), 0.0);
    while !simulation.over() {
        step(&mut simulation);
        let mut all = world.gather(&own(&simulation));
        all.sort_unstable();
        assert!(all.into_iter().eq(0..COUNT as u64), "each body has one owner");
        let state = simulation.state();
        assert_eq!(matches!(state.share, Share::Own { .. }), world.size() > 1);
        assert!(state.bodies.iter().all(|body| world.size() == 1 || regions.owner(simulation.domain(), &body.center) == world.rank()));
        assert_eq!(simulation.radii().len(), state.bodies.len());
        for (place, &radius) in simulation.radii().iter().enumerate() {
            assert_eq!(radius, if state.number(place) % 3 == 0 { 0.5 } else { 0.4 });
        }
        moved += own(&simulation).iter().filter(|number| first.binary_search(number).is_err()).count() as f64;
    }
    assert!(world.size() == 1 || world.max(moved) > 10.0, "nobody has changed ranks");
}

/// In a periodic box nothing takes momentum away, if what one rank does to a body of another is what that body feels.
fn forces_across_ranks_are_opposite(session: &Session) {
    let momentum = |simulation: &Simulation<2>| {
        let (state, balls) = (simulation.whole_state(), simulation.whole_balls());
        let terms = state.bodies.iter().zip(&balls).map(|(body, ball)| body.twist.velocity * ball.radius.powi(2));
        terms.fold(Vector2::zeros(), |sum, term| sum + term)
    };
    let repulsion = Repulsion { touch: 2.0, range: 0.3 };
    let all = [gas(session, Inelastic, 0.1), gas(session, Gluey { least: f64::NEG_INFINITY }, 0.1), gas(session, repulsion, 0.01)];
    for (number, mut simulation) in all.into_iter().enumerate() {
        let before = momentum(&simulation);
        while !simulation.over() {
            step(&mut simulation);
        }
        let change = (momentum(&simulation) - before).norm();
        assert!(change < 1e-11, "interaction {number}: the momentum changes by {change:e}");
        assert_eq!(number == 1, !simulation.whole_state().adhesive_contacts.is_empty());
    }
}
