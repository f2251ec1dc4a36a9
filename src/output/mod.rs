//! What a run leaves behind and shows on the way: files are complete or absent.

mod accuracy;
mod answer;
mod body_summary;
mod clock;
mod curve;
mod effort;
mod files;
mod frames;
mod motions;
mod numbers;
mod oscillation;
mod probe;
mod quantities;
mod report;
mod report_page;
mod research_crate;
mod run_scene;
mod say;
mod scalar;
mod spread;
mod stages;
mod statistics;
mod summary;
mod too_short;
mod traces;
mod video;
mod view;

pub use accuracy::{AccuracySummary, DragSummary, EstimatedErrors};
pub use answer::{Answer, answers};
pub use body_summary::{BODY_TABLE, BodySummary, MOST_LISTED, write_bodies};
pub use clock::{date, duration};
pub use curve::{CurvePoint, MeanViscosity, viscosity_too_short};
pub use effort::effort_chart;
pub use files::checkpoint::{Checkpoint, CheckpointWriter};
pub use files::checksum::checksum_of;
pub use files::columns::{AXES, Columns, column_names, row_numbers};
pub use files::file::{prepare_folder, remove_file, write_whole, write_whole_with};
pub use files::finite::{check_finite, not_finite};
pub use files::lock::FolderLock;
pub use frames::{
    FlowLayer, Frame, FrameBond, FrameContact, FrameCorner, FrameFace, FrameFields, FrameFile, FrameMembranes, FrameSurroundings, Frames,
    StoredFrame, read_frames,
};
pub use motions::{ForceSummary, MeanSpeed, SettlingSummary, VelocitySummary};
pub use numbers::{bar, lengths_of_steps, number, plain, vector, with_bar};
pub use oscillation::{Modulus, OscillationSummary, measured_stress};
pub use quantities::{QuantitySummary, SteadyMean};
pub use report::{report, sparkline};
pub use report_page::{Breakdown, Facts, Image, Page, Standing, Table, bodies_table};
pub use research_crate::{RunRecord, write_crate};
pub use run_scene::{SCENE, SWEEP, SWEEP_RUNS, scene_and_frames, scene_file};
pub use say::{note, say};
pub use scalar::{InclusionSummary, ScalarSummary};
pub use spread::{ParallelSummary, Spread};
pub use stages::stage_table;
pub use statistics::autocorrelation::{AutocorrelationSummary, autocorrelation_files};
pub use statistics::displacements::{DisplacementSummary, displacement_files};
pub use statistics::pairs::{PAIR_FILES, PairSummary, pair_files};
pub use statistics::profiles::ProfileFrames;
pub use statistics::structure_factor::{ShellSummary, StructureFactorSummary, structure_factor_files};
pub use summary::{ContactSummary, EnergySummary, FrictionSummary, GlueSummary, InertiaSummary, MotionSummary, Summary};
pub use too_short::TooShort;
pub use traces::{CHECKPOINT, CRATE, KNOWN_FILES, LOG, REPORT, SUMMARY, Traces};
pub use video::{convert_to_video, ffmpeg_present};
pub use view::{RunView, serve};
