//! The spatial structure of suspensions: distributions of pairs and the structure factor.

pub mod ideal_gas;
pub mod pair_map;
pub mod pairs;
pub mod structure_factor;
pub mod wave_vectors;
