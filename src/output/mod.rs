//! What a run leaves behind and shows on the way: files are complete or absent.

mod accuracy;
mod animation;
mod chart;
mod checkpoint;
mod file;
mod frames;
mod images;
mod picture;
mod probe;
mod progress;
mod report;
mod restart;
mod scalar;
mod series;
mod slab;
mod spread;
mod stages;
mod summary;
mod together;

pub use accuracy::{AccuracySummary, DragSummary, EstimatedErrors};
pub use animation::{AnimatedDisk, Animation, AnimationFrame};
pub use chart::{Chart, Level, Mark, Notes, Scale, Series};
pub use checkpoint::{Checkpoint, CheckpointWriter};
pub use file::{prepare_folder, write_whole};
pub use frames::{Frame, FrameBody, FrameContact, FrameFields, Frames, StoredFrame, read_frames};
pub use picture::{Disk, Picture, escaped};
pub use probe::Probe;
pub use progress::{Progress, TimeProgress};
pub use report::{report, sparkline};
pub use restart::{restore, store};
pub use scalar::{InclusionSummary, ScalarSummary};
pub use series::{ContactNumbers, Row, Rows};
pub use spread::{ParallelSummary, Spread};
pub use stages::stage_table;
pub use summary::{ContactSummary, GlueSummary, MotionSummary, Summary};
