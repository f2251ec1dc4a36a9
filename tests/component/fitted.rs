//! Fitted meshes against computed values (reference, sections 1 to 3 and 6).

use std::f64::consts::PI;

use nalgebra::Vector2;
use turbid::{
    flow::Drive,
    petsc::Session,
    simulation::{FittedFlow, Setup, Solution},
};

use crate::{
    Test,
    suspension::{fixed, periodic_cube, suspended},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![Test::of(errors_on_one_disk)]
}

fn solve(session: &Session, setup: Setup<2>) -> (FittedFlow<2>, Solution<2>) {
    let mut fitted = FittedFlow::new(session, setup).unwrap();
    let solution = fitted.solve(&mut |_, _| {}).unwrap();
    (fitted, solution)
}

fn errors_on_one_disk(session: &Session) {
    let radius = (0.3 / PI).sqrt();
    for cells in [3.0, 4.0, 6.0, 8.0, 12.0, 16.0] {
        let array = |drive, motion| periodic_cube(radius / cells, drive, vec![suspended(Vector2::new(0.513, 0.527), radius, motion, 3)]);
        let (fitted, solution) = solve(session, array(Drive::MeanVelocity(Vector2::x()), fixed()));
        let drag = solution.bodies[0].force[0];
        let (_, sheared) = solve(session, array(Drive::Shear(1.0), crate::suspension::free()));
        let viscosity = 1.0 + sheared.bodies[0].stresslet[(0, 1)];
        if session.world().rank() == 0 {
            println!(
                "{cells} {} unknowns: drag {drag:.8} {:.2e} viscosity {viscosity:.9} {:.2e} mean {:?} spin {} {:?}",
                fitted.cost().grid_unknowns,
                drag / 102.881303670 - 1.0,
                viscosity / 1.59811597742 - 1.0,
                solution.mean_velocity,
                sheared.bodies[0].twist.spin[(1, 0)],
                fitted.cost()
            );
        }
    }
}
