//! What is solved in Stokes flow on a mesh, and what is found; everything is per unit viscosity.

use nalgebra::{Matrix2, Vector2};

use super::Mesh;

/// A rigid motion of a disk: velocity and spin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Velocity of the centre.
    pub velocity: Vector2<f64>,
    /// Counter-clockwise.
    pub spin: f64,
}

/// What decides the motion of a disk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DiskMotion {
    /// Force and torque on it, besides those of the fluid.
    Free {
        /// Force.
        force: Vector2<f64>,
        /// Torque about its centre.
        torque: f64,
    },
    /// The motion is given.
    Given(Rigid),
}

/// What is solved on a mesh, per unit viscosity.
pub struct StokesProblem<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// How each disk moves.
    pub motions: &'a [DiskMotion],
    /// Gradient of a background velocity whose disturbance is solved for, zero without one; the background is zero at the origin.
    pub background: Matrix2<f64>,
    /// A given uniform force per area of fluid.
    pub on_fluid: Vector2<f64>,
    /// The same on disks.
    pub on_disks: Vector2<f64>,
    /// For each axis, the mean velocity over the whole box, disks included, if it is given: the uniform force that it takes is an unknown.
    pub mean_velocity: [Option<f64>; 2],
}

/// Stokes flow on a mesh, per unit viscosity.
#[derive(Debug, Clone)]
pub struct StokesFlow {
    /// Velocities at all nodes, without the background.
    pub velocities: Vec<Vector2<f64>>,
    /// Pressures at vertices, zero at the first one.
    pub pressures: Vec<f64>,
    /// Motions of the disks.
    pub motions: Vec<Rigid>,
    /// The uniform force per area that mean velocities take.
    pub force: Vector2<f64>,
}

impl Rigid {
    /// The velocity at an arm from the centre.
    pub fn at(&self, arm: &Vector2<f64>) -> Vector2<f64> {
        self.velocity + self.spin * Vector2::new(-arm.y, arm.x)
    }
}
