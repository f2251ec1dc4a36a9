//! What is written of a run: the interface behind which frames, series, checkpoints, pictures and the progress line stand.

use super::{statistics::RunStatistics, view::View};
use crate::{
    error::{Error, Result},
    motion::Simulation,
    output::Summary,
    parallel::World,
};

/// Writes one thing of a run, at its own pace, and cannot change the run. All functions are collective but [`iterate`](Output::iterate).
pub trait Output<const D: usize> {
    /// Is told of an iteration of the solver at an instant and its relative residual, on each rank.
    fn iterate(&mut self, _iteration: usize, _residual: f64) {}

    /// Keeps what a restart from this state needs, before it is evaluated.
    ///
    /// # Errors
    /// A file cannot be written, here and below.
    fn keep(&mut self, _before: &BeforeStep<D>) -> Result<()> {
        Ok(())
    }

    /// Writes what is due of an instant that was evaluated.
    fn write(&mut self, _seen: &View<D>) -> Result<()> {
        Ok(())
    }

    /// Is told, on each rank by itself, that the run ends here because of an error or a signal.
    fn interrupted(&mut self, _error: &Error) {}

    /// Writes what is due at the end, adds to the summary what it found, and gives the names of its files.
    fn finish(&mut self, _seen: &View<D>, _summary: &mut Summary) -> Result<Vec<String>> {
        Ok(Vec::new())
    }
}

/// A state that was not evaluated yet.
pub struct BeforeStep<'a, const D: usize> {
    /// All ranks.
    pub world: &'a World,
    /// The simulation.
    pub simulation: &'a Simulation<D>,
    /// What its steps cost and kept so far.
    pub statistics: &'a RunStatistics,
    /// Whether somebody asks for a checkpoint, or the next step may be the last; may differ from rank to rank.
    pub due: bool,
}
