//! Directions of a contact, and how bodies move there.

use nalgebra::{SMatrix, SVector};

use crate::{
    body::{Twist, planes},
    contact::{Contact, ContactForce, Partner},
    geometry::{Ball, Domain},
};

/// Where the axis that makes the first tangent is not used: too near to the normal.
const OBLIQUE: f64 = 0.6;

/// The directions of a contact, normal first, and how far from the centres its bodies touch.
pub struct Frame<const D: usize> {
    /// Orthonormal: the normal from the body to the partner, then tangents.
    pub axes: [SVector<f64, D>; D],
    /// Distances of the point of contact from the centre of the body and from that of the partner; their sum is the distance of the centres, so that a
    /// rigid rotation of a pair does not slip.
    pub arms: [f64; 2],
    /// The reduced radius, by which couples against rolling and twisting are forces: of two bodies `a_1 a_2 / (a_1 + a_2)`, at a wall that of the body.
    pub reduced_radius: f64,
}

impl<const D: usize> Frame<D> {
    /// That of a contact.
    pub fn new(contact: &Contact<D>, balls: &[Ball<D>]) -> Frame<D> {
        let own = balls[contact.body].radius;
        // a wall is none
        let ball = contact.other().filter(|&other| balls[other].radius.is_finite());
        let (arms, reduced_radius) = ball.map_or(([contact.separation, 0.0], own), |other| {
            let whole = own + balls[other].radius;
            ([own, balls[other].radius].map(|radius| radius * contact.separation / whole), own * balls[other].radius / whole)
        });
        Frame { axes: axes(&contact.normal), arms, reduced_radius }
    }

    /// Components of a vector.
    pub fn components(&self, vector: &SVector<f64, D>) -> [f64; D] {
        std::array::from_fn(|axis| self.axes[axis].dot(vector))
    }

    /// The tangential vector of these components.
    pub fn tangential(&self, components: &[f64; D]) -> SVector<f64, D> {
        (1..D).map(|axis| self.axes[axis] * components[axis]).sum()
    }

    /// The velocity of the partner's surface relative to the body's.
    pub fn slip(&self, domain: &Domain<D>, contact: &Contact<D>, twists: &[Twist<D>]) -> SVector<f64, D> {
        self.between(contact, twists) + carried(domain, contact)
    }

    /// The same without what images and walls add.
    fn between(&self, contact: &Contact<D>, twists: &[Twist<D>]) -> SVector<f64, D> {
        let normal = &contact.normal;
        let own = twists[contact.body].at(&(normal * self.arms[0]));
        contact.other().map_or_else(SVector::zeros, |other| twists[other].at(&(-normal * self.arms[1]))) - own
    }

    /// The same along the axes, with the gap over the step along the normal: `u`.
    pub fn velocity(&self, domain: &Domain<D>, contact: &Contact<D>, twists: &[Twist<D>], step: f64) -> [f64; D] {
        let mut velocity = self.components(&self.slip(domain, contact, twists));
        velocity[0] += contact.gap / step;
        velocity
    }

    /// What the spin of a body, component by component, adds along a tangent where it is an arm of one from its centre.
    pub fn turning(&self, tangent: usize) -> impl Iterator<Item = f64> {
        let (normal, along) = (self.axes[0], self.axes[tangent]);
        planes::<D>().iter().map(move |&(row, column)| along[row] * normal[column] - along[column] * normal[row])
    }

    /// The change of spin, over the inverse of inertia, by a tangential impulse on the surface at an arm along the normal.
    pub fn torque(&self, impulse: &SVector<f64, D>, arm: f64) -> SMatrix<f64, D, D> {
        let lever = self.axes[0] * arm;
        // of a skew matrix the entries (row, column) are force times lever minus its transpose
        impulse * lever.transpose() - lever * impulse.transpose()
    }
}

impl<const D: usize> ContactForce<D> {
    /// What force and couple do on the two bodies, which move so.
    pub fn power(&self, balls: &[Ball<D>], twists: &[Twist<D>]) -> f64 {
        let turning = self.contact.other().map_or_else(SMatrix::zeros, |other| twists[other].spin) - twists[self.contact.body].spin;
        // a skew matrix has each component twice
        self.whole().dot(&Frame::new(&self.contact, balls).between(&self.contact, twists)) + 0.5 * self.couple.dot(&turning)
    }
}

/// The velocity of the partner's surface besides that by its own motion: of an image that slides, or of a wall.
pub fn carried<const D: usize>(domain: &Domain<D>, contact: &Contact<D>) -> SVector<f64, D> {
    match contact.partner {
        Partner::Body(_) => contact.sliding,
        Partner::Wall { axis, upper } => domain.wall_velocity(axis, upper),
    }
}

fn axes<const D: usize>(normal: &SVector<f64, D>) -> [SVector<f64, D>; D] {
    let mut axes = [*normal; D];
    if D == 2 {
        axes[1] = SVector::from_fn(|axis, _| if axis == 0 { -normal[1] } else { normal[0] });
        return axes;
    }
    let along = usize::from(normal[0].abs() >= OBLIQUE);
    axes[1] = cross(normal, &SVector::from_fn(|axis, _| f64::from(axis == along))).normalize();
    axes[2] = cross(normal, &axes[1]);
    axes
}

/// The vector product, in three dimensions.
pub fn cross<const D: usize>(one: &SVector<f64, D>, two: &SVector<f64, D>) -> SVector<f64, D> {
    SVector::from_fn(|axis, _| one[(axis + 1) % D] * two[(axis + 2) % D] - one[(axis + 2) % D] * two[(axis + 1) % D])
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::{
        body::{components, skew},
        geometry::Axis,
    };

    #[test]
    fn a_rigid_rotation_of_a_pair_across_a_gap_does_not_slip_and_the_torques_of_a_force_balance() {
        let domain = Domain { size: [20.0; 3].into(), axes: [Axis::Periodic; 3] };
        let (normal, radii) = (Vector3::new(0.5, -0.3, 0.8).normalize(), [1.0, 0.6]);
        let centers = [Vector3::new(5.0, 5.0, 5.0), Vector3::new(5.0, 5.0, 5.0) + normal * 1.9];
        let balls: Vec<Ball<3>> = centers.iter().zip(radii).map(|(&center, radius)| Ball { center, radius }).collect();
        let contact = Contact::between(&domain, &balls, [0, 1], centers[1] - centers[0]);
        let frame = Frame::new(&contact, &balls);
        assert!((frame.arms[0] + frame.arms[1] - contact.separation).abs() < 1e-15);
        let spin = skew(&[0.3, -0.2, 0.9]);
        let twists = centers.map(|center| Twist { velocity: spin * center, spin });
        assert!(frame.slip(&domain, &contact, &twists).norm() < 1e-14);
        let impulse = frame.axes[1] * 0.7 - frame.axes[2] * 0.4;
        // on the partner the lever points against the normal
        let torques = frame.torque(&-impulse, frame.arms[0]) + frame.torque(&impulse, -frame.arms[1]);
        let of_forces = skew::<3>((centers[1] - centers[0]).cross(&impulse).as_slice());
        assert!((torques + of_forces).norm() < 1e-14);
        for (tangent, axis) in [(1, 0), (2, 2)] {
            let one = frame.turning(tangent).nth(axis).unwrap();
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            assert!((one - frame.axes[tangent].dot(&(skew::<3>(&unit) * normal))).abs() < 1e-15);
            let torque = components(&frame.torque(&frame.axes[tangent], 1.0))[axis];
            assert!((torque - one).abs() < 1e-15, "power is the same by rates and by torques");
        }
    }
}
