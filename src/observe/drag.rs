//! Coefficients of drag and lift: the force on a body over that of the inertia of a stream past it.

use nalgebra::SVector;

use crate::geometry::Ball;

/// A stream to which forces are referred.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stream<const D: usize> {
    /// Its velocity, not zero.
    pub velocity: SVector<f64, D>,
    /// Mass of its fluid per volume, positive.
    pub density: f64,
}

/// A force over `density U^2 / 2` times the diameter (2D) or the cross-section (3D) of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceCoefficients {
    /// Along the stream.
    pub drag: f64,
    /// Across the stream: in 2D to its left (upwards where it goes along x), in 3D the components along the axes of what is not drag.
    pub lift: Vec<f64>,
}

impl<const D: usize> Stream<D> {
    /// The coefficients of a force by the fluid on a body.
    pub fn coefficients(&self, ball: &Ball<D>, force: &SVector<f64, D>) -> ForceCoefficients {
        let section = if D == 2 { 2.0 * ball.radius } else { std::f64::consts::PI * ball.radius * ball.radius };
        let (along, coefficient) = (self.velocity.normalize(), force / (0.5 * self.density * self.velocity.norm_squared() * section));
        let drag = along.dot(&coefficient);
        let lift = if D == 2 {
            vec![along[0] * coefficient[1] - along[1] * coefficient[0]]
        } else {
            (coefficient - along * drag).as_slice().to_vec()
        };
        ForceCoefficients { drag, lift }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::*;

    #[test]
    fn a_force_is_split_along_and_across_the_stream() {
        let ball = Ball { center: Vector2::zeros(), radius: 0.25 };
        let stream = Stream { velocity: Vector2::new(2.0, 0.0), density: 3.0 };
        assert_eq!(stream.coefficients(&ball, &Vector2::new(6.0, 1.5)), ForceCoefficients { drag: 2.0, lift: vec![0.5] });
        // the same seen by one who is turned a quarter to the left
        let turned = Stream { velocity: Vector2::new(0.0, 2.0), density: 3.0 };
        assert_eq!(turned.coefficients(&ball, &Vector2::new(-1.5, 6.0)), ForceCoefficients { drag: 2.0, lift: vec![0.5] });
    }

    #[test]
    fn the_lift_of_a_sphere_is_what_is_not_drag() {
        let ball = Ball { center: Vector3::zeros(), radius: 1.0 };
        let stream = Stream { velocity: Vector3::new(0.0, 0.0, -2.0), density: 1.0 };
        let force = Vector3::new(1.0, -3.0, -4.0) * std::f64::consts::TAU;
        let ForceCoefficients { drag, lift } = stream.coefficients(&ball, &force);
        assert!((drag - 4.0).abs() < 1e-14 && lift.iter().zip([1.0, -3.0, 0.0]).all(|(lift, exact)| (lift - exact).abs() < 1e-14));
    }
}
