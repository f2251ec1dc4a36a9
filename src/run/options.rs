//! What the caller of a run chooses.

/// What a run does besides its outputs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Options {
    /// Whether SIGINT and SIGTERM stop a run in time after the step, or between its solves, and SIGUSR1 asks for a checkpoint.
    pub signals: bool,
    /// Whether a line on the terminal shows how far it has come.
    pub progress: bool,
}
