//! Signals: what the user or the batch system asks of a run under way.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use signal_hook::{
    consts::{SIGINT, SIGTERM, SIGUSR1},
    flag::register,
};

use crate::{
    error::{Error, Result},
    motion::StopRequest,
};

/// Signals that have come since the start; this rank's.
pub struct Signals {
    stop: Arc<AtomicBool>,
    checkpoint: Arc<AtomicBool>,
}

impl Signals {
    /// From now on SIGINT and SIGTERM ask for a stop after the step, or between the solves that it takes, and SIGUSR1 for a checkpoint.
    pub fn listen() -> Result<Signals> {
        let signals = Signals { stop: Arc::default(), checkpoint: Arc::default() };
        let listen = || {
            for signal in [SIGINT, SIGTERM] {
                register(signal, signals.stop.clone())?;
            }
            register(SIGUSR1, signals.checkpoint.clone())
        };
        listen().map_err(Error::Signals)?;
        Ok(signals)
    }

    /// Whether the run is to stop.
    pub fn stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// What long work looks at.
    pub fn stop_request(&self) -> StopRequest {
        StopRequest::of(self.stop.clone())
    }

    /// Whether a checkpoint is asked for; asked once.
    pub fn take_checkpoint(&self) -> bool {
        self.checkpoint.swap(false, Ordering::Relaxed)
    }
}
