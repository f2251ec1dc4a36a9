//! Runs: a scene solved at an instant or simulated in time, what is written of it, and how it goes on.
//!
//! A [`Run`] knows the order of things and no file; each [`Output`] writes one thing at its own pace and cannot change the run.

mod calibration;
mod column;
mod command;
mod finished;
mod folder;
mod memory;
mod motion_view;
mod options;
mod origin;
mod output;
mod outputs;
mod page;
mod progress;
mod quantities;
mod quantity;
#[expect(clippy::module_inception, reason = "the run is what the module is named after")]
mod run;
mod scalar;
mod signals;
mod statistics;
mod summary;
mod trial;
mod view;
mod viscosity;

pub use calibration::{
    Calibration, CalibrationAnswer, Estimate, EstimatedQuantity, RefinementLevel, RefinementSequence, STEADY, Solved, cached, coarsest,
    refine_whole_runs, still_to_come, unresolved,
};
pub use column::{Number, SeriesColumn, SeriesEntry};
pub use command::command;
pub use finished::Finished;
pub use folder::{NewRun, RunFolder};
pub use memory::{check_memory, check_memory_of_plan};
pub use motion_view::{ContactTotals, MotionView};
pub use options::Options;
pub use output::{BeforeStep, Output};
pub use outputs::outputs;
pub use progress::{Progress, TimeProgress};
pub use quantities::columns;
pub use quantity::{Finite, Quantity, QuantityValue};
pub use run::{Run, complete};
pub use statistics::{KeptContacts, RunStatistics};
pub use trial::Trial;
pub use view::{FlowView, View};
pub use viscosity::ViscosityHistory;
