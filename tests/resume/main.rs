//! Runs in time as a user meets them: resumed, killed, stopped, refused, on a full disk.

#![allow(clippy::unwrap_used)]

#[path = "../common/mod.rs"]
mod common;
mod disk;
mod energy;
mod folders;
mod given;
mod halves;
mod kills;
mod lost;
mod obstacle;
mod promises;
mod refusals;
mod scenes;
mod signals;
mod tables;
mod until;
