//! The mean shear stress of a suspension in Stokes flow that a shear drags along x, past planes across y.

use nalgebra::{SMatrix, SVector};

use crate::{
    body::Motion,
    contact::ContactForce,
    interaction::{PairForce, Wrench},
};
use crate::{setup::Setup, system::Solution};

/// The shear stress, contacts included: `viscosity x rate`, and what stresslets and forces between bodies add over the volume.
pub fn shear_stress<const D: usize>(setup: &Setup<D>, solution: &Solution<D>, contacts: &[ContactForce<D>]) -> f64 {
    let stresslets: SMatrix<f64, D, D> = solution.bodies.iter().map(|state| state.stresslet).sum();
    let of_contacts: SMatrix<f64, D, D> =
        contacts.iter().map(|contact| PairForce::from(contact).stress() + contact.stress_of_couple()).sum();
    let along = SVector::from_fn(|axis, _| if axis == 0 { 1.0 } else { 0.0 });
    let loads = load_stress(setup, solution, along, 1);
    let others = [solution.pair_stress, solution.bond_stress, loads];
    let total = stresslets + of_contacts + others.into_iter().flatten().sum::<SMatrix<f64, D, D>>();
    let rate = setup.domain.protocol().map_or(0.0, |protocol| protocol.rate(setup.domain.time()));
    setup.viscosity * rate + total[(0, 1)] / setup.domain.volume()
}

/// What torques and, between walls, forces along the flow on single bodies add to the stress, times volume, in a shear along a direction past planes across an
/// axis; nothing without any.
pub fn load_stress<const D: usize>(
    setup: &Setup<D>,
    solution: &Solution<D>,
    flow: SVector<f64, D>,
    gradient: usize,
) -> Option<SMatrix<f64, D, D>> {
    let walled = setup.domain.axes[gradient].walled();
    let across = SVector::<f64, D>::from_fn(|axis, _| if axis == gradient { 1.0 } else { 0.0 });
    let along = flow * across.transpose();
    let pull = |force: &SVector<f64, D>| if walled { force.dot(&flow) } else { 0.0 };
    let load = |body: usize, Wrench { force, torque }: Wrench<D>| {
        let height = solution.bodies[body].center[gradient] - 0.5 * setup.domain.size[gradient];
        // a torque is turned as a spin is: its entry from x to y is the one of y and x
        torque * -0.5 - along * (pull(&force) * height)
    };
    let given = setup.bodies.iter().enumerate().filter_map(|(body, suspended)| {
        let Motion::Free { force, torque } = suspended.body.motion else { return None };
        (pull(&force) != 0.0 || torque.norm() != 0.0).then(|| load(body, Wrench { force, torque }))
    });
    // what changes with time has a stress where it happens to be zero, too
    given.chain(solution.loads.iter().map(|&(body, wrench)| load(body, wrench))).reduce(|sum, part| sum + part)
}
