//! What a run leaves behind and shows on the way: files are complete or absent.

mod animation;
mod chart;
mod file;
mod images;
mod picture;
mod progress;
mod report;
mod summary;

pub use animation::{AnimatedDisk, Animation, AnimationFrame};
pub use chart::{Chart, Series};
pub use file::{prepare_folder, write_whole};
pub use picture::{Disk, Picture};
pub use progress::Progress;
pub use report::report;
pub use summary::Summary;
