//! Friction against rolling and twisting in a flow: limits, couples that balance, what may not matter. Viscosity and rate are 1.

use nalgebra::{SMatrix, SVector, Vector2, Vector3};
use turbid::{
    body::{Twist, components, skew},
    contact::{ContactForce, FrictionReport},
    friction::FrictionLaw,
    mechanics::History,
    petsc::Session,
    setup::Setup,
};

use crate::{
    Test,
    friction_by_law_in_flow::speeds,
    friction_in_flow::{
        dense_suspension, evaluate, forces, is_what_the_flow_feels, pressed_on_a_floor, rubbing_by, sheared, spheres, step, stresses_add_up,
    },
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_disk_on_a_wall_in_shear_rolls_above_the_limit),
        Test::of(a_sphere_on_a_wall_in_shear_rolls_above_the_limit),
        Test::of(a_sphere_on_a_wall_twists_above_the_limit),
        Test::of(a_disk_that_rolls_in_a_thin_fluid_comes_to_rest),
        Test::of(couples_are_what_the_flow_feels_and_stresses_add_up),
        Test::of(no_couple_of_a_crowd_exceeds_its_bound),
        Test::of(little_resistance_to_rolling_is_next_to_none),
        Test::of(a_restart_goes_on_from_the_couples_of_the_last_step),
        Test::of(spheres_in_a_sheared_box_obey_the_law),
    ]
}

const ROLLING_AND_SLIDING: FrictionLaw = FrictionLaw { coefficient: 0.7, rolling: 0.1, twisting: 0.0, critical_load: 0.0, convex: false };

/// The couple of a contact over its normal force and the radius of a ball that touches at its roughness.
fn ratio<const D: usize>(active: &ContactForce<D>) -> f64 {
    let couple = components(&active.couple).iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    couple / (active.force * active.contact.separation)
}

/// A ball on the floor of a box in shear rests where friction is enough and the couple that rest takes is below its bound; else it rolls with just the bound.
fn rests_or_rolls<const D: usize>(session: &Session, size: SVector<f64, D>, spacing: f64, critical_load: f64) {
    let found = |rolling: f64| {
        let law = FrictionLaw { rolling, critical_load, ..FrictionLaw::plain(10.0) };
        pressed_on_a_floor(session, (size, spacing), (20.0, SMatrix::zeros()), law)
    };
    let slip = |twist: &Twist<D>, active: &ContactForce<D>| twist.at(&(active.contact.normal * active.contact.separation)).norm();
    let (active, twist) = found(10.0);
    let needed = ratio(&active);
    assert!(twist.velocity.norm() < 1e-5 && twist.spin.norm() < 1e-5 && needed > 0.02, "{} {needed}", twist.velocity);
    let above_load = (active.force - critical_load) / active.force;
    for part in [0.5, 0.98] {
        let (active, twist) = found(part * needed / above_load);
        let bound = part * needed / above_load * (active.force - critical_load) / active.force;
        let couple = ratio(&active);
        assert!((couple / bound - 1.0).abs() < 1e-5, "{couple} of {bound}");
        assert!(twist.velocity[0] > 1e-3 && slip(&twist, &active) < 1e-5, "{} {}", twist.velocity, slip(&twist, &active));
        // it takes energy
        assert!(active.couple.dot(&twist.spin) > 0.0);
    }
    let (active, twist) = found(1.02 * needed / above_load);
    let couple = ratio(&active);
    // as it lands it presses less, and rolls to another place of the grid
    assert!(twist.velocity.norm() < 1e-5 && (couple / needed - 1.0).abs() < 2e-3, "{} {couple} {needed}", twist.velocity);
}

fn a_disk_on_a_wall_in_shear_rolls_above_the_limit(session: &Session) {
    rests_or_rolls(session, Vector2::new(8.0, 5.0), 0.25, 0.0);
    rests_or_rolls(session, Vector2::new(8.0, 5.0), 0.25, 5.0);
}

fn a_sphere_on_a_wall_in_shear_rolls_above_the_limit(session: &Session) {
    rests_or_rolls(session, Vector3::new(5.0, 5.0, 4.0), 1.0 / 3.0, 0.0);
}

/// A torque about the normal turns a sphere just where it exceeds the bound.
fn a_sphere_on_a_wall_twists_above_the_limit(session: &Session) {
    let law = FrictionLaw { twisting: 0.05, rolling: 10.0, ..FrictionLaw::plain(10.0) };
    let found = |torque: f64| pressed_on_a_floor(session, (Vector3::new(5.0, 5.0, 4.0), 1.0 / 3.0), (20.0, skew(&[0.0, 0.0, torque])), law);
    let (active, _) = found(0.0);
    let most = law.twisting * active.force * active.contact.separation;
    for part in [0.98, -1.02, 3.0] {
        let (active, twist) = found(part * most);
        let (spin, couple) = (components(&twist.spin)[2], -components(&active.couple)[2]);
        if part < 1.0 && part > 0.0 {
            assert!(spin.abs() < 1e-5 && (couple + part * most).abs() < 1e-3 * most, "{part}: {spin} {couple} of {most}");
        } else {
            assert!(spin * part > 1e-5 && (couple + part.signum() * most).abs() < 1e-3 * most, "{part}: {spin} {couple} of {most}");
        }
    }
}

/// A disk that rolls on the floor slows down by `k g A^2 / (1/2 + A^2)`, `A` being the distance from its centre at which it touches, and stays where it
/// came to rest: as it would do without a fluid.
fn a_disk_that_rolls_in_a_thin_fluid_comes_to_rest(session: &Session) {
    let text = "gravity = [0.0, -1.0]\ndomain = { size = [8.0, 6.0], y = \"walls\" }\n\
                flow = { model = \"navier-stokes\", viscosity = 1e-4, density = 1e-3 }\n\
                resolution = { cells_per_radius = 4 }\nmethod = { inverse = \"transform\" }\n\
                bodies = [{ radius = 1.0, density = 1.0, centers = [[2.0, 1.01001]], velocity = [0.5, 0.0], spin = -0.4950495 }]\n\
                contact = { model = \"inelastic\", friction = { coefficient = 2.0, rolling = 0.8 }, roughness = 0.02 }\n\
                time = { end = 1.2, step = 0.025 }\n";
    let at = speeds(session, text);
    let slowed = (at(0.2) - at(0.6)) / 0.4;
    let square = 1.01_f64.powi(2);
    // lighter by the weight of the fluid
    let expected = 0.8 * 0.999 * square / (0.5 + square);
    assert!((slowed / expected - 1.0).abs() < 1e-2, "{slowed} for {expected}");
    let stops = at(0.2) / slowed + 0.2;
    assert!(at(stops - 0.05) > 0.01 && at(stops + 0.05).abs() < 1e-4 && at(1.1).abs() < 1e-4, "{} {}", at(stops + 0.05), at(1.1));
}

fn couples_are_what_the_flow_feels_and_stresses_add_up(session: &Session) {
    let there = sheared(session, ROLLING_AND_SLIDING, 22);
    let active_contacts = forces(&there.1);
    assert!(active_contacts.iter().filter(|(active, _)| ratio(active) > 1e-3).count() >= 3);
    stresses_add_up(&there);
    is_what_the_flow_feels(session, there);
}

/// The most that couples may be, at contacts of equal disks and at walls.
fn bound(active: &ContactForce<2>, law: &FrictionLaw) -> f64 {
    let reduced = if active.contact.other().is_some() { 0.5 } else { 1.0 };
    law.rolling * 1.01 * reduced * (active.force - law.critical_load).max(0.0)
}

fn no_couple_of_a_crowd_exceeds_its_bound(session: &Session) {
    for law in [ROLLING_AND_SLIDING, FrictionLaw { rolling: 0.5, critical_load: 20.0, ..ROLLING_AND_SLIDING }] {
        let mut simulation = rubbing_by(session, dense_suspension(11, 5, 1.0), law, 0.03);
        let (mut solves, mut of_each) = (0, [0; 2]);
        for number in 0..25 {
            let (observation, report) = step(&mut simulation);
            assert!(report.residual <= FrictionReport::TOLERANCE_IN_FLOW, "step {number}: {report:?}");
            let largest = forces(&observation).iter().map(|(active, _)| active.force).fold(0.0, f64::max);
            for (active, side) in forces(&observation) {
                let most = law.coefficient * (active.force - law.critical_load).max(0.0);
                assert!(side.norm() < most + 1e-3 * largest, "{} of {most}", side.norm());
                let (couple, most) = (components(&active.couple)[0].abs(), bound(&active, &law));
                assert!(couple < most + 1e-3 * largest, "{couple} of {most}");
                of_each[usize::from(couple < 0.98 * most)] += 1;
            }
            solves += observation.effort.solves;
        }
        assert!(of_each[0] > 5 && of_each[1] > 5 && solves < 6 * 25, "{of_each:?} roll and do not, {solves} solves");
    }
}

fn little_resistance_to_rolling_is_next_to_none(session: &Session) {
    let run = |law: FrictionLaw| sheared(session, law, 22).0.state().centers();
    let apart =
        |one: &[Vector2<f64>], other: &[Vector2<f64>]| one.iter().zip(other).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    let (plain, little, much) = (
        run(FrictionLaw::plain(0.7)),
        run(FrictionLaw { rolling: 1e-4, ..ROLLING_AND_SLIDING }),
        run(FrictionLaw { rolling: 0.5, ..ROLLING_AND_SLIDING }),
    );
    assert!(apart(&plain, &little) < 1e-3, "{}", apart(&plain, &little));
    assert!(apart(&plain, &much) > 1e-2, "{}", apart(&plain, &much));
}

fn a_restart_goes_on_from_the_couples_of_the_last_step(session: &Session) {
    let (mut simulation, _) = sheared(session, ROLLING_AND_SLIDING, 20);
    let mut again = rubbing_by(session, dense_suspension(11, 5, 1.0), ROLLING_AND_SLIDING, 0.03);
    assert!(simulation.state().contact_history.iter().any(|contact| contact.couple != SMatrix::<f64, 2, 2>::zeros()));
    again.restore(simulation.state().clone(), History::default()).unwrap();
    (0..3).for_each(|_| _ = (step(&mut simulation), step(&mut again)));
    let apart = simulation.state().bodies.iter().zip(&again.state().bodies).map(|(one, other)| (one.center - other.center).norm());
    assert!(apart.fold(0.0, f64::max) < 1e-4);
}

/// In 3D, with all that resists.
fn spheres_in_a_sheared_box_obey_the_law(session: &Session) {
    let law = FrictionLaw { rolling: 0.05, twisting: 0.02, ..FrictionLaw::plain(0.5) };
    let setup: Setup<3> = spheres();
    // images slide by a cell
    let mut simulation = rubbing_by(session, setup, law, 2.0 / 16.0);
    let (mut held, mut turned) = (0, 0);
    for number in 0..4 {
        let (observation, report) = step(&mut simulation);
        assert!(report.residual <= FrictionReport::TOLERANCE_IN_FLOW && report.work < 0.0, "step {number}: {report:?}");
        let largest = forces(&observation).iter().map(|(active, _)| active.force).fold(0.0, f64::max);
        for (active, side) in forces(&observation) {
            // next to what the residual allows where a slip turns
            assert!(side.norm() <= 0.5 * active.force + 5e-3 * largest, "{} of {}, {largest}", side.norm(), 0.5 * active.force);
            let couple = Vector3::from_column_slice(&components(&active.couple)) / (0.5 * 1.01);
            let twisting = couple.dot(&active.contact.normal);
            let (rolling, most) =
                ((couple - active.contact.normal * twisting).norm(), [law.rolling, law.twisting].map(|part| part * active.force));
            assert!(rolling <= most[0] + 5e-3 * largest && twisting.abs() <= most[1] + 5e-3 * largest, "{rolling} {twisting} of {most:?}");
            turned += usize::from(rolling > 0.9 * most[0]);
        }
        held += report.sticking + report.slipping;
    }
    let last = evaluate(&mut simulation);
    assert!(held > 4 && turned > 0 && last.effort.solves < 20, "{held} {turned} {}", last.effort.solves);
}
