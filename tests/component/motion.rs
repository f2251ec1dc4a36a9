//! Bodies that move: order in time, warm starts, contacts with the flow, dry bodies.

use nalgebra::{SVector, Vector2};
use turbid::{
    body::pack,
    flow::Drive,
    geometry::{Axis, Ball, Domain},
    petsc::Session,
    scene::{ContactModel, Scheme, Step, TimeSection},
    simulation::{Setup, Simulation, Suspension},
};

use crate::Test;
use crate::suspension::{free, suspended};

pub fn tests() -> Vec<Test> {
    vec![Test::of(a_warm_start_saves_iterations)]
}

fn time(step: Step, end: f64, scheme: Scheme) -> TimeSection {
    TimeSection { step, end, scheme, travel: 0.1 }
}

/// Free disks at fraction 0.3 between sliding walls.
fn sheared(count: usize) -> Setup<2> {
    let height = (count as f64 * std::f64::consts::PI / 0.3 / 2.0).sqrt();
    let wall = |sign: f64| Vector2::new(sign * 0.5 * height, 0.0);
    let domain =
        Domain { size: Vector2::new(2.0 * height, height), axes: [Axis::Periodic, Axis::Walls { lower: wall(-1.0), upper: wall(1.0) }] };
    let centers = pack(&domain, &[] as &[Ball<2>], &vec![1.0; count], 0.1, 1).unwrap();
    let bodies = centers.into_iter().map(|center: SVector<f64, 2>| suspended(center, 1.0, free(), 6)).collect();
    Setup { domain, spacing: 1.0 / 6.0, viscosity: 1.0, drive: Drive::Rest, bodies, tolerance: 1e-6 }
}

/// What is left of the start's error sits in the slow modes of gaps, which a better preconditioner would have to know.
fn a_warm_start_saves_iterations(session: &Session) {
    let suspension = Suspension::new(session, sheared(60)).unwrap();
    let mut simulation = Simulation::flowing(session, suspension, time(Step::Auto, 1.0, Scheme::TwoStep), ContactModel::None);
    let mut iterations = Vec::new();
    for _ in 0..8 {
        let view = simulation.look(&mut |_, _| {}).unwrap();
        iterations.push(view.effort.iterations);
        simulation.step(&view, &mut |_, _| {}).unwrap();
    }
    let warm = iterations[1..].iter().sum::<usize>() as f64 / 7.0;
    assert!(warm <= 0.86 * iterations[0] as f64, "{iterations:?}");
}
