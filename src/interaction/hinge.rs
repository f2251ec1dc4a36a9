//! Hinges: stiffness of a membrane of triangles against bending at its edges.

use nalgebra::{SVector, Vector3};

use super::Spring;

/// Two triangles with a common edge, `V = stiffness/2 (angle - rest)^2`; in three dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hinge {
    /// Ends of the edge, in the direction in which they follow each other in the first triangle, counterclockwise as seen from outside.
    pub ends: [usize; 2],
    /// The third corners of the first and of the second triangle.
    pub wings: [usize; 2],
    /// Angle between the triangles' normals at rest in radians, positive where the membrane is convex.
    pub rest: f64,
    /// Energy.
    pub stiffness: f64,
}

impl Hinge {
    /// The angle between the normals.
    pub fn angle(&self, center: &impl Fn(usize) -> Vector3<f64>) -> f64 {
        let [edge, first, second] = self.arms(center);
        let normals = [edge.cross(&first), second.cross(&edge)];
        let angle = normals[0].angle(&normals[1]);
        angle.copysign(-first.dot(&normals[1]))
    }

    /// The edge, and both wings from its first end.
    fn arms(&self, center: &impl Fn(usize) -> Vector3<f64>) -> [Vector3<f64>; 3] {
        let start = center(self.ends[0]);
        [center(self.ends[1]) - start, center(self.wings[0]) - start, center(self.wings[1]) - start]
    }

    /// What the angle differs from that at rest by, for bodies with these centres.
    pub fn spring<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> Spring<D> {
        let center = |body: usize| center(body).fixed_rows::<3>(0).into_owned();
        let [edge, first, second] = self.arms(&center);
        let length = edge.norm();
        // a wing that moves along its triangle's normal turns it by that over its height; what the ends must do follows from where its foot is
        let of_wing =
            |arm: &Vector3<f64>, normal: Vector3<f64>| (normal * (-length / normal.norm_squared()), arm.dot(&edge) / (length * length));
        let [(one, foot), (other, other_foot)] = [of_wing(&first, edge.cross(&first)), of_wing(&second, second.cross(&edge))];
        let (end, start) = (-one * foot - other * other_foot, -one * (1.0 - foot) - other * (1.0 - other_foot));
        let ends = [(self.ends[0], start), (self.ends[1], end), (self.wings[0], one), (self.wings[1], other)];
        let turned = self.angle(&center) - self.rest;
        let in_space = |gradient: Vector3<f64>| SVector::from_fn(|axis, _| gradient[axis]);
        Spring {
            ends: ends.map(|(body, gradient)| (body, in_space(gradient))).to_vec(),
            value: super::spring::beyond_rounding(turned.sin().atan2(turned.cos()), 1.0),
            stiffness: self.stiffness,
            smooth: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Membrane;

    /// `V = b/2 integral of (c + c')^2` with a Gaussian part `-4/3 b integral of c c'` and `b = sqrt 3 / 2 stiffness`: on a sphere, from flat, `8 pi / 3 b`.
    #[test]
    fn hinges_have_the_bending_modulus_of_their_membrane() {
        let over = |parts: usize| {
            let sphere = Membrane::sphere(parts);
            let hinge = |ends, wings| Hinge { ends, wings, rest: 0.0, stiffness: 2.0 };
            let springs =
                sphere.edges().into_iter().map(|edge| hinge(edge.ends, edge.wings).spring::<3>(&|corner: usize| sphere.places[corner]));
            springs.map(|spring| spring.energy()).sum::<f64>() / (8.0 * std::f64::consts::PI / 3.0 * 3f64.sqrt())
        };
        // what is left comes from the twelve corners of the icosahedron and from triangles that are not all alike
        let [coarse, fine] = [2, 8].map(over);
        assert!((coarse - 1.045).abs() < 2e-3 && (fine - 1.009).abs() < 2e-3, "{coarse} {fine}");
    }

    #[test]
    fn gradients_are_slopes_of_the_angle_and_a_convex_edge_has_a_positive_one() {
        let mut corners = [[0.0, 0.1, 0.0], [1.0, 0.0, 0.2], [0.3, 1.0, -0.4], [0.6, -0.8, -0.3]].map(Vector3::from);
        let hinge = Hinge { ends: [0, 1], wings: [2, 3], rest: 0.2, stiffness: 1.0 };
        let spring = hinge.spring::<3>(&|body: usize| corners[body]);
        // outside is above: both wings lie below the edge
        assert!(hinge.angle(&|body: usize| corners[body]) > 0.3);
        for (body, gradient) in spring.ends {
            for axis in 0..3 {
                let here = corners[body][axis];
                let [after, before] = [1e-5, -1e-5].map(|by| {
                    corners[body][axis] = here + by;
                    hinge.angle(&|body: usize| corners[body])
                });
                corners[body][axis] = here;
                assert!(
                    ((after - before) / 2e-5 - gradient[axis]).abs() < 1e-8,
                    "{body} {axis}: {} {}",
                    (after - before) / 2e-5,
                    gradient[axis]
                );
            }
        }
        corners[2].z = 0.9;
        corners[3].z = 0.9;
        assert!(hinge.angle(&|body: usize| corners[body]) < -0.3);
    }
}
