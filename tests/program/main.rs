//! The program as a user meets it: examples, studies, pages, the viewer, limits.

#![allow(clippy::unwrap_used)]

#[path = "../common/mod.rs"]
mod common;
mod conditioning;
mod cost;
mod cost_inertia;
mod examples;
mod limits;
mod report;
mod scaling;
mod sweep;
mod view;
