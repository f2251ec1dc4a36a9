//! How a disk moves.

use nalgebra::Vector2;

/// A rigid motion of a disk: velocity and spin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneTwist {
    /// Velocity of the centre.
    pub velocity: Vector2<f64>,
    /// Counter-clockwise.
    pub spin: f64,
}

impl PlaneTwist {
    /// The velocity at an arm from the centre.
    pub fn at(&self, arm: &Vector2<f64>) -> Vector2<f64> {
        self.velocity + self.spin * Vector2::new(-arm.y, arm.x)
    }
}
