//! What every interaction and every stepper must keep, whichever it is: a new one is added to the lists here.

use std::collections::BTreeMap;

use nalgebra::{SMatrix, SVector, Vector2};
use turbid::{
    body::{Motion, Twist},
    constraint::{MultiplierLayout, Neighbourhood},
    contact::{Contact, ContactForce},
    error::Result,
    flow::{Drive, InverseMethod, Stokes, StokesInverse},
    geometry::{Axis, Ball, Domain},
    grid::Grid,
    interaction::{
        Arrangement, Expression, Forces, Gluey, Inelastic, Interaction, Interactions, Lubrication, PairForce, PairForceLaw, Repulsion,
    },
    mechanics::{FlowSolver, Suspension},
    motion::{GranularBody, GranularSetup, Simulation},
    petsc::{Session, Vector},
    plan::{Plan, flow_solver},
    scene::{BodyGroup, ConstraintMethod, FlowModel, Placement, Scene, Scheme, Step, TimeSection, Tolerance},
    setup::Setup,
};

use crate::{Test, suspension::suspended};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(every_interaction_conforms),
        Test::of(steppers_conform),
        Test::of(a_step_that_is_too_long_for_an_interaction_is_refused_by_its_name),
        Test::of(an_inverse_of_ones_own_is_one_implementation),
        Test::of(a_force_at_a_distance_moves_bodies_in_a_flow_as_its_wrench_does),
        Test::of(the_stress_of_a_force_at_a_distance_is_that_of_the_same_force_in_contact),
    ]
}

/// Springs of rest length zero between near bodies, with a torque that turns both: an interaction from outside.
#[derive(Debug)]
struct Springs {
    stiffness: f64,
    reach: f64,
}

impl<const D: usize> Interaction<D> for Springs {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn describe(&self) -> String {
        format!("of stiffness {} up to gaps of {}", self.stiffness, self.reach)
    }

    fn steepest(&self, _: f64) -> f64 {
        self.stiffness
    }

    fn reach(&self, _: f64) -> f64 {
        self.reach
    }

    fn forces(&self, arrangement: &Arrangement<D>) -> Forces<D> {
        let force = |contact: Contact<D>| {
            let force = contact.normal * (-self.stiffness * contact.separation);
            PairForce { contact, force, torques: [SMatrix::zeros(); 2] }
        };
        let near = arrangement.near(self.reach).into_iter().filter(|contact| contact.other().is_some());
        near.map(force).collect::<Vec<_>>().into()
    }
}

const SIZE: [f64; 2] = [9.0, 7.0];

fn domain() -> Domain<2> {
    Domain { size: SIZE.into(), axes: [Axis::Periodic; 2] }
}

/// Disks with gaps from 0.02 to 1, of two sizes, moved together.
fn disks(moved: Vector2<f64>) -> Vec<Ball<2>> {
    let places = [(1.2, 1.1, 1.0), (3.22, 1.1, 1.0), (5.4, 1.6, 1.0), (2.2, 3.3, 1.2), (4.6, 3.9, 1.2), (7.6, 5.0, 1.0)];
    places.map(|(x, y, radius)| Ball { center: Vector2::new(x, y) + moved, radius }).to_vec()
}

fn every_interaction_conforms(session: &Session) {
    conforms(session, &Inelastic);
    conforms(session, &Gluey { least: f64::NEG_INFINITY });
    conforms(session, &Repulsion { touch: 3.0, range: 0.4 });
    conforms(session, &Lubrication::new(1e-4));
    conforms(session, &Springs { stiffness: 2.0, reach: 0.5 });
    for force in ["-2.5*(a + b)/r^4*exp(-gap/0.1)", "3*max(0, 0.3 - gap)^2", "0.2*sin(9*r) - b/a"] {
        let expression = Expression::parse(force, &PairForceLaw::VARIABLES, &BTreeMap::new()).unwrap();
        conforms(session, &PairForceLaw::new(force.into(), expression, 0.5, [1.0, 1.2]).unwrap());
    }
}

fn a_step_that_is_too_long_for_an_interaction_is_refused_by_its_name(_: &Session) {
    let mut scene = Scene::new("springs", &SIZE);
    scene.flow.model = FlowModel::None;
    scene.bodies = vec![BodyGroup::new(1.0, Placement::Centers(vec![vec![2.0, 2.0], vec![4.2, 2.0]]))];
    scene.time = Some(TimeSection { step: Step::Fixed(0.1), ..TimeSection::to(1.0) });
    let scene = scene.checked().unwrap();
    let with = |stiffness: f64| Plan::<2>::of(&scene).unwrap().with(Springs { stiffness, reach: 0.5 });
    let refusal = with(1e4).unwrap_err().to_string();
    assert!(refusal.contains("time.step = 0.1: is too long for the interactions (springs)"), "{refusal}");
    with(1.0).unwrap();
}

pub fn conforms(session: &Session, interaction: &dyn Interaction<2>) {
    assert!(!interaction.name().is_empty() && !interaction.describe().is_empty(), "{interaction:?} says nothing of itself");
    let (domain, weights) = (domain(), vec![2.0; 6]);
    let wrenches = |balls: &[Ball<2>]| {
        let arrangement =
            Arrangement { domain: &domain, numbers: None, balls, weights: &weights, viscosity: Some(1.5), reach: f64::INFINITY, time: 0.0 };
        interaction.forces(&arrangement).on_bodies(balls.len(), &[])
    };
    let here = wrenches(&disks(Vector2::zeros()));
    let scale = here.iter().map(|wrench| wrench.force.norm()).fold(1.0, f64::max);
    let total: SVector<f64, 2> = here.iter().map(|wrench| wrench.force).sum();
    assert!(total.norm() < 1e-12 * scale, "{interaction:?} has a net force {total}");
    // across the periodic boundaries
    let there = wrenches(&disks(Vector2::new(4.4, -3.3)));
    for (one, other) in here.iter().zip(&there) {
        assert!((one.force - other.force).norm() < 1e-12 * scale, "{interaction:?} knows where the box begins");
    }
    slope_is_bounded(interaction);
    memory_is_consistent(interaction);
    rows_are_balanced(session, interaction);
}

/// A stiffness that is not said makes explicit steps unstable.
fn slope_is_bounded(interaction: &dyn Interaction<2>) {
    let domain = Domain { size: Vector2::new(40.0, 40.0), axes: [Axis::Periodic; 2] };
    let force = |gap: f64| {
        let balls = [0.0, 2.0 + gap].map(|x| Ball { center: Vector2::new(10.0 + x, 20.0), radius: 1.0 });
        let arrangement = Arrangement {
            domain: &domain,
            numbers: None,
            balls: &balls,
            weights: &[1.0; 2],
            viscosity: Some(1.0),
            reach: f64::INFINITY,
            time: 0.0,
        };
        interaction.forces(&arrangement).on_bodies(2, &[])[1].force[0]
    };
    for gap in [-0.01, 0.0, 0.01, 0.1, 0.3] {
        let slope = (force(gap + 1e-6) - force(gap - 1e-6)).abs() / 2e-6;
        assert!(slope <= interaction.steepest(1.0) * (1.0 + 1e-4), "{interaction:?} is steeper than it says: {slope} at {gap}");
    }
}

/// What is remembered of no force is nothing, and bounds that follow from what is remembered let contacts pull, in order.
fn memory_is_consistent(interaction: &dyn Interaction<2>) {
    let (domain, balls, weights) = (domain(), disks(Vector2::zeros()), vec![2.0; 6]);
    let arrangement = Arrangement {
        domain: &domain,
        numbers: None,
        balls: &balls,
        weights: &weights,
        viscosity: Some(1.5),
        reach: f64::INFINITY,
        time: 0.0,
    };
    let Some(law) = interaction.contact().memory else { return };
    assert!(law.remember(&arrangement, &[], &[], 0.1).is_empty() && law.lower_bounds(&arrangement, &[], 0.1).is_empty());
    let mut active_contacts: Vec<ContactForce<2>> =
        arrangement.near(0.5).into_iter().map(|contact| ContactForce::normal(contact, 1.0 + contact.gap)).collect();
    active_contacts.sort_by_key(|active| active.contact.identity());
    let memory = law.remember(&arrangement, &[], &active_contacts, 0.1);
    let bounds = law.lower_bounds(&arrangement, &memory, 0.1);
    assert_eq!(bounds.len(), memory.len());
    assert!(bounds.is_sorted_by_key(|bound| bound.contact.identity()));
    for bound in &bounds {
        let before = active_contacts.iter().find(|active| active.contact.identity() == bound.contact.identity()).unwrap();
        assert!((bound.force + before.force).abs() < 1e-12, "a step takes back what the one before it pressed: {bound:?}");
    }
    // once taken back it is forgotten
    let back: Vec<_> = active_contacts.iter().map(|active| ContactForce { force: -active.force, ..*active }).collect();
    assert!(law.remember(&arrangement, &memory, &back, 0.1).is_empty());
}

/// Rows resist, and neither push nor turn a pair that moves as one.
fn rows_are_balanced(session: &Session, interaction: &dyn Interaction<2>) {
    let (domain, balls) = (domain(), disks(Vector2::zeros()));
    let world = session.world();
    let grid = Grid::new(&domain, 0.25, world.size(), world.rank()).unwrap();
    let centers: Vec<_> = balls.iter().map(|ball| ball.center).collect();
    let layout = MultiplierLayout::new(&grid, &centers, &[13; 6], world.rank());
    let neighbourhood = Neighbourhood::alone(&domain, balls.clone(), vec![3; 6], Neighbourhood::reach(&balls));
    let Some(resistance) = interaction.resistance() else { return };
    let rows = resistance.rows(&neighbourhood, &layout);
    assert!(world.max(rows.films.len() as f64) > 0.0, "{interaction:?}");
    assert!(rows.imbalance < 1e-12, "{}", rows.imbalance);
    assert!(rows.films.iter().flat_map(|film| &film.relative_modes).all(|mode| mode.resistance > 0.0));
}

fn time(end: f64) -> TimeSection {
    TimeSection { step: Step::Auto, end, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None }
}

fn all_interactions() -> Interactions<2> {
    Interactions::default().with(Springs { stiffness: 0.5, reach: 0.5 }).with(Gluey { least: -1.0 })
}

fn granular(session: &Session) -> Simulation<2> {
    let body = |ball: &Ball<2>| GranularBody {
        radius: ball.radius,
        center: ball.center,
        twist: Twist { velocity: Vector2::new(0.3 - 0.1 * ball.center[1], 0.0), spin: SMatrix::zeros() },
        mass: 2.0,
        inertia: 1.0,
        acceleration: Vector2::new(0.0, -0.2),
        spin_up: SMatrix::zeros(),
    };
    let bodies = disks(Vector2::zeros()).iter().map(body).collect();
    Simulation::granular(
        session,
        GranularSetup { domain: domain(), bodies, trajectories: Default::default(), interactions: all_interactions(), load: None },
        time(1.0),
    )
}

pub fn setup(interactions: Interactions<2>) -> Setup<2> {
    let body = |ball: Ball<2>| suspended(ball.center, ball.radius, Motion::Free { force: Vector2::zeros(), torque: SMatrix::zeros() }, 3);
    Setup {
        changing_drive: None,
        domain: domain(),
        spacing: 0.25,
        viscosity: 1.5,
        drive: Drive::MeanVelocity(Vector2::new(0.3, 0.1)),
        bodies: disks(Vector2::zeros()).into_iter().map(body).collect(),
        inertia: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions,
        inverse: InverseMethod::Transform,
        tolerance: Tolerance::Fixed(1e-10),
    }
}

fn quasi_static(session: &Session) -> Simulation<2> {
    let suspension = flow_solver(session, setup(all_interactions())).unwrap();
    // neighbours move little relative to each other
    Simulation::flowing(session, suspension, TimeSection { travel: 0.02, error: 4e-5, ..time(1.5) })
}

fn steppers_conform(session: &Session) {
    stepper_conforms(&|| granular(session), 1e-13);
    stepper_conforms(&|| quasi_static(session), 1e-7);
}

/// Times grow and end where they should, nothing overlaps, and a state is all that a step depends on.
pub fn stepper_conforms(start: &dyn Fn() -> Simulation<2>, tolerance: f64) {
    let mut simulation = start();
    let (mut steps, end) = (0, if simulation.suspension().is_some() { 1.5 } else { 1.0 });
    while !simulation.over() {
        let before = simulation.whole_state().into_owned();
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let report = simulation.step(&observation, &mut |_, _| {}).unwrap();
        assert!(report.length > 0.0 && (simulation.state().time - before.time - report.length).abs() < 1e-14);
        assert!(report.kkt_report.is_some_and(|kkt_report| kkt_report.kkt_residual < 1e-7 && kkt_report.smallest_gap > -1e-9));
        let mut again = start();
        again.restore(before, turbid::mechanics::History::default()).unwrap();
        let observation = again.evaluate(&mut |_, _| {}).unwrap();
        again.step(&observation, &mut |_, _| {}).unwrap();
        for (one, other) in simulation.whole_state().bodies.iter().zip(&again.whole_state().bodies) {
            assert!((one.center - other.center).norm() < tolerance, "step {steps}: {} and {}", one.center, other.center);
        }
        steps += 1;
    }
    assert!(steps > 2 && (simulation.state().time - end).abs() < 1e-12, "{steps} steps to {}", simulation.state().time);
}

fn a_force_at_a_distance_moves_bodies_in_a_flow_as_its_wrench_does(session: &Session) {
    let springs = Springs { stiffness: 2.0, reach: 0.5 };
    let free = setup(Interactions::default());
    let balls: Vec<Ball<2>> = free.bodies.iter().map(|suspended| suspended.body.ball).collect();
    let arrangement = Arrangement {
        domain: &free.domain,
        numbers: None,
        balls: &balls,
        weights: &[1.0; 6],
        viscosity: None,
        reach: f64::INFINITY,
        time: 0.0,
    };
    let wrenches = springs.forces(&arrangement).on_bodies(6, &[]);
    let mut given = setup(Interactions::default());
    for (suspended, wrench) in given.bodies.iter_mut().zip(&wrenches) {
        suspended.body.motion = Motion::Free { force: wrench.force, torque: wrench.torque };
    }
    let twists = |setup: Setup<2>| {
        let solution = flow_solver(session, setup).unwrap().solve(&mut |_, _| {}).unwrap();
        solution.bodies.iter().map(|body| body.twist.velocity).collect::<Vec<_>>()
    };
    let (undisturbed, by_spring, by_force) = (twists(free), twists(setup(Interactions::default().with(springs))), twists(given));
    let largest = |others: &[SVector<f64, 2>]| by_spring.iter().zip(others).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    assert!(largest(&by_force) < 1e-8, "{by_spring:?} and {by_force:?}");
    assert!(largest(&undisturbed) > 1e-2, "the force moves nothing");
}

fn the_stress_of_a_force_at_a_distance_is_that_of_the_same_force_in_contact(_: &Session) {
    let (domain, balls) = (domain(), disks(Vector2::zeros()));
    let arrangement =
        Arrangement { domain: &domain, numbers: None, balls: &balls, weights: &[1.0; 6], viscosity: None, reach: f64::INFINITY, time: 0.0 };
    let contact = arrangement.near(0.5)[0];
    let stress = PairForce::from(&ContactForce::normal(contact, 3.0)).stress();
    let expected = contact.normal * contact.normal.transpose() * (-3.0 * contact.separation);
    assert!((stress - expected).norm() < 1e-14, "{stress}");
}

/// An inverse from outside: half of multigrid's, which a Krylov method does not mind.
struct HalfInverse(Box<dyn StokesInverse<2>>);

impl StokesInverse<2> for HalfInverse {
    fn exact(&self) -> bool {
        false
    }

    fn precondition(&mut self, stokes: &Stokes<2>, rhs: &Vector, x: &mut Vector) -> Result<()> {
        self.0.precondition(stokes, rhs, x)?;
        x.scale(0.5)
    }
}

fn an_inverse_of_ones_own_is_one_implementation(session: &Session) {
    let solved = |suspension: Result<Box<dyn FlowSolver<2>>>| {
        let solution = suspension.unwrap().solve(&mut |_, _| {}).unwrap();
        solution.bodies.iter().map(|body| body.twist.velocity).collect::<Vec<_>>()
    };
    let setup = setup(Interactions::default().with(Springs { stiffness: 2.0, reach: 0.5 }));
    let boxed = |suspension| Box::new(suspension) as Box<dyn FlowSolver<2>>;
    let own = |stokes: &Stokes<2>, grid: &Grid<2>| -> Result<Box<dyn StokesInverse<2>>> {
        Ok(Box::new(HalfInverse(InverseMethod::Hypre.set_up(stokes, grid)?)))
    };
    let (exact, by_half) = (solved(flow_solver(session, setup.clone())), solved(Suspension::with_inverse(session, setup, own).map(boxed)));
    let apart = exact.iter().zip(&by_half).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-7, "{apart:e}");
}
