//! What an instantaneous solve finds.

use nalgebra::{SMatrix, SVector};

use super::cost::Cost;
use crate::{
    body::{Twist, components, skew},
    fitted::MeshVelocity,
    interaction::Wrench,
    petsc::Vector,
};

/// Motion of a body and what the fluid does to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyState<const D: usize> {
    /// Its centre, in the box.
    pub center: SVector<f64, D>,
    /// Its motion.
    pub twist: Twist<D>,
    /// Force on it by the fluid.
    pub force: SVector<f64, D>,
    /// Torque on it by the fluid about its centre, as a skew matrix.
    pub torque: SMatrix<f64, D, D>,
    /// Symmetric traceless first moment of the traction of the fluid on it.
    pub stresslet: SMatrix<f64, D, D>,
}

impl<const D: usize> BodyState<D> {
    /// Flat numbers, to send to other ranks.
    pub(super) fn pack(&self) -> Vec<f64> {
        let mut numbers = self.center.as_slice().to_vec();
        numbers.extend(self.twist.velocity.as_slice());
        numbers.extend(components(&self.twist.spin));
        numbers.extend(self.force.as_slice());
        numbers.extend(components(&self.torque));
        numbers.extend(self.stresslet.as_slice());
        numbers
    }

    /// The inverse of [`pack`](Self::pack).
    pub(super) fn unpack(numbers: &[f64]) -> Self {
        let planes = D * (D - 1) / 2;
        let (center, rest) = numbers.split_at(D);
        let (motion, rest) = rest.split_at(D + planes);
        let (load, stresslet) = rest.split_at(D + planes);
        BodyState {
            center: SVector::from_column_slice(center),
            twist: Twist { velocity: SVector::from_column_slice(&motion[..D]), spin: skew(&motion[D..]) },
            force: SVector::from_column_slice(&load[..D]),
            torque: skew(&load[D..]),
            stresslet: SMatrix::from_column_slice(stresslet),
        }
    }

    /// How many numbers [`pack`](Self::pack) makes.
    pub(super) const fn packed_length() -> usize {
        D + 2 * (D + D * (D - 1) / 2) + D * D
    }
}

/// The part of films in the pressure, times volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LubricationPressure {
    /// Inside bodies, which is less the traces of the moments of their tractions, over `D`.
    pub inside: f64,
    /// In the whole box.
    pub everywhere: f64,
}

/// The films of a suspension that modes do not see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lubrication<const D: usize> {
    /// Their number.
    pub films: usize,
    /// Smallest gap, in radii of the smaller body.
    pub smallest_gap: f64,
    /// Net force or torque of a film on a pair, at most, over its force.
    pub imbalance: f64,
    /// What they dissipate, energy per time.
    pub dissipation: f64,
    /// Sum over all bodies of the part of the stresslets that films make.
    pub stress: SMatrix<f64, D, D>,
    /// What pressure they make.
    pub pressure: LubricationPressure,
    /// First moment of the tractions of films on bodies, `t_i x_j`, about the wall or, of a pair, about any point. Tractions next to the gap have
    /// none; what there is drives a flow that the grid does not have, and that reaches the walls.
    pub first_moment: SMatrix<f64, D, D>,
}

/// Forces on the lower and the upper wall across each axis; zero where there are none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallForces<const D: usize> {
    /// Those of the fluid, or those that bodies within a cell of a wall and films exert besides the stress that velocities on the grid have there.
    pub forces: [[SVector<f64, D>; 2]; D],
    /// Whether they are all that acts on the walls.
    pub complete: bool,
}

impl<const D: usize> WallForces<D> {
    /// Nothing besides the stress that velocities on the grid have.
    pub fn none() -> Self {
        WallForces { forces: [[SVector::zeros(); 2]; D], complete: false }
    }
}

/// The state of the suspension at one instant.
pub struct Solution<const D: usize> {
    /// All bodies, on every rank.
    pub bodies: Vec<BodyState<D>>,
    /// Velocity and pressure over viscosity, as a fluid vector: a disturbance of the background of the drive
    /// ([`Drive::background`](crate::flow::Drive::background)), which is not in it.
    pub fluid: Vector,
    /// The velocity on the mesh, if it was found on one.
    pub on_mesh: Option<MeshVelocity>,
    /// Mean of its velocity over the whole box.
    pub mean_velocity: SVector<f64, D>,
    /// Mean gradient of the pressure along periodic axes.
    pub pressure_gradient: SVector<f64, D>,
    /// Forces on the walls.
    pub walls: WallForces<D>,
    /// Force of each contact that was held, positive where it pushes.
    pub contact_forces: Vec<f64>,
    /// What forces at a distance add to the stress times volume, if there are any.
    pub pair_stress: Option<SMatrix<f64, D, D>>,
    /// Forces and torques on single bodies that interactions have, besides those that the setup gives.
    pub loads: Vec<(usize, Wrench<D>)>,
    /// What springs and clusters add to the stress times volume, if there are any.
    pub bond_stress: Option<SMatrix<f64, D, D>>,
    /// Forces of springs and clusters, along the coordinates of the configuration.
    pub bond_forces: Vec<f64>,
    /// Films, if lubrication acts; what they do is in the states of the bodies.
    pub lubrication: Option<Lubrication<D>>,
    /// What the solve cost.
    pub cost: Cost,
}
