//! Rules of the project, checked without solving anything: the order of modules, refusals of bad scenes, the manual.

#![allow(clippy::unwrap_used)]

mod manual;
mod modules;
mod refusals;
