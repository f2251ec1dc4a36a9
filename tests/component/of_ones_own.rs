//! Laws of contact, forces and quantities that are registered from outside, by what the library gives to anybody.

use nalgebra::{Matrix2, SMatrix, Vector2};
use turbid::{
    body::{Motion, Twist},
    contact::{Contact, ContactForce},
    geometry::{Axis, Ball, Domain},
    interaction::{Arrangement, ContactLaw, Forces, Inelastic, Interaction, Interactions, Touch, Wrench},
    motion::{GranularBody, GranularSetup, Simulation},
    petsc::Session,
    plan::flow_solver,
    run::{NewRun, Number, Options, Quantity, Run, RunFolder, View},
    scene::{AxisSection, BodyGroup, Placement, ResolutionSection, Scene, Scheme, Spacing, Step, TimeSection},
};

use crate::{
    Test,
    conformance::{conforms, setup, stepper_conforms},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_linear_law_of_contact_bounces_in_half_a_period_of_its_spring),
        Test::of(a_random_force_moves_dry_bodies_as_the_sum_of_its_impulses_does),
        Test::of(a_random_force_moves_bodies_in_a_flow_as_given_forces_do),
        Test::of(a_random_force_is_the_same_after_a_restart),
        Test::of(a_quantity_is_a_column_of_the_series_and_an_entry_of_the_summary),
    ]
}

/// A force in proportion to the overlap.
#[derive(Debug)]
struct Linear {
    stiffness: f64,
}

impl<const D: usize> Interaction<D> for Linear {
    fn name(&self) -> &'static str {
        "linear contact"
    }

    fn describe(&self) -> String {
        format!("force over overlap {}", self.stiffness)
    }

    fn contact(&self) -> ContactLaw<'_, D> {
        Touch::Soft { overlap: 0.1, remedy: "raise the stiffness" }.into()
    }

    fn steepest(&self, _: f64) -> f64 {
        self.stiffness
    }

    fn forces(&self, arrangement: &Arrangement<D>) -> Forces<D> {
        let force = |contact: Contact<D>| ContactForce::normal(contact, -self.stiffness * contact.gap);
        let contacts = arrangement.near(0.0).into_iter().filter(|contact| contact.gap < 0.0).map(force).collect();
        Forces { contacts, ..Forces::default() }
    }
}

/// A force of this size on each body, in a direction that body, time and seed decide, and a torque.
#[derive(Debug, Clone, Copy)]
struct Noise {
    seed: u64,
    force: f64,
}

impl Noise {
    /// A number from 0 to 1 that nothing but the arguments decides (splitmix64).
    fn draw(&self, body: usize, time: f64) -> f64 {
        let mut bits = self.seed ^ time.to_bits().wrapping_add((body as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        for (shift, factor) in [(30, 0xbf58_476d_1ce4_e5b9), (27, 0x94d0_49bb_1331_11eb)] {
            bits = (bits ^ (bits >> shift)).wrapping_mul(factor);
        }
        (bits ^ (bits >> 31)) as f64 / u64::MAX as f64
    }

    fn wrench(&self, body: usize, time: f64) -> Wrench<2> {
        let (sin, cos) = (std::f64::consts::TAU * self.draw(body, time)).sin_cos();
        let torque = 0.1 * self.force * cos;
        Wrench { force: Vector2::new(cos, sin) * self.force, torque: Matrix2::new(0.0, -torque, torque, 0.0) }
    }
}

impl Interaction<2> for Noise {
    fn name(&self) -> &'static str {
        "noise"
    }

    fn describe(&self) -> String {
        format!("random forces of {}", self.force)
    }

    fn forces(&self, arrangement: &Arrangement<2>) -> Forces<2> {
        let single = (0..arrangement.balls.len()).map(|place| (place, self.wrench(arrangement.number(place), arrangement.time)));
        Forces { single: single.collect(), ..Forces::default() }
    }
}

const NOISE: Noise = Noise { seed: 7, force: 0.5 };

fn dry(session: &Session, interactions: Interactions<2>, bodies: &[([f64; 2], [f64; 2])], time: TimeSection) -> Simulation<2> {
    let body = |&(center, velocity): &([f64; 2], [f64; 2])| GranularBody {
        radius: 0.5,
        center: center.into(),
        twist: Twist { velocity: velocity.into(), spin: SMatrix::zeros() },
        mass: 2.0,
        inertia: 0.25,
        acceleration: Vector2::zeros(),
        spin_up: SMatrix::zeros(),
    };
    let domain = Domain { size: Vector2::new(9.0, 7.0), axes: [Axis::Periodic; 2] };
    let setup =
        GranularSetup { domain, bodies: bodies.iter().map(body).collect(), trajectories: Default::default(), interactions, load: None };
    Simulation::granular(session, setup, time)
}

fn fixed(step: f64, end: f64, scheme: Scheme) -> TimeSection {
    TimeSection { step: Step::Fixed(step), end, scheme, travel: 0.1, error: 1e-3, until: None }
}

fn run(simulation: &mut Simulation<2>) {
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

/// Two bodies of mass 2 touch for half a period of a spring between masses of which the reduced one is 1, however fast they meet.
fn a_linear_law_of_contact_bounces_in_half_a_period_of_its_spring(session: &Session) {
    conforms(session, &Linear { stiffness: 3.0 });
    let (stiffness, speed, gap, end) = (400.0_f64, 0.2, 0.1, 0.8);
    let pair = [([3.0, 3.0], [speed, 0.0]), ([4.0 + gap, 3.0], [-speed, 0.0])];
    let interactions = Interactions::default().with(Linear { stiffness });
    let mut simulation = dry(session, interactions, &pair, fixed(0.002, end, Scheme::TwoStep));
    run(&mut simulation);
    let state = simulation.whole_state();
    let apart = (state.bodies[1].center - state.bodies[0].center).norm() - 1.0;
    let touching = std::f64::consts::PI / stiffness.sqrt();
    let expected = 2.0 * speed * (end - gap / (2.0 * speed) - touching);
    // a step ends where contact does or up to a step later, by which the bounce is late
    assert!((apart - expected).abs() < 2.0 * speed * 0.002, "{apart} and {expected}");
    assert!((state.bodies[0].twist.velocity[0] + speed).abs() < 5e-3 * speed, "{}", state.bodies[0].twist.velocity);
}

/// On any number of ranks, as nothing but body and time decides the force.
fn a_random_force_moves_dry_bodies_as_the_sum_of_its_impulses_does(session: &Session) {
    let (step, steps) = (0.01, 20);
    let bodies = [([1.2, 1.1], [0.0; 2]), ([5.4, 1.6], [0.1, 0.0]), ([2.2, 5.3], [0.0; 2]), ([7.6, 5.0], [0.0, -0.1])];
    let mut simulation = dry(session, Interactions::default().with(NOISE), &bodies, fixed(step, step * f64::from(steps), Scheme::Euler));
    let mut velocities: Vec<Vector2<f64>> = bodies.iter().map(|(_, velocity)| (*velocity).into()).collect();
    while !simulation.over() {
        let time = simulation.state().time;
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let length = simulation.step(&observation, &mut |_, _| {}).unwrap().length;
        velocities.iter_mut().enumerate().for_each(|(body, velocity)| *velocity += NOISE.wrench(body, time).force * (length / 2.0));
    }
    for (body, velocity) in simulation.whole_state().bodies.iter().zip(&velocities) {
        assert!((body.twist.velocity - velocity).norm() < 1e-14, "{} and {velocity}", body.twist.velocity);
    }
    let moved = |(velocity, body): (&Vector2<f64>, &([f64; 2], [f64; 2]))| (velocity - Vector2::from(body.1)).norm();
    assert!(velocities.iter().zip(&bodies).map(moved).fold(0.0, f64::max) > 1e-3, "the force moves nothing");
}

fn a_random_force_moves_bodies_in_a_flow_as_given_forces_do(session: &Session) {
    let twists = |setup| {
        let solution = flow_solver(session, setup).unwrap().solve(&mut |_, _| {}).unwrap();
        solution.bodies.iter().map(|body| body.twist).collect::<Vec<_>>()
    };
    let mut given = setup(Interactions::default());
    for (body, suspended) in given.bodies.iter_mut().enumerate() {
        let Wrench { force, torque } = NOISE.wrench(body, 0.0);
        suspended.body.motion = Motion::Free { force, torque };
    }
    let balls: Vec<Ball<2>> = given.bodies.iter().map(|suspended| suspended.body.ball).collect();
    let (by_noise, by_force) = (twists(setup(Interactions::default().with(NOISE))), twists(given));
    let still = twists(setup(Interactions::default()));
    let largest = |one: &[Twist<2>], other: &[Twist<2>]| {
        let apart = |((one, other), ball): ((&Twist<2>, &Twist<2>), &Ball<2>)| {
            (one.velocity - other.velocity).norm() + ball.radius * (one.spin - other.spin).norm()
        };
        one.iter().zip(other).zip(&balls).map(apart).fold(0.0, f64::max)
    };
    assert!(largest(&by_noise, &by_force) < 1e-8 && largest(&by_noise, &still) > 1e-3, "{by_noise:?} and {by_force:?}");
}

fn a_random_force_is_the_same_after_a_restart(session: &Session) {
    let start = || {
        let interactions = Interactions::default().with(NOISE).with(Inelastic);
        let suspension = flow_solver(session, setup(interactions)).unwrap();
        Simulation::flowing(session, suspension, fixed(0.25, 1.5, Scheme::TwoStep))
    };
    stepper_conforms(&start, 1e-7);
}

/// Two disks between walls that shear them.
fn sheared() -> Scene {
    let mut scene = Scene::new("own", &[2.0, 2.0]);
    scene.domain.axes[1] = AxisSection::Walls { lower: vec![-1.0, 0.0], upper: vec![1.0, 0.0] };
    scene.resolution = Some(ResolutionSection::new(Spacing::Length(0.1)));
    scene.bodies = vec![BodyGroup::new(0.3, Placement::Centers(vec![vec![0.5, 0.8], vec![1.5, 1.2]]))];
    scene.time = Some(TimeSection { step: Step::Fixed(0.1), ..TimeSection::to(0.3) });
    scene.checked().unwrap()
}

/// The mean square of heights above the middle of the box.
fn spread(view: &View<2>) -> Option<f64> {
    let motion = view.motion?;
    let heights = motion.state().bodies.iter().map(|body| body.center.y - 0.5 * motion.domain().size.y);
    let mut sums = [heights.clone().map(|height| height * height).sum(), heights.count() as f64];
    motion.state().peers(view.world).sum(&mut sums);
    Some(sums[0] / sums[1])
}

fn a_quantity_is_a_column_of_the_series_and_an_entry_of_the_summary(session: &Session) {
    let (world, scene) = (session.world(), sheared());
    let name = world.broadcast(0, &format!("turbid-own-quantity-{}", std::process::id()));
    let path = std::env::temp_dir().join(name);
    let folder = RunFolder::to_begin(world, &path, NewRun { scene: &scene, scene_file: None, overwrite: true }).unwrap();
    let mut run = Run::<2>::start(session, &scene, Some(folder), Options::default()).unwrap();
    run.measure(Quantity::new("spread", "area", "mean square of heights above the middle", spread)).unwrap();
    run.measure(Quantity::of_shear("normal_stress_ratio", "first normal over shear stress", |found| {
        Some(found.normal.first / found.relative())
    }))
    .unwrap();
    for taken in ["spread", "viscosity", "Spread"] {
        let refusal = run.measure(Quantity::new(taken, "", "", |_| Some(1.0))).unwrap_err().to_string();
        assert!(refusal.starts_with(&format!("quantity {taken}: ")), "{refusal}");
    }
    while run.advance().unwrap() {}
    let measured = run.row().iter().find(|entry| entry.column.name == "spread").map(|entry| entry.number);
    let (heights, ratio) = (run.state().unwrap().bodies.iter().map(|body| body.center.y - 1.0), run.viscosity().unwrap());
    let expected = heights.map(|height| height * height).sum::<f64>() / 2.0;
    let ratio = ratio.normal.first / ratio.relative();
    let summary = run.finish().unwrap().summary;
    assert_eq!(measured, Some(Number::Real(expected)));
    let found = &summary.quantities["spread"];
    assert_eq!((found.unit.as_str(), found.last, found.mean), ("area", Some(expected), None));
    assert_eq!((summary.quantities["normal_stress_ratio"].last, summary.quantities.contains_key("step")), (Some(ratio), false));
    if world.rank() == 0 {
        let series = turbid::output::Columns::read(&path.join("series.csv")).unwrap();
        assert_eq!((series.rows(), series.number("spread", 3), series.number("normal_stress_ratio", 3)), (4, Some(expected), Some(ratio)));
        std::fs::remove_dir_all(&path).unwrap();
    }
}
