//! Where things are: the box and its images. It knows no fluid and no forces.

mod domain;

pub use domain::{Axis, Domain};
