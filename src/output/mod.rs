//! What a run leaves behind and shows on the way: files are complete or absent.

mod checkpoint;
mod file;
mod frames;
mod picture;
mod progress;
mod report;
mod slab;
mod summary;
mod together;

pub use checkpoint::{Checkpoint, CheckpointWriter};
pub use file::{prepare_folder, write_whole};
pub use frames::{Frame, FrameBody, FrameFields, Frames, StoredFrame, read_frames};
pub use picture::{Disk, Picture};
pub use progress::Progress;
pub use report::report;
pub use summary::Summary;
