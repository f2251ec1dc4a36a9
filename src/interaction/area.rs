//! Areas that rings of bodies enclose: those of red cells stay as they are.

use std::ops::Range;

use nalgebra::{SVector, Vector2};

use super::spring::{Spring, beyond_rounding};

/// The area that a ring of bodies encloses, which stays as it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Area {
    /// The bodies, counterclockwise.
    pub bodies: Range<usize>,
    /// The area.
    pub area: f64,
}

impl Area {
    /// What the area differs from that at rest by, for bodies with these centres.
    pub fn spring<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> Spring<D> {
        let (first, count) = (self.bodies.start, self.bodies.len());
        let ring: Vec<Vector2<f64>> = self.bodies.clone().map(|body| center(body).fixed_rows::<2>(0).into_owned()).collect();
        let gradient = |bead: usize| {
            let across = (ring[(bead + 1) % count] - ring[(bead + count - 1) % count]) * 0.5;
            SVector::from_fn(|axis, _| if axis == 0 { across.y } else { -across.x })
        };
        let ends = (0..count).map(|bead| (first + bead, gradient(bead))).collect();
        Spring { ends, value: beyond_rounding(enclosed(&ring) - self.area, self.area), stiffness: f64::INFINITY, smooth: true }
    }
}

/// The area that a closed polygon encloses, positive if its corners go around counterclockwise.
pub fn enclosed(corners: &[Vector2<f64>]) -> f64 {
    let count = corners.len();
    let part = |corner: usize| (corners[corner] - corners[0]).perp(&(corners[(corner + 1) % count] - corners[0]));
    0.5 * (0..count).map(part).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_slopes_of_the_area() {
        let mut corners = [[0.0, 0.0], [2.0, 0.3], [1.5, 1.7], [-0.4, 1.1]].map(Vector2::from);
        let area = Area { bodies: 0..4, area: 2.0 };
        let spring = area.spring(&|body: usize| corners[body]);
        assert!((spring.value + 2.0 - enclosed(&corners)).abs() < 1e-15 && spring.value > 0.0);
        for (body, gradient) in spring.ends {
            for axis in 0..2 {
                let here = corners[body][axis];
                let [after, before] = [1e-3, -1e-3].map(|by| {
                    corners[body][axis] = here + by;
                    enclosed(&corners)
                });
                corners[body][axis] = here;
                assert!(((after - before) / 2e-3 - gradient[axis]).abs() < 1e-12);
            }
        }
    }
}
