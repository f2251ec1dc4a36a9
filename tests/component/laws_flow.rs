//! Laws of contact in Stokes flow: bodies that rest where forces balance, and gluey contacts that let go when they were pulled as much.

use nalgebra::{SMatrix, Vector2};
use turbid::{
    body::Motion,
    flow::{Drive, InverseMethod},
    geometry::{Axis, Domain},
    motion::{Observation, Simulation},
    petsc::Session,
    plan::flow_solver,
    scene::{ConstraintMethod, ContactModel, Scheme, Step, TimeSection, Tolerance},
    setup::Setup,
};

use crate::Test;
use crate::suspension::suspended;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(every_law_keeps_two_disks_pressed_together_at_rest_in_symmetry),
        Test::of(a_chain_pressed_to_the_floor_sticks_until_it_was_pulled_as_much),
        Test::of(resistances_are_known_before_anything_is_built),
    ]
}

const GLUEY: ContactModel = ContactModel::Gluey { gamma_min: None };

/// Disks of radius 1 pulled by forces, in a channel of height 6 with fluid at rest.
fn channel(disks: &[([f64; 2], [f64; 2])]) -> Setup<2> {
    let still = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
    let body = |&(center, force): &([f64; 2], [f64; 2])| {
        suspended(Vector2::from(center), 1.0, Motion::Free { force: force.into(), torque: SMatrix::zeros() }, 4)
    };
    Setup {
        changing_drive: None,
        domain: Domain { size: Vector2::new(8.0, 6.0), axes: [Axis::Periodic, still] },
        spacing: 0.25,
        viscosity: 2.0,
        drive: Drive::Rest,
        bodies: disks.iter().map(body).collect(),
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: Default::default(),
        inverse: InverseMethod::Transform,
        tolerance: Tolerance::Fixed(1e-9),
    }
}

fn start(session: &Session, setup: Setup<2>, step: Step, contact: ContactModel) -> Simulation<2> {
    let time = TimeSection { step, end: 100.0, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None };
    Simulation::flowing(session, flow_solver(session, setup.with_contact(contact)).unwrap(), time)
}

fn step(simulation: &mut Simulation<2>) -> Observation<2> {
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap();
    observation
}

/// A repulsion lets them rest where it equals what presses: `touch (1 - gap/range)^2 = f`; the others where they touch. The pair lies
/// in the middle or across the boundary.
fn every_law_keeps_two_disks_pressed_together_at_rest_in_symmetry(session: &Session) {
    let repulsion = ContactModel::Repulsion { stiffness: 4.0, range: 0.2 };
    for (law, rest) in [(ContactModel::Inelastic, 0.0), (GLUEY, 0.0), (repulsion, 0.2 * (1.0 - 0.5))] {
        for middle in [4.0, 0.0] {
            let disks = [([middle - 1.045, 3.0], [10.0, 0.0]), ([middle + 1.045, 3.0], [-10.0, 0.0])];
            let length = if law == repulsion { Step::Auto } else { Step::Fixed(0.3) };
            let mut simulation = start(session, channel(&disks), length, law);
            let most = if law == repulsion { 300 } else { 20 };
            let mut observation = step(&mut simulation);
            for _ in 0..most {
                observation = step(&mut simulation);
                let [one, two] = [0, 1].map(|body| simulation.state().bodies[body].center - Vector2::new(middle, 3.0));
                // the flow is solved to 1e-9
                assert!((one + two).norm() < 1e-6, "{law:?}: {one} and {two} have lost their symmetry");
            }
            let [one, two] = [0, 1].map(|body| simulation.state().bodies[body].center);
            let gap = (two - one).norm() - 2.0;
            let slack = if law == repulsion { 2e-4 } else { 1e-6 };
            assert!((gap - rest).abs() < slack, "{law:?} at {middle}: they rest at a gap of {gap}, not {rest}");
            let active_contacts: Vec<_> = observation.contacts.iter().filter(|active| active.force != 0.0).collect();
            assert_eq!(active_contacts.len(), 1);
            assert!((active_contacts[0].force - 10.0).abs() < 0.05, "{law:?}: {} between them", active_contacts[0].force);
            let total = observation.solution.as_ref().unwrap().bodies.iter().map(|body| body.force).sum::<Vector2<f64>>();
            assert!(total.norm() < 1e-5, "{law:?}: forces are equal and opposite, {total}");
        }
    }
}

/// The lower of two disks touches the floor, the upper one touches it. A force on the upper one presses both contacts for a time 2,
/// then pulls: both let go at 4, and before that nothing moves. The memory is the impulse over the viscosity.
fn a_chain_pressed_to_the_floor_sticks_until_it_was_pulled_as_much(session: &Session) {
    let disks = |force: f64| channel(&[([4.0, 1.0], [0.0, 0.0]), ([4.0, 3.0], [0.0, force])]);
    let length = 0.1;
    let mut simulation = start(session, disks(-6.0), Step::Fixed(length), GLUEY);
    for number in 1..=45 {
        step(&mut simulation);
        let state = simulation.state();
        let heights = [0, 1].map(|body| state.bodies[body].center[1]);
        if number < 40 {
            let held = 6.0 / 2.0 * length * f64::from(if number <= 20 { number } else { 40 - number });
            assert_eq!(state.adhesive_contacts.len(), 2, "step {number}");
            for contact in &state.adhesive_contacts {
                assert!((contact.gamma + held).abs() < 1e-5, "step {number}: {} instead of {}", contact.gamma, -held);
            }
            assert!((heights[0] - 1.0).abs() < 1e-6 && (heights[1] - 3.0).abs() < 1e-6, "step {number}: {heights:?}");
        } else if number > 41 {
            // both have let go; the upper one is pulled off and takes some of the lower one with it through the fluid
            assert!(heights[1] > heights[0] + 2.0 + 1e-4 && heights[0] >= 1.0 - 1e-9, "step {number}: {heights:?}");
            assert!(state.adhesive_contacts.iter().all(|contact| contact.gamma > -1e-3), "{:?}", state.adhesive_contacts);
        }
        if number == 20 {
            let (state, past) = (simulation.state().clone(), None);
            simulation = start(session, disks(6.0), Step::Fixed(length), GLUEY);
            simulation.restore(state, turbid::mechanics::History { past, ..Default::default() }).unwrap();
        }
    }
}

/// Plans and refusals need no grid.
fn resistances_are_known_before_anything_is_built(session: &Session) {
    let setup = channel(&[([2.0, 2.0], [0.0, 0.0]), ([5.0, 3.0], [0.0, 0.0])]);
    let early = setup.resistance(&setup.bodies[0].body.ball);
    for resistance in flow_solver(session, setup).unwrap().resistance().of_bodies() {
        assert!((resistance / early - 1.0).abs() < 1e-12, "{resistance} and {early}");
    }
}
