//! The box: its size, its walls and its periodic images.

use nalgebra::SVector;

/// What bounds the box along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Axis<const D: usize> {
    /// The box repeats.
    Periodic,
    /// Two walls, each with a velocity (tangential: its component along the axis is zero).
    Walls {
        /// Velocity of the wall at coordinate 0.
        lower: SVector<f64, D>,
        /// Velocity of the wall at coordinate `size`.
        upper: SVector<f64, D>,
    },
}

/// The box `[0, size_0) x .. x [0, size_{D-1})`.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain<const D: usize> {
    /// Edge lengths.
    pub size: SVector<f64, D>,
    /// What bounds each axis.
    pub axes: [Axis<D>; D],
}

impl<const D: usize> Domain<D> {
    /// Whether the box repeats along `axis`.
    pub fn periodic(&self, axis: usize) -> bool {
        self.axes[axis] == Axis::Periodic
    }

    /// Whether the box repeats along every axis.
    pub fn fully_periodic(&self) -> bool {
        (0..D).all(|axis| self.periodic(axis))
    }

    /// Volume of the box (area in 2D).
    pub fn volume(&self) -> f64 {
        self.size.product()
    }

    /// The shortest of the periodic images of a separation.
    pub fn nearest_image(&self, mut separation: SVector<f64, D>) -> SVector<f64, D> {
        for axis in (0..D).filter(|&axis| self.periodic(axis)) {
            separation[axis] -= self.size[axis] * (separation[axis] / self.size[axis]).round();
        }
        separation
    }

    /// The periodic image of a point that lies in the box.
    pub fn wrap(&self, mut point: SVector<f64, D>) -> SVector<f64, D> {
        for axis in (0..D).filter(|&axis| self.periodic(axis)) {
            let wrapped = point[axis].rem_euclid(self.size[axis]);
            // rem_euclid of a tiny negative number rounds up to the size itself
            point[axis] = if wrapped < self.size[axis] { wrapped } else { 0.0 };
        }
        point
    }
}
