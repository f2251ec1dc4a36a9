//! Known answers: cases whose values are published or exactly computable, solved on this machine.

mod bars;
mod cases;
mod crowds;

use std::time::Instant;

use crate::{error::Result, output::say, petsc::Session};

pub use bars::{Bar, KnownScene, bars, known_scenes, random_scene};
pub use cases::cases;
pub use crowds::crowds;

/// Solves a case and measures its quantity; collective.
pub type Solve = Box<dyn Fn(&Session) -> Result<f64>>;

/// A case with a known answer.
pub struct Case {
    /// What is measured.
    pub name: &'static str,
    /// Where the reference comes from.
    pub source: &'static str,
    /// Grid and modes.
    pub resolution: String,
    /// The known value.
    pub reference: f64,
    /// Largest relative error that is promised.
    pub tolerance: f64,
    /// How to get ours.
    pub solve: Solve,
}

impl Case {
    /// Relative error of a value.
    pub fn error(&self, value: f64) -> f64 {
        value / self.reference - 1.0
    }
}

/// Solves all cases and prints them as a table in Markdown; tells whether every promise is kept.
pub fn validation(session: &Session) -> Result<bool> {
    let first = session.world().rank() == 0;
    let say = |text: &str| session.world().agree(if first { say(text) } else { Ok(()) });
    say("| case | resolution | reference | turbid | error | seconds | source |\n|-|-|-|-|-|-|-|")?;
    let mut kept = true;
    for case in cases() {
        let start = Instant::now();
        let value = (case.solve)(session)?;
        let seconds = session.world().max(start.elapsed().as_secs_f64());
        let error = case.error(value);
        kept &= error.abs() <= case.tolerance;
        let (name, resolution, source, percent) = (case.name, &case.resolution, case.source, 100.0 * error);
        say(&format!("| {name} | {resolution} | {:.6} | {value:.6} | {percent:+.3} % | {seconds:.3} | {source} |", case.reference))?;
    }
    Ok(kept)
}
