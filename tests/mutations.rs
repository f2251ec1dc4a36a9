//! No text and no override makes the scene reader panic, and the text of what it accepts gives the same scene.

use std::path::Path;

use proptest::prelude::*;
use turbid::scene::Scene;

const SCENE: &str = r#"title = "mutant"
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
"#;

const PIECES: [&str; 36] = [
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
];

const KEYS: [&str; 20] = [
    "seed",
    "title",
    "domain",
    "domain.size",
    "domain.size.1",
    "domain.y",
    "domain.y.lower",
    "flow.drive",
    "flow.drive.shear_rate",
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
];

const VALUES: [&str; 16] = [
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
];

fn mutate(edits: &[(usize, usize, usize)]) -> String {
    let mut letters: Vec<char> = SCENE.chars().collect();
    for &(position, removed, piece) in edits {
        let start = position % (letters.len() + 1);
        let end = (start + removed).min(letters.len());
        letters.splice(start..end, PIECES[piece].chars());
    }
    letters.into_iter().collect()
}

fn read_twice(text: &str, overrides: &[String]) -> Result<(), TestCaseError> {
    if let Ok(scene) = Scene::parse("mutant", Path::new("folder"), text, overrides) {
        let again = Scene::parse("mutant", Path::new("folder"), &scene.text, &[]);
        let again = again.map_err(|error| TestCaseError::fail(format!("{error} in\n{}", scene.text)))?;
        let locations = scene.locations.clone();
        prop_assert_eq!(Scene { locations, ..again }, scene);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn mutated_texts_never_panic(
        edits in prop::collection::vec((0..SCENE.len(), 0..12_usize, 0..PIECES.len()), 0..5)
    ) {
        read_twice(&mutate(&edits), &[])?;
    }

    #[test]
    fn overrides_of_mutated_texts_never_panic(
        edits in prop::collection::vec((0..SCENE.len(), 0..12_usize, 0..PIECES.len()), 0..2),
        changes in prop::collection::vec((0..KEYS.len(), 0..VALUES.len()), 0..4),
    ) {
        let change = |&(key, value): &(usize, usize)| format!("{}={}", KEYS[key], VALUES[value]);
        read_twice(&mutate(&edits), &changes.iter().map(change).collect::<Vec<_>>())?;
    }

    #[test]
    fn arbitrary_overrides_never_panic(change in "[a-z0-9.\\[\\]]{0,12}=?[\\PC\n]{0,12}") {
        read_twice(SCENE, &[change])?;
    }
}
