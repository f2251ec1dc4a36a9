//! Rigid clusters of dry balls: free flight, impact, shape.

use std::{f64::consts::PI, path::Path};

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use turbid::{
    body::{Twist, skew},
    motion::{GranularSetup, Simulation},
    petsc::Session,
    scene::Scene,
};

use crate::{Test, dry::smallest_gap};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_free_cluster_tumbles_as_eulers_equations_say_at_second_order),
        Test::of(a_rod_under_a_torque_turns_as_its_inertia_says_in_steps_of_any_length),
        Test::of(a_slanting_rod_that_lands_on_one_end_turns_as_its_inertia_says),
        Test::of(clusters_that_pile_up_keep_their_shape_and_lose_energy),
        Test::only_on(1, heaps_of_rods_come_to_rest_without_overlap),
        Test::of(clusters_cells_and_chains_fall_on_one_heap),
    ]
}

fn scene(text: &str) -> Scene {
    Scene::parse("clusters", Path::new("."), text, &[]).unwrap()
}

/// The scene with one cluster that starts with a rigid motion.
fn thrown<const D: usize>(session: &Session, text: &str, velocity: SVector<f64, D>, spin: SMatrix<f64, D, D>) -> Simulation<D> {
    let scene = scene(text);
    let mut setup = GranularSetup::<D>::of(&scene).unwrap();
    let middle = setup.bodies.iter().map(|body| body.center).sum::<SVector<f64, D>>() / setup.bodies.len() as f64;
    for body in &mut setup.bodies {
        body.twist = Twist { velocity: velocity + spin * (body.center - middle), spin };
    }
    Simulation::granular(session, setup, scene.time.clone().unwrap())
}

fn step<const D: usize>(simulation: &mut Simulation<D>) {
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    simulation.step(&observation, &mut |_, _| {}).unwrap();
}

/// Places of the balls of a cluster with three different moments of inertia.
const OFFSETS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.4, 1.1, 0.0], [0.2, 0.3, 1.5]];

/// The turn of that cluster after a time, by the classical Runge-Kutta method: its angular momentum stays as it is.
fn turned(spin: Vector3<f64>, end: f64) -> Matrix3<f64> {
    let places = OFFSETS.map(Vector3::from);
    let middle = places.iter().sum::<Vector3<f64>>() / 4.0;
    let (volume, own) = (4.0 / 3.0 * PI * 0.125, 0.4 * 0.25);
    let inertia = places
        .iter()
        .map(|place| place - middle)
        .fold(Matrix3::zeros(), |sum, arm| sum + (Matrix3::identity() * (arm.norm_squared() + own) - arm * arm.transpose()) * volume);
    let momentum = inertia * spin;
    let rate = |rotation: &Matrix3<f64>| {
        let spin = rotation * inertia.try_inverse().unwrap() * rotation.transpose() * momentum;
        spin.cross_matrix() * rotation
    };
    let steps = 4000;
    let step = end / f64::from(steps);
    (0..steps).fold(Matrix3::identity(), |rotation, _| {
        let one = rate(&rotation);
        let two = rate(&(rotation + one * (0.5 * step)));
        let three = rate(&(rotation + two * (0.5 * step)));
        let four = rate(&(rotation + three * step));
        rotation + (one + two * 2.0 + three * 2.0 + four) * (step / 6.0)
    })
}

fn a_free_cluster_tumbles_as_eulers_equations_say_at_second_order(session: &Session) {
    let spin = Vector3::new(0.6, 1.1, -0.4);
    let exact = turned(spin, 4.0);
    let errors = [0.04, 0.02].map(|length| {
        let text = format!(
            "domain = {{ size = [30.0, 30.0, 30.0] }}\nflow = {{ model = \"none\" }}\ntime = {{ end = 4.0, step = {length} }}\n\
             clusters = [{{ offsets = {OFFSETS:?}, radius = 0.5, centers = [[15.0, 15.0, 15.0]] }}]\n"
        );
        let velocity = Vector3::new(0.5, 0.0, -0.2);
        let mut simulation = thrown::<3>(session, &text, velocity, skew(spin.as_slice()));
        while !simulation.over() {
            step(&mut simulation);
        }
        let state = simulation.whole_state();
        let middle = state.centers().iter().sum::<Vector3<f64>>() / 4.0;
        assert!((middle - Vector3::repeat(15.0) - velocity * 4.0).norm() < 1e-10);
        (state.bodies[2].rotation - exact).norm()
    });
    assert!((errors[0] / errors[1]).log2() > 1.9 && errors[1] < 2e-3, "{errors:?}");
}

/// From rest by `T t^2 / 2 I`, with spin and energy of the time of the places.
fn a_rod_under_a_torque_turns_as_its_inertia_says_in_steps_of_any_length(session: &Session) {
    let (torque, end) = (0.3, 4.0);
    let inertia = 2.0 * (0.125 + 0.25) * 0.25 * PI;
    let (angle, spin) = (0.5 * torque * end * end / inertia, torque * end / inertia);
    for length in ["0.2", "\"auto\""] {
        let text = format!(
            "domain = {{ size = [10.0, 10.0] }}\nflow = {{ model = \"none\" }}\ntime = {{ end = {end}, step = {length} }}\n\
             clusters = [{{ shape = \"rod\", beads = 2, radius = 0.5, centers = [[5.0, 5.0]], torque = {torque} }}]\n"
        );
        let mut simulation = Simulation::<2>::new(session, &scene(&text)).unwrap();
        while !simulation.over() {
            step(&mut simulation);
        }
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let mut energy = [observation.kinetic_energy.unwrap()];
        session.world().sum(&mut energy);
        assert!((energy[0] / (0.5 * inertia * spin * spin) - 1.0).abs() < 1e-9, "{length}: {}", energy[0]);
        for body in &simulation.whole_state().bodies {
            let turned = body.rotation[(1, 0)].atan2(body.rotation[(0, 0)]);
            let off = (turned - angle).sin().abs();
            // turns are of second order in the step
            assert!(off < 0.03, "{length}: {turned} for {angle}");
        }
    }
}

/// Two touching balls whose line makes an angle with the floor; the lower one is stopped by an impulse `J = u / (1/M + d^2 / I)`, with `d` how far the
/// middle is from it along the floor.
fn a_slanting_rod_that_lands_on_one_end_turns_as_its_inertia_says(session: &Session) {
    let (angle, fall) = (0.5_f64, 1.0);
    let text = format!(
        "domain = {{ size = [6.0, 6.0], y = \"walls\" }}\nflow = {{ model = \"none\" }}\ncontact = {{ model = \"inelastic\" }}\n\
         time = {{ end = 1.0, step = 1e-4 }}\n\
         clusters = [{{ shape = \"rod\", beads = 2, radius = 0.5, centers = [[3.0, {}]], rotation = {angle} }}]\n",
        0.5 + 0.5 * angle.sin() + 1.05e-3
    );
    let mut simulation = thrown::<2>(session, &text, SVector::from([0.0, -fall]), SMatrix::zeros());
    (0..14).for_each(|_| step(&mut simulation));
    let state = simulation.whole_state();
    let (distance, mass) = (0.5 * angle.cos(), 2.0);
    // of two disks about their middle: their own, and that of masses half a diameter away
    let inertia = 2.0 * (0.125 + 0.25);
    let impulse = fall / (1.0 / mass + distance * distance / inertia);
    let (spin, velocity) = (-impulse * distance / inertia, -fall + impulse / mass);
    for body in &state.bodies {
        assert!((body.twist.spin[(1, 0)].abs() / spin.abs() - 1.0).abs() < 2e-3, "{} {spin}", body.twist.spin[(1, 0)]);
    }
    let middle = 0.5 * (state.bodies[0].twist.velocity + state.bodies[1].twist.velocity);
    assert!((middle[1] / velocity - 1.0).abs() < 2e-3 && middle[0].abs() < 1e-12, "{middle} {velocity}");
}

fn clusters_that_pile_up_keep_their_shape_and_lose_energy(session: &Session) {
    let text = "seed = 4\ngravity = [0.0, 0.0, -1.0]\ndomain = { size = [4.0, 4.0, 8.0], z = \"walls\" }\nflow = { model = \"none\" }\n\
                contact = { model = \"inelastic\" }\ntime = { end = 5.0, step = 0.05 }\n\
                clusters = [{ shape = \"tetrahedron\", spacing = 1.05, radius = 0.4, count = 4 }, { shape = \"rod\", beads = 3, spacing = 1.05, radius = 0.4, count = 4 }]\n\
                bodies = [{ radius = 0.5, count = 3 }]\n";
    let scene = scene(text);
    let mut simulation = Simulation::<3>::new(session, &scene).unwrap();
    let clusters = simulation.interactions().clusters().to_vec();
    let height = |simulation: &Simulation<3>| {
        let (state, balls) = (simulation.whole_state(), simulation.whole_balls());
        let of = |(body, ball): (&turbid::setup::Moving<3>, &turbid::geometry::Ball<3>)| {
            let twist = body.twist;
            let rotational = 0.4 * ball.radius.powi(2) * 0.5 * twist.spin.norm_squared();
            ball.radius.powi(3) * (ball.center[2] + 0.5 * twist.velocity.norm_squared() + 0.5 * rotational)
        };
        state.bodies.iter().zip(&balls).map(of).sum::<f64>()
    };
    let (start, mut steps) = (height(&simulation), 0);
    while !simulation.over() {
        step(&mut simulation);
        steps += 1;
        if steps % 20 == 0 {
            assert!(smallest_gap(&simulation) > -1e-9, "{}", smallest_gap(&simulation));
        }
    }
    // velocities live half a step before places: a free fall gains what gravity does in half a step
    assert!(height(&simulation) < 0.8 * start, "{} of {start}", height(&simulation));
    let centers = simulation.whole_state().centers();
    for cluster in &clusters {
        for (one, other) in cluster.bodies.clone().flat_map(|one| cluster.bodies.clone().map(move |other| (one, other))) {
            let distance = (centers[one] - centers[other]).norm();
            assert!((distance - cluster.distance([one, other]).unwrap()).abs() < 1e-6, "{one} {other}: {distance}");
        }
    }
}

/// Runs a dry scene of gravity 1 along y to its end; the smallest gap after any step, and the fastest ball in the end.
fn fallen(session: &Session, text: &str) -> (f64, f64) {
    let mut simulation = Simulation::<2>::new(session, &scene(text)).unwrap();
    let mut gap = f64::INFINITY;
    while !simulation.over() {
        step(&mut simulation);
        gap = gap.min(smallest_gap(&simulation));
    }
    let fastest = simulation.whole_state().bodies.iter().map(|body| body.twist.velocity.norm()).fold(0.0, f64::max);
    (gap, fastest)
}

/// Six rods of four disks that fall between walls from random places, in steps of 1/32 and in automatic ones.
fn heaps_of_rods_come_to_rest_without_overlap(session: &Session) {
    let text = |seed: usize, time: &str| {
        format!(
            "seed = {seed}\ngravity = [0.0, -1.0]\ndomain = {{ size = [5.0, 12.0], x = \"walls\", y = \"walls\" }}\nflow = {{ model = \"none\" }}\n\
             contact = {{ model = \"inelastic\" }}\ntime = {{ {time} }}\nclusters = [{{ shape = \"rod\", beads = 4, radius = 0.3, count = 6 }}]\n"
        )
    };
    let fixed = (1..=12).map(|seed| text(seed, "end = 8.0, step = 0.03125"));
    let auto = [2, 4].into_iter().map(|seed| text(seed, "end = 8.0"));
    for scene in fixed.chain(auto) {
        let (gap, fastest) = fallen(session, &scene);
        // clusters and contacts agree on places to 1e-7 radii
        assert!(gap > -1e-7 && fastest < 5.0, "gap {gap:e}, speed {fastest}: {scene}");
    }
}

fn clusters_cells_and_chains_fall_on_one_heap(session: &Session) {
    let text = "seed = 3\ngravity = [0.0, -1.0]\ndomain = { size = [5.0, 12.0], x = \"walls\", y = \"walls\" }\nflow = { model = \"none\" }\n\
                contact = { model = \"inelastic\" }\ntime = { end = 5.0, step = 0.02 }\n\
                clusters = [{ shape = \"rod\", beads = 4, radius = 0.3, count = 3 }, { shape = \"cross\", radius = 0.3, count = 1 }]\n\
                cells = [{ count = 2, beads = 24, radius = 0.15, stretch = 50.0, bend = 0.2 }]\n\
                chains = [{ count = 2, beads = 4, radius = 0.25, stretch = \"rigid\", bend = 0.5 }]\nbodies = [{ count = 3, radius = 0.3 }]\n";
    let (gap, fastest) = fallen(session, text);
    assert!(gap > -1e-7 && fastest < 3.0, "gap {gap:e}, speed {fastest}");
}
