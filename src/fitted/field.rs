//! What was found on a mesh, at any point of the box.

use nalgebra::{Matrix2, Vector2};

use super::{Locator, Mesh, Place, PlaneTwist, Spot, StokesFlow, StokesProblem, second_order};
use crate::error::Result;

/// A velocity that is given at the nodes of a mesh, and by rigid motions in its disks.
#[derive(Debug, Clone)]
pub struct MeshVelocity {
    mesh: Mesh,
    /// At all nodes, without the background.
    nodes: Vec<Vector2<f64>>,
    motions: Vec<PlaneTwist>,
    background: Matrix2<f64>,
}

impl MeshVelocity {
    /// That of a flow.
    pub fn of(problem: &StokesProblem, flow: &StokesFlow) -> MeshVelocity {
        let (nodes, motions) = (flow.velocities.clone(), flow.motions.clone());
        MeshVelocity { mesh: problem.mesh.clone(), nodes, motions, background: problem.background }
    }

    /// At points, without the background.
    ///
    /// # Errors
    /// No triangle holds a point.
    pub fn at(&self, points: impl Iterator<Item = Vector2<f64>>) -> Result<Vec<Vector2<f64>>> {
        let locator = Locator::new(&self.mesh);
        let in_disk = |disk: usize, arm: &Vector2<f64>| self.motions[disk].at(arm) - self.background * (self.mesh.disks[disk].center + arm);
        points.map(|point| velocity(&locator, &self.nodes, in_disk, &point)).collect()
    }
}

/// A velocity given at the nodes of a mesh and, by the arm from its centre, in each of its disks, at a point.
///
/// # Errors
/// No triangle holds the point.
pub fn velocity(
    locator: &Locator,
    nodes: &[Vector2<f64>],
    in_disk: impl Fn(usize, &Vector2<f64>) -> Vector2<f64>,
    point: &Vector2<f64>,
) -> Result<Vector2<f64>> {
    Ok(match locator.spot(point)? {
        Spot::Fluid(triangle, l) => second_order(triangle, &l, |node| nodes[node]),
        Spot::Disk(disk, arm) => in_disk(disk, &arm),
    })
}

/// A scalar that is given at the nodes of a mesh, and has one value in each of its disks.
#[derive(Debug, Clone)]
pub struct MeshScalar {
    /// The mesh.
    pub mesh: Mesh,
    /// At all nodes.
    pub nodes: Vec<f64>,
}

impl MeshScalar {
    /// In a disk: that of any node on it.
    pub fn in_disk(&self, disk: usize) -> f64 {
        let on_it = Place::Surface(disk);
        let node = self.mesh.places.iter().position(|place| *place == on_it).expect("a mesh has nodes on every surface");
        self.nodes[node]
    }

    /// At points.
    ///
    /// # Errors
    /// No triangle holds a point.
    pub fn at(&self, points: impl Iterator<Item = Vector2<f64>>) -> Result<Vec<f64>> {
        let (locator, disks) = (Locator::new(&self.mesh), (0..self.mesh.disks.len()).map(|disk| self.in_disk(disk)).collect::<Vec<f64>>());
        let value = |point: Vector2<f64>| {
            Ok(match locator.spot(&point)? {
                Spot::Fluid(triangle, l) => second_order(triangle, &l, |node| self.nodes[node]),
                Spot::Disk(disk, _) => disks[disk],
            })
        };
        points.map(value).collect()
    }
}
