//! Ten thousand scenes whose numbers and letters were exchanged at random: none makes the door panic, every refusal comes soon and with
//! exit code 2. A part of them goes through the program itself, within limits of time and memory.
//!
//! With `TURBID_FUZZ_SUMMARY=docs/parts/hard-fuzz.md` what became of them is written there.

use std::{
    collections::BTreeMap,
    fs,
    os::unix::process::ExitStatusExt,
    path::Path,
    process::Command,
    time::{Duration, Instant},
};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use turbid::{
    error::Result,
    plan::{Plan, demand},
    scene::Scene,
};

use super::{DRY, PIECES, WET, mutate};
use crate::common::{PROGRAM, bodies, folder, root, said, settle, write};

/// Seeds, and how many of them go through the program.
const INPUTS: u64 = 10_000;
const PLANNED: u64 = 80;
const RUN: u64 = 40;

/// Bytes beyond which a scene is not planned here.
const LARGE: f64 = 3e7;

/// What a refusal may take, with a search for places that finds none, and what a process may.
const SOON: Duration = Duration::from_secs(2);
const SEARCHED: Duration = Duration::from_secs(15);
const LIMITS: &str = "ulimit -v 1500000; exec timeout 300 \"$0\" \"$@\"";

/// Signals to a process that has used up its seconds of a core.
pub const OUT_OF_TIME: i32 = 24;
pub const KILLED: i32 = 9;

const SPHERES: &str = r#"[domain]
size = [6.0, 6.0, 6.0]
z = { lower = [0.0, 0.0, 0.0], upper = [1.0, 0.0, 0.0] }
[flow]
viscosity = 1.0
[resolution]
cells_per_radius = 3
[method]
inverse = "auto"
constraint = "sharp"
[[bodies]]
radius = 1.0
count = 3
gap = 0.2
density = 2.0
force = [0.0, 0.0, -1.0]
[lubrication]
model = "pairwise"
roughness = 1e-3
"#;

const SCALAR: &str = r#"[domain]
size = [4.0, 4.0]
x = "walls"
[flow]
model = "scalar"
source = 1.0
[resolution]
spacing = 0.1
modes = 4
[method]
constraint = "penalty"
epsilon = 1e-5
tolerance = 1e-7
[[bodies]]
radius = 0.6
centers = [[1.0, 2.0], [3.0, 2.5]]
"#;

const SHEARED: &str = r#"seed = 3
[domain]
size = [8.0, 8.0]
[flow]
drive = { shear_rate = 0.5, periodic = "sheared" }
[resolution]
cells_per_radius = 4
[method]
inverse = "transform"
[[bodies]]
radius = 1.0
fraction = 0.2
[contact]
model = "repulsion"
stiffness = 100.0
range = 0.1
[time]
step = 0.05
end = 1.0
"#;

const FITTED: &str = r#"[domain]
size = [8.0, 8.0]
y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }
[resolution]
spacing = 0.4
[method]
constraint = "fitted"
[[bodies]]
radius = 1.0
centers = [[2.0, 2.5], [5.0, 5.5]]
"#;

const SCENES: [&str; 6] = [WET, DRY, SPHERES, SCALAR, SHEARED, FITTED];

const NUMBERS: [&str; 30] = [
    "0",
    "-1",
    "1",
    "2.5",
    "3",
    "7",
    "16",
    "100",
    "0.3",
    "0.999999",
    "1e-3",
    "1e-6",
    "1e-9",
    "1e-60",
    "1e-61",
    "1e-300",
    "5e-324",
    "1e3",
    "1e6",
    "1e12",
    "1e60",
    "1e61",
    "1e200",
    "1e308",
    "nan",
    "-inf",
    "30000",
    "1000000000000",
    "9223372036854775807",
    "-9223372036854775808",
];

/// A scene with up to three of its numbers exchanged, now and then with other changes too.
fn input(seed: u64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut text = SCENES[random.random_range(0..SCENES.len())].to_owned();
    for _ in 0..random.random_range(1..=3) {
        let places = numbers(&text);
        let (start, end) = places[random.random_range(0..places.len())];
        text.replace_range(start..end, NUMBERS[random.random_range(0..NUMBERS.len())]);
    }
    if random.random_range(0..5) == 0 {
        let edit = (random.random_range(0..10_000), random.random_range(0..12), random.random_range(0..PIECES.len()));
        text = mutate(&text, &PIECES, &[edit]);
    }
    text
}

/// Where numbers stand.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let part = |letter: char| letter.is_ascii_digit() || "+-.e".contains(letter);
    let mut places = Vec::new();
    let mut start = None;
    for (place, letter) in text.char_indices() {
        let before = text[..place].chars().next_back().unwrap_or(' ');
        match start {
            None if letter.is_ascii_digit() || (letter == '-' && before == ' ') => start = (!before.is_alphanumeric()).then_some(place),
            Some(begin) if !part(letter) => {
                places.push((begin, place));
                start = None;
            }
            _ => {}
        }
    }
    places
}

/// What becomes of an input, and its refusal.
pub fn door(text: &str) -> (&'static str, Result<()>) {
    let scene = match Scene::parse("mutant", Path::new("folder"), text, &[]) {
        Ok(scene) => scene,
        Err(error) => return ("refused when read", Err(error)),
    };
    let planned = if scene.dimension() == 2 { plan::<2>(&scene) } else { plan::<3>(&scene) };
    match planned {
        Ok(true) => ("planned", Ok(())),
        Ok(false) => ("too large to be planned here", Ok(())),
        Err(error) => ("refused when planned", Err(error)),
    }
}

fn plan<const D: usize>(scene: &Scene) -> Result<bool> {
    if scene.accuracy.is_some() || demand::<D>(scene, 1).is_ok_and(|bytes| bytes > LARGE) {
        return Ok(false);
    }
    Plan::<D>::of(scene)?.report(1).map(|_| true)
}

#[test]
fn ten_thousand_scenes_with_other_numbers_are_planned_or_refused_soon() {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut slowest = Duration::ZERO;
    for seed in 0..INPUTS {
        let text = input(seed);
        let start = Instant::now();
        let (outcome, error) = std::panic::catch_unwind(|| door(&text)).unwrap_or_else(|_| panic!("seed {seed} panics:\n{text}"));
        let taken = start.elapsed();
        *counts.entry(outcome).or_default() += 1;
        if let Err(error) = error {
            assert_eq!(error.exit_code(), 2, "seed {seed}: {error}\n{text}");
            let searched = error.to_string().contains("the search reached");
            assert!(taken < if searched { SEARCHED } else { SOON }, "seed {seed} is refused after {taken:?}: {error}\n{text}");
            slowest = if searched { slowest } else { slowest.max(taken) };
        }
    }
    assert!(counts.len() == 4 && counts.values().all(|&count| count > 50), "{counts:?}");
    summarize(&counts, slowest);
}

#[test]
fn the_program_plans_or_refuses_mutated_scenes_within_its_limits() {
    let here = folder("mutations-plan");
    for seed in INPUTS..INPUTS + PLANNED {
        let scene = write(&here, &input(seed));
        let output = limited(10, &["plan", scene.to_str().unwrap()]);
        let (code, said) = (output.status.code(), said(&output));
        assert!(code == Some(0) && said.is_empty() || code == Some(2) && said.starts_with("turbid: "), "seed {seed}: {code:?} {said}");
    }
}

#[test]
fn no_mutated_scene_ends_well_with_numbers_that_are_none() {
    let here = folder("mutations-run");
    let instant = |seed: &u64| {
        let text = input(*seed);
        let scene = Scene::parse("mutant", Path::new("folder"), &text, &[]).ok();
        let small = |scene: &Scene| {
            (if scene.dimension() == 2 { demand::<2>(scene, 1) } else { demand::<3>(scene, 1) }).is_ok_and(|bytes| bytes < LARGE)
        };
        scene.is_some_and(|scene| scene.time.is_none() && scene.accuracy.is_none() && small(&scene))
    };
    for seed in (2 * INPUTS..).filter(instant).take(RUN as usize) {
        let scene = write(&here, &input(seed));
        let out = here.join("out");
        let _ = fs::remove_dir_all(&out);
        let output = limited(3, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--set", "output.picture=false"]);
        match output.status.code() {
            Some(0) => {
                let summary = serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
                let numbers = if summary_has_bodies(&summary) { bodies(&summary) } else { Vec::new() };
                assert!(numbers.iter().all(|number| number.is_finite()), "seed {seed}: {summary}");
            }
            // a solve that takes longer than its limits let it
            Some(124) => {}
            None if matches!(output.status.signal(), Some(OUT_OF_TIME | KILLED)) => {}
            code => {
                assert!(matches!(code, Some(1 | 2)) && said(&output).starts_with("turbid: "), "seed {seed}: {code:?} {}", said(&output))
            }
        }
        assert!(!said(&output).contains("panicked"), "seed {seed}: {}", said(&output));
    }
}

fn summary_has_bodies(summary: &serde_json::Value) -> bool {
    summary["bodies"].as_array().is_some_and(|bodies| !bodies.is_empty())
}

/// The program within its limits, one of which is given in seconds of a core.
pub fn limited(seconds: u32, arguments: &[&str]) -> std::process::Output {
    let mut command = Command::new("bash");
    command.args(["-c", &format!("ulimit -t {seconds}; {LIMITS}"), PROGRAM]).args(arguments);
    settle(&mut command);
    command.output().unwrap()
}

fn summarize(counts: &BTreeMap<&str, usize>, slowest: Duration) {
    let Ok(path) = std::env::var("TURBID_FUZZ_SUMMARY") else { return };
    let count = |outcome: &str| counts.get(outcome).copied().unwrap_or_default();
    let text = format!(
        "\n## Mutated scenes\n\nOf {INPUTS} scenes with numbers exchanged at random for extreme ones (`cargo test --test long mutations::`, seeds fixed), {} are\n\
         refused when they are read and {} when they are planned, {} are planned, and {} are too large to be planned in the test. None panics,\n\
         every refusal has exit code 2, and the slowest without a search for places took {:.2} s. {PLANNED} more go through `turbid plan`, and {RUN} through `turbid run`,\n\
         each within 1.5 GB of addresses and 10 or 3 s of one core: none panics, and none ends with exit code 0 and a number that is none.\n",
        count("refused when read"),
        count("refused when planned"),
        count("planned"),
        count("too large to be planned here"),
        slowest.as_secs_f64()
    );
    fs::write(root().join(path), text).unwrap();
}
