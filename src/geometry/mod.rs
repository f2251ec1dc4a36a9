//! Where things are: the box and its images. It knows no fluid and no forces.

mod domain;

pub use domain::{Axis, Domain};
mod ball;
pub use ball::Ball;
mod pairs;
pub use pairs::{Pair, near_pairs};
