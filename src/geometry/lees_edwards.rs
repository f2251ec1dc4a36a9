//! How the images of a sheared box slide: the boxes above it lie displaced along x, and further so as time passes.

/// The images above the box along y, displaced along x (Lees and Edwards 1972, doi:10.1088/0022-3719/5/15/006).
///
/// What is at `(x, y)` is also at `(x + shift, y + size_y)`, and moves there faster by `speed`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeesEdwards {
    /// Displacement at time 0.
    pub start: f64,
    /// Speed of the images above the box relative to the box: the shear rate times its height.
    pub speed: f64,
    /// The time.
    pub time: f64,
}

impl LeesEdwards {
    /// Displacement of the images above the box, of any number of its lengths.
    pub fn shift(&self) -> f64 {
        self.start + self.speed * self.time
    }
}
