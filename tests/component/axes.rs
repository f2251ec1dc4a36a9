//! No axis is told from another: scenes whose axes are exchanged have the same answers.

use nalgebra::SVector;
use turbid::{
    body::{Motion, Twist},
    flow::{Drive, InverseMethod},
    geometry::{Axis, Domain},
    petsc::Session,
    scene::{ConstraintMethod, MultiplierSolver, Tolerance},
    simulation::{Setup, Suspension},
};

use crate::{Test, suspension::suspended};

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![Test::of(axes_of_a_box_with_two_disks_are_alike), Test::of(axes_of_a_box_with_two_spheres_are_alike)]
}

/// Forces on fixed balls in a flow along the first axis, if axis `i` of the box is called `names[i]`.
fn forces<const D: usize>(session: &Session, constraint: ConstraintMethod, names: [usize; D]) -> Vec<SVector<f64, D>> {
    let renamed = |vector: SVector<f64, D>| {
        let mut found = SVector::zeros();
        (0..D).for_each(|axis| found[names[axis]] = vector[axis]);
        found
    };
    let vector = |numbers: [f64; 3]| renamed(SVector::from_fn(|axis, _| numbers[axis]));
    let still = Motion::Prescribed(Twist::zero());
    let ball = |center: [f64; 3]| suspended(vector(center), 1.0, still, 3);
    let setup = Setup {
        domain: Domain { size: vector([6.0, 7.0, 8.0]), axes: [Axis::Periodic; D] },
        spacing: 0.25,
        viscosity: 1.0,
        drive: Drive::MeanVelocity(vector([1.0, 0.0, 0.0])),
        bodies: vec![ball([1.3, 2.1, 2.2]), ball([4.1, 4.9, 5.7])],
        constraint,
        lubrication: None,
        inverse: InverseMethod::Transform,
        tolerance: Tolerance::Fixed(1e-12),
    };
    let solution = Suspension::new(session, setup).unwrap().solve(&mut |_, _| {}).unwrap();
    let original = |force: SVector<f64, D>| SVector::from_fn(|axis, _| force[names[axis]]);
    solution.bodies.iter().map(|state| original(state.force)).collect()
}

fn alike<const D: usize>(session: &Session, orders: &[[usize; D]]) {
    for constraint in [ConstraintMethod::Sharp, ConstraintMethod::MeanValue(MultiplierSolver::Krylov)] {
        let as_they_are = forces(session, constraint, orders[0]);
        for names in &orders[1..] {
            for (found, wanted) in forces(session, constraint, *names).iter().zip(&as_they_are) {
                assert!((found - wanted).norm() < 1e-10 * wanted.norm(), "{names:?}: {found:?} {wanted:?}");
            }
        }
    }
}

fn axes_of_a_box_with_two_disks_are_alike(session: &Session) {
    alike::<2>(session, &[[0, 1], [1, 0]]);
}

fn axes_of_a_box_with_two_spheres_are_alike(session: &Session) {
    alike::<3>(session, &[[0, 1, 2], [1, 0, 2], [1, 2, 0]]);
}
