//! Rigid clusters: balls that move as one body.

use std::path::Path;

use nalgebra::{Matrix2, SVector, Vector2};
use turbid::{
    error::Error,
    mechanics::{FlowSolver, Suspension},
    motion::Simulation,
    observe,
    petsc::Session,
    scene::Scene,
    setup::Setup,
};

use crate::Test;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(clusters_between_walls_are_rigid_and_their_stress_is_that_on_the_walls),
        Test::of(a_rod_in_a_turning_fluid_turns_at_second_order_in_time),
        Test::of(a_cluster_moves_as_a_stiff_chain_does),
        Test::of(a_dense_cluster_is_as_hard_to_turn_as_its_moment_of_inertia),
        Test::of(clusters_pressed_into_a_corner_do_not_overlap),
        Test::of(clusters_without_room_are_refused),
        Test::of(where_the_box_cuts_clusters_changes_nothing_in_2d),
        Test::of(where_the_box_cuts_clusters_changes_nothing_in_3d),
        Test::of(random_rods_in_a_sheared_box_have_one_viscosity_at_an_instant_and_in_time),
    ]
}

fn scene(text: &str) -> Scene {
    Scene::parse("clusters", Path::new("."), text, &[]).unwrap()
}

const FLOW: &str = "flow = { model = \"stokes\", viscosity = 1.0 }\n";

/// Clusters of all kinds between sliding walls, the walls' velocities being such.
fn many_clusters(lubrication: &str) -> String {
    format!(
        "seed = 3\ndomain = {{ size = [10.0, 8.0], y = {{ lower = [-1.0, 0.0], upper = [1.0, 0.0] }} }}\n{FLOW}\
         resolution = {{ cells_per_radius = 4 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-8 }}\n\
         lubrication = {{ model = \"{lubrication}\" }}\ncontact = {{ model = \"inelastic\" }}\ntime = {{ end = 0.5, step = 0.1 }}\n\
         clusters = [\n{{ shape = \"rod\", beads = 3, radius = 0.5, count = 3 }},\n{{ shape = \"triangle\", spacing = 1.1, radius = 0.5, count = 2 }},\n\
         {{ offsets = [[0.0, 0.0], [1.0, 0.1], [1.5, -0.9]], radius = 0.5, count = 2 }},\n{{ shape = \"cross\", radius = 0.5, count = 1 }}]\n\
         bodies = [{{ count = 4, radius = 0.5 }}]\n"
    )
}

fn clusters_between_walls_are_rigid_and_their_stress_is_that_on_the_walls(session: &Session) {
    for lubrication in ["none", "pairwise"] {
        let scene = scene(&many_clusters(lubrication));
        let mut suspension = Suspension::<2>::new(session, Setup::of(&scene).unwrap()).unwrap();
        let solution = suspension.solve(&mut |_, _| {}).unwrap();
        let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap();
        let (parts, walls) = (viscosity.relative(), viscosity.from_walls.unwrap());
        assert!((parts / walls - 1.0).abs() < if lubrication == "none" { 1e-6 } else { 1e-4 } && parts > 1.5, "{parts} {walls}");
        let mut simulation = Simulation::<2>::new(session, &scene).unwrap();
        let start = simulation.state().centers();
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        let now = simulation.state();
        for cluster in suspension.setup().interactions.clusters() {
            for (one, other) in cluster.bodies.clone().zip(cluster.bodies.clone().skip(1)) {
                let distance = |centers: &[Vector2<f64>]| (centers[one] - centers[other]).norm();
                assert!((distance(&now.centers()) - distance(&start)).abs() < 1e-13);
                let [one, other] = [one, other].map(|body| now.bodies[body].rotation);
                assert!((one - other).norm() < 1e-13 && (one - Matrix2::identity()).norm() > 1e-4);
            }
        }
    }
}

/// Between walls that slide, until it has nearly turned to lie along them: the angle with steps of 0.4, 0.2 and 0.1.
fn a_rod_in_a_turning_fluid_turns_at_second_order_in_time(session: &Session) {
    let angle = |step: f64| {
        let text = format!(
            "domain = {{ size = [8.0, 8.0], y = {{ lower = [-4.0, 0.0], upper = [4.0, 0.0] }} }}\n{FLOW}\
             resolution = {{ cells_per_radius = 4 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-9 }}\n\
             clusters = [{{ shape = \"rod\", beads = 3, radius = 0.5, centers = [[4.1, 4.2]], rotation = 1.5 }}]\ntime = {{ end = 3.2, step = {step} }}\n"
        );
        let mut simulation = Simulation::<2>::new(session, &scene(&text)).unwrap();
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        let rotation = simulation.state().bodies[1].rotation;
        rotation[(1, 0)].atan2(rotation[(0, 0)])
    };
    let [long, half, quarter] = [0.4, 0.2, 0.1].map(angle);
    let order = ((long - half) / (half - quarter)).abs().log2();
    assert!(order > 1.6 && (-1.35..-1.25).contains(&quarter), "order {order}: {long} {half} {quarter}");
}

/// Pulled along their length, where no bead would turn: across it those of a chain do, those of a cluster do not, and it is slower by 8 %.
fn a_cluster_moves_as_a_stiff_chain_does(session: &Session) {
    let centers = "[[3.0, 4.0], [4.2, 4.0], [5.4, 4.0]]";
    let velocities = |bodies: &str| -> Vec<SVector<f64, 2>> {
        let text = format!(
            "domain = {{ size = [8.0, 8.0] }}\n{FLOW}resolution = {{ cells_per_radius = 4 }}\n\
             method = {{ inverse = \"transform\", tolerance = 1e-8 }}\ntime = {{ end = 0.1, step = 0.1 }}\n{bodies}\n"
        );
        let mut simulation = Simulation::<2>::new(session, &scene(&text)).unwrap();
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        observation.twists.iter().map(|twist| twist.velocity).collect()
    };
    let chain = velocities(&format!(
        "chains = [{{ centers = {centers}, beads = 3, radius = 0.5, spacing = 1.2, stretch = \"rigid\", bend = 1e7, force = [1.0, 0.0] }}]"
    ));
    let cluster =
        velocities("clusters = [{ shape = \"rod\", beads = 3, radius = 0.5, spacing = 1.2, centers = [[4.2, 4.0]], force = [3.0, 0.0] }]");
    let fastest = cluster.iter().map(|velocity| velocity.norm()).fold(0.0, f64::max);
    let apart = chain.iter().zip(&cluster).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-3 * fastest, "{apart} of {fastest}: {chain:?} {cluster:?}");
}

/// A hundred times as dense as a thin fluid, which adds a hundredth to what its balls are and as much for what moves around them.
fn a_dense_cluster_is_as_hard_to_turn_as_its_moment_of_inertia(session: &Session) {
    let text = "domain = { size = [8.0, 8.0] }\nflow = { model = \"navier-stokes\", viscosity = 0.1, density = 1.0 }\n\
                resolution = { cells_per_radius = 4 }\nmethod = { inverse = \"transform\", tolerance = 1e-8 }\ntime = { end = 0.05, step = 0.01 }\n\
                clusters = [{ shape = \"rod\", beads = 3, radius = 0.5, density = 100.0, torque = 30.0, centers = [[4.1, 4.2]] }]\n";
    let mut simulation = Simulation::<2>::new(session, &scene(text)).unwrap();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    let mass = 100.0 * std::f64::consts::PI * 0.25;
    let alone = 30.0 * 0.05 / (3.0 * mass * 0.125 + 2.0 * mass);
    let (twists, bodies) = (simulation.evaluate(&mut |_, _| {}).unwrap().twists, &simulation.state().bodies);
    for (body, twist) in bodies.iter().zip(&twists) {
        let spin = twist.spin[(1, 0)];
        assert!((spin / alone - 0.985).abs() < 0.012, "{spin} of {alone}");
        let arm = body.center - bodies[1].center;
        assert!((twist.velocity - twists[1].velocity - twist.spin * arm).norm() < 1e-6 * alone);
    }
}

/// A cross and a rod pressed into a corner: wherever they touch, they turn, slide and hold.
fn clusters_pressed_into_a_corner_do_not_overlap(session: &Session) {
    let text = format!(
        "domain = {{ size = [8.0, 6.0], x = \"walls\", y = \"walls\" }}\n{FLOW}resolution = {{ cells_per_radius = 3 }}\n\
         contact = {{ model = \"inelastic\" }}\ntime = {{ end = 8.0 }}\nclusters = [\n\
         {{ shape = \"cross\", radius = 0.4, centers = [[1.9, 1.9]], rotation = 0.3, force = [-40.0, -40.0] }},\n\
         {{ shape = \"rod\", beads = 5, radius = 0.4, centers = [[5.3, 3.6]], rotation = 0.6, force = [-30.0, -30.0] }}]\n"
    );
    let mut simulation = Simulation::<2>::new(session, &scene(&text)).unwrap();
    let mut most = 0;
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        most = most.max(observation.contacts.iter().filter(|active| active.force > 1.0).count());
        simulation.step(&observation, &mut |_, _| {}).unwrap();
        let centers = simulation.state().centers();
        for (one, other) in (0..5).flat_map(|one| (5..10).map(move |other| (one, other))) {
            let gap = (centers[one] - centers[other]).norm() - 0.8;
            assert!(gap > -1e-6, "{gap} at {}", simulation.state().time);
        }
        assert!(centers.iter().all(|center| center.iter().all(|place| *place > 0.4 - 1e-6)));
    }
    assert!(most >= 2, "{most}");
}

fn clusters_without_room_are_refused(_: &Session) {
    let refusal_of = |cluster: &str| {
        let text = format!(
            "domain = {{ size = [8.0, 8.0] }}\n{FLOW}resolution = {{ cells_per_radius = 3 }}\nclusters = [{{ radius = 0.5, {cluster} }}]\n"
        );
        let Err(Error::Refused(refusal)) = Setup::<2>::of(&scene(&text)) else { panic!("{cluster} is not refused") };
        (refusal.key.clone().unwrap(), refusal.remedy.clone())
    };
    let (key, remedy) = refusal_of("shape = \"triangle\", count = 26");
    assert!(key == "clusters[0].count" && remedy.starts_with("leaves no place for number "), "{key} {remedy}");
    let (key, remedy) = refusal_of("shape = \"rod\", beads = 9, count = 1");
    assert!(key == "clusters[0].radius" && remedy.starts_with("is of clusters 9 long, and domain.size is 8 at most"), "{key} {remedy}");
}

/// Viscosity of a box whose images shear at unit rate: at an instant, and in each row in time.
fn sheared<const D: usize>(session: &Session, text: &str, time: &str) -> (f64, Vec<f64>) {
    let drive = |more: &str| text.replace("SHEAR", &format!("shear_rate = 1.0{more}"));
    let mut suspension = Suspension::<D>::new(session, Setup::of(&scene(&drive(""))).unwrap()).unwrap();
    let solution = suspension.solve(&mut |_, _| {}).unwrap();
    let at_once = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap().relative();
    let mut simulation = Simulation::<D>::new(session, &scene(&format!("{}{time}", drive(", periodic = \"sheared\"")))).unwrap();
    let mut rows = Vec::new();
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let (flow, solution) = (simulation.suspension().unwrap(), observation.solution.as_ref().unwrap());
        rows.push(observe::viscosity(flow.setup(), flow.grid(), solution, &[]).unwrap().unwrap().relative());
        if simulation.over() {
            return (at_once, rows);
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

/// A rod in the middle and moved by whole cells so that an end, or two of three balls, lie in another image: the same at an instant, and as in time.
fn where_the_box_cuts_clusters_changes_nothing_in_2d(session: &Session) {
    let rod = |x: f64, y: f64| {
        let text = format!(
            "domain = {{ size = [8.0, 8.0] }}\nflow = {{ drive = {{ SHEAR }} }}\nresolution = {{ spacing = 0.125 }}\n\
             method = {{ inverse = \"transform\", tolerance = 1e-9 }}\n\
             clusters = [{{ shape = \"rod\", beads = 3, radius = 0.5, centers = [[{x}, {y}]], rotation = 0.8 }}]\n"
        );
        sheared::<2>(session, &text, "time = { end = 0.125, step = 0.03125 }\n")
    };
    let (middle, rows) = rod(4.0, 4.0);
    assert!((middle - 1.11772).abs() < 1e-4 && (rows[0] / middle - 1.0).abs() < 1e-6, "{middle} {rows:?}");
    // the third's shear carries it by a whole cell more or less in each step; others come to other places between the points of the grid
    for (x, y, rows_alike) in [(4.0, 7.5, 1), (0.5, 0.25, 1), (0.5, 0.0, 5), (7.5, 7.875, 1)] {
        let (moved, moved_rows) = rod(x, y);
        assert!((moved / middle - 1.0).abs() < 1e-6, "{moved} at {x}, {y}, {middle} in the middle");
        let same = moved_rows.iter().zip(&rows).take(rows_alike).all(|(moved, row)| (moved / row - 1.0).abs() < 1e-6);
        assert!(same && moved_rows.len() == 5 && rows.len() == 5, "{moved_rows:?} at {x}, {y}, {rows:?} in the middle");
    }
}

fn where_the_box_cuts_clusters_changes_nothing_in_3d(session: &Session) {
    let body = |y: f64, z: f64| {
        let text = format!(
            "domain = {{ size = [5.0, 5.0, 5.0] }}\nflow = {{ drive = {{ SHEAR }} }}\nresolution = {{ spacing = 0.16666666666666666 }}\n\
             method = {{ inverse = \"transform\", tolerance = 1e-8 }}\n\
             clusters = [{{ shape = \"tetrahedron\", radius = 0.5, centers = [[2.5, {y}, {z}]], rotation = [0.3, 0.2, 0.5] }}]\n"
        );
        sheared::<3>(session, &text, "time = { end = 0.06666666666666667, step = 0.06666666666666667 }\n")
    };
    let (middle, rows) = body(2.5, 2.5);
    // half the box higher shear carries it by a whole cell more
    let (moved, moved_rows) = body(0.0, 0.5);
    assert!((moved / middle - 1.0).abs() < 1e-6 && (rows[0] / middle - 1.0).abs() < 1e-6, "{moved} {middle} {rows:?}");
    assert!((moved_rows[1] / rows[1] - 1.0).abs() < 1e-6, "{moved_rows:?} {rows:?}");
}

fn random_rods_in_a_sheared_box_have_one_viscosity_at_an_instant_and_in_time(session: &Session) {
    for (seed, lubrication) in [(1, "none"), (2, "none"), (3, "pairwise")] {
        let text = format!(
            "seed = {seed}\ndomain = {{ size = [16.0, 16.0] }}\nflow = {{ drive = {{ SHEAR }} }}\nresolution = {{ cells_per_radius = 3 }}\n\
             method = {{ inverse = \"transform\", tolerance = 1e-8 }}\nlubrication = {{ model = \"{lubrication}\" }}\n\
             clusters = [{{ shape = \"rod\", beads = 5, radius = 0.5, count = 12 }}]\n"
        );
        let (at_once, rows) = sheared::<2>(session, &text, "time = { end = 0.0625, step = 0.0625 }\n");
        assert!((at_once / rows[0] - 1.0).abs() < 1e-6 && at_once > 1.3, "{seed}: {at_once} at an instant, {rows:?} in time");
    }
}
