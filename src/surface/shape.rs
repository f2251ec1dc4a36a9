//! Shapes of rigid bodies: all that the rest of the program asks of one.

use std::rc::Rc;

use nalgebra::{SMatrix, SVector};

use super::{Modes, SurfaceTable, modes};
use crate::geometry::Ball;

/// The shape of a rigid body, about its centre of mass. Offsets are from that centre.
pub trait Shape<const D: usize> {
    /// Distance from the surface, negative inside.
    fn signed_distance(&self, offset: &SVector<f64, D>) -> f64;

    /// Radius of the smallest ball about the centre that holds it.
    fn bounding_radius(&self) -> f64;

    /// Volume (area in 2D).
    fn volume(&self) -> f64;

    /// Moment of inertia about an axis through the centre at unit density.
    fn moment_of_inertia(&self) -> f64;

    /// The point of the surface that is farthest along a unit vector: where it is touched by a plane normal to that.
    fn contact_point(&self, direction: &SVector<f64, D>) -> SVector<f64, D>;

    /// The shape turned about its centre by a rotation.
    fn turned(&self, rotation: &SMatrix<f64, D, D>) -> Rc<dyn Shape<D>>;

    /// Multiplier modes up to an order, and the jumps that they cause, at unit viscosity.
    fn modes(&self, order: usize) -> Box<dyn Modes>;

    /// The surface with its modes, sampled about as finely as a grid of this spacing.
    fn surface(&self, order: usize, spacing: f64) -> SurfaceTable<D> {
        SurfaceTable::of(self.modes(order), order, spacing)
    }
}

impl<const D: usize> Shape<D> for Ball<D> {
    fn signed_distance(&self, offset: &SVector<f64, D>) -> f64 {
        offset.norm() - self.radius
    }

    fn bounding_radius(&self) -> f64 {
        self.radius
    }

    fn volume(&self) -> f64 {
        Ball::volume(self)
    }

    fn moment_of_inertia(&self) -> f64 {
        // of a disk, 1/2 m r^2, and of a sphere, 2/5 m r^2
        self.volume() * self.radius.powi(2) * 2.0 / (D + 2) as f64
    }

    fn contact_point(&self, direction: &SVector<f64, D>) -> SVector<f64, D> {
        direction * self.radius
    }

    fn turned(&self, _: &SMatrix<f64, D, D>) -> Rc<dyn Shape<D>> {
        Rc::new(*self)
    }

    fn modes(&self, order: usize) -> Box<dyn Modes> {
        modes(D, self.radius, order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What any shape must keep, by midpoints of a lattice of so many cells across: a shape's own closed forms agree with its distance.
    fn conforms<const D: usize>(shape: &dyn Shape<D>, cells: usize, tolerance: f64) {
        let (radius, count) = (shape.bounding_radius(), cells.pow(D as u32));
        let cell = 2.0 * radius / cells as f64;
        let point = |place: usize| {
            SVector::<f64, D>::from_fn(|axis, _| (place / cells.pow(axis as u32) % cells) as f64 * cell + 0.5 * cell - radius)
        };
        let inside = || (0..count).map(point).filter(|offset| shape.signed_distance(offset) < 0.0);
        let volume = inside().count() as f64 * cell.powi(D as i32);
        assert!((volume / shape.volume() - 1.0).abs() < tolerance, "volume {volume}, said {}", shape.volume());
        let inertia: f64 = inside().map(|offset| offset[0].powi(2) + offset[1].powi(2)).sum::<f64>() * cell.powi(D as i32);
        assert!((inertia / shape.moment_of_inertia() - 1.0).abs() < tolerance, "inertia {inertia}, said {}", shape.moment_of_inertia());
        let center = inside().fold(SVector::<f64, D>::zeros(), |sum, offset| sum + offset);
        assert!(center.norm() < tolerance * radius * inside().count() as f64, "the centre of mass is not the origin");

        let surface = shape.surface(4, radius / 5.0);
        for offset in surface.offsets() {
            assert!(shape.signed_distance(&offset).abs() < 1e-12 * radius && offset.norm() <= radius * (1.0 + 1e-12));
            let direction = offset.normalize();
            let farthest = shape.contact_point(&direction);
            assert!(shape.signed_distance(&farthest).abs() < 1e-12 * radius, "{farthest} is not on the surface");
            assert!(surface.offsets().all(|other| direction.dot(&other) <= direction.dot(&farthest) + 1e-12 * radius));
        }
        let modes = shape.modes(4);
        assert_eq!((modes.dimension(), modes.count()), (D, surface.modes.count()));
    }

    #[test]
    fn balls_conform() {
        conforms::<2>(&Ball { center: SVector::zeros(), radius: 0.7 }, 400, 2e-3);
        conforms::<3>(&Ball { center: SVector::from([1.0, 2.0, 3.0]), radius: 1.3 }, 80, 2e-3);
    }
}
