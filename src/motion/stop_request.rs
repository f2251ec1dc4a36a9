//! A request to stop, which may come at any time.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use crate::{
    error::{Error, Result},
    parallel::World,
};

/// Whether somebody asks for a stop; without a flag nobody does.
#[derive(Debug, Clone, Default)]
pub struct StopRequest(Option<Arc<AtomicBool>>);

impl StopRequest {
    /// The one that a flag of this rank tells of.
    pub fn of(flag: Arc<AtomicBool>) -> StopRequest {
        StopRequest(Some(flag))
    }

    /// Goes on unless a rank is asked to stop, at this time of a run. Collective.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn heed(&self, world: &World, time: f64) -> Result<()> {
        let Some(flag) = &self.0 else { return Ok(()) };
        let asked = world.max(f64::from(flag.load(Ordering::Relaxed))) > 0.0;
        if asked { Err(Error::Stopped { time, folder: None }) } else { Ok(()) }
    }
}
