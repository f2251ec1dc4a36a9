//! What closed membranes keep: the area that a ring of bodies encloses, the volume in a surface of triangles, and the area of that.

use std::{ops::Range, rc::Rc};

use nalgebra::{SVector, Vector2, Vector3};

use super::spring::{Spring, beyond_rounding};

/// A measure of a closed membrane that stays as it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Conserved {
    /// The bodies of the membrane.
    pub bodies: Range<usize>,
    /// What is measured.
    pub measure: Measure,
    /// How much there is of it.
    pub value: f64,
}

/// A measure of a closed membrane.
#[derive(Debug, Clone, PartialEq)]
pub enum Measure {
    /// The area that a ring encloses, its bodies counterclockwise.
    EnclosedArea,
    /// The volume that triangles enclose, whose corners are counted from the first body, counterclockwise as seen from outside.
    Volume(Rc<Vec<[usize; 3]>>),
    /// The area of these triangles.
    Surface(Rc<Vec<[usize; 3]>>),
}

impl Measure {
    /// Its name among results.
    pub fn name(&self) -> &'static str {
        match self {
            Measure::EnclosedArea => "enclosed_area",
            Measure::Volume(_) => "enclosed_volume",
            Measure::Surface(_) => "surface",
        }
    }

    /// The faces of a membrane of so many bodies, counted from its first: one polygon in 2D, its triangles in 3D.
    pub fn faces(&self, bodies: usize) -> Vec<Vec<usize>> {
        match self {
            Measure::EnclosedArea => vec![(0..bodies).collect()],
            Measure::Volume(triangles) | Measure::Surface(triangles) => triangles.iter().map(|triangle| triangle.to_vec()).collect(),
        }
    }
}

impl Conserved {
    /// What there is of it, for bodies with these centres.
    pub fn measured<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> f64 {
        let corners = self.corners(center);
        match &self.measure {
            Measure::EnclosedArea => enclosed(&self.ring(center)),
            Measure::Volume(triangles) => triangles.iter().map(|&triangle| volume_to(triangle, &corners)).sum(),
            Measure::Surface(triangles) => triangles.iter().map(|&triangle| 0.5 * normal(triangle, &corners).norm()).sum(),
        }
    }

    /// What it differs from that at rest by, for bodies with these centres.
    pub fn spring<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> Spring<D> {
        let gradients: Vec<Vector3<f64>> = match &self.measure {
            Measure::EnclosedArea => of_ring(&self.ring(center)),
            Measure::Volume(triangles) => gathered(triangles, &self.corners(center), volume_slope),
            Measure::Surface(triangles) => gathered(triangles, &self.corners(center), surface_slope),
        };
        let end = |(body, gradient): (usize, Vector3<f64>)| (body, SVector::from_fn(|axis, _| gradient[axis]));
        let value = beyond_rounding(self.measured(center) - self.value, self.value);
        Spring { ends: self.bodies.clone().zip(gradients).map(end).collect(), value, stiffness: f64::INFINITY, smooth: true }
    }

    fn ring<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> Vec<Vector2<f64>> {
        self.bodies.clone().map(|body| center(body).fixed_rows::<2>(0).into_owned()).collect()
    }

    /// Places from that of the first body: far from the origin, differences would round.
    fn corners<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> Vec<Vector3<f64>> {
        let first = center(self.bodies.start);
        let place = |body: usize| {
            let way = center(body) - first;
            Vector3::from_fn(|axis, _| if axis < D { way[axis] } else { 0.0 })
        };
        self.bodies.clone().map(place).collect()
    }
}

/// The area that a closed polygon encloses, positive if its corners go around counterclockwise.
pub fn enclosed(corners: &[Vector2<f64>]) -> f64 {
    let count = corners.len();
    let part = |corner: usize| (corners[corner] - corners[0]).perp(&(corners[(corner + 1) % count] - corners[0]));
    0.5 * (0..count).map(part).sum::<f64>()
}

/// Slopes of the area that a ring encloses.
fn of_ring(ring: &[Vector2<f64>]) -> Vec<Vector3<f64>> {
    let count = ring.len();
    let gradient = |bead: usize| {
        let across = (ring[(bead + 1) % count] - ring[(bead + count - 1) % count]) * 0.5;
        Vector3::new(across.y, -across.x, 0.0)
    };
    (0..count).map(gradient).collect()
}

fn volume_to([one, two, three]: [usize; 3], corners: &[Vector3<f64>]) -> f64 {
    corners[one].dot(&corners[two].cross(&corners[three])) / 6.0
}

fn normal([one, two, three]: [usize; 3], corners: &[Vector3<f64>]) -> Vector3<f64> {
    (corners[two] - corners[one]).cross(&(corners[three] - corners[one]))
}

/// The slopes of a sum over triangles, of which `slope` has that by the first of three corners.
fn gathered(
    triangles: &[[usize; 3]],
    corners: &[Vector3<f64>],
    slope: impl Fn([Vector3<f64>; 3], Vector3<f64>) -> Vector3<f64>,
) -> Vec<Vector3<f64>> {
    let mut gradients = vec![Vector3::zeros(); corners.len()];
    for &triangle in triangles {
        let normal = normal(triangle, corners);
        for turn in 0..3 {
            let turned: [usize; 3] = std::array::from_fn(|corner| triangle[(corner + turn) % 3]);
            gradients[turned[0]] += slope(turned.map(|corner| corners[corner]), normal);
        }
    }
    gradients
}

fn volume_slope(_: [Vector3<f64>; 3], normal: Vector3<f64>) -> Vector3<f64> {
    // a third of the triangle goes along with each corner
    normal / 6.0
}

fn surface_slope([_, next, last]: [Vector3<f64>; 3], normal: Vector3<f64>) -> Vector3<f64> {
    0.5 * (next - last).cross(&normal.normalize())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::body::Membrane;

    fn proof<const D: usize>(mut corners: Vec<SVector<f64, D>>, conserved: &Conserved) {
        let spring = conserved.spring(&|body: usize| corners[body]);
        assert!((spring.value + conserved.value - conserved.measured(&|body: usize| corners[body])).abs() < 1e-14 && spring.value > 0.0);
        for (body, gradient) in spring.ends {
            for axis in 0..D {
                let here = corners[body][axis];
                let [after, before] = [1e-4, -1e-4].map(|by| {
                    corners[body][axis] = here + by;
                    conserved.measured(&|body: usize| corners[body])
                });
                corners[body][axis] = here;
                assert!(((after - before) / 2e-4 - gradient[axis]).abs() < 1e-7, "{body} {axis}");
            }
        }
    }

    #[test]
    fn gradients_are_slopes_of_what_is_measured() {
        let ring = [[0.0, 0.0], [2.0, 0.3], [1.5, 1.7], [-0.4, 1.1]].map(Vector2::from).to_vec();
        proof(ring, &Conserved { bodies: 0..4, measure: Measure::EnclosedArea, value: 2.0 });
        let membrane = Membrane::biconcave(42, 1.0).unwrap();
        let triangles = Rc::new(membrane.triangles);
        for measure in [Measure::Volume(Rc::clone(&triangles)), Measure::Surface(triangles)] {
            proof(membrane.places.clone(), &Conserved { bodies: 0..42, measure, value: 2.0 });
        }
    }
}
