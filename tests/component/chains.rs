//! Chains: beads tied by springs and rods, stiff against bending.

use std::path::Path;

use nalgebra::{SVector, Vector2, Vector3};
use turbid::{
    body::Twist,
    error::Error,
    motion::{GranularSetup, Simulation},
    observe::{ChainNumbers, MembraneNumbers},
    petsc::Session,
    scene::Scene,
    setup::Setup,
};

use crate::Test;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(beads_on_a_spring_relax_at_second_order_in_steps_of_any_length),
        Test::of(a_chain_at_rest_that_is_pulled_is_followed_from_its_first_step),
        Test::of(a_stiff_chain_of_rods_moves_as_one_body),
        Test::only_on(1, a_stiff_chain_on_fixed_joints_moves_as_the_rigid_cluster_of_its_beads),
        Test::of(a_bent_chain_becomes_straight_and_a_ring_round_without_moving_off),
        Test::of(a_chain_in_space_turns_by_its_natural_angle),
        Test::of(chains_longer_than_the_box_are_refused),
        Test::of(chains_with_inertia_come_to_rest_at_their_length),
        Test::only_on(1, cells_keep_their_area_and_tread_or_tumble),
        Test::only_on(1, a_cell_in_space_comes_back_to_its_shape),
        Test::of(dry_beads_on_a_spring_swing_at_second_order_and_stiff_ones_come_to_rest),
        Test::of(a_dry_chain_of_rods_lies_down_on_the_floor),
        Test::of(rods_are_kept_in_long_steps),
        Test::of(a_step_in_which_rods_turn_too_far_is_shortened),
    ]
}

fn scene(text: &str) -> Scene {
    Scene::parse("chains", Path::new("."), text, &[]).unwrap()
}

/// Centres of all bodies at the end of a run.
fn run<const D: usize>(session: &Session, text: &str) -> Vec<SVector<f64, D>> {
    let mut simulation = Simulation::<D>::new(session, &scene(text)).unwrap();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    simulation.whole_state().centers()
}

/// A pair in a periodic box, pulled apart by a spring of this strength.
fn pair(stretch: f64, step: f64, end: f64) -> String {
    format!(
        "domain = {{ size = [8.0, 8.0] }}\nflow = {{ model = \"stokes\", viscosity = 1.0 }}\nresolution = {{ cells_per_radius = 4 }}\n\
         method = {{ inverse = \"transform\", tolerance = 1e-7 }}\n\
         chains = [{{ centers = [[2.9, 4.0], [5.1, 4.2]], beads = 2, radius = 0.75, spacing = 2.0, stretch = {stretch} }}]\n\
         time = {{ end = {end}, step = {step} }}\n"
    )
}

/// Distances of two beads whose spring is 0.79 too short: in steps of up to a hundred times what explicit ones are stable with, they come to rest at
/// the same distance.
fn beads_on_a_spring_relax_at_second_order_in_steps_of_any_length(session: &Session) {
    let distance = |stretch: f64, step: f64, end: f64| {
        let centers = run::<2>(session, &pair(stretch, step, end));
        (centers[1] - centers[0]).norm()
    };
    let [one, two, four] = [0.2, 0.1, 0.05].map(|step| distance(4.0, step, 0.8));
    let order = ((one - two) / (two - four)).abs().log2();
    assert!(order > 1.6 && (2.3..2.9).contains(&four), "order {order}: {one} {two} {four}");
    for stretch in [1e2, 1e5, 1e9] {
        let at_rest = distance(stretch, 0.5, 5.0);
        assert!((at_rest - 3.0).abs() < 2e-3, "{at_rest} with {stretch}");
    }
}

/// Four beads whose ends are pulled: three springs of which each grows by 2/40. The first step is no longer than what pulls lets it be, whenever the run ends,
/// and Euler's rule follows the springs as it does everything else.
fn a_chain_at_rest_that_is_pulled_is_followed_from_its_first_step(session: &Session) {
    let length = |time: &str| {
        let text = format!(
            "domain = {{ size = [8.0, 4.0], x = \"walls\", y = \"walls\" }}\nresolution = {{ cells_per_radius = 4 }}\n\
             chains = [{{ centers = [[3.01, 2.0], [3.67, 2.0], [4.33, 2.0], [4.99, 2.0]], beads = 4, radius = 0.3, spacing = 1.1, stretch = 40.0 }}]\n\
             interactions = [{{ body_force = [\"f * max(-1, min(1, 100 * (x - 4))) * max(0, min(1, (abs(x - 4) - 0.7) / 0.1))\", \"0\"], \
             constants = {{ f = 2.0 }} }}]\ntime = {{ {time} }}\n"
        );
        let centers = run::<2>(session, &text);
        centers.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>()
    };
    for (end, wanted) in [(30.0, 2.13), (120.0, 2.13)] {
        let found = length(&format!("end = {end:?}"));
        assert!((found - wanted).abs() < 1e-4, "{found} at {end}");
    }
    // on the way there
    let wanted = length("end = 3.0, step = 0.02");
    for (time, bound) in [("end = 3.0", 1e-2), ("end = 3.0, error = 1e-5", 2e-3), ("end = 3.0, step = 0.1, scheme = \"euler\"", 5e-3)] {
        let found = length(time);
        assert!((found - wanted).abs() < bound, "{found} for {wanted}: {time}");
    }
}

/// Between sliding walls: velocities of the beads are those of a rigid motion, and lengths stay.
fn a_stiff_chain_of_rods_moves_as_one_body(session: &Session) {
    let text = "domain = { size = [9.0, 6.0], y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] } }\n\
                flow = { model = \"stokes\", viscosity = 1.0 }\nresolution = { cells_per_radius = 3 }\n\
                method = { inverse = \"transform\", tolerance = 1e-6 }\n\
                chains = [{ centers = [[3.0, 2.4], [4.0, 2.7], [5.0, 3.0], [6.0, 3.3]], beads = 4, radius = 0.4, spacing = 1.305037, \
                stretch = \"rigid\", bend = 1e6 }]\n\
                time = { end = 0.4, step = 0.1 }\n";
    let mut simulation = Simulation::<2>::new(session, &scene(text)).unwrap();
    let length = 0.8 * 1.305037;
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let (bodies, twists) = (&simulation.state().bodies, &observation.twists);
        let across = |bead: usize| {
            let way = (bodies[bead].center - bodies[0].center).normalize();
            let velocity = twists[bead].velocity - twists[0].velocity;
            [way.dot(&velocity), (way.x * velocity.y - way.y * velocity.x) / (bead as f64 * length)]
        };
        let ([_, spin], fastest) = (across(3), twists.iter().map(|twist| twist.velocity.norm()).fold(0.0, f64::max));
        for bead in 1..4 {
            let [along, turn] = across(bead);
            assert!(along.abs() < 1e-3 * fastest && (turn - spin).abs() < 2e-3 * spin.abs(), "{bead}: {along} {turn} {spin}");
        }
        assert!(spin < -0.01, "{spin}");
        if simulation.over() {
            break;
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    let centers = simulation.state().centers();
    let lengths: Vec<f64> = centers.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
    assert!(lengths.iter().all(|found| (found / length - 1.0).abs() < 1e-3), "{lengths:?}");
}

/// Velocities of all bodies at the start.
fn at_start<const D: usize>(session: &Session, text: &str) -> Vec<Twist<D>> {
    Simulation::<D>::new(session, &scene(text)).unwrap().evaluate(&mut |_, _| {}).unwrap().twists
}

/// Between sliding walls, under a force along and one across, in 2D and in 3D: to 1e-3 of the fastest, spins times radius included. On free joints the same
/// chain is off by more than 1e-2.
fn a_stiff_chain_on_fixed_joints_moves_as_the_rigid_cluster_of_its_beads(session: &Session) {
    proof_as_cluster(session, "[9.0, 6.0]", "[-1.0, 0.0]", "[1.0, 0.0]", ["[3.0, 2.4]", "[4.2, 2.8]", "[5.4, 3.2]"]);
    let centers = ["[2.5, 2.4, 2.0]", "[3.6, 2.8, 2.3]", "[4.7, 3.2, 2.6]"];
    proof_as_cluster(session, "[7.5, 6.0, 5.25]", "[-1.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]", centers);
}

fn proof_as_cluster(session: &Session, size: &str, lower: &str, upper: &str, centers: [&str; 3]) {
    let [one, middle, three] =
        centers.map(|center| center.trim_matches(['[', ']']).split(", ").map(|x| x.parse().unwrap()).collect::<Vec<f64>>());
    let length = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(one, other)| (one - other).powi(2)).sum::<f64>().sqrt();
    let spacing = length(&one, &middle) / 0.8;
    let offsets: Vec<Vec<f64>> = [&one, &middle, &three].map(|center| center.iter().zip(&middle).map(|(x, y)| x - y).collect()).to_vec();
    let zeros = vec![0.0; one.len() - 2];
    for (x, y) in [(0.0, 0.0), (3.0, 1.0), (-1.0, 3.0)] {
        let force: Vec<f64> = [x, y].into_iter().chain(zeros.clone()).collect();
        let whole: Vec<f64> = force.iter().map(|force| 3.0 * force).collect();
        let head = format!(
            "domain = {{ size = {size}, y = {{ lower = {lower}, upper = {upper} }} }}\nflow = {{ model = \"stokes\", viscosity = 1.0 }}\n\
             resolution = {{ cells_per_radius = 3 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-7 }}\n\
             time = {{ end = 0.1, step = 0.1 }}\n"
        );
        let chain = |joints: &str| {
            let beads = centers.join(", ");
            format!(
                "{head}chains = [{{ centers = [{beads}], beads = 3, radius = 0.4, spacing = {spacing}, stretch = \"rigid\", bend = 1e8, \
                 joints = \"{joints}\", force = {force:?} }}]\n"
            )
        };
        let cluster = format!("{head}clusters = [{{ centers = [{middle:?}], offsets = {offsets:?}, radius = 0.4, force = {whole:?} }}]\n");
        let difference = |text: &str| {
            if one.len() == 2 {
                off(&at_start::<2>(session, text), &at_start(session, &cluster))
            } else {
                off(&at_start::<3>(session, text), &at_start(session, &cluster))
            }
        };
        let [fixed, free] = ["fixed", "free"].map(|joints| difference(&chain(joints)));
        assert!(
            fixed < 1e-3 && free > 1e-2,
            "{} dimensions, force {x}, {y}: {fixed:.1e} on fixed joints, {free:.1e} on free ones",
            one.len()
        );
    }
}

/// The largest difference of motions over the fastest, for beads of radius 0.4.
fn off<const D: usize>(one: &[Twist<D>], other: &[Twist<D>]) -> f64 {
    let difference =
        |(one, other): (&Twist<D>, &Twist<D>)| (one.velocity - other.velocity).norm().max(0.4 * (one.spin - other.spin).norm());
    let fastest = other.iter().map(|twist| twist.velocity.norm()).fold(0.0, f64::max);
    one.iter().zip(other).map(difference).fold(0.0, f64::max) / fastest
}

fn a_bent_chain_becomes_straight_and_a_ring_round_without_moving_off(session: &Session) {
    let head = "domain = { size = [8.0, 8.0] }\nflow = { model = \"stokes\", viscosity = 1.0 }\nresolution = { cells_per_radius = 3 }\n\
                method = { inverse = \"transform\" }\ntime = { end = 40.0, step = 2.0 }\n";
    let bent = "chains = [{ centers = [[3.0, 3.0], [4.1, 3.5], [4.6, 4.6]], beads = 3, radius = 0.4, spacing = 1.5, stretch = 50.0, bend = 20.0 }]\n";
    let centers = run::<2>(session, &format!("{head}{bent}"));
    let [one, two] = [centers[0] - centers[1], centers[2] - centers[1]];
    assert!((one.normalize().dot(&two.normalize()) + 1.0).abs() < 1e-6, "{centers:?}");
    assert!((one.norm() - 1.2).abs() < 1e-4 && (two.norm() - 1.2).abs() < 1e-4, "{one} {two}");
    let middle: Vector2<f64> = centers.iter().sum::<Vector2<f64>>() / 3.0;
    assert!((middle - Vector2::new(11.7 / 3.0, 11.1 / 3.0)).norm() < 0.05, "{middle}");
    for corners in ["[5.3, 4.0], [4.0, 4.9], [2.7, 4.0], [4.0, 3.1]", "[4.0, 3.1], [2.7, 4.0], [4.0, 4.9], [5.3, 4.0]"] {
        let ring = format!(
            "chains = [{{ centers = [{corners}], beads = 4, radius = 0.4, spacing = 1.9, stretch = \"rigid\", bend = 20.0, shape = \"ring\" }}]\n"
        );
        let centers = run::<2>(session, &format!("{head}{ring}"));
        let diagonals = [(centers[2] - centers[0]).norm(), (centers[3] - centers[1]).norm()];
        assert!(diagonals.iter().all(|found| (found / (1.52 * 2.0_f64.sqrt()) - 1.0).abs() < 1e-3), "{corners}: {diagonals:?}");
    }
}

fn a_chain_in_space_turns_by_its_natural_angle(session: &Session) {
    let text = "domain = { size = [10.0, 8.0, 8.0] }\nflow = { model = \"stokes\", viscosity = 1.0 }\n\
                resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\", tolerance = 1e-7 }\ntime = { end = 60.0, step = 3.0 }\n\
                chains = [{ centers = [[3.0, 4.0, 4.0], [5.2, 4.1, 4.0], [7.4, 4.0, 4.2]], beads = 3, radius = 1.0, spacing = 1.1, \
                stretch = \"rigid\", bend = 50.0, angle = 0.4 }]\n";
    let centers = run::<3>(session, text);
    let angle = (centers[1] - centers[0]).angle(&(centers[2] - centers[1]));
    assert!((angle - 0.4).abs() < 1e-5, "{angle}");
}

fn chains_longer_than_the_box_are_refused(_: &Session) {
    let head = "domain = { size = [8.0, 8.0, 8.0] }\nflow = { model = \"stokes\", viscosity = 1.0 }\nresolution = { cells_per_radius = 3 }\n\
                time = { end = 1.0 }\n";
    for (section, rest) in [("chains", "beads = 10"), ("cells", "beads = 42, bend = 1.0")] {
        let text = format!("{head}{section} = [{{ count = 1, radius = 0.5, stretch = 1.0, {rest} }}]\n");
        let Err(Error::Refused(refusal)) = Setup::<3>::of(&scene(&text)) else { panic!("{section} are not refused") };
        assert_eq!(refusal.key, Some(format!("{section}[0].radius")));
        assert!(refusal.remedy.starts_with(&format!("is of {section} ")) && refusal.remedy.contains(" long, and domain.size is 8 at most"));
    }
}

/// A heavy pair on a spring: it swings and is damped, whatever the step; a rod keeps its length.
fn chains_with_inertia_come_to_rest_at_their_length(session: &Session) {
    let text = |stretch: &str| {
        format!(
            "domain = {{ size = [8.0, 6.0], y = \"walls\" }}\nflow = {{ model = \"navier-stokes\", viscosity = 1.0, density = 1.0 }}\n\
             resolution = {{ cells_per_radius = 4 }}\nmethod = {{ inverse = \"transform\" }}\n\
             chains = [{{ centers = [[2.9, 3.0], [5.1, 3.0]], beads = 2, radius = 0.75, spacing = 1.6, stretch = {stretch}, density = 2.0 }}]\n\
             time = {{ end = 3.0, step = 0.1 }}\n"
        )
    };
    for stretch in ["200.0", "1e7", "\"rigid\""] {
        let centers = run::<2>(session, &text(stretch));
        let found = (centers[1] - centers[0]).norm();
        assert!((found - 2.4).abs() < 5e-3, "{found} with {stretch}");
    }
}

/// A cell in shear, whose membrane gives way or does not.
fn sheared_cell(bend: f64, step: f64, end: f64) -> String {
    format!(
        "domain = {{ size = [6.0, 5.0], y = {{ lower = [-2.5, 0.0], upper = [2.5, 0.0] }} }}\nflow = {{ model = \"stokes\", viscosity = 1.0 }}\n\
         resolution = {{ cells_per_radius = 3 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-3 }}\n\
         cells = [{{ centers = [[3.0, 2.5]], rotation = 0.3, beads = 24, radius = 0.14, stretch = \"rigid\", bend = {bend} }}]\n\
         time = {{ end = {end}, step = {step} }}\ncontact = {{ model = \"inelastic\" }}\n"
    )
}

/// The membrane of a soft cell goes around while the cell keeps its inclination; a stiff cell turns over as a whole.
fn cells_keep_their_area_and_tread_or_tumble(session: &Session) {
    let way = |bend: f64| {
        let mut simulation = Simulation::<2>::new(session, &scene(&sheared_cell(bend, 0.1, 8.0))).unwrap();
        let mut observed = Vec::new();
        loop {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            observed.push(MembraneNumbers::of(simulation.interactions(), &simulation.whole_state().centers()).unwrap());
            if simulation.over() {
                break observed;
            }
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
    };
    let turned = |observed: &[MembraneNumbers], of: &dyn Fn(&MembraneNumbers) -> f64, period: f64| -> f64 {
        observed.windows(2).map(|pair| (of(&pair[1]) - of(&pair[0]) + 0.5 * period).rem_euclid(period) - 0.5 * period).sum()
    };
    let (soft, stiff) = (way(0.00441), way(2.94));
    for observed in [&soft, &stiff] {
        let error = observed.iter().map(|numbers| numbers.kept[0].2).fold(0.0, f64::max);
        assert!(error < 1e-6, "area {error:e}");
    }
    let pi = std::f64::consts::PI;
    let treads = [&soft, &stiff].map(|observed| turned(observed, &|numbers| numbers.tread, pi));
    let turns = [&soft, &stiff].map(|observed| turned(observed, &|numbers| numbers.inclination, pi));
    assert!(treads[0] < -0.4 && treads[1].abs() < 0.3, "membranes went around by {treads:?}");
    assert!(turns[0].abs() < 0.5 && turns[1] < -1.5, "cells turned by {turns:?}");
}

/// A cell in space that was drawn out comes back to its shape, and keeps what it encloses and its surface on the way.
fn a_cell_in_space_comes_back_to_its_shape(session: &Session) {
    let text = "domain = { size = [7.0, 5.0, 7.0] }\nflow = { model = \"stokes\", viscosity = 1.0 }\nresolution = { cells_per_radius = 3 }\n\
                method = { inverse = \"transform\" }\ncells = [{ centers = [[3.5, 2.5, 3.5]], beads = 42, radius = 0.25, stretch = 46.2, bend = 8.66 }]\n\
                contact = { model = \"inelastic\" }\ntime = { end = 2.4, step = 0.3 }\n";
    let mut simulation = Simulation::<3>::new(session, &scene(text)).unwrap();
    let mut state = simulation.state().clone();
    let middle = Vector3::new(3.5, 2.5, 3.5);
    for body in &mut state.bodies {
        let drawn = (body.center - middle).component_mul(&Vector3::new(1.1, 1.0, 1.0 / 1.1));
        body.center = middle + drawn;
    }
    simulation.restore(state, turbid::mechanics::History::default()).unwrap();
    let (mut energies, mut errors) = (Vec::new(), Vec::new());
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let (setup, state) = (simulation.suspension().unwrap().setup(), simulation.state());
        energies.push(ChainNumbers::of(&setup.interactions, &state.centers()).unwrap().bond_energy);
        errors.push(MembraneNumbers::of(&setup.interactions, &state.centers()).unwrap().kept.iter().map(|kept| kept.2).fold(0.0, f64::max));
        if simulation.over() {
            break;
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    assert!(energies.windows(2).all(|pair| pair[1] < pair[0]), "{energies:?}");
    assert!(energies[energies.len() - 1] < 1e-3 * energies[0], "{energies:?}");
    assert!(errors[1..].iter().all(|&error| error < 1e-12), "{errors:?}");
}

/// Two beads of mass `pi a^2` on a spring that is 0.1 too long swing as `cos(w t)`, `w^2 = 2 k / m`; a spring that no step resolves is at rest at once.
fn dry_beads_on_a_spring_swing_at_second_order_and_stiff_ones_come_to_rest(session: &Session) {
    let distance = |stretch: f64, step: f64| {
        let text = format!(
            "domain = {{ size = [8.0, 8.0] }}\nflow = {{ model = \"none\" }}\n\
             chains = [{{ centers = [[7.0, 4.0], [0.3, 4.0]], beads = 2, radius = 0.5, spacing = 1.2, stretch = {stretch:?} }}]\n\
             contact = {{ model = \"none\" }}\ntime = {{ end = 2.0, step = {step} }}\n"
        );
        let centers = run::<2>(session, &text);
        (centers[1] - centers[0]).norm()
    };
    let frequency = (2.0 / (0.25 * std::f64::consts::PI)).sqrt();
    let exact = 1.2 + 0.1 * (2.0 * frequency).cos();
    let errors = [0.02, 0.01, 0.005].map(|step| (distance(1.0, step) - exact).abs());
    assert!(errors[2] < 1e-5 && errors[0] > 3.0 * errors[1] && errors[1] > 3.0 * errors[2], "{errors:?}");
    for stretch in [1e6, 1e12] {
        assert!((distance(stretch, 0.02) - 1.2).abs() < 1e-6, "{}", distance(stretch, 0.02));
    }
}

/// Rods keep their length and beads do not overlap while a chain falls, strikes the floor and comes to rest on it.
fn a_dry_chain_of_rods_lies_down_on_the_floor(session: &Session) {
    let text = "domain = { size = [8.0, 8.0], y = \"walls\" }\nflow = { model = \"none\" }\ngravity = [0.0, -1.0]\n\
                chains = [{ centers = [[2.0, 2.0], [2.9, 2.6], [3.8, 3.2], [4.7, 3.8], [5.6, 3.2]], beads = 5, radius = 0.5, spacing = 1.0816654, stretch = \"rigid\" }]\n\
                contact = { model = \"inelastic\" }\ntime = { end = 20.0, step = 0.02 }\n";
    let centers = run::<2>(session, text);
    for pair in centers.windows(2) {
        assert!(((pair[1] - pair[0]).norm() - 1.0816654).abs() < 1e-6, "{centers:?}");
    }
    assert!(centers.iter().all(|center| (center[1] - 0.5).abs() < 1e-6), "{centers:?}");
}

/// Chains of rods in shear, in steps in which they turn by a quarter of a radian, with and without inertia of fluid and bodies, and dry ones that spin.
fn rods_are_kept_in_long_steps(session: &Session) {
    let walls = "domain = { size = [8.0, 6.0], y = { lower = [-6.0, 0.0], upper = [6.0, 0.0] } }\n";
    let chain = "chains = [{ centers = [[3.0, 2.0], [3.2, 3.05], [3.4, 4.1]], beads = 3, radius = 0.4, spacing = 1.336085, stretch = \"rigid\", bend = 2.0 }]\n";
    let wet = "resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\" }\n";
    let stokes = "flow = { model = \"stokes\" }\n";
    let inertia = "flow = { model = \"navier-stokes\", density = 0.05 }\n";
    let sheared = "domain = { size = [8.0, 6.0] }\n";
    let shear = "flow = { model = \"stokes\", drive = { shear_rate = 1.0, periodic = \"sheared\" } }\n";
    let time = |step: f64| format!("time = {{ end = {}, step = {step} }}\n", 6.0 * step);
    for contact in ["", "contact = { model = \"inelastic\" }\n"] {
        lengths_are(&run::<2>(session, &format!("{walls}{stokes}{wet}{chain}{contact}{}", time(0.25))), 3, false, 1.068868);
    }
    lengths_are(&run::<2>(session, &format!("{walls}{inertia}{wet}{chain}{}", time(0.012))), 3, false, 1.068868);
    lengths_are(&run::<2>(session, &format!("{sheared}{shear}{wet}{chain}{}", time(4.0 / 15.0))), 3, false, 1.068868);
    let ring = "chains = [{ centers = [[5.3, 3.0], [4.0, 3.9], [2.7, 3.0], [4.0, 2.1]], beads = 4, radius = 0.4, spacing = 1.976424, stretch = \"rigid\", shape = \"ring\" }]\n";
    lengths_are(&run::<2>(session, &format!("{walls}{stokes}{wet}{ring}{}", time(0.2))), 4, true, 1.5811392);
    let space = "domain = { size = [5.0, 5.0, 4.0], y = { lower = [-5.0, 0.0, 0.0], upper = [5.0, 0.0, 0.0] } }\n";
    let line = "chains = [{ centers = [[2.3, 1.5, 2.0], [2.5, 2.5, 2.1], [2.7, 3.5, 2.0]], beads = 3, radius = 0.4, spacing = 1.280869, stretch = \"rigid\" }]\n";
    lengths_are(&run::<3>(session, &format!("{space}{stokes}{wet}{line}{}", time(0.25))), 3, false, 1.0246952);
    let dry = format!(
        "domain = {{ size = [8.0, 8.0] }}\nflow = {{ model = \"none\" }}\ncontact = {{ model = \"inelastic\" }}\n{chain}{}",
        time(0.25)
    );
    lengths_are(&spun(session, &dry, 1.6), 3, false, 1.068868);
}

/// Places of dry beads of a scene that start as if they turned as one.
fn spun(session: &Session, text: &str, spin: f64) -> Vec<SVector<f64, 2>> {
    let scene = scene(text);
    let mut setup = GranularSetup::<2>::of(&scene).unwrap();
    for body in &mut setup.bodies {
        body.twist.velocity = Vector2::new(-spin * (body.center.y - 3.05), spin * (body.center.x - 3.2));
    }
    let mut simulation = Simulation::granular(session, setup, scene.time.clone().unwrap());
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    let centers = simulation.whole_state().centers();
    let way = (centers[2] - centers[0]).normalize();
    assert!(way.x.abs() > 0.3, "it has turned: {way}");
    centers
}

fn lengths_are<const D: usize>(centers: &[SVector<f64, D>], beads: usize, ring: bool, length: f64) {
    for bond in 0..if ring { beads } else { beads - 1 } {
        let found = (centers[(bond + 1) % beads] - centers[bond]).norm();
        assert!((found / length - 1.0).abs() < 1e-6, "bond {bond}: {found} for {length} of {centers:?}");
    }
}

fn a_step_in_which_rods_turn_too_far_is_shortened(session: &Session) {
    let text = "domain = { size = [8.0, 6.0], y = { lower = [-60.0, 0.0], upper = [60.0, 0.0] } }\nflow = { model = \"stokes\" }\n\
                resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\" }\ntime = { end = 1.0, step = 0.5 }\n\
                chains = [{ centers = [[3.0, 2.0], [3.2, 3.05], [3.4, 4.1]], beads = 3, radius = 0.4, spacing = 1.336085, stretch = \"rigid\" }]\n";
    let mut simulation = Simulation::<2>::new(session, &scene(text)).unwrap();
    let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
    let report = simulation.step(&observation, &mut |_, _| {}).unwrap();
    assert!(report.halvings > 0 && report.length < 0.5, "{report:?}");
    lengths_are(&simulation.whole_state().centers(), 3, false, 2.0 * 0.4 * 1.336085);
}
