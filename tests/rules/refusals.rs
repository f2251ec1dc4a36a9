//! Every scene, every table of centres and every path in `tests/refusals` is refused with the message of its `#^` line.
//!
//! `#--set` lines of a scene are overrides, the `#dimension` line of a table is the dimension of its centres, the `#path` line that of its places.

use std::path::{Path, PathBuf};

use turbid::body::{read_centers, read_places};
use turbid::cli::message;
use turbid::error::{Error, Result};
use turbid::scene::Scene;

#[test]
fn every_bad_scene_is_refused_with_its_message() {
    let read = |path: &Path, text: &str| Scene::read(path, &marked(text, "#--set ")).map(drop);
    refuses("toml", 130, read);
}

#[test]
fn every_bad_table_is_refused_with_its_message() {
    let last = |text: &str, mark: &str| marked(text, mark).pop();
    let read = |path: &Path, text: &str| match (last(text, "#dimension ").as_deref(), last(text, "#path ").as_deref()) {
        (Some("2"), None) => read_centers::<2>(path).map(drop),
        (Some("3"), None) => read_centers::<3>(path).map(drop),
        (None, Some("2")) => read_places::<2>(path).map(drop),
        (None, Some("3")) => read_places::<3>(path).map(drop),
        _ => panic!("{}: a bad table says #dimension or #path, 2 or 3", path.display()),
    };
    refuses("csv", 22, read);
}

fn refuses(ending: &str, least: usize, read: impl Fn(&Path, &str) -> Result<()>) {
    let paths = bad_files(ending);
    assert!(paths.len() >= least, "only {} bad files", paths.len());
    let failures: Vec<String> = paths.iter().filter_map(|path| failure(path, &read)).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn bad_files(wanted: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/refusals");
    let files = std::fs::read_dir(folder).unwrap();
    let paths = files.map(|file| file.unwrap().path());
    paths.filter(|path| path.extension().is_some_and(|ending| ending == wanted)).collect()
}

fn failure(path: &Path, read: impl Fn(&Path, &str) -> Result<()>) -> Option<String> {
    let text = std::fs::read_to_string(path).unwrap();
    let expected = marked(&text, "#^ ").pop().expect("a bad file says its message");
    match read(path, &text) {
        Err(error @ Error::Refused(_)) if message(&error).contains(&expected) => None,
        result => Some(format!("{}: expected {expected}\n  found {result:?}", path.display())),
    }
}

fn marked(text: &str, mark: &str) -> Vec<String> {
    text.lines().filter_map(|line| line.strip_prefix(mark)).map(str::to_owned).collect()
}
