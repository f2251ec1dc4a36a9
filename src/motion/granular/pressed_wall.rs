//! What presses a wall on granular bodies, and how it moves by that alone.

use nalgebra::SVector;

use super::setup::WallLoad;
use crate::{motion::step_control::BodyMotion, setup::WallMotion};

/// A wall under a load on its way.
pub struct PressedWall {
    /// What presses it, and what is fixed to it.
    pub load: WallLoad,
    /// Where it was at the start.
    pub start: f64,
    /// Radius of the smallest body, by which its step is measured.
    smallest: f64,
}

impl PressedWall {
    /// A wall at the end of a box of this size, over bodies of which the smallest has this radius.
    pub fn new<const D: usize>(load: WallLoad, size: &SVector<f64, D>, smallest: f64) -> PressedWall {
        PressedWall { start: size[load.axis], load, smallest }
    }

    /// Its velocity by the load alone.
    pub fn wanted<const D: usize>(&self, wall: &WallMotion<D>, push: f64) -> f64 {
        wall.velocity - self.load.force / self.load.mass * push
    }

    /// How it moves, as a body whose step is chosen.
    pub fn motion<const D: usize>(&self, wall: &WallMotion<D>, last_step: f64) -> BodyMotion<D> {
        let along = |value: f64| SVector::from_fn(|axis, _| if axis == wall.axis { value } else { 0.0 });
        let acceleration = -self.load.force / self.load.mass;
        // velocities live half a step before places
        let velocity = along(wall.velocity + 0.5 * last_step * acceleration);
        BodyMotion { radius: self.smallest, velocity, acceleration: along(acceleration) }
    }
}
