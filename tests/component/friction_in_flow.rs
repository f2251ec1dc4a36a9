//! Friction in a flow: forces that balance, limits, what may not matter, reversal. Viscosity and rate are 1 but where it is said.

use nalgebra::{SMatrix, SVector, Vector2, Vector3};
use turbid::{
    body::{Motion, Twist, pack},
    contact::{ContactForce, FrictionReport, Partner},
    flow::{Drive, InverseMethod},
    friction::{FrictionLaw, SurfaceFriction},
    geometry::{Axis, Ball, Domain},
    interaction::{Friction, Lubrication, UnequalFriction},
    mechanics::{FlowSolver, History},
    motion::{Observation, Simulation},
    observe,
    petsc::Session,
    plan::flow_solver,
    scene::{ContactModel, Scheme, Step, TimeSection, Tolerance},
    setup::{Setup, SuspendedBody},
};

use crate::{
    Test,
    suspension::{free, periodic_cube, solve, suspended},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::of(a_disk_on_a_wall_in_shear_is_in_balance_and_rolls_or_slips_as_the_law_says),
        Test::of(a_sphere_on_a_wall_in_shear_is_in_balance_and_rolls_or_slips_as_the_law_says),
        Test::of(what_contacts_exert_is_what_the_flow_feels),
        Test::of(little_friction_is_next_to_none),
        Test::of(nothing_overlaps_and_contacts_take_energy),
        Test::of(stresses_add_up_to_the_force_on_walls),
        Test::of(after_reversal_the_viscosity_is_that_without_contacts),
        Test::of(units_places_and_the_order_of_bodies_do_not_matter),
        Test::of(a_restart_goes_on_from_the_forces_of_the_last_step),
        Test::of(spheres_in_a_sheared_box_obey_the_law),
    ]
}

/// Gap at which bodies touch, in radii.
pub const ROUGHNESS: f64 = 0.02;

/// A box with walls across the last axis, of which the upper one moves, or a whole shear.
pub fn between_walls<const D: usize>(size: SVector<f64, D>, rate: f64, spacing: f64, bodies: Vec<SuspendedBody<D>>) -> Setup<D> {
    let along = SVector::<f64, D>::from_fn(|axis, _| if axis == 0 { rate * size[D - 1] } else { 0.0 });
    let walls = Axis::Walls { lower: along * 0.0, upper: along };
    let domain = Domain { size, axes: std::array::from_fn(|axis| if axis + 1 == D { walls } else { Axis::Periodic }) };
    Setup { domain, inverse: InverseMethod::Transform, ..periodic_cube(spacing, Drive::Rest, bodies) }
}

fn time(step: f64) -> TimeSection {
    TimeSection { step: Step::Fixed(step), end: 1e6 * step, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None }
}

/// A suspension that rubs.
fn rubbing<const D: usize>(session: &Session, setup: Setup<D>, coefficient: f64, step: f64) -> Simulation<D> {
    rubbing_by(session, setup, FrictionLaw::plain(coefficient), step)
}

/// A suspension whose surfaces rub by a law.
pub fn rubbing_by<const D: usize>(session: &Session, setup: Setup<D>, law: FrictionLaw, step: f64) -> Simulation<D> {
    let friction = Friction::new(law.coefficient, ROUGHNESS);
    let setup = setup.with_contact(ContactModel::Inelastic);
    let setup = if law.is_plain() {
        setup.with(friction)
    } else {
        setup.with(UnequalFriction { friction, surfaces: SurfaceFriction::uniform(law) })
    };
    let scheme = if law.convex { Scheme::Euler } else { Scheme::TwoStep };
    Simulation::flowing(session, flow_solver(session, setup).unwrap(), TimeSection { scheme, ..time(step) })
}

/// What there is before a step.
pub fn evaluate<const D: usize>(simulation: &mut Simulation<D>) -> Observation<D> {
    simulation.evaluate(&mut |_, _| {}).unwrap()
}

/// One step, and how friction was kept in it.
pub fn step<const D: usize>(simulation: &mut Simulation<D>) -> (Observation<D>, FrictionReport) {
    let observation = evaluate(simulation);
    let report = simulation.step(&observation, &mut |_, _| {}).unwrap();
    let kkt_report = report.kkt_report.unwrap();
    assert!(kkt_report.smallest_gap > 0.49 * ROUGHNESS || kkt_report.smallest_gap.is_infinite(), "{kkt_report:?}");
    (observation, kkt_report.friction.unwrap())
}

/// Normal and tangential force of the contacts of an observation.
pub fn forces<const D: usize>(observation: &Observation<D>) -> Vec<(ContactForce<D>, SVector<f64, D>)> {
    observation.contacts.iter().filter(|active| active.force > 0.0).map(|active| (*active, active.tangential)).collect()
}

/// Slip, tangential over normal force, velocity and normal force of a ball that is pulled to the floor of a box in shear.
pub fn on_a_floor<const D: usize>(session: &Session, seen: (SVector<f64, D>, f64), weight: f64, law: FrictionLaw) -> [f64; 4] {
    let (active, twist) = pressed_on_a_floor(session, seen, (weight, SMatrix::zeros()), law);
    let arm = active.contact.normal * active.contact.separation;
    [twist.at(&arm)[0], active.tangential[0] / active.force, twist.velocity[0], active.force]
}

/// The contact of a ball that is pulled to the floor of a box in shear and turned by a torque, and its motion; forces and torques balance.
pub fn pressed_on_a_floor<const D: usize>(
    session: &Session,
    (size, spacing): (SVector<f64, D>, f64),
    (weight, torque): (f64, SMatrix<f64, D, D>),
    law: FrictionLaw,
) -> (ContactForce<D>, Twist<D>) {
    let center = SVector::from_fn(|axis, _| if axis + 1 == D { 1.0101 } else { 0.5 * size[axis] });
    let down = SVector::<f64, D>::from_fn(|axis, _| if axis + 1 == D { -weight } else { 0.0 });
    let pulled = Motion::Free { force: down, torque };
    let setup = between_walls(size, 1.0, spacing, vec![suspended(center, 1.0, pulled, 4)]);
    let mut simulation = rubbing_by(session, setup, law, 0.01);
    (0..3).for_each(|_| _ = step(&mut simulation));
    let (observation, report) = step(&mut simulation);
    let (twist, fluid) = (observation.twists[0], observation.solution.as_ref().unwrap().bodies[0]);
    let [(active, side)] = forces(&observation)[..] else { panic!("{:?}", observation.contacts) };
    assert_eq!(active.contact.partner, Partner::Wall { axis: D - 1, upper: false });
    let on_wall = active.contact.normal * active.force + side;
    assert!((fluid.force + down - on_wall).norm() < 1e-5 * weight, "{} {down} {on_wall}", fluid.force);
    let arm = active.contact.normal * active.contact.separation;
    let by_wall = -on_wall * arm.transpose() + arm * on_wall.transpose() - active.couple;
    assert!((fluid.torque + torque + by_wall).norm() < 1e-5 * weight, "{} {by_wall}", fluid.torque);
    // gaps are kept where bodies touch, at half of the roughness; by the convex law a slip opens them
    let (height, slip) = (simulation.state().bodies[0].center[D - 1], twist.at(&arm)[0]);
    let opened = if law.convex { law.coefficient * slip.abs() * 0.01 } else { 0.0 };
    assert!((height - 1.0 - 0.5 * ROUGHNESS - opened).abs() < 1e-6 + 1e-2 * opened, "{height} {opened}");
    assert!(report.residual < FrictionReport::TOLERANCE_IN_FLOW && report.work < 1e-6 * weight, "{report:?}");
    assert_eq!((report.sticking, report.slipping), if slip.abs() < 1e-5 { (1, 0) } else { (0, 1) });
    // what pulls the ball does not pull along walls
    let flow = simulation.suspension().unwrap();
    let viscosity =
        observe::viscosity(flow.setup(), flow.grid(), observation.solution.as_ref().unwrap(), &observation.contacts).unwrap().unwrap();
    let (sum, walls) = (viscosity.relative(), viscosity.from_walls.unwrap());
    assert!((sum / walls - 1.0).abs() < 1e-5, "{sum} {walls}");
    (active, twist)
}

fn a_disk_on_a_wall_in_shear_is_in_balance_and_rolls_or_slips_as_the_law_says(session: &Session) {
    rolls_or_slips(|coefficient| on_a_floor(session, (Vector2::new(8.0, 5.0), 0.25), 20.0, FrictionLaw::plain(coefficient)));
}

fn a_sphere_on_a_wall_in_shear_is_in_balance_and_rolls_or_slips_as_the_law_says(session: &Session) {
    rolls_or_slips(|coefficient| on_a_floor(session, (Vector3::new(5.0, 5.0, 4.0), 1.0 / 3.0), 20.0, FrictionLaw::plain(coefficient)));
}

/// Slip, tangential over normal force on the floor, and velocity by the coefficient: the shear takes the ball along, the floor holds it.
fn rolls_or_slips(on_a_floor: impl Fn(f64) -> [f64; 4]) {
    let [slip, ratio, rolling, _] = on_a_floor(10.0);
    assert!(slip.abs() < 1e-5 && ratio > 0.02, "{slip} {ratio}");
    for part in [0.5, 0.98] {
        let [slip, found, velocity, _] = on_a_floor(part * ratio);
        assert!(slip > 0.0 && (found / (part * ratio) - 1.0).abs() < 1e-5 && velocity > rolling, "{slip} {found} {ratio} {velocity}");
    }
    let [slip, found, velocity, _] = on_a_floor(1.02 * ratio);
    assert!(slip.abs() < 1e-5 && (found / ratio - 1.0).abs() < 1e-4 && (velocity / rolling - 1.0).abs() < 1e-3, "{slip} {found} {ratio}");
}

/// Disks between walls in shear, at a fraction of 0.6, with films cut at the roughness.
pub fn dense_suspension(count: usize, seed: u64, rate: f64) -> Setup<2> {
    let size = Vector2::new(8.0, count as f64 * std::f64::consts::PI / 0.6 / 8.0);
    let still = between_walls::<2>(size, rate, 0.25, Vec::new());
    let centers: Vec<Vector2<f64>> = pack(&still.domain, &[] as &[Ball<2>], &vec![1.0; count], 0.03, seed).unwrap();
    let bodies = centers.into_iter().map(|center| suspended(center, 1.0, free(), 4)).collect();
    Setup { bodies, ..still }.with(Lubrication::new(ROUGHNESS))
}

/// Where a crowd is after some steps with friction, and what happens there.
pub fn sheared(session: &Session, law: FrictionLaw, steps: usize) -> (Simulation<2>, Observation<2>) {
    let mut simulation = rubbing_by(session, dense_suspension(11, 5, 1.0), law, 0.03);
    (0..steps).for_each(|_| _ = step(&mut simulation));
    let observation = evaluate(&mut simulation);
    (simulation, observation)
}

/// Bodies at rest in the motions that were found feel the forces that contacts are said to exert.
fn what_contacts_exert_is_what_the_flow_feels(session: &Session) {
    is_what_the_flow_feels(session, sheared(session, FrictionLaw::plain(0.7), 22));
}

/// The same of a crowd of 11 that was sheared.
pub fn is_what_the_flow_feels(session: &Session, (simulation, observation): (Simulation<2>, Observation<2>)) {
    let active_contacts = forces(&observation);
    assert!(active_contacts.len() >= 3, "{} contacts", active_contacts.len());
    let mut expected = vec![(Vector2::zeros(), SMatrix::<f64, 2, 2>::zeros()); 11];
    for (active, side) in &active_contacts {
        let (contact, force) = (active.contact, active.contact.normal * active.force + side);
        expected[contact.body].1 -= active.couple;
        contact.other().into_iter().for_each(|other| expected[other].1 += active.couple);
        let whole = |radius: f64| contact.other().map_or(contact.separation, |_| 0.5 * contact.separation * radius);
        let mut add = |body: usize, push: Vector2<f64>, arm: Vector2<f64>| {
            expected[body].0 += push;
            expected[body].1 += push * arm.transpose() - arm * push.transpose();
        };
        add(contact.body, -force, contact.normal * whole(1.0));
        if let Some(other) = contact.other() {
            add(other, force, -contact.normal * whole(1.0));
        }
    }
    let mut given = dense_suspension(11, 5, 1.0);
    for (suspended, (moving, twist)) in given.bodies.iter_mut().zip(simulation.state().bodies.iter().zip(&observation.twists)) {
        suspended.body.ball.center = moving.center;
        suspended.body.motion = Motion::Prescribed(*twist);
    }
    let largest = active_contacts.iter().map(|(active, _)| active.force).fold(0.0, f64::max);
    let (_, solution) = solve(session, given);
    for (state, (force, torque)) in solution.bodies.iter().zip(&expected) {
        assert!((state.force + force).norm() < 1e-6 * largest, "{} {force} of {largest}", state.force);
        assert!((state.torque + torque).norm() < 1e-6 * largest, "{} {torque} of {largest}", state.torque);
    }
}

fn little_friction_is_next_to_none(session: &Session) {
    let run = |coefficient: f64| {
        let mut simulation = rubbing(session, dense_suspension(11, 5, 1.0), coefficient, 0.03);
        (0..8).for_each(|_| {
            let observation = evaluate(&mut simulation);
            simulation.step(&observation, &mut |_, _| {}).unwrap();
        });
        simulation.state().centers()
    };
    let (without, with) = (run(0.0), run(1e-4));
    let apart = without.iter().zip(&with).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-3, "{apart}");
}

fn nothing_overlaps_and_contacts_take_energy(session: &Session) {
    for coefficient in [0.3, 1.0] {
        let mut simulation = rubbing(session, dense_suspension(11, 5, 1.0), coefficient, 0.03);
        let (mut solves, mut held) = (0, 0);
        for number in 0..25 {
            let (observation, report) = step(&mut simulation);
            assert!(report.residual <= FrictionReport::TOLERANCE_IN_FLOW, "step {number}: {report:?}");
            for (active, side) in forces(&observation) {
                assert!(side.dot(&active.contact.normal).abs() < 1e-9 * active.force);
            }
            (solves, held) = (solves + observation.effort.solves, held + report.sticking + report.slipping);
        }
        assert!(held > 20 && solves < 6 * 25, "{held} contacts, {solves} solves");
    }
}

fn stresses_add_up_to_the_force_on_walls(session: &Session) {
    stresses_add_up(&sheared(session, FrictionLaw::plain(0.7), 22));
}

/// Of a crowd between walls.
pub fn stresses_add_up((simulation, observation): &(Simulation<2>, Observation<2>)) {
    let flow = simulation.suspension().unwrap();
    let solution = observation.solution.as_ref().unwrap();
    let viscosity = observe::viscosity(flow.setup(), flow.grid(), solution, &observation.contacts).unwrap().unwrap();
    let friction = viscosity.parts.get(observe::Part::Friction).unwrap();
    assert!(friction.abs() > 0.01, "{friction}");
    let (sum, walls) = (viscosity.relative(), viscosity.from_walls.unwrap());
    assert!((sum / walls - 1.0).abs() < 1e-5, "{sum} {walls}");
}

/// Stokes flow is linear: contacts open when everything turns round.
fn after_reversal_the_viscosity_is_that_without_contacts(session: &Session) {
    let (simulation, before) = sheared(session, FrictionLaw::plain(0.7), 22);
    assert!(forces(&before).len() >= 3);
    let there = |rate: f64| {
        let mut setup = dense_suspension(11, 5, rate);
        for (suspended, moving) in setup.bodies.iter_mut().zip(&simulation.state().bodies) {
            suspended.body.ball.center = moving.center;
        }
        setup
    };
    let viscosity = |flow: &dyn FlowSolver<2>, observation: &Observation<2>| {
        let solution = observation.solution.as_ref().unwrap();
        observe::viscosity(flow.setup(), flow.grid(), solution, &observation.contacts).unwrap().unwrap().relative()
    };
    let mut reversed = rubbing(session, there(-1.0), 0.7, 1e-3);
    let after = evaluate(&mut reversed);
    assert_eq!(forces(&after).len(), 0);
    let alone = Setup { interactions: there(1.0).interactions, ..there(1.0) };
    let (suspension, solution) = solve(session, alone);
    let without = observe::viscosity(suspension.setup(), suspension.grid(), &solution, &[]).unwrap().unwrap().relative();
    let (found, viscosity_with_contacts) =
        (viscosity(reversed.suspension().unwrap(), &after), viscosity(simulation.suspension().unwrap(), &before));
    assert!((found / without - 1.0).abs() < 1e-6, "{found} {without}");
    assert!(viscosity_with_contacts > 1.02 * without, "{viscosity_with_contacts} {without}");
}

/// The same run in other units of length, time and force, moved along the walls by whole cells, and with bodies in another order.
fn units_places_and_the_order_of_bodies_do_not_matter(session: &Session) {
    let last = |setup: Setup<2>, step_length: f64, length: f64| {
        let mut simulation = rubbing(session, setup, 0.7, step_length);
        (0..6).for_each(|_| _ = step(&mut simulation));
        let flow = evaluate(&mut simulation);
        let suspension = simulation.suspension().unwrap();
        let solution = flow.solution.as_ref().unwrap();
        let viscosity = observe::viscosity(suspension.setup(), suspension.grid(), solution, &flow.contacts).unwrap().unwrap().relative();
        let mut heights: Vec<f64> = simulation.state().bodies.iter().map(|body| body.center[1] / length).collect();
        heights.sort_by(f64::total_cmp);
        (viscosity, heights)
    };
    let (plain, heights) = last(dense_suspension(11, 5, 1.0), 0.03, 1.0);
    let mut scaled = dense_suspension(11, 5, 1.0);
    scaled.domain.size *= 3.0;
    scaled.domain.axes[1] = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::x() * (scaled.domain.size[1] * 2.0) };
    (scaled.spacing, scaled.viscosity) = (scaled.spacing * 3.0, 0.2);
    for suspended in &mut scaled.bodies {
        (suspended.body.ball.center, suspended.body.ball.radius) = (suspended.body.ball.center * 3.0, 3.0);
    }
    let mut moved = dense_suspension(11, 5, 1.0);
    let cell = moved.domain.size[0] / (moved.domain.size[0] / moved.spacing).round();
    moved.bodies.iter_mut().for_each(|suspended| suspended.body.ball.center[0] += 7.0 * cell);
    let mut ordered = dense_suspension(11, 5, 1.0);
    ordered.bodies.reverse();
    for (what, (setup, length_of_step, length)) in
        [("scaled", (scaled, 0.015, 3.0)), ("moved", (moved, 0.03, 1.0)), ("ordered", (ordered, 0.03, 1.0))]
    {
        let (other, others) = last(setup, length_of_step, length);
        assert!((other / plain - 1.0).abs() < 1e-3, "{what}: {other} {plain}");
        let apart = heights.iter().zip(&others).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-4, "{what}: {apart}");
    }
}

fn a_restart_goes_on_from_the_forces_of_the_last_step(session: &Session) {
    let (mut simulation, _) = sheared(session, FrictionLaw::plain(0.7), 20);
    let mut again = rubbing(session, dense_suspension(11, 5, 1.0), 0.7, 0.03);
    assert!(simulation.state().contact_history.iter().any(|held| held.tangential != SVector::<f64, 2>::zeros()));
    again.restore(simulation.state().clone(), History::default()).unwrap();
    (0..3).for_each(|_| _ = (step(&mut simulation), step(&mut again)));
    let apart = simulation.state().bodies.iter().zip(&again.state().bodies).map(|(one, other)| (one.center - other.center).norm());
    assert!(apart.fold(0.0, f64::max) < 1e-4);
}

/// Spheres in a sheared box, with films cut at the roughness.
pub fn spheres() -> Setup<3> {
    let size = Vector3::repeat(4.6);
    let mut domain = Domain { size, axes: [Axis::Periodic; 3] };
    domain.axes[1] = Axis::Sheared(turbid::geometry::LeesEdwards::steady(0.0, size[1], 0.0));
    let centers: Vec<Vector3<f64>> = pack(&domain, &[] as &[Ball<3>], &[1.0; 8], 0.02, 4).unwrap();
    let bodies = centers.into_iter().map(|center| suspended(center, 1.0, free(), 3)).collect();
    let still = between_walls::<3>(size, 0.0, 4.6 / 16.0, bodies);
    Setup { domain, drive: Drive::Shear(1.0), tolerance: Tolerance::Fixed(1e-7), ..still }.with(Lubrication::new(ROUGHNESS))
}

fn spheres_in_a_sheared_box_obey_the_law(session: &Session) {
    // images slide by a cell
    let mut simulation = rubbing(session, spheres(), 0.5, 2.0 / 16.0);
    let mut held = 0;
    for number in 0..4 {
        let (observation, report) = step(&mut simulation);
        assert!(report.residual <= FrictionReport::TOLERANCE_IN_FLOW, "step {number}: {report:?}");
        for (active, side) in forces(&observation) {
            assert!(side.norm() <= 0.5 * active.force * (1.0 + 1e-3) && side.dot(&active.contact.normal).abs() < 1e-9 * active.force);
        }
        held += report.sticking + report.slipping;
    }
    assert!(held > 4, "{held}");
}
