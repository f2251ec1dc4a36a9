//! Cuts through a box as pictures and films show them.

pub mod film;
pub mod network;
pub mod picture;
pub mod plane;
pub mod scalar_picture;
pub mod scale;
