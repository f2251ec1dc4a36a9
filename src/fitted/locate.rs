//! Which triangle holds a point, and what a field on the mesh is there.

use std::{iter::Sum, ops::Mul};

use nalgebra::{Vector2, Vector3};

use super::{Mesh, Place, Triangle, element::values};
use crate::{
    error::{Error, Result},
    linalg::ROUNDING,
};

/// Triangles by the cells of a lattice that they reach into.
pub struct Locator<'a> {
    mesh: &'a Mesh,
    cells: [usize; 2],
    /// For each cell, triangles and the image of the box in which they reach into it.
    near: Vec<Vec<(usize, Vector2<f64>)>>,
}

/// Where a point lies.
pub enum Spot<'a> {
    /// In a disk, at an arm from its centre.
    Disk(usize, Vector2<f64>),
    /// In a triangle, at barycentric coordinates.
    Fluid(&'a Triangle, Vector3<f64>),
}

impl<'a> Locator<'a> {
    /// Sorts the triangles of a mesh.
    pub fn new(mesh: &'a Mesh) -> Locator<'a> {
        let size = mesh.domain.size;
        let per_axis = (mesh.triangles.len() as f64 / size.product()).sqrt();
        let cells = [0, 1].map(|axis| ((size[axis] * per_axis).ceil() as usize).max(1));
        let mut near = vec![Vec::new(); cells[0] * cells[1]];
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            let [lower, upper] = mesh.shape(triangle).bounds();
            let range = |axis: usize| {
                let place = |x: f64| (x / size[axis] * cells[axis] as f64).floor() as i64;
                place(lower[axis])..=place(upper[axis])
            };
            for [x, y] in range(0).flat_map(|x| range(1).map(move |y| [x, y])) {
                let Some((cell, image)) = wrapped(mesh, cells, [x, y]) else { continue };
                near[cell].push((number, image));
            }
        }
        Locator { mesh, cells, near }
    }

    /// Where a point of the box lies; between a circle and the parabolas of its edges, in the triangle that is nearest.
    pub fn find(&self, point: &Vector2<f64>) -> Option<Spot<'a>> {
        let point = self.mesh.domain.wrap(*point);
        let place = |axis: usize| {
            let cells = self.cells[axis];
            ((point[axis] / self.mesh.domain.size[axis] * cells as f64) as usize).min(cells - 1)
        };
        let mut best: Option<(&Triangle, Vector3<f64>)> = None;
        for (number, image) in &self.near[place(0) * self.cells[1] + place(1)] {
            let triangle = &self.mesh.triangles[*number];
            let Some(disk) = self.disk_at(triangle, &point) else {
                let (shape, point) = (self.mesh.shape(triangle), point + image);
                let [lower, upper] = shape.bounds();
                let near = (0..2).all(|axis| (lower[axis]..=upper[axis]).contains(&point[axis]));
                let Some(found) = near.then(|| shape.locate(&point)).flatten() else { continue };
                if best.is_none_or(|(_, l)| found.min() > l.min()) {
                    best = Some((triangle, found));
                }
                if found.min() > -ROUNDING {
                    break;
                }
                continue;
            };
            return Some(disk);
        }
        best.map(|(triangle, l)| Spot::Fluid(triangle, l)).or_else(|| self.any_disk_at(&point))
    }

    /// As [`find`](Self::find).
    ///
    /// # Errors
    /// [`Error::Diverged`] if no triangle holds the point.
    pub fn spot(&self, point: &Vector2<f64>) -> Result<Spot<'a>> {
        self.find(point).ok_or_else(|| Error::Diverged(format!("no triangle of the mesh holds the point {:?}", point.as_slice())))
    }

    /// The disk on which the triangle has a node, if it holds the point.
    fn disk_at(&self, triangle: &Triangle, point: &Vector2<f64>) -> Option<Spot<'a>> {
        triangle.nodes.iter().find_map(|&node| match self.mesh.places[node] {
            Place::Surface(disk) => self.in_disk(disk, point),
            _ => None,
        })
    }

    fn any_disk_at(&self, point: &Vector2<f64>) -> Option<Spot<'a>> {
        (0..self.mesh.disks.len()).find_map(|disk| self.in_disk(disk, point))
    }

    fn in_disk(&self, disk: usize, point: &Vector2<f64>) -> Option<Spot<'a>> {
        let arm = self.mesh.arm(disk, point);
        (arm.norm() <= self.mesh.disks[disk].radius).then_some(Spot::Disk(disk, arm))
    }
}

/// A field given at all nodes, at a place in a triangle.
pub fn second_order<T: Sum>(triangle: &Triangle, l: &Vector3<f64>, field: impl Fn(usize) -> T) -> T
where
    f64: Mul<T, Output = T>,
{
    triangle.nodes.iter().zip(values(l)).map(|(&node, value)| value * field(node)).sum()
}

/// A field given at vertices, at a place in a triangle.
pub fn first_order(triangle: &Triangle, l: &Vector3<f64>, field: &[f64]) -> f64 {
    (0..3).map(|k| l[k] * field[triangle.nodes[k]]).sum()
}

/// The cell of the box that a cell is an image of, and what moves a point of the former to the latter; nothing for a cell beyond a wall.
fn wrapped(mesh: &Mesh, cells: [usize; 2], cell: [i64; 2]) -> Option<(usize, Vector2<f64>)> {
    let mut image = Vector2::zeros();
    let mut within = [0; 2];
    for axis in 0..2 {
        let count = cells[axis] as i64;
        let turns = cell[axis].div_euclid(count);
        if turns != 0 && !mesh.domain.periodic(axis) {
            return None;
        }
        image[axis] = turns as f64 * mesh.domain.size[axis];
        within[axis] = cell[axis].rem_euclid(count) as usize;
    }
    Some((within[0] * cells[1] + within[1], image))
}
