//! An effect that is off does not exist: pairs of scenes with and without it. Without it nothing of it is built, which is counted; with it
//! at zero strength the answer is the same.

use std::path::Path;

use turbid::{
    body::components,
    mechanics::FlowSolver,
    motion::Simulation,
    petsc::{Class, ObjectCounts, Session},
    plan::{Plan, flow_solver},
    scene::Scene,
    setup::Setup,
    system::Cost,
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(all_objects_of_a_suspension_go_with_it),
        Test::of(no_bodies_no_multipliers_and_a_body_that_drifts_along_changes_no_flow),
        Test::of(no_motion_no_memory_of_solves_and_bodies_that_stay_are_solved_for_alike),
        Test::of(no_contact_no_certificate_and_bodies_that_do_not_touch_move_alike),
        Test::of(no_gravity_no_weight_and_a_weightless_body_moves_alike),
        Test::of(no_lubrication_no_film_and_bodies_far_apart_move_alike),
        Test::of(no_torque_and_a_torque_of_zero_are_alike),
        Test::of(no_drive_no_mean_values_and_a_drive_of_zero_is_alike),
        Test::of(no_fluid_not_one_object_and_no_pressure),
        Test::of(inertia_is_planned_where_a_scene_has_it_and_only_there),
        Test::of(frames_that_wait_for_steps_are_planned_so),
    ]
}

/// Two free disks between sliding walls.
const SHEARED: &str = r#"
[domain]
size = [4.0, 3.0]
y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }
[resolution]
cells_per_radius = 4
[method]
inverse = "hypre"
tolerance = 1e-11
[[bodies]]
radius = 0.5
centers = [[1.0, 1.4], [2.8, 1.7]]
"#;

/// Rounding and the tolerance of the linear solver.
const SAME: f64 = 1e-8;

fn scene(text: &str, changes: &[&str]) -> Scene {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    Scene::parse("effect", Path::new("."), text, &changes).unwrap()
}

/// What was found at an instant, and what was built for it.
struct Built {
    /// Motions, forces and torques of the bodies, and the mean velocity.
    numbers: Vec<f64>,
    /// Objects that were alive after the solve.
    counts: ObjectCounts,
    suspension: Box<dyn FlowSolver<2>>,
    cost: Cost,
}

fn instant(session: &Session, scene: &Scene) -> Built {
    let before = ObjectCounts::local_now();
    let mut suspension = flow_solver(session, Setup::<2>::of(scene).unwrap()).unwrap();
    let solution = suspension.solve(&mut |_, _| {}).unwrap();
    let mut numbers = solution.mean_velocity.as_slice().to_vec();
    for body in &solution.bodies {
        numbers.extend(body.twist.velocity.iter().chain(body.force.iter()));
        numbers.extend(components(&body.twist.spin).iter().chain(&components(&body.torque)));
    }
    let cost = solution.cost;
    drop(solution);
    Built { numbers, counts: ObjectCounts::local_now().since(&before), suspension, cost }
}

fn assert_same(what: &str, one: &[f64], two: &[f64]) {
    assert_eq!(one.len(), two.len(), "{what}");
    let furthest = one.iter().zip(two).map(|(one, two)| (one - two).abs()).fold(0.0, f64::max);
    assert!(furthest < SAME, "{what}: {one:?} and {two:?} differ by {furthest:.1e}");
}

fn plan(session: &Session, scene: &Scene) -> String {
    Plan::<2>::of(scene).unwrap().report(session.world().size()).unwrap().to_string()
}

/// The count counts down as well as up: what the other tests rely on.
fn all_objects_of_a_suspension_go_with_it(session: &Session) {
    let before = ObjectCounts::local_now();
    let built = instant(session, &scene(SHEARED, &[]));
    let classes = [Class::Vector, Class::Matrix, Class::Solver, Class::Preconditioner];
    assert!(classes.iter().all(|&class| built.counts.of(class) > 0), "{:?}", built.counts);
    assert_eq!(built.counts.total(), ObjectCounts::local_now().total() - before.total());
    drop(built);
    assert_eq!(ObjectCounts::local_now(), before);
}

/// A free body in a uniform flow is at zero strength: it moves with the fluid and disturbs nothing.
fn no_bodies_no_multipliers_and_a_body_that_drifts_along_changes_no_flow(session: &Session) {
    let uniform = ["domain.y=periodic", "flow.drive.mean_velocity=[1.0, 0.5]", "resolution.spacing=0.125"];
    let with = instant(session, &scene(SHEARED, &uniform));
    let without = instant(session, &scene(SHEARED, &[&uniform[..], &["bodies=[]"]].concat()));
    assert_eq!((without.cost.multiplier_unknowns, without.cost.assembled), (0, 0));
    assert!(with.cost.multiplier_unknowns > 0);
    assert_same("mean velocity", &with.numbers[..2], &without.numbers);
    assert_same("velocity of the body", &with.numbers[2..4], &[1.0, 0.5]);
    assert_same("velocity of the empty box", &without.numbers, &[1.0, 0.5]);
}

/// Bodies that are held stay where they are: every step finds what the instant finds.
fn no_motion_no_memory_of_solves_and_bodies_that_stay_are_solved_for_alike(session: &Session) {
    let held = ["bodies.0.motion=fixed"];
    let without = instant(session, &scene(SHEARED, &held));
    assert!(without.suspension.history(f64::INFINITY).past.is_none());
    let moving = scene(SHEARED, &[&held[..], &["time.end=0.3", "time.step=0.1"]].concat());
    let before = ObjectCounts::local_now();
    let mut simulation = Simulation::<2>::new(session, &moving).unwrap();
    let mut steps = 0;
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let found: Vec<f64> =
            observation.solution.iter().flat_map(|solution| solution.bodies.iter().flat_map(|body| body.force.data.0[0])).collect();
        let forces: Vec<f64> = [4, 5, 10, 11].map(|place| without.numbers[place]).to_vec();
        assert_same("forces", &found, &forces);
        if simulation.over() {
            break;
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
        steps += 1;
    }
    assert_eq!(steps, 3);
    assert!(simulation.suspension().unwrap().history(f64::INFINITY).past.is_some());
    let built = ObjectCounts::local_now().since(&before);
    assert!(built.of(Class::Vector) > without.counts.of(Class::Vector), "{built:?} and {:?}", without.counts);
    assert_eq!(built.of(Class::Matrix), without.counts.of(Class::Matrix));
}

fn no_contact_no_certificate_and_bodies_that_do_not_touch_move_alike(session: &Session) {
    let run = |model: &str| {
        let scene = scene(SHEARED, &["time.end=0.2", "time.step=0.1", &format!("contact.model={model}")]);
        let before = ObjectCounts::local_now();
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        let mut certificates = 0;
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            assert!(observation.contacts.is_empty());
            let report = simulation.step(&observation, &mut |_, _| {}).unwrap();
            certificates += usize::from(report.kkt_report.is_some());
        }
        let centers: Vec<f64> = simulation.state().centers().iter().flat_map(|center| center.data.0[0]).collect();
        (centers, certificates, ObjectCounts::local_now().since(&before))
    };
    let (with, without) = (run("inelastic"), run("none"));
    assert_eq!((without.1, with.1), (0, 2));
    assert_eq!(without.2, with.2, "contacts that do not press are no unknowns");
    assert_same("centres", &with.0, &without.0);
}

fn no_gravity_no_weight_and_a_weightless_body_moves_alike(session: &Session) {
    let without = instant(session, &scene(SHEARED, &[]));
    let weightless = ["gravity=[0.0, 0.0]", "gravity=[0.0, -1.0]"].map(|gravity| {
        let text = scene(SHEARED, &[gravity, "flow.density=1.0", "bodies.0.density=1.0"]);
        assert!(plan(session, &text).contains("not built  gravity"), "{gravity}");
        instant(session, &text)
    });
    for with in &weightless {
        assert_same("zero weight", &with.numbers, &without.numbers);
        assert_eq!(with.counts, without.counts);
    }
    let heavy = scene(SHEARED, &["gravity=[0.0, -1.0]"]);
    assert!(plan(session, &heavy).contains("built      gravity: [0.0, -1.0], weight of free bodies"));
    assert!((instant(session, &heavy).numbers[5] - without.numbers[5]).abs() > 0.1, "the fluid bears the weight");
}

/// Bodies beyond the reach of films are at zero strength.
fn no_lubrication_no_film_and_bodies_far_apart_move_alike(session: &Session) {
    let modes = "resolution.modes=3";
    let without = instant(session, &scene(SHEARED, &[modes]));
    let with = instant(session, &scene(SHEARED, &[modes, "lubrication.model=pairwise"]));
    assert_same("films out of reach", &with.numbers, &without.numbers);
    assert_eq!(with.counts, without.counts);
    let near = [modes, "bodies.0.centers=[[1.0, 1.4], [2.01, 1.45]]"];
    let resolved = instant(session, &scene(SHEARED, &near));
    let lubricated = instant(session, &scene(SHEARED, &[&near[..], &["lubrication.model=pairwise"]].concat()));
    let slower = |built: &Built| (built.numbers[2] - built.numbers[8]).abs();
    assert!(slower(&lubricated) < 0.9 * slower(&resolved), "{} {}", slower(&lubricated), slower(&resolved));
}

fn no_torque_and_a_torque_of_zero_are_alike(session: &Session) {
    let without = instant(session, &scene(SHEARED, &[]));
    let with = instant(session, &scene(SHEARED, &["bodies.0.torque=0.0", "bodies.0.force=[0.0, 0.0]"]));
    assert_same("zero torque", &with.numbers, &without.numbers);
    assert_eq!(with.counts, without.counts);
    assert!(plan(session, &scene(SHEARED, &["bodies.0.motion=fixed"])).contains("not built  rotation"));
    let turned = instant(session, &scene(SHEARED, &["bodies.0.torque=0.5"]));
    assert!((turned.numbers[6] - without.numbers[6]).abs() > 0.1, "a torque turns");
}

fn no_drive_no_mean_values_and_a_drive_of_zero_is_alike(session: &Session) {
    let without = scene(SHEARED, &[]);
    assert!(plan(session, &without).contains(" 0 mean values"));
    let found = instant(session, &without);
    for drive in ["pressure_gradient=[0.0, 0.0]", "body_force=[0.0, 0.0]"] {
        let with = instant(session, &scene(SHEARED, &[&format!("flow.drive.{drive}")]));
        assert_same(drive, &with.numbers, &found.numbers);
        assert_eq!(with.counts, found.counts, "{drive}");
    }
    // a mean velocity is held by a force that is to be found
    assert!(plan(session, &scene(SHEARED, &["flow.drive.mean_velocity=[0.0, 0.0]"])).contains(" 1 mean values"));
}

const DRY: &str = r#"
[domain]
size = [4.0, 3.0]
y = "walls"
[flow]
model = "none"
[[bodies]]
radius = 0.5
centers = [[1.0, 1.0], [2.6, 1.7]]
velocity = [0.5, -1.0]
[contact]
model = "inelastic"
[time]
end = 1.0
step = 0.1
"#;

fn no_fluid_not_one_object_and_no_pressure(session: &Session) {
    let before = ObjectCounts::local_now();
    let scene = scene(DRY, &[]);
    let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        assert!(observation.solution.is_none());
        simulation.step(&observation, &mut |_, _| {}).unwrap();
        assert_eq!(ObjectCounts::local_now(), before);
    }
    assert!(simulation.suspension().is_none());
    let said = plan(session, &scene);
    for effect in ["flow", "pressure", "gravity", "fields output"] {
        assert!(said.contains(&format!("not built  {effect}\n")), "{effect} in {said}");
    }
    for effect in ["inertia", "rotation", "contact", "motion in time"] {
        assert!(said.contains(&format!("built      {effect}:")), "{effect} in {said}");
    }
}

fn inertia_is_planned_where_a_scene_has_it_and_only_there(session: &Session) {
    let said = plan(session, &scene(SHEARED, &["time.end=1.0"]));
    for effect in ["inertia", "lubrication", "contact", "gravity"] {
        assert!(said.contains(&format!("not built  {effect}\n")), "{effect} in {said}");
    }
    let heavy = ["time.end=1.0", "flow.model=navier-stokes", "flow.density=2.0", "bodies.0.density=3.0"];
    let said = plan(session, &scene(SHEARED, &heavy));
    assert!(said.contains("built      inertia: fluid of density 2") && said.contains("built      navier-stokes flow:"), "{said}");
    assert!(!said.contains("not built  inertia"), "{said}");
}

fn frames_that_wait_for_steps_are_planned_so(session: &Session) {
    let frames = ["time.end=1.0", "output.every=0.3"];
    let said = plan(session, &scene(SHEARED, &frames));
    assert!(said.contains("built      frames: bodies every 0.3, with the first step at or after each multiple of that\n"), "{said}");
    let said = plan(session, &scene(SHEARED, &[&frames[..], &["time.step=0.1"]].concat()));
    assert!(said.contains("built      frames: bodies every 0.3\n"), "{said}");
}
