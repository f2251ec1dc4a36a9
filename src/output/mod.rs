//! What a run leaves behind and shows on the way: files are complete or absent.

mod file;
mod picture;
mod progress;
mod report;
mod summary;

pub use file::{prepare_folder, write_whole};
pub use picture::{Disk, Picture};
pub use progress::Progress;
pub use report::report;
pub use summary::Summary;
