//! How the images of a sheared box slide: the boxes above it lie displaced along x, and further so as time passes.

use super::Protocol;

/// The images above the box along y, displaced along x (Lees and Edwards 1972, doi:10.1088/0022-3719/5/15/006).
///
/// What is at `(x, y)` is also at `(x + shift, y + size_y)`, and moves there faster by [`speed`](Self::speed).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeesEdwards {
    /// Displacement at time 0.
    pub start: f64,
    /// Speed of the images above the box relative to the box over time: the shear rate times its height.
    pub protocol: Protocol,
    /// The time.
    pub time: f64,
}

impl LeesEdwards {
    /// Images that slide at one speed.
    pub fn steady(start: f64, speed: f64, time: f64) -> LeesEdwards {
        LeesEdwards { start, protocol: Protocol::Steady(speed), time }
    }

    /// Displacement of the images above the box, of any number of its lengths.
    pub fn shift(&self) -> f64 {
        self.start + self.protocol.passed(self.time)
    }

    /// Speed of the images above the box relative to the box.
    pub fn speed(&self) -> f64 {
        self.protocol.rate(self.time)
    }

    /// Images that are where these are and slide as far as these in the interval to come, at one speed.
    pub fn over(&self, interval: f64) -> LeesEdwards {
        let speed = self.protocol.mean_rate(self.time, interval);
        if self.protocol.steady() { *self } else { LeesEdwards::steady(self.shift() - speed * self.time, speed, self.time) }
    }
}
