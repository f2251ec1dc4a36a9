//! Five hundred scenes drawn over the key space, most of them with motion in time, planned and run: what must hold of every run is checked, and on a
//! sample that units, the place in the box, the number of ranks and a stop half way change nothing.
//!
//! `TURBID_FUZZ_MOTION=N` draws so many, `TURBID_FUZZ_FIRST=N` begins with that seed, and `TURBID_FUZZ_KEEP=1` keeps the folders.

use std::{
    collections::BTreeMap,
    fs,
    os::unix::process::ExitStatusExt,
    path::{Path, PathBuf},
    process::Output,
    sync::{
        Mutex,
        atomic::{AtomicU64, Ordering},
    },
};

use super::{
    drawn::{Drawn, draw},
    pairs,
    promises::broken,
    scenes::{KILLED, OUT_OF_TIME, door, limited},
    units::Units,
};
use crate::common::{folder, said};

const DRAWN: u64 = 500;

/// Of how many scenes one goes through each kind of pair, and two through `turbid plan`.
const SAMPLE: u64 = 20;

/// Seconds of a core for a run, and for a plan, which runs a scene for two seconds.
const SECONDS: u32 = 2;
const SECONDS_OF_PLAN: u32 = 10;

/// Runs a scene into a folder of its own within the limits; nothing if they did not let it end.
pub fn run(here: &Path, name: &str, text: &str, settings: &[&str]) -> Option<(PathBuf, Output)> {
    let (scene, out) = (here.join(format!("{name}.toml")), here.join(name));
    fs::write(&scene, text).unwrap();
    let mut arguments = vec!["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
    settings.iter().for_each(|setting| arguments.extend(["--set", setting]));
    let output = limited(SECONDS, &arguments);
    let stopped = output.status.code() == Some(124) || matches!(output.status.signal(), Some(OUT_OF_TIME | KILLED));
    (!stopped).then_some((out, output))
}

/// What became of a scene, and what is wrong with it.
fn examined(seed: u64, here: &Path) -> (&'static str, Vec<String>) {
    let drawn = draw(seed, Units::PLAIN);
    let planned = std::panic::catch_unwind(|| door(&drawn.text).1.err().map(|error| (error.exit_code(), error.to_string())));
    let Ok(refusal) = planned else { return ("panics when planned", vec!["panics when planned".to_owned()]) };
    let Some((out, output)) = run(here, &format!("run-{seed}"), &drawn.text, &[]) else { return ("took too long", Vec::new()) };
    let (code, said) = (output.status.code(), said(&output));
    let mut wrong = Vec::new();
    if !matches!(code, Some(0..=2)) || said.contains("panicked") || code != Some(0) && !said.contains("turbid: ") {
        wrong.push(format!("ends with {code:?}: {said}"));
    }
    if let Some((refused, reason)) = &refusal
        && code != Some(*refused)
    {
        wrong.push(format!("the plan is refused ({reason}), the run ends with {code:?}: {said}"));
    }
    if matches!(seed % SAMPLE, 0 | 10) {
        wrong.extend(plans_as_it_runs(here, seed, code));
    }
    match code {
        Some(0) => {
            wrong.extend(broken(&drawn, &out));
            wrong.extend(paired(seed, &drawn, here, &out));
            ("ran to the end", wrong)
        }
        Some(2) => ("refused", wrong),
        _ => ("ended with an error", wrong),
    }
}

/// The command `turbid plan`, which also solves a sample of the scene, accepts what runs.
fn plans_as_it_runs(here: &Path, seed: u64, run: Option<i32>) -> Option<String> {
    let scene = here.join(format!("run-{seed}.toml"));
    let output = limited(SECONDS_OF_PLAN, &["plan", scene.to_str().unwrap()]);
    let code = output.status.code();
    let right = code == Some(0) || code == Some(2) && run == Some(2);
    (!right).then(|| format!("turbid plan ends with {code:?}, the run with {run:?}: {}", said(&output)))
}

/// The kinds of pairs in turn.
fn paired(seed: u64, drawn: &Drawn, here: &Path, out: &Path) -> Vec<String> {
    match seed % SAMPLE {
        1 | 11 => pairs::in_other_units(seed, drawn, here, out),
        2 | 7 | 12 => pairs::elsewhere(seed, drawn, here, out),
        3 => pairs::on_other_ranks(seed, drawn, here, out),
        4 => pairs::in_halves(seed, drawn, here, out),
        _ => Vec::new(),
    }
}

#[test]
fn five_hundred_drawn_scenes_keep_what_every_run_promises() {
    let number = |name: &str, other: u64| std::env::var(name).map_or(other, |text| text.parse().unwrap());
    let (first, count) = (number("TURBID_FUZZ_FIRST", 0), number("TURBID_FUZZ_MOTION", DRAWN));
    let keep = std::env::var("TURBID_FUZZ_KEEP").is_ok();
    let here = folder("mutations-motion");
    let (next, outcomes) = (AtomicU64::new(first), Mutex::new(BTreeMap::<&str, u64>::new()));
    let failures = Mutex::new(Vec::new());
    let work = || {
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= first + count {
                return;
            }
            let folder = here.join(seed.to_string());
            fs::create_dir_all(&folder).unwrap();
            let (outcome, wrong) = examined(seed, &folder);
            *outcomes.lock().unwrap().entry(outcome).or_default() += 1;
            failures.lock().unwrap().extend(wrong.into_iter().map(|wrong| format!("seed {seed}: {wrong}")));
            if !keep {
                fs::remove_dir_all(&folder).unwrap();
            }
        }
    };
    std::thread::scope(|scope| {
        (0..std::thread::available_parallelism().map_or(1, usize::from)).for_each(|_| {
            scope.spawn(work);
        });
    });
    let (outcomes, failures) = (outcomes.into_inner().unwrap(), failures.into_inner().unwrap());
    assert!(failures.is_empty(), "{} of {count} ({outcomes:?}):\n{}", failures.len(), failures.join("\n"));
    assert!(count < DRAWN || outcomes.get("ran to the end").is_some_and(|&ran| ran > count / 2), "{outcomes:?}");
}
