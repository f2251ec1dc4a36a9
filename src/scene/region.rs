//! A part of the box, in which bodies are placed at random.

use super::{
    AxisSection, Drive, Scene,
    demand::{expect, name},
    entry::Entry,
};
use crate::error::Result;

/// A part of the box with sides along its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Its lower corner.
    pub lower: Vec<f64>,
    /// Its upper corner, above the lower one along every axis.
    pub upper: Vec<f64>,
}

impl Region {
    pub(super) fn read(entry: &Entry, dimension: usize) -> Result<Region> {
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

/// Refuses regions that are no part of their box, or across which images slide.
pub(super) fn check(scene: &Scene) -> Result<()> {
    for (group, bodies) in scene.bodies.iter().enumerate() {
        let Some(region) = &bodies.region else { continue };
        let key = format!("{}.region", scene.group_key(group));
        let size = &scene.domain.size;
        for axis in 0..size.len() {
            let inside = region.lower[axis] >= 0.0 && region.upper[axis] <= size[axis];
            let remedy = format!("leaves the box along {}, which goes from 0 to {}", name(axis), size[axis]);
            expect(scene, inside, &key, region.text(), &remedy)?;
            let open = matches!(scene.domain.axes[axis], AxisSection::Open { .. });
            let remedy = format!(
                "ends within the box along {}, along which fluid flows in and out; bodies keep clear of both: let it reach from 0 to {}",
                name(axis),
                size[axis]
            );
            expect(scene, !open || region.spans(axis, size[axis]), &key, region.text(), &remedy)?;
        }
        let torn = matches!(scene.flow.drive, Some(Drive::ShearedBox(_))) && region.spans(1, size[1]) && !region.spans(0, size[0]);
        let remedy = format!(
            "ends within the box along x and not along y, across which images slide along x; let it reach from 0 to {} along x, or end within the box along y",
            size[0]
        );
        expect(scene, !torn, &key, region.text(), &remedy)?;
    }
    Ok(())
}
