//! Mean of a quantity that fluctuates in time, with an interval that respects its correlation.
//!
//! The steps of a run differ in length, so the curve is first averaged over stretches of equal strain. Its beginning is left out as far as that
//! makes the mean more certain; the interval comes from means over blocks that grow until their scatter grows no more. Pure functions of slices.

mod blocking;
mod resampling;
mod shortage;
mod steady;
mod transient;

pub use blocking::{FEWEST_BLOCKS, Interval, interval, student};
pub use resampling::{mean_from, resampled};
pub use shortage::Shortage;
pub use steady::{Steady, steady};
pub use transient::transient;

#[cfg(test)]
mod tests;
