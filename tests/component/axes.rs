//! No axis is told from another: scenes whose axes are exchanged have the same answers.

use nalgebra::Vector3;
use turbid::{
    flow::{Drive, InverseMethod},
    geometry::{Axis, Domain},
    petsc::Session,
    scene::{ConstraintMethod, MultiplierSolver, Tolerance},
    setup::Setup,
};

use crate::{
    Test,
    suspension::{fixed, solve, suspended},
};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![Test::of(axes_of_a_box_with_two_spheres_are_alike)]
}

/// Forces on two fixed spheres in a flow along the first axis, if axis `i` of the box is called `names[i]`.
fn forces(session: &Session, constraint: ConstraintMethod, names: [usize; 3]) -> Vec<Vector3<f64>> {
    let renamed = |numbers: [f64; 3]| {
        let mut found = Vector3::zeros();
        (0..3).for_each(|axis| found[names[axis]] = numbers[axis]);
        found
    };
    let sphere = |center: [f64; 3]| suspended(renamed(center), 1.0, fixed(), 3);
    let setup = Setup {
        changing_drive: None,
        domain: Domain { size: renamed([6.0, 7.0, 8.0]), axes: [Axis::Periodic; 3] },
        spacing: 0.25,
        viscosity: 1.0,
        drive: Drive::MeanVelocity(renamed([1.0, 0.0, 0.0])),
        bodies: vec![sphere([1.3, 2.1, 2.2]), sphere([4.1, 4.9, 5.7])],
        inertia: None,
        trajectories: Default::default(),
        constraint,
        interactions: Default::default(),
        inverse: InverseMethod::Transform,
        tolerance: Tolerance::Fixed(1e-12),
    };
    let (_, solution) = solve(session, setup);
    solution.bodies.iter().map(|state| Vector3::from_fn(|axis, _| state.force[names[axis]])).collect()
}

fn axes_of_a_box_with_two_spheres_are_alike(session: &Session) {
    for constraint in [ConstraintMethod::Sharp, ConstraintMethod::MeanValue(MultiplierSolver::Krylov)] {
        let as_they_are = forces(session, constraint, [0, 1, 2]);
        for names in [[1, 0, 2], [1, 2, 0]] {
            for (found, wanted) in forces(session, constraint, names).iter().zip(&as_they_are) {
                assert!((found - wanted).norm() < 1e-10 * wanted.norm(), "{names:?}: {found:?} {wanted:?}");
            }
        }
    }
}
