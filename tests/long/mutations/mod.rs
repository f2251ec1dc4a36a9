//! No text and no override makes the scene reader panic, and the text of what it accepts gives the same scene.
//! No table makes the reader of centres panic, and what it accepts is finite.
//!
//! `TURBID_FUZZ_CASES` is the number of cases of each test.

mod drawn;
mod motion;
mod objects;
mod pairs;
mod promises;
mod scenes;
mod units;

use std::path::Path;

use proptest::prelude::*;
use turbid::body::parse_centers;
use turbid::scene::Scene;

const WET: &str = r#"title = "mutant"
seed = 7
gravity = [0.0, -1.5]
[domain]
size = [8.0, 4.0]
x = "periodic"
y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }
[flow]
viscosity = 2.0
drive = { mean_velocity = [1.0, 0.0] }
[resolution]
cells_per_radius = 6
modes = "auto"
[method]
tolerance = 1e-8
[[bodies]]
radius = 0.5
centers = [[1.0, 2.0],
           [3.0, 2.0]]
motion = { velocity = [0.5, 0.0], spin = 2.0 }
[[bodies]]
radius = 1.0
fraction = 0.3
torque = 0.25
[contact]
model = "inelastic"
[time]
step = 0.01
end = 2.0
scheme = "midpoint"
[output]
every = 0.1
fields = false
checkpoint = 60
"#;

const DRY: &str = r#"gravity = [0.0, 0.0, -9.81]
[domain]
size = [4.0, 4.0, 8.0]
z = "walls"
[flow]
model = "none"
[[bodies]]
radius = 0.5
count = 20
density = 2.5
velocity = [1.0, 0.0, 0.0]
spin = [0.0, 0.0, 1.0]
[[bodies]]
radius = 1.0
centers = [[2.0, 2.0, 1.0]]
motion = "fixed"
[contact]
model = "inelastic"
[time]
end = 2.0
step = "auto"
travel = 0.2
"#;

const TABLE: &str = "# made by hand\nx,y,z,radius\n1.0,2.0,3.0,0.5\n\n4.5,-5e-1,6,1e-3\n 7 , 8,9 ,0.25\n";

const PIECES: [&str; 45] = [
    "[",
    "]",
    "{",
    "}",
    "=",
    ".",
    ",",
    "\"",
    "\n",
    "#",
    "-",
    "nan",
    "inf",
    "1e999",
    "-1",
    "0",
    "9223372036854775807",
    "true",
    "1979-05-27",
    "[[bodies]]\n",
    "[flow.drive]\n",
    "bodies",
    "drive",
    "size",
    "domain",
    "spacing = 1\n",
    "é",
    "\\u0000",
    "\r\n",
    "'''",
    "\"\"\"",
    "[[[[[[[[",
    "{a=",
    "3.",
    "z = \"walls\"\n",
    "count = 2\n",
    "[time]\n",
    "step = 3\n",
    "model = \"none\"\n",
    "model = \"scalar\"\n",
    "source = 2\n",
    "\"auto\"",
    "velocity = [1, 0]\n",
    "[output]\n",
    "fields = true\n",
];

const TABLE_PIECES: [&str; 20] =
    [",", "\n", "\r\n", "#", "x", "y", "z", "radius", "nan", "inf", "-", "1e999", "0", "1e-400", ".", "e", " ", "\u{feff}", "é", "\"1\""];

const KEYS: [&str; 35] = [
    "seed",
    "title",
    "domain",
    "domain.size",
    "domain.size.1",
    "domain.y",
    "domain.y.lower",
    "flow.drive",
    "flow.drive.shear_rate",
    "flow.drive.periodic",
    "flow",
    "resolution.spacing",
    "resolution",
    "bodies",
    "bodies.0",
    "bodies.1.count",
    "bodies.0.centers.1",
    "bodies.0.motion.spin",
    "bodies.9.radius",
    "output.picture",
    "no.such.key",
    "time",
    "time.step",
    "time.end",
    "time.travel",
    "time.scheme",
    "output",
    "output.every",
    "output.fields",
    "output.checkpoint",
    "flow.model",
    "contact.model",
    "bodies.0.velocity",
    "bodies.0.spin",
    "bodies.0.density",
];

const VALUES: [&str; 22] = [
    "1",
    "0.5",
    "-2",
    "walls",
    "fixed",
    "[]",
    "[1.0, 0.0]",
    "[[1, 1]]",
    "{}",
    "{shear_rate=1}",
    "false",
    "nan",
    "",
    "[",
    "[{radius=1, count=2}]",
    "\"a\\nb\"",
    "none",
    "auto",
    "euler",
    "inelastic",
    "sheared",
    "{end=3}",
];

fn cases() -> ProptestConfig {
    let cases = std::env::var("TURBID_FUZZ_CASES").map_or(2000, |cases| cases.parse().unwrap());
    ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases) }
}

type Edit = (usize, usize, usize);

fn edits(pieces: &[&str], most: usize) -> impl Strategy<Value = Vec<Edit>> {
    prop::collection::vec((0..10_000_usize, 0..12_usize, 0..pieces.len()), 0..=most)
}

fn mutate(text: &str, pieces: &[&str], edits: &[Edit]) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    for &(position, removed, piece) in edits {
        let start = position % (letters.len() + 1);
        let end = (start + removed).min(letters.len());
        letters.splice(start..end, pieces[piece].chars());
    }
    letters.into_iter().collect()
}

fn read_twice(text: &str, overrides: &[String]) -> Result<(), TestCaseError> {
    if let Ok(scene) = Scene::parse("mutant", Path::new("folder"), text, overrides) {
        let again = Scene::parse("mutant", Path::new("folder"), &scene.text, &[]);
        let again = again.map_err(|error| TestCaseError::fail(format!("{error} in\n{}", scene.text)))?;
        prop_assert_eq!(scene.difference(&again), None);
        let locations = scene.locations.clone();
        prop_assert_eq!(Scene { locations, ..again }, scene);
    }
    Ok(())
}

fn read_table<const D: usize>(text: &str) -> Result<(), TestCaseError> {
    for (center, radius) in parse_centers::<D>("mutant.csv", text).unwrap_or_default() {
        prop_assert!(center.iter().all(|number| number.is_finite()), "{center} in\n{text}");
        prop_assert!(radius.is_none_or(|radius| radius.is_finite() && radius > 0.0), "{radius:?} in\n{text}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn mutated_texts_never_panic(dry: bool, edits in edits(&PIECES, 4)) {
        read_twice(&mutate(if dry { DRY } else { WET }, &PIECES, &edits), &[])?;
    }

    #[test]
    fn overrides_of_mutated_texts_never_panic(
        dry: bool,
        edits in edits(&PIECES, 1),
        changes in prop::collection::vec((0..KEYS.len(), 0..VALUES.len()), 0..4),
    ) {
        let change = |&(key, value): &(usize, usize)| format!("{}={}", KEYS[key], VALUES[value]);
        let changes: Vec<String> = changes.iter().map(change).collect();
        let _ = Scene::resumable_overrides(&changes);
        read_twice(&mutate(if dry { DRY } else { WET }, &PIECES, &edits), &changes)?;
    }

    #[test]
    fn arbitrary_overrides_never_panic(change in "[a-z0-9.\\[\\]]{0,12}=?[\\PC\n]{0,12}") {
        let changes = [change];
        let _ = Scene::resumable_overrides(&changes);
        read_twice(WET, &changes)?;
    }

    #[test]
    fn mutated_tables_never_panic(edits in edits(&TABLE_PIECES, 5)) {
        let text = mutate(TABLE, &TABLE_PIECES, &edits);
        read_table::<2>(&text)?;
        read_table::<3>(&text)?;
    }
}

#[test]
fn the_texts_before_mutation_are_right() {
    for text in [WET, DRY] {
        Scene::parse("origin", Path::new("folder"), text, &[]).unwrap();
    }
    assert_eq!(parse_centers::<3>("origin.csv", TABLE).unwrap().len(), 3);
}
