//! `chains.csv`, `cells.csv` and `clusters.csv`: a row of each such object at the times of frames.

pub mod cells;
pub mod chains;
pub mod clusters;
mod table;
mod turns;
