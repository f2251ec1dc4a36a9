//! What flows into a box that is open along an axis.

/// A flow into the box at the lower end of an axis, along it, and out at the upper end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inflow {
    /// The largest velocity.
    pub speed: f64,
    /// Whether it falls to zero at the walls of other axes, as a product of parabolas; else it is uniform.
    pub parabolic: bool,
}
