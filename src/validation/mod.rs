//! Known answers: cases whose values are published or exactly computable, solved on this machine.

mod bars;
mod bead_model;
mod beds;
mod case;
mod cases;
mod channel;
mod dense;
mod doctor;
mod falling;
mod follow;
mod inertia;
mod kissing;
mod known;
mod oscillation;
mod places;
mod scenes;
mod solve;
mod strokes;

use std::time::Instant;

pub use self::{
    bars::random_scene,
    case::Case,
    cases::cases,
    doctor::Doctor,
    known::{ErrorBar, KnownScene},
    scenes::known_scenes,
};
use crate::{
    error::{Error, Result},
    output::say,
    petsc::Session,
    study::Study,
};

/// Which of the known answers to hold the program to.
#[derive(Debug, Clone, clap::Args)]
pub struct Validation {
    /// Solve scenes with known answers to these accuracies instead, and print their error bars beside the true errors.
    #[arg(long, value_delimiter = ',', num_args = 0.., default_missing_value = "1e-2", value_name = "ACCURACY")]
    pub bars: Vec<f64>,
    /// With --bars: so many scenes drawn at random, with answers from fine grids, in place of those with known ones.
    #[arg(long, requires = "bars", value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub random: Option<u64>,
    /// Seed of the first of them.
    #[arg(long, default_value_t = 1, requires = "random", value_parser = clap::value_parser!(u64).range(..=1_000_000))]
    pub seed: u64,
    /// All of them in 3D, every second one a lattice of fixed spheres.
    #[arg(long, requires = "random")]
    pub space: bool,
    /// Solve dense suspensions with many lubrication films instead: known ones, and series of number, fraction and gap that show the cost.
    #[arg(long = "crowds", conflicts_with = "bars")]
    pub dense: bool,
    /// Measure drag, settling and viscosity of random beds with lubrication films instead, on coarse and on fine grids.
    #[arg(long, conflicts_with_all = ["bars", "dense"])]
    pub beds: bool,
    /// Follow bodies in flows with inertia instead: all cases, or those that are named.
    #[arg(long, value_enum, value_delimiter = ',', num_args = 0.., default_missing_values = inertia::NAMES, value_name = "CASES")]
    #[arg(conflicts_with_all = ["bars", "dense", "beds"])]
    pub inertia: Vec<inertia::Family>,
}

impl Study<Session> for Validation {
    const NAME: &'static str = "validation";
    const ABOUT: &'static str = "Solve cases with known answers and print a table of errors and seconds";

    fn run(&self, session: &Session) -> Result<()> {
        if !self.inertia.is_empty() {
            return inertia::inertia(session, &self.inertia);
        }
        if self.beds {
            return beds::beds(session);
        }
        let random = self.random.map(|count| bars::RandomScenes { seeds: self.seed..self.seed + count, space: self.space });
        let (kept, broken) = match (self.dense, self.bars.is_empty()) {
            (true, _) => return dense::dense_suspensions(session),
            (_, true) => (table(session)?, "a case is further from its reference than promised"),
            _ => (bars::bars(session, &self.bars, random)?, "more than one error bar in twelve does not hold the true error"),
        };
        if kept { Ok(()) } else { Err(Error::Diverged(broken.into())) }
    }
}

/// Solves all cases and prints them as a table in Markdown; tells whether every promise is kept.
fn table(session: &Session) -> Result<bool> {
    let say = |text: &str| session.world().on_first_rank(|| say(text));
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
