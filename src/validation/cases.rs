//! The cases: scenes with known answers on grids with known errors.

mod chains;
mod clusters;
mod random;
mod spring;

use super::{beds, case::Case, scenes};

/// All cases, in the order of the table: those that are files, then those of several solves.
pub fn cases() -> Vec<Case> {
    let mut all = scenes::cases();
    all.extend(random::cases());
    all.extend(beds::cases());
    all.extend(clusters::cases());
    all.extend(chains::cases());
    all.push(spring::case());
    all
}
