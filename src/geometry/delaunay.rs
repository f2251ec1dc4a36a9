//! Delaunay triangulations of points in a box and their periodic images.

use std::collections::HashMap;

use nalgebra::Vector2;
use spade::{DelaunayTriangulation, InsertionError, Point2, Triangulation};

use super::Domain;

/// A point in a periodic image of the box, by its number and the image.
pub type Corner = (usize, [i32; 2]);

/// The triangles of points in the box, counter-clockwise and sorted: of all periodic images of one, that which begins with its smallest point
/// in the box. `reach` bounds the circumcircles of the triangles.
///
/// # Errors
/// No point set of finite numbers.
pub fn delaunay(domain: &Domain<2>, points: &[Vector2<f64>], reach: f64) -> Result<Vec<[Corner; 3]>, InsertionError> {
    let corners = images(domain, points, reach);
    let place = |corner: &Corner| position(domain, points, *corner);
    let connected =
        DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(corners.iter().map(place).map(|at| Point2::new(at.x, at.y)).collect())?;
    let faces = connected.inner_faces().map(|face| face.vertices().map(|vertex| corners[vertex.index()]));
    let mut triangles: Vec<[Corner; 3]> = faces.filter(|face| face.iter().any(|corner| corner.1 == [0, 0])).map(canonical).collect();
    triangles.sort_unstable();
    triangles.dedup();
    Ok(triangles)
}

/// Where a corner lies.
pub fn position(domain: &Domain<2>, points: &[Vector2<f64>], (point, image): Corner) -> Vector2<f64> {
    points[point] + domain.offset(image.map(|boxes| boxes as isize))
}

/// All points and those of their images that lie within `reach` of the box.
fn images(domain: &Domain<2>, points: &[Vector2<f64>], reach: f64) -> Vec<Corner> {
    let range = |axis: usize, at: f64| match domain.periodic(axis) {
        true => (-(reach + at) / domain.size[axis]).ceil() as i32..=((reach - at) / domain.size[axis] + 1.0).floor() as i32,
        false => 0..=0,
    };
    let of_point = |(number, point): (usize, &Vector2<f64>)| {
        let point = *point;
        let rows = range(1, point.y);
        rows.flat_map(move |row| {
            let shifted = point.x + domain.offset([0, row as isize]).x;
            range(0, shifted).map(move |column| (number, [column, row]))
        })
    };
    points.iter().enumerate().flat_map(of_point).collect()
}

/// The image of a triangle that begins with its smallest point in the box; of a point that it has twice, so that the rest is smallest.
fn canonical(triangle: [Corner; 3]) -> [Corner; 3] {
    let begun_with = |first: usize| {
        let [x, y] = triangle[first].1;
        [0, 1, 2].map(|place| {
            let (point, image) = triangle[(first + place) % 3];
            (point, [image[0] - x, image[1] - y])
        })
    };
    let [one, two, three] = [0, 1, 2].map(begun_with);
    one.min(two).min(three)
}

/// Which triangle lies to the left of each edge.
pub struct Edges(HashMap<(usize, usize, [i32; 2]), usize>);

impl Edges {
    /// The edges of some triangles.
    pub fn new(triangles: &[[Corner; 3]]) -> Edges {
        let of_triangle = |(number, triangle): (usize, &[Corner; 3])| {
            let triangle = *triangle;
            (0..3).map(move |place| (key(triangle[place], triangle[(place + 1) % 3]), number))
        };
        Edges(triangles.iter().enumerate().flat_map(of_triangle).collect())
    }

    /// The triangle on the other side of an edge of a triangle that goes from one corner to the next.
    pub fn across(&self, from: Corner, to: Corner) -> Option<usize> {
        self.0.get(&key(to, from)).copied()
    }
}

/// An edge, whatever the image.
fn key(from: Corner, to: Corner) -> (usize, usize, [i32; 2]) {
    (from.0, to.0, [to.1[0] - from.1[0], to.1[1] - from.1[1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, LeesEdwards};

    /// As many triangles as twice the points, and a neighbour across each edge, also where a point is its own neighbour.
    #[test]
    fn a_periodic_box_has_two_triangles_a_point() {
        let slide = LeesEdwards::steady(0.0, 1.0, 0.37);
        let domain = Domain { size: [3.0, 2.0].into(), axes: [Axis::Periodic, Axis::Sheared(slide)] };
        for count in [1, 2, 3, 20, 100] {
            let points: Vec<Vector2<f64>> =
                (0..count).map(|n| Vector2::new((0.77 * n as f64).fract() * 3.0, (0.341 * n as f64 + 0.1).fract() * 2.0)).collect();
            let triangles = delaunay(&domain, &points, 3.0).unwrap();
            assert_eq!(triangles.len(), 2 * count);
            let edges = Edges::new(&triangles);
            for triangle in &triangles {
                (0..3).for_each(|place| assert!(edges.across(triangle[place], triangle[(place + 1) % 3]).is_some()));
            }
        }
    }
}
