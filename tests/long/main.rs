//! What takes minutes: runs that are killed, stopped and resumed, hard cases, drawn scenes, readers that share no code with the program.

#![allow(clippy::unwrap_used)]

#[path = "../common/mod.rs"]
mod common;
mod hard;
mod independent_reader;
mod mutations;
mod resume;
