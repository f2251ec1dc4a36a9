//! Inertia on a mesh that moves: the rate of change of momentum in a step, linear in the new velocity.
//!
//! ```text
//! rho (du/dt + c . grad u),  du/dt = rate u + history,  c = u* - w
//! ```
//!
//! `du/dt` is that at the nodes, which move with the velocity `w` of the mesh: what they were earlier goes along with them. `u*` is the velocity
//! extrapolated from earlier times. Disks have their whole mass; what the pressure of the fluid at rest takes from it is in the given forces.

use nalgebra::Vector2;

use super::{PlaneTwist, Sample, Triangle};

/// What fluid and disks bring into a step, per unit viscosity.
#[derive(Debug, Clone)]
pub struct MeshInertia {
    /// Mass of the fluid per area.
    pub density: f64,
    /// Part of a new velocity in its rate of change.
    pub rate: f64,
    /// For each node, what earlier velocities add to that.
    pub history: Vec<Vector2<f64>>,
    /// For each node, the extrapolated velocity relative to the mesh.
    pub carrying: Vec<Vector2<f64>>,
    /// The disks.
    pub disks: Vec<DiskInertia>,
}

/// What a disk brings into a step, per unit viscosity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiskInertia {
    /// Mass.
    pub mass: f64,
    /// Moment of inertia.
    pub moment: f64,
    /// What earlier motions add to the rate of change of the motion.
    pub history: PlaneTwist,
}

/// Rate of change of momentum at a point, per area and unit viscosity: a sum over the velocities of the nodes of a triangle, and a known part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Acceleration {
    /// Weights of the velocities.
    pub weights: [f64; 6],
    /// The known part.
    pub known: Vector2<f64>,
}

impl MeshInertia {
    /// At a point of a triangle.
    pub fn at(&self, triangle: &Triangle, sample: &Sample) -> Acceleration {
        let interpolated = |field: &[Vector2<f64>]| sample.interpolate(&triangle.nodes, |node| field[node]);
        let carrying = interpolated(&self.carrying);
        let weight = |j: usize| self.density * (self.rate * sample.values[j] + carrying.dot(&sample.gradients[j]));
        Acceleration { weights: std::array::from_fn(weight), known: self.density * interpolated(&self.history) }
    }
}
