//! What is solved in Stokes flow on a mesh or in a step of a flow with inertia, and what is found; everything is per unit viscosity.

use nalgebra::{Matrix2, Vector2};

use super::{Acceleration, Mesh, MeshInertia, PlaneTwist, Sample, Triangle};

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
    Given(PlaneTwist),
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
    /// What inertia brings into a step, if there is any.
    pub inertia: Option<&'a MeshInertia>,
}

impl StokesProblem<'_> {
    /// Rate of change of momentum at a point of a triangle.
    pub(super) fn acceleration(&self, triangle: &Triangle, sample: &Sample) -> Acceleration {
        self.inertia.map_or_else(Acceleration::default, |inertia| inertia.at(triangle, sample))
    }
}

/// Stokes flow on a mesh, per unit viscosity.
#[derive(Debug, Clone)]
pub struct StokesFlow {
    /// Velocities at all nodes, without the background.
    pub velocities: Vec<Vector2<f64>>,
    /// Pressures at vertices, zero at the first one.
    pub pressures: Vec<f64>,
    /// Motions of the disks.
    pub motions: Vec<PlaneTwist>,
    /// The uniform force per area that mean velocities take.
    pub force: Vector2<f64>,
}
