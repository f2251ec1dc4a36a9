//! The vertices of a mesh before they are connected, and their Delaunay triangulation.

use nalgebra::Vector2;

use crate::{
    error::{Error, Result},
    geometry::{self, Ball, Corner, Domain, delaunay},
};

/// What a node of a mesh lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// In the fluid.
    Fluid,
    /// On the surface of this disk.
    Surface(usize),
    /// On walls: for each axis that has one there, whether it is the upper one.
    Wall([Option<bool>; 2]),
}

/// Vertices with what they lie on.
#[derive(Debug, Clone)]
pub struct Cloud {
    /// The box.
    pub domain: Domain<2>,
    /// The disks.
    pub disks: Vec<Ball<2>>,
    /// The vertices, in the box.
    pub points: Vec<Vector2<f64>>,
    /// What each lies on.
    pub places: Vec<Place>,
}

impl Cloud {
    /// Adds a vertex.
    pub fn push(&mut self, point: Vector2<f64>, place: Place) {
        self.points.push(self.domain.wrap(point));
        self.places.push(place);
    }

    /// Where a corner lies.
    pub fn position(&self, corner: Corner) -> Vector2<f64> {
        geometry::position(&self.domain, &self.points, corner)
    }

    /// The triangles of the fluid, counter-clockwise: of all periodic images of one, that whose first vertex lies in the box, and which has
    /// the smallest number. `reach` bounds the diameter of the disks and the circumcircles of the triangles.
    ///
    /// # Errors
    /// No point set of finite numbers.
    pub fn triangles(&self, reach: f64) -> Result<Vec<[Corner; 3]>> {
        let unfit = |error| Error::Diverged(format!("the mesh cannot be made: {error}"));
        let mut triangles = delaunay(&self.domain, &self.points, reach).map_err(unfit)?;
        triangles.retain(|triangle| !self.in_a_disk(triangle));
        Ok(triangles)
    }

    /// Whether all corners lie on the same image of one disk.
    fn in_a_disk(&self, triangle: &[Corner; 3]) -> bool {
        let Place::Surface(disk) = self.places[triangle[0].0] else { return false };
        if triangle.iter().any(|corner| self.places[corner.0] != Place::Surface(disk)) {
            return false;
        }
        let centers = triangle.map(|corner| self.center_seen_from(disk, &self.position(corner)));
        centers.iter().all(|center| (center - centers[0]).norm() < self.disks[disk].radius)
    }

    /// The centre of that image of a disk on whose surface a point lies.
    pub fn center_seen_from(&self, disk: usize, point: &Vector2<f64>) -> Vector2<f64> {
        point - self.domain.nearest_image(point - self.disks[disk].center)
    }
}

/// How far an image of the box lies from it.
pub fn image_offset(domain: &Domain<2>, image: [i32; 2]) -> Vector2<f64> {
    Vector2::from_fn(|axis, _| f64::from(image[axis]) * domain.size[axis])
}
