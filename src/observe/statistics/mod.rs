//! Mean of a quantity that fluctuates in time, with an interval that respects its correlation.
//!
//! The steps of a run differ in length, so the curve is first averaged over stretches of equal strain. A tenth of it is left out, or more where a start-up
//! stands out; the interval comes from the scatter of few long blocks. Pure functions of slices.

mod blocks;
mod harmonics;
mod resampling;
mod shortage;
mod steady;
mod transient;

pub use blocks::{BLOCKS, FEWEST, Interval, interval, mean, standard_error, student};
pub use harmonics::{HARMONICS, Harmonics, harmonics};
pub use resampling::{mean_from, resampled, samples_from};
pub use shortage::Shortage;
pub use steady::{Steady, steady};
pub use transient::transient;

#[cfg(test)]
mod tests;
