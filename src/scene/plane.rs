//! The plane of pictures.

use crate::{
    geometry::Protocol,
    scene::{AxisSection, Drive, Scene},
};

impl Scene {
    /// The axes that point right and up in pictures: as the scene says, or else such that gravity pulls down, or else such that walls shear what is
    /// between them, or else such that walls are above and below.
    pub fn plane_of_pictures(&self) -> [usize; 2] {
        let up = || self.axis_of_gravity().or_else(|| self.axis_of_shear()).or_else(|| self.axis_of_walls()).unwrap_or(1);
        self.output.plane.unwrap_or_else(|| [0, up()])
    }

    /// The axis across that plane; nothing in two dimensions.
    pub fn depth_of_pictures(&self) -> Option<usize> {
        let plane = self.plane_of_pictures();
        (0..self.dimension()).find(|axis| !plane.contains(axis))
    }

    /// The rate of the shear that walls or the drive impose, if they impose one; the largest where it changes.
    pub fn shear_rate(&self) -> Option<f64> {
        match &self.flow.drive {
            Some(Drive::ShearRate(Protocol::Steady(rate)) | Drive::ShearedBox(Protocol::Steady(rate))) => return Some(*rate),
            Some(Drive::ShearRate(protocol) | Drive::ShearedBox(protocol)) => return Some(protocol.fastest()),
            _ => {}
        }
        let rate = |(section, size): (&AxisSection, &f64)| match section {
            AxisSection::Walls { lower, upper } if lower != upper => {
                Some(lower.iter().zip(upper).map(|(one, other)| (one - other).powi(2)).sum::<f64>().sqrt() / size)
            }
            _ => None,
        };
        self.domain.axes.iter().zip(&self.domain.size).find_map(rate)
    }

    fn axis_of_gravity(&self) -> Option<usize> {
        let gravity = self.gravity.as_deref().unwrap_or_default();
        let strongest = (0..gravity.len()).max_by(|&one, &two| gravity[one].abs().total_cmp(&gravity[two].abs()));
        strongest.filter(|&axis| axis > 0 && gravity[axis] != 0.0)
    }

    fn axis_of_shear(&self) -> Option<usize> {
        (1..self.dimension()).find(|&axis| matches!(&self.domain.axes[axis], AxisSection::Walls { lower, upper } if lower != upper))
    }

    fn axis_of_walls(&self) -> Option<usize> {
        (1..self.dimension()).find(|&axis| matches!(self.domain.axes[axis], AxisSection::Walls { .. }))
    }
}
