//! Friction in a flow together with what else a scene may have: clusters and chains, whose contacts act on their balls, and inertia.

use std::{ops::Range, path::Path};

use nalgebra::{SMatrix, SVector};
use turbid::{
    body::Motion,
    contact::FrictionReport,
    motion::{Observation, Simulation},
    observe,
    petsc::Session,
    scene::Scene,
    setup::SuspendedBody,
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(rods_that_rub_are_rigid_and_in_balance),
        Test::only_on(1, chains_and_rings_that_rub_are_in_balance),
        Test::only_on(1, clusters_in_space_that_rub_are_in_balance),
        Test::of(the_smoother_surface_of_a_contact_counts),
        Test::of(a_heavy_disk_in_a_thin_fluid_slides_until_it_rolls),
        Test::of(a_crowd_with_inertia_obeys_the_law),
    ]
}

/// A crowd between walls that move, or in a sheared box.
pub fn scene_text(domain: &str, spacing: f64, bodies: &str) -> String {
    format!(
        "seed = 3\n{domain}\nresolution = {{ cells_per_radius = {spacing} }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-8 }}\n\
         lubrication = {{ model = \"pairwise\", roughness = 0.04 }}\ncontact = {{ model = \"inelastic\", friction = 0.5 }}\n\
         time = {{ end = 0.6, step = 0.05 }}\n{bodies}\n"
    )
}

/// Walls that move.
pub const WALLS: &str = "domain = { size = [9.0, 7.0], y = { lower = [-3.5, 0.0], upper = [3.5, 0.0] } }\nflow = { model = \"stokes\" }";

/// A box whose images slide.
pub const SHEARED: &str =
    "domain = { size = [7.0, 7.0] }\nflow = { model = \"stokes\", drive = { shear_rate = 1.0, periodic = \"sheared\" } }";

/// A force that brings balls to the floor.
pub const PULLED: &str = ", force = [0.0, -90.0]";

/// Force and torque on each group of bodies by the flow and by contacts, about the centre of the first body; the most over the largest contact force; zero without contacts.
fn imbalance<const D: usize>(simulation: &Simulation<D>, observation: &Observation<D>, groups: &[Range<usize>]) -> f64 {
    let (centers, solution) = (simulation.state().centers(), observation.solution.as_ref().unwrap());
    let by_hand = |suspended: &SuspendedBody<D>| match suspended.body.motion {
        Motion::Free { force, torque } => (force, torque),
        Motion::Prescribed(_) => panic!("all bodies are free"),
    };
    let given = simulation.suspension().unwrap().setup().bodies.iter().map(by_hand);
    let felt = solution.bodies.iter().zip(given).map(|(state, (force, torque))| (state.force + force, state.torque + torque));
    let mut wrenches: Vec<(SVector<f64, D>, SMatrix<f64, D, D>)> = felt.collect();
    let torque = |arm: SVector<f64, D>, force: SVector<f64, D>| force * arm.transpose() - arm * force.transpose();
    let radii = simulation.radii();
    let mut largest = 0.0f64;
    for active in &observation.contacts {
        let (contact, force) = (&active.contact, active.whole());
        largest = largest.max(force.norm());
        let part = contact.other().map_or(1.0, |other| radii[contact.body] / (radii[contact.body] + radii[other]));
        let mut add = |body: usize, force: SVector<f64, D>, arm: SVector<f64, D>| {
            wrenches[body].0 += force;
            wrenches[body].1 += torque(arm, force);
        };
        add(contact.body, -force, contact.normal * (contact.separation * part));
        if let Some(other) = contact.other() {
            add(other, force, -contact.normal * (contact.separation * (1.0 - part)));
        }
    }
    let of_group = |group: &Range<usize>| {
        let origin = centers[group.start];
        let sum = group.clone().fold((SVector::<f64, D>::zeros(), SMatrix::<f64, D, D>::zeros()), |(force, turn), body| {
            let (push, own) = wrenches[body];
            (force + push, turn + own + torque(centers[body] - origin, push))
        });
        sum.0.norm().max(sum.1.norm())
    };
    if largest > 0.0 { groups.iter().map(of_group).fold(0.0, f64::max) / largest } else { 0.0 }
}

/// What holds at every instant of a scene in which this many contacts rub, at least, in all steps together.
pub fn proves<const D: usize>(session: &Session, text: &str, groups: &[Range<usize>], least: usize) {
    let mut simulation = Simulation::<D>::new(session, &Scene::parse("groups", Path::new("."), text, &[]).unwrap()).unwrap();
    let mut rubbed = 0;
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let report = observation.friction.unwrap();
        assert!(report.residual <= FrictionReport::TOLERANCE_IN_FLOW, "{report:?}");
        rubbed += report.sticking + report.slipping;
        let imbalance = imbalance(&simulation, &observation, groups);
        assert!(imbalance < 1e-5, "{imbalance:e}");
        let flow = simulation.suspension().unwrap();
        let found = observe::viscosity(flow.setup(), flow.grid(), observation.solution.as_ref().unwrap(), &observation.contacts);
        let viscosity = found.unwrap().unwrap();
        if let Some(walls) = viscosity.from_walls {
            assert!((viscosity.relative() / walls - 1.0).abs() < 1e-4, "{} {walls}", viscosity.relative());
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    assert!(rubbed >= least, "{rubbed} contacts");
}

fn rods_that_rub_are_rigid_and_in_balance(session: &Session) {
    let rods = |force: &str| {
        format!(
            "clusters = [{{ shape = \"rod\", beads = 3, radius = 0.5, count = 6, gap = 0.06{force} }}]\n\
             bodies = [{{ radius = 0.5, count = 8, gap = 0.06{force} }}]"
        )
    };
    let groups: Vec<_> = (0..18).step_by(3).map(|first| first..first + 3).chain((18..26).map(|ball| ball..ball + 1)).collect();
    proves::<2>(session, &scene_text(WALLS, 4.0, &rods(PULLED)), &groups, 5);
    proves::<2>(session, &scene_text(SHEARED, 4.0, &rods("")).replace("end = 0.6", "end = 1.0"), &groups, 1);
}

fn chains_and_rings_that_rub_are_in_balance(session: &Session) {
    for kind in ["joints = \"free\"", "joints = \"fixed\""] {
        let chains = format!(
            "chains = [{{ beads = 4, radius = 0.5, spacing = 1.06, stretch = \"rigid\", bend = 5.0, {kind}, count = 6, gap = 0.06, \
             force = [0.0, -400.0] }}]"
        );
        let groups: Vec<_> = (0..24).step_by(4).map(|first| first..first + 4).collect();
        proves::<2>(session, &scene_text(WALLS, 4.0, &chains), &groups, 5);
    }
    let ring = "chains = [{ beads = 8, radius = 0.5, spacing = 1.06, stretch = \"rigid\", bend = 5.0, shape = \"ring\", count = 1, \
                force = [0.0, -200.0] }]";
    proves::<2>(session, &scene_text(WALLS, 4.0, ring).replace("1e-8", "1e-7"), std::slice::from_ref(&(0..8)), 1);
}

fn clusters_in_space_that_rub_are_in_balance(session: &Session) {
    let domain =
        "domain = { size = [4.0, 3.2, 3.2], y = { lower = [-1.6, 0.0, 0.0], upper = [1.6, 0.0, 0.0] } }\nflow = { model = \"stokes\" }";
    let bodies = "clusters = [{ shape = \"rod\", beads = 2, radius = 0.6, count = 4, gap = 0.06, force = [0.0, -400.0, 0.0] }]";
    let groups: Vec<_> = (0..8).step_by(2).map(|first| first..first + 2).collect();
    proves::<3>(session, &scene_text(domain, 3.0, bodies), &groups, 3);
}

/// With the arm `a` of the contact, its radius and half of the roughness: `v = 2 a^2 / (1 + 2 a^2)` of the first velocity when it rolls.
fn a_heavy_disk_in_a_thin_fluid_slides_until_it_rolls(session: &Session) {
    let text = "gravity = [0.0, -1.0]\ndomain = { size = [8.0, 6.0], y = \"walls\" }\n\
                flow = { model = \"navier-stokes\", viscosity = 1e-4, density = 1e-3 }\n\
                resolution = { cells_per_radius = 4 }\nmethod = { inverse = \"transform\" }\n\
                bodies = [{ radius = 1.0, density = 1.0, centers = [[2.0, 1.011]], velocity = [1.0, 0.0] }]\n\
                contact = { model = \"inelastic\", friction = 0.5, roughness = 0.02 }\ntime = { end = 0.8, step = 0.025 }\n";
    let mut simulation = Simulation::<2>::new(session, &Scene::parse("roll", Path::new("."), text, &[]).unwrap()).unwrap();
    let mut motions = Vec::new();
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        motions.push((simulation.state().time, observation.twists[0]));
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    let at = |time: f64| motions.iter().find(|(of, _)| *of > time - 1e-9).unwrap().1;
    let [early, late] = [0.2, 0.5].map(at);
    let slowed = (early.velocity[0] - late.velocity[0]) / 0.3;
    // lighter by the weight of the fluid
    assert!((slowed / (0.5 * 0.999) - 1.0).abs() < 3e-3, "{slowed}");
    let spun = (late.spin[(1, 0)] - early.spin[(1, 0)]) / 0.3;
    assert!((spun / (-2.0 * 0.5 * 1.01 * 0.999) - 1.0).abs() < 5e-3, "{spun}");
    let last = motions.last().unwrap().1;
    assert!((last.velocity[0] / -last.spin[(1, 0)] - 1.01).abs() < 1e-5, "{last:?}");
    assert!((last.velocity[0] / 0.6711 - 1.0).abs() < 6e-3, "{last:?}");
}

fn a_crowd_with_inertia_obeys_the_law(session: &Session) {
    let text = "seed = 3\ndomain = { size = [8.0, 6.0], y = { lower = [-6.0, 0.0], upper = [6.0, 0.0] } }\n\
                flow = { model = \"navier-stokes\", density = 0.5 }\nresolution = { cells_per_radius = 4 }\nmethod = { inverse = \"transform\" }\n\
                lubrication = { model = \"pairwise\", roughness = 0.04 }\ncontact = { model = \"inelastic\", friction = 0.5 }\n\
                time = { end = 0.5, step = 0.0125 }\nbodies = [{ radius = 1.0, density = 2.0, count = 8, gap = 0.05 }]\n";
    let mut simulation = Simulation::<2>::new(session, &Scene::parse("crowd", Path::new("."), text, &[]).unwrap()).unwrap();
    let mut rubbed = 0;
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        let report = observation.friction.unwrap();
        assert!(report.residual <= FrictionReport::TOLERANCE_IN_FLOW, "{report:?}");
        // friction takes energy, but for what the law is missed by at the speed of the walls
        let pressing: f64 = observation.contacts.iter().map(|active| active.force.max(0.0)).sum();
        assert!(report.work <= FrictionReport::TOLERANCE_IN_FLOW * pressing * 12.0 * 0.0125, "{report:?}");
        for active in observation.contacts.iter().filter(|active| active.force > 0.0) {
            assert!(active.tangential.norm() <= 0.5 * active.force * (1.0 + 1e-3));
        }
        rubbed += report.sticking + report.slipping;
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
    assert!(rubbed > 5, "{rubbed}");
}

/// Balls that are pressed on the floor of a shear: of 0.02, of 0, and of what all others have, which does not slip.
fn the_smoother_surface_of_a_contact_counts(session: &Session) {
    fn proof<const D: usize>(session: &Session, text: &str, walls: &str) {
        let text = text.replace("WALLS", walls);
        let mut simulation = Simulation::<D>::new(session, &Scene::parse("surfaces", Path::new("."), &text, &[]).unwrap()).unwrap();
        let mut last = Vec::new();
        while !simulation.over() {
            let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
            assert!(observation.friction.unwrap().residual <= FrictionReport::TOLERANCE_IN_FLOW);
            last = vec![f64::NAN; 3];
            for active in observation.contacts.iter().filter(|active| active.force > 0.0) {
                last[active.contact.body] = active.tangential.norm() / active.force;
            }
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        }
        let rubs = if walls.is_empty() { last[2] > 0.03 } else { (last[2] - 0.01).abs() < 1e-5 };
        let least = if walls.is_empty() { 0.02 } else { 0.01 };
        assert!((last[0] - least).abs() < 1e-5 && last[1] == 0.0 && rubs, "{last:?}");
    }
    let disks = "domain = { size = [15.0, 5.0], y = { lower = [0.0, 0.0], upper = [5.0, 0.0] } }\nflow = { model = \"stokes\" }\n\
                 resolution = { cells_per_radius = 4 }\nmethod = { inverse = \"transform\", tolerance = 1e-8 }\n\
                 bodies = [{ radius = 1.0, friction = 0.02, centers = [[2.5, 1.0101]], force = [0.0, -20.0] },\n\
                 { radius = 1.0, friction = 0.0, centers = [[7.5, 1.0101]], force = [0.0, -20.0] },\n\
                 { radius = 1.0, centers = [[12.5, 1.0101]], force = [0.0, -20.0] }]\n\
                 contact = { model = \"inelastic\", friction = 5.0, roughness = 0.02WALLS }\ntime = { end = 0.15, step = 0.05 }\n";
    ["", ", wall_friction = 0.01"].into_iter().for_each(|walls| proof::<2>(session, disks, walls));
    let spheres = "domain = { size = [12.0, 4.0, 4.0], y = { lower = [0.0, 0.0, 0.0], upper = [4.0, 0.0, 0.0] } }\nflow = { model = \"stokes\" }\n\
                   resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\", tolerance = 1e-7 }\n\
                   bodies = [{ radius = 1.0, friction = 0.02, centers = [[2.0, 1.0101, 2.0]], force = [0.0, -20.0, 0.0] },\n\
                   { radius = 1.0, friction = 0.0, centers = [[6.0, 1.0101, 2.0]], force = [0.0, -20.0, 0.0] },\n\
                   { radius = 1.0, centers = [[10.0, 1.0101, 2.0]], force = [0.0, -20.0, 0.0] }]\n\
                   contact = { model = \"inelastic\", friction = 5.0, roughness = 0.02WALLS }\ntime = { end = 0.1, step = 0.05 }\n";
    proof::<3>(session, spheres, "");
}
