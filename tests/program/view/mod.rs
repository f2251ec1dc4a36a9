//! `turbid view`: what its page holds, and, where Chromium is installed, what is seen on it.

#![allow(clippy::print_stderr)]

mod browser;
mod page;
mod refusals;
mod server;
