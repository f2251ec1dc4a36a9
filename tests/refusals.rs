//! Every scene in `tests/refusals` is refused with the message of its `#^` line; `#--set` lines are overrides.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use turbid::error::Error;
use turbid::scene::Scene;

#[test]
fn every_bad_scene_is_refused_with_its_message() {
    let scenes = bad_scenes();
    assert!(scenes.len() >= 28, "only {} bad scenes", scenes.len());
    let failures: Vec<String> = scenes.iter().filter_map(|path| failure(path)).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn bad_scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/refusals");
    let files = std::fs::read_dir(folder).unwrap();
    let paths = files.map(|file| file.unwrap().path());
    paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect()
}

fn failure(path: &Path) -> Option<String> {
    let text = std::fs::read_to_string(path).unwrap();
    let overrides = marked(&text, "#--set ");
    let expected = marked(&text, "#^ ").pop().expect("a bad scene says its message");
    match Scene::read(path, &overrides) {
        Err(Error::Refused(message)) if message.contains(&expected) => None,
        result => Some(format!("{}: expected {expected}\n  found {:?}", path.display(), result.map(|_| "a scene"))),
    }
}

fn marked(text: &str, mark: &str) -> Vec<String> {
    text.lines().filter_map(|line| line.strip_prefix(mark)).map(str::to_owned).collect()
}
