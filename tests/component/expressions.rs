//! Forces that a scene gives by expressions: they do what the same forces do by other means.

use std::path::Path;

use nalgebra::{SMatrix, SVector};
use turbid::{
    contact::Contact,
    interaction::{Arrangement, Forces, Interaction, PairForce},
    motion::Simulation,
    observe::{self, Part},
    petsc::Session,
    plan::Plan,
    scene::Scene,
    setup::Moving,
};

use crate::{Test, conformance::stepper_conforms};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_pair_force_does_what_the_same_law_in_rust_does),
        Test::of(a_pair_force_in_space_does_what_the_same_law_in_rust_does),
        Test::of(constant_expressions_do_what_forces_and_torques_of_bodies_do),
        Test::of(forces_and_torques_on_bodies_count_in_the_viscosity_as_those_of_their_keys_do),
        Test::of(a_dry_body_in_a_trap_oscillates_as_its_spring_says),
        Test::of(a_force_that_changes_with_time_and_place_is_the_same_after_a_restart),
        Test::of(a_step_that_is_too_long_is_refused_by_the_name_of_the_force),
        Test::of(what_is_not_finite_for_the_radii_that_were_placed_is_refused),
        Test::of(a_scene_built_in_rust_is_written_with_its_expressions),
    ]
}

/// The law of the scenes below in Rust.
#[derive(Debug)]
struct Attraction;

impl<const D: usize> Interaction<D> for Attraction {
    fn name(&self) -> &'static str {
        "attraction"
    }

    fn describe(&self) -> String {
        "by the program".into()
    }

    fn reach(&self, _: f64) -> f64 {
        0.8
    }

    fn forces(&self, arrangement: &Arrangement<D>) -> Forces<D> {
        let force = |contact: Contact<D>| {
            let radii = [contact.body, contact.other()?].map(|body| arrangement.balls[body].radius);
            let size = -2.5 * (radii[0] + radii[1]) / contact.separation.powi(4) * (-contact.gap / 0.5).exp();
            Some(PairForce { contact, force: contact.normal * size, torques: [SMatrix::zeros(); 2] })
        };
        arrangement.near(0.8).into_iter().filter_map(force).collect::<Vec<_>>().into()
    }
}

const BY_EXPRESSION: &str =
    "interactions = [{ pair_force = \"-k * (a + b) / r^4 * exp(-gap / length)\", reach = 0.8, constants = { k = 2.5, length = 0.5 } }]\n";

/// Disks of two sizes, a rod and a chain, near each other and near images and walls.
const FLAT: &str = "resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\", tolerance = 1e-9 }\nlubrication = { model = \"pairwise\" }\n\
    contact = { model = \"inelastic\" }\ntime = { end = 0.2, step = 0.1 }\nclusters = [{ shape = \"rod\", beads = 2, radius = 0.5, centers = [[5.5, 2.5]] }]\n\
    chains = [{ centers = [[3.2, 4.5], [4.3, 4.6]], beads = 2, radius = 0.5, spacing = 1.1, stretch = 30.0 }]\n\
    bodies = [{ radius = 0.5, centers = [[0.4, 0.7], [2.0, 3.9]] }, { radius = 0.7, centers = [[1.7, 1.1], [7.5, 5.0]] }]\n";

/// Places at the end, and the relative viscosity of each step where it is known.
fn ran<const D: usize>(mut simulation: Simulation<D>) -> Vec<f64> {
    let mut numbers = Vec::new();
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        if let (Some(flow), Some(solution)) = (simulation.suspension(), &observation.solution) {
            let viscosity = observe::viscosity(flow.setup(), flow.grid(), solution, &observation.contacts).unwrap();
            numbers.extend(viscosity.map(|viscosity| viscosity.relative()));
        }
        if simulation.over() {
            numbers.extend(
                simulation.whole_state().centers().iter().flat_map(|center: &SVector<f64, D>| center.iter().copied().collect::<Vec<_>>()),
            );
            return numbers;
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

fn scene(text: &str) -> Scene {
    Scene::parse("expressions", Path::new("."), text, &[]).unwrap()
}

fn furthest(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// Exactly but for rounding, and otherwise than without the force.
fn does_the_same<const D: usize>(session: &Session, name: &str, text: &str) {
    let without = scene(text);
    let by_rust = Plan::<D>::of(&without).unwrap().with(Attraction).unwrap().simulation(session).unwrap();
    let by_expression = ran(Simulation::<D>::new(session, &scene(&format!("{text}{BY_EXPRESSION}"))).unwrap());
    let [by_rust, without] = [by_rust, Simulation::<D>::new(session, &without).unwrap()].map(ran);
    let (apart, moved) = (furthest(&by_expression, &by_rust), furthest(&by_expression, &without));
    assert!(apart < 1e-11 && moved > 1e-3, "{name}: {apart:.1e} from the law in Rust, {moved:.1e} from none");
}

fn a_pair_force_does_what_the_same_law_in_rust_does(session: &Session) {
    let sheared = "domain = { size = [9.0, 6.0] }\nflow = { drive = { shear_rate = 1.0, periodic = \"sheared\" } }\n";
    does_the_same::<2>(session, "a sheared box", &format!("{sheared}{FLAT}"));
    let walls = "domain = { size = [9.0, 6.0], y = { lower = [-3.0, 0.0], upper = [3.0, 0.0] } }\nflow = { model = \"navier-stokes\", density = 1.0 }\n";
    does_the_same::<2>(
        session,
        "walls and inertia",
        &format!("{walls}{}", FLAT.replace("end = 0.2, step = 0.1", "end = 0.06, step = 0.02")),
    );
    let dry = FLAT.lines().filter(|line| !["resolution", "method", "lubrication"].iter().any(|key| line.starts_with(key)));
    let dry: String = dry.map(|line| format!("{line}\n")).collect();
    does_the_same::<2>(
        session,
        "dry",
        &format!(
            "domain = {{ size = [9.0, 6.0] }}\nflow = {{ model = \"none\" }}\n{}",
            dry.replace("end = 0.2, step = 0.1", "end = 0.5, step = 0.05")
        ),
    );
}

fn a_pair_force_in_space_does_what_the_same_law_in_rust_does(session: &Session) {
    let text = "domain = { size = [4.0, 4.0, 4.0] }\nflow = { drive = { shear_rate = 1.0, periodic = \"sheared\" } }\nresolution = { cells_per_radius = 3 }\n\
        method = { inverse = \"transform\", tolerance = 1e-9 }\ntime = { end = 0.2, step = 0.1 }\n\
        bodies = [{ radius = 0.5, centers = [[1.0, 1.0, 2.0], [2.2, 1.2, 2.1], [3.6, 1.1, 2.0]] }]\n";
    does_the_same::<3>(session, "a sheared box in space", text);
}

/// A force and a torque by keys of bodies against the same by expressions, which act on each of two balls of a cluster.
fn constant_expressions_do_what_forces_and_torques_of_bodies_do(session: &Session) {
    let flat = "domain = { size = [6.0, 5.0], y = \"walls\" }\nresolution = { cells_per_radius = 3 }\ntime = { end = 0.1, step = 0.05 }\n";
    let groups = "bodies = [{ radius = 0.5, centers = [[1.5, 1.5]], KEYS }]\nclusters = [{ shape = \"rod\", beads = 2, radius = 0.5, centers = [[4.0, 2.5]], TWICE }]\n\
        chains = [{ centers = [[1.5, 3.5], [2.7, 3.6]], beads = 2, radius = 0.5, spacing = 1.2, stretch = 30.0, KEYS }]\n";
    let disk = "bodies = [{ radius = 0.5, centers = [[1.5, 1.5]], KEYS }]\n";
    let method = |word: &str| format!("method = {{ constraint = \"{word}\", tolerance = 1e-10 }}\n");
    let texts = [
        format!("{flat}{}{groups}", method("sharp")),
        format!("{flat}{}flow = {{ model = \"navier-stokes\", density = 1.0 }}\n{groups}", method("sharp")),
        format!("{flat}{}{disk}", method("mean-value")),
        format!("{flat}{}{disk}", method("distributed")),
        format!("{flat}{}{disk}", method("penalty")),
        format!("{flat}flow = {{ model = \"none\" }}\n{groups}").replace("resolution = { cells_per_radius = 3 }\n", ""),
    ];
    for text in texts {
        let by_keys =
            scene(&text.replace("KEYS", "force = [0.3, -1.0], torque = 0.4").replace("TWICE", "force = [0.6, -2.0], torque = 0.8"));
        let expressions = "interactions = [{ body_force = [\"0.3\", \"-k\"], torque = \"0.4*k\", constants = { k = 1.0 } }]\n";
        let by_expressions = scene(&format!("{expressions}{}", text.replace(", KEYS", "").replace(", TWICE", "")));
        let [by_keys, by_expressions] = [by_keys, by_expressions].map(|scene| turns::<2>(session, &scene));
        let apart = furthest(&by_keys, &by_expressions);
        assert!(apart < 1e-9 && by_keys.iter().any(|number| number.abs() > 1e-3), "{text}: {apart:.1e}");
    }
    let space = "domain = { size = [3.0, 3.0, 3.0], y = \"walls\" }\nresolution = { cells_per_radius = 3 }\nmethod = { tolerance = 1e-10 }\n\
        time = { end = 0.1, step = 0.05 }\nbodies = [{ radius = 0.5, centers = [[1.5, 1.5, 1.2]], KEYS }]\n";
    let by_keys = scene(&space.replace("KEYS", "force = [0.0, 0.2, -1.0], torque = [0.1, 0.2, 0.3]"));
    let expressions = "interactions = [{ body_force = [0, \"0.2\", \"-1\"], torque = [\"0.1\", \"0.2\", \"0.3\"] }]\n";
    let by_expressions = scene(&format!("{expressions}{}", space.replace(", KEYS", "")));
    let [by_keys, by_expressions] = [by_keys, by_expressions].map(|scene| turns::<3>(session, &scene));
    assert!(furthest(&by_keys, &by_expressions) < 1e-9, "{by_keys:?} and {by_expressions:?}");
}

/// Torques, and along moving walls forces without a net one, in the lower and the upper half of the box.
fn forces_and_torques_on_bodies_count_in_the_viscosity_as_those_of_their_keys_do(session: &Session) {
    let box_of = |more: &str, keys: [&str; 2], forces: &str| {
        scene(&format!(
            "domain = {{ size = [6.0, 5.0]{more} }}\nresolution = {{ cells_per_radius = 3 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-10 }}\n\
             time = {{ end = 0.2, step = 0.1 }}\nbodies = [{{ radius = 0.5, centers = [[1.5, 1.5]]{} }}, {{ radius = 0.5, centers = [[4.0, 3.0]]{} }}]\n{forces}",
            keys[0], keys[1]
        ))
    };
    let sliding = " }\nflow = { drive = { shear_rate = 1.0, periodic = \"sheared\" }";
    let walls = ", y = { lower = [-2.5, 0.0], upper = [2.5, 0.0] }";
    let keys = [", force = [0.7, -0.2], torque = 0.4", ", force = [-0.7, -0.2], torque = 0.4"];
    let forces = "interactions = [{ body_force = [\"max(-0.7, min(0.7, 100 * (2.25 - y)))\", -0.2], torque = \"0.4\" }]\n";
    for more in [sliding, walls] {
        let scenes = [box_of(more, [""; 2], ""), box_of(more, keys, ""), box_of(more, [""; 2], forces)];
        let [without, by_keys, by_expressions] = scenes.map(|scene| ran(Simulation::<2>::new(session, &scene).unwrap()));
        let (apart, changed) = (furthest(&by_keys, &by_expressions), (by_keys[0] - without[0]).abs());
        assert!(apart < 1e-8 && changed > 1e-3, "{more}: {apart:.1e} from that of keys, {changed:.1e} from none");
    }
    // with a net force along the walls it is that of the mean stress on both
    let pushed = box_of(walls, [""; 2], "interactions = [{ body_force = [\"0.5\", \"0\"] }]\n");
    let mut simulation = Simulation::<2>::new(session, &pushed).unwrap();
    let solution = simulation.evaluate(&mut |_, _| {}).unwrap().solution.unwrap();
    let flow = simulation.suspension().unwrap();
    let viscosity = observe::viscosity(flow.setup(), flow.grid(), &solution, &[]).unwrap().unwrap();
    let (all, interaction) = (viscosity.relative(), viscosity.parts.get(Part::Interaction).unwrap());
    assert!((all - viscosity.from_walls.unwrap()).abs() < 1e-6 && interaction.abs() > 1e-3, "{viscosity:?}");
}

/// How far bodies have gone and turned in the end.
fn turns<const D: usize>(session: &Session, scene: &Scene) -> Vec<f64> {
    let mut simulation = Simulation::<D>::new(session, scene).unwrap();
    let start = simulation.whole_state().into_owned();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    let end = simulation.whole_state();
    let pairs = end.bodies.iter().zip(&start.bodies);
    let change = |(end, start): (&Moving<D>, &Moving<D>)| {
        let (center, rotation) = (end.center - start.center, end.rotation - start.rotation);
        center.iter().chain(rotation.iter()).copied().collect::<Vec<_>>()
    };
    pairs.flat_map(change).collect()
}

/// A mass of `2 pi r^2 / 2` on a spring from the middle of the box, over a period, by a rule of second order.
fn a_dry_body_in_a_trap_oscillates_as_its_spring_says(session: &Session) {
    let text = "domain = { size = [8.0, 8.0] }\nflow = { model = \"none\" }\nbodies = [{ radius = 0.5, density = 2.0, centers = [[5.0, 4.0]] }]\n\
        time = { end = 2.0, step = 0.002 }\n\
        interactions = [{ name = \"trap\", body_force = [\"-k * (x - 4)\", \"-k * (y - 4)\"], torque = \"k * cos(time)\", constants = { k = 3.0 } }]\n";
    let scene = scene(text);
    let plan = Plan::<2>::of(&scene).unwrap().report(session.world().size()).unwrap().to_string();
    assert!(
        plan.contains(
            "built      trap: force (-k * (x - 4), -k * (y - 4)), torque k * cos(time) on each free body, stable with steps up to"
        ),
        "{plan}"
    );
    let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    let (state, mass) = (simulation.whole_state(), std::f64::consts::FRAC_PI_2);
    let (body, frequency) = (&state.bodies[0], (3.0 / mass).sqrt());
    let expected = 4.0 + (2.0 * frequency).cos();
    assert!((body.center.x - expected).abs() < 5e-3 && (body.center.y - 4.0).abs() < 1e-12, "{} and {expected}", body.center);
    // the integral of the torque over the moment of inertia
    let (spin, expected) = (body.twist.spin[(1, 0)], 3.0 * 2.0_f64.sin() / (mass * 0.125));
    assert!((spin.abs() - expected.abs()).abs() < 1e-2 * expected.abs(), "{spin} and {expected}");
}

fn a_force_that_changes_with_time_and_place_is_the_same_after_a_restart(session: &Session) {
    let text = "domain = { size = [9.0, 7.0] }\nflow = { drive = { mean_velocity = [0.3, 0.1] } }\nresolution = { spacing = 0.25 }\nmethod = { tolerance = 1e-10 }\n\
        contact = { model = \"inelastic\" }\ntime = { end = 1.5, step = 0.25 }\nbodies = [{ radius = 1.0, centers = [[1.2, 1.1], [3.3, 1.1], [5.6, 1.6], [2.2, 3.8]] }]\n\
        interactions = [{ body_force = [\"0.5 * sin(5 * time) * cos(2 * pi * y / 7)\", \"0.2 * x / 9\"], torque = \"time\" }, \
        { pair_force = \"-1 / r^2\", reach = 1.0 }]\n";
    let scene = scene(text);
    stepper_conforms(&|| Simulation::<2>::new(session, &scene).unwrap(), 1e-7);
}

const PAIR: &str =
    "domain = { size = [8.0, 8.0] }\nflow = { model = \"none\" }\nbodies = [{ radius = 0.5, sizes = [1.0, 1.4], count = 4 }]\n";

fn a_step_that_is_too_long_is_refused_by_the_name_of_the_force(_: &Session) {
    let stiff = "interactions = [{ name = \"glue\", pair_force = \"-k * gap\", reach = 1.0, constants = { k = 1e6 } }]\n";
    let plan = |step: &str| Plan::<2>::of(&scene(&format!("{PAIR}{stiff}time = {{ end = 1.0, step = {step} }}\n")));
    let refusal = plan("0.1").unwrap_err().to_string();
    assert!(refusal.contains("time.step = 0.1: is too long for the interactions (glue), which are stable up to"), "{refusal}");
    plan("1e-5").unwrap();
}

fn what_is_not_finite_for_the_radii_that_were_placed_is_refused(_: &Session) {
    // the radius of the group is 0.5, that of the larger ones 0.7
    let text = format!("{PAIR}time = {{ end = 1.0, step = 1e-3 }}\ninteractions = [{{ pair_force = \"sqrt(0.6 - b)\", reach = 1.0 }}]\n");
    let refusal = Plan::<2>::of(&scene(&text)).unwrap_err().to_string();
    assert!(
        refusal.contains("interactions[0].pair_force = \"sqrt(0.6 - b)\": is not finite, or infinitely steep, at a gap of 0"),
        "{refusal}"
    );
}

fn a_scene_built_in_rust_is_written_with_its_expressions(_: &Session) {
    let interactions = "interactions = [{ name = \"trap \\\"x\\\"\", body_force = [\"-k * x\", \"0\"], constants = { k = 3.0, m_2 = -1e-20 } }, \
        { pair_force = \"-1 / r^2\", reach = 1.0 }, { torque = \"time\" }]\n";
    let given = scene(&format!("{PAIR}time = {{ end = 1.0, step = 1e-3 }}\n{interactions}"));
    let built = given.clone().checked().unwrap();
    assert_eq!(built.interactions, given.interactions);
    assert_eq!((built.interactions.len(), built.interactions[1].name.as_str()), (3, "custom force"), "{}", built.text);
}
