//! Friction between bodies of which some are rigid clusters or chains.

pub mod contacts;
pub mod islands;
pub mod report;
