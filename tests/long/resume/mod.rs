//! Runs in time as a user meets them: resumed, killed, stopped, refused, on a full disk.

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
mod signals;
mod tables;
mod until;
