//! A part of the box, in which bodies are placed at random.

use crate::{error::Result, scene::entry::Entry};

/// A part of the box with sides along its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Its lower corner.
    pub lower: Vec<f64>,
    /// Its upper corner, above the lower one along every axis.
    pub upper: Vec<f64>,
}

impl Region {
    pub(in crate::scene) fn read(entry: &Entry, dimension: usize) -> Result<Region> {
        let corners = entry.list()?;
        entry.expect((), corners.len() == 2, "must be a lower and an upper corner")?;
        let (lower, upper) = (corners[0].vector(dimension)?, corners[1].vector(dimension)?);
        let ordered = lower.iter().zip(&upper).all(|(lower, upper)| lower < upper);
        entry.expect(Region { lower, upper }, ordered, "must have its lower corner below its upper corner along every axis")
    }

    /// Whether it reaches from end to end of a box of this size along an axis.
    pub fn spans(&self, axis: usize, size: f64) -> bool {
        self.lower[axis] == 0.0 && self.upper[axis] == size
    }

    /// Its volume; in 2D its area.
    pub fn volume(&self) -> f64 {
        self.upper.iter().zip(&self.lower).map(|(upper, lower)| upper - lower).product()
    }

    /// The corners as a scene file has them.
    pub fn text(&self) -> String {
        format!("[{:?}, {:?}]", self.lower, self.upper)
    }
}
