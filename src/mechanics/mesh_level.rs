//! A flow with inertia on a fitted mesh at one time, from which later steps start.

use nalgebra::Vector2;

use crate::fitted::{Mesh, PlaneTwist, StokesFlow};

/// A flow on a mesh at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshLevel {
    /// The time.
    pub time: f64,
    /// Centres of the disks, not wrapped into the box.
    pub centers: Vec<Vector2<f64>>,
    /// Motions of the disks.
    pub motions: Vec<PlaneTwist>,
    /// Where the nodes of the mesh are.
    pub nodes: Vec<Vector2<f64>>,
    /// Velocities there.
    pub velocities: Vec<Vector2<f64>>,
}

impl MeshLevel {
    /// A flow that was found on a mesh whose disks, not wrapped into the box, have these centres.
    pub fn of(time: f64, centers: Vec<Vector2<f64>>, mesh: &Mesh, flow: &StokesFlow) -> MeshLevel {
        MeshLevel { time, centers, motions: flow.motions.clone(), nodes: mesh.nodes.clone(), velocities: flow.velocities.clone() }
    }
}
