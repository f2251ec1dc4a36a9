//! Whether this installation works: what it was built with, what it runs on, and a few known answers within two seconds.

use std::{env, time::Instant};

use super::{case::Case, scenes};
use crate::{
    error::{Error, Result},
    output::{ffmpeg_present, say},
    parallel::{Machine, free_memory_bytes, memory_in_words},
    petsc::Session,
    study::Study,
};

/// Rows of the table of known answers that take tenths of a second: both dimensions, transforms and multigrid, fluid and films.
const SELF_TEST: [&str; 3] = ["drag, square array 0.3", "drag, cubic array 0.064", "viscosity from the walls, disk in a Couette cell"];

/// Check this installation.
#[derive(Debug, Clone, clap::Args)]
pub struct Doctor {}

impl Study<Session> for Doctor {
    const NAME: &'static str = "doctor";
    const ABOUT: &'static str = "Check this installation: libraries, ranks, cores, threads, memory, and known answers within seconds";

    fn run(&self, session: &Session) -> Result<()> {
        let world = session.world();
        let say = |text: &str| world.on_first_rank(|| say(text));
        let ranks = world.size();
        // ranks that are bound to cores see these alone
        let cores = Machine::local().cores;
        let free = -world.max(-free_memory_bytes());
        say(&format!("turbid      {}, {}", env!("CARGO_PKG_VERSION"), env!("TURBID_LIBRARIES")))?;
        say(&format!("built       {}", env!("TURBID_BUILD")))?;
        say(&format!("ranks       {ranks}{}", crowded(ranks, cores)))?;
        say(&format!("cores       {cores} that a rank may use"))?;
        say(&format!("threads     {}", threads(env::var("OMP_NUM_THREADS").ok().as_deref())))?;
        say(&format!("memory      {} free", memory_in_words(free)))?;
        say(&format!(
            "ffmpeg      {}",
            if ffmpeg_present() { "found" } else { "not found: turbid animate writes APNG and GIF, no MP4 or WebM" }
        ))?;
        let mut kept = true;
        for case in self_test() {
            let start = Instant::now();
            let error = case.error((case.solve)(session)?);
            let seconds = world.max(start.elapsed().as_secs_f64());
            let right = error.abs() <= case.tolerance;
            kept &= right;
            let (word, off, most) = (if right { "right" } else { "WRONG" }, 100.0 * error, 100.0 * case.tolerance);
            say(&format!(
                "known answer {word}: {} ({}), {off:+.3} % off, {most:.3} % at most, {seconds:.2} s",
                case.name, case.resolution
            ))?;
        }
        match kept {
            true => Ok(()),
            false => {
                Err(Error::Diverged("a known answer is further off than promised: this build or one of its libraries is faulty".into()))
            }
        }
    }
}

/// The first row of each name.
fn self_test() -> impl Iterator<Item = Case> {
    let mut found = Vec::new();
    scenes::cases().into_iter().filter(move |case| {
        let new = SELF_TEST.contains(&case.name) && !found.contains(&case.name);
        found.push(case.name);
        new
    })
}

fn crowded(ranks: usize, cores: usize) -> String {
    match ranks > cores {
        true => ": more than cores that a rank may use; unless ranks are bound to cores of their own, runs are slow".into(),
        false => String::new(),
    }
}

fn threads(set: Option<&str>) -> String {
    match set {
        Some("1") => "1 a rank (OMP_NUM_THREADS)".into(),
        Some(other) => format!("{other} a rank (OMP_NUM_THREADS); set it to 1: a rank has one thread of work"),
        None => "OMP_NUM_THREADS is not set; set it to 1 where the BLAS library has threads of its own".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_self_test_has_all_its_rows() {
        assert_eq!(self_test().count(), SELF_TEST.len());
    }

    #[test]
    fn more_ranks_than_cores_and_threads_are_told() {
        assert!(crowded(4, 2).contains("more than cores") && crowded(2, 2).is_empty());
        assert!(
            threads(None).contains("not set") && threads(Some("8")).contains("set it to 1") && threads(Some("1")).starts_with("1 a rank")
        );
    }
}
