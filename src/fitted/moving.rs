//! A mesh that moves with its disks: the displacement of these is continued into the fluid by Laplace's equation.

use nalgebra::Vector2;

use super::{Mesh, Place, System};
use crate::{
    error::Result,
    geometry::Ball,
    petsc::{Direct, Session},
};

/// Smallest angle of a mesh that is still used, in degrees; one that is made has no smaller one than about 25.
const SMALLEST_ANGLE: f64 = 12.0;

/// A mesh as it was made, from which all later positions are reached.
///
/// What a mesh is at an instant depends on where it was made and where disks are, not on their way there. Centres are not wrapped into the box: nodes move
/// without jumps.
pub struct MovingMesh {
    made: Mesh,
    /// Centres of the disks where it was made.
    centers: Vec<Vector2<f64>>,
    /// For each vertex in the fluid, its unknown.
    numbers: Vec<Option<usize>>,
    unknowns: usize,
    direct: Option<Direct>,
}

impl MovingMesh {
    /// A mesh that is to move, made with its disks at these centres.
    pub fn new(made: Mesh, centers: Vec<Vector2<f64>>) -> MovingMesh {
        let mut unknowns = 0;
        let mut number = |place: &Place| {
            let free = *place == Place::Fluid;
            unknowns += usize::from(free);
            free.then(|| unknowns - 1)
        };
        let numbers = made.places[..made.vertices].iter().map(&mut number).collect();
        MovingMesh { made, centers, numbers, unknowns, direct: None }
    }

    /// The mesh as it was made.
    pub fn into_made(self) -> Mesh {
        self.made
    }

    /// The mesh with the centres of its disks elsewhere, or nothing if it would be too distorted.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn moved(&mut self, session: &Session, centers: &[Vector2<f64>]) -> Result<Option<Mesh>> {
        let mesh = self.at(session, centers)?;
        let good = mesh.smallest_angle().to_degrees() > SMALLEST_ANGLE && mesh.regular();
        Ok(good.then_some(mesh))
    }

    /// The mesh with the centres of its disks elsewhere, however distorted.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn at(&mut self, session: &Session, centers: &[Vector2<f64>]) -> Result<Mesh> {
        let displacements: Vec<Vector2<f64>> = centers.iter().zip(&self.centers).map(|(center, made)| center - made).collect();
        let mut mesh = self.made.clone();
        for axis in 0..2 {
            let along: Vec<f64> = displacements.iter().map(|displacement| displacement[axis]).collect();
            if along.iter().any(|&displacement| displacement != 0.0) {
                let moves = self.continued(session, &along)?;
                mesh.nodes.iter_mut().zip(moves).for_each(|(node, displacement)| node[axis] += displacement);
            }
        }
        for (disk, center) in mesh.disks.iter_mut().zip(centers) {
            *disk = Ball { center: mesh.domain.wrap(*center), ..*disk };
        }
        mesh.place_middles();
        Ok(mesh)
    }

    /// How far each vertex moves along an axis when disks move so far; small triangles are the stiffer.
    fn continued(&mut self, session: &Session, displacements: &[f64]) -> Result<Vec<f64>> {
        let mut system = System::new(session.world(), self.unknowns);
        let made = &self.made;
        let known = |vertex: usize| match made.places[vertex] {
            Place::Surface(disk) => displacements[disk],
            _ => 0.0,
        };
        for triangle in &made.triangles {
            let slopes = made.shape(triangle).linear_slopes();
            for i in 0..3 {
                let Some(row) = self.numbers[triangle.nodes[i]] else { continue };
                for j in 0..3 {
                    // weighted with one over the area, which the integral cancels
                    let value = slopes[i].dot(&slopes[j]);
                    match self.numbers[triangle.nodes[j]] {
                        Some(column) => system.add(row, column, value),
                        None => system.load(row, -value * known(triangle.nodes[j])),
                    }
                }
            }
        }
        let (found, _) = system.solve(session, &mut self.direct)?;
        Ok(self.numbers.iter().enumerate().map(|(vertex, number)| number.map_or_else(|| known(vertex), |number| found[number])).collect())
    }
}
