//! `turbid view`: what its page holds, and, where Chromium is installed, what is seen on it.

#![allow(clippy::unwrap_used, clippy::print_stderr)]

#[path = "view/browser.rs"]
mod browser;
mod common;
#[path = "view/page.rs"]
mod page;
#[path = "view/refusals.rs"]
mod refusals;
#[path = "resume/scenes.rs"]
#[allow(dead_code, reason = "the other scenes are for other tests")]
mod scenes;
#[path = "view/server.rs"]
mod server;
