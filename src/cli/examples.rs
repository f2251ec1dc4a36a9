//! `turbid examples` and `turbid new`: scenes to begin with, which the program carries along.

use std::{
    fs::OpenOptions,
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};

use crate::{
    error::{Error, Result},
    output::say,
};

/// What to do about examples.
#[derive(Debug, clap::Args)]
pub struct ExampleArguments {
    /// Example to copy into this folder, with the files that it names (default: list all of them).
    name: Option<String>,
}

/// Where a new scene goes.
#[derive(Debug, clap::Args)]
pub struct NewArguments {
    /// File to write.
    #[arg(default_value = "scene.toml")]
    file: PathBuf,
}

/// Names and texts of files in the folder of examples.
macro_rules! files {
    ($($name:literal),* $(,)?) => { [$(($name, include_str!(concat!("../../examples/", $name)))),*] };
}

/// The scenes, by their files.
const SCENES: &[(&str, &str)] = &files![
    "array.toml",
    "avalanche.toml",
    "buckling.toml",
    "cells.toml",
    "chain.toml",
    "conduction.toml",
    "crowd.toml",
    "crowd3d.toml",
    "cubic.toml",
    "custom.toml",
    "dense.toml",
    "friction.toml",
    "friction_in_flow.toml",
    "gluey.toml",
    "inertial.toml",
    "oscillation.toml",
    "pressed.toml",
    "random.toml",
    "reversal.toml",
    "rods.toml",
    "scalar.toml",
    "sediment.toml",
    "settle3d.toml",
    "settling.toml",
    "shear.toml",
    "shear3d.toml",
    "sheared.toml",
    "steady.toml",
    "stress.toml",
    "tencate.toml",
    "tumbling.toml",
    "vortex.toml",
];

/// Tables of centres that scenes name.
const TABLES: &[(&str, &str)] = &files!["fibre.csv", "friction.csv", "random30.csv"];

/// The scene of `turbid new`.
const NEW: &str = include_str!("new.toml");

/// Lists the examples, or copies one into the current folder.
///
/// # Errors
/// There is no example of that name, or a file would be overwritten or cannot be written.
pub fn examples(arguments: &ExampleArguments) -> Result<()> {
    let Some(name) = &arguments.name else { return say(&list()) };
    let stem = name.strip_suffix(".toml").unwrap_or(name);
    let scene = SCENES.iter().find(|(file, _)| file.strip_suffix(".toml") == Some(stem));
    let Some((file, text)) = scene else {
        let names: Vec<&str> = SCENES.iter().filter_map(|(file, _)| file.strip_suffix(".toml")).collect();
        return Err(Error::refused(format!("{name}: is no example; must be one of {}", names.join(", "))));
    };
    // the header tells how it is run from the folder of the program's source
    let text = text.replace(&format!("examples/{file}"), file);
    let tables = TABLES.iter().filter(|(table, _)| text.contains(&format!("\"{table}\"")));
    let files: Vec<(&str, &str)> = std::iter::once((*file, text.as_str())).chain(tables.copied()).collect();
    if let Some((taken, _)) = files.iter().find(|(file, _)| Path::new(file).exists()) {
        return Err(overwritten(Path::new(taken)));
    }
    files.iter().try_for_each(|(file, text)| write_new(Path::new(file), text))?;
    let names: Vec<&str> = files.iter().map(|(file, _)| *file).collect();
    say(&format!("written: {}\nrun it:  turbid run {file}", names.join(", ")))
}

/// Writes a scene with comments.
///
/// # Errors
/// A file would be overwritten, or cannot be written.
pub fn new_scene(arguments: &NewArguments) -> Result<()> {
    let file = arguments.file.display().to_string();
    write_new(&arguments.file, &NEW.replace("FILE", &file))?;
    say(&format!("written: {file}\nnext:    turbid plan {file}, then turbid run {file}"))
}

/// Names with the first lines of the headers.
fn list() -> String {
    let line = |(file, text): &(&str, &str)| {
        let title = text.lines().next().unwrap_or_default().trim_start_matches('#').trim();
        format!("{:<12} {title}", file.trim_end_matches(".toml"))
    };
    SCENES.iter().map(line).collect::<Vec<_>>().join("\n") + "\n\nturbid examples NAME copies one of them into this folder"
}

fn overwritten(path: &Path) -> Error {
    Error::refused(format!("{}: is there already and would be overwritten; move it away, or go to another folder", path.display()))
}

/// Writes a file that is not there yet.
fn write_new(path: &Path, text: &str) -> Result<()> {
    let opened = OpenOptions::new().write(true).create_new(true).open(path);
    opened.and_then(|mut file| file.write_all(text.as_bytes())).map_err(|source| match source.kind() {
        ErrorKind::AlreadyExists => overwritten(path),
        _ => Error::File { path: path.to_owned(), source },
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{plan::Plan, scene::Scene};

    #[test]
    fn every_example_of_the_folder_is_carried_along_with_its_tables() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
        let names = |ending: &str| {
            let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
            let mut names: Vec<String> = files.filter(|name| name.ends_with(ending)).collect();
            names.sort();
            names
        };
        assert_eq!(SCENES.iter().map(|(name, _)| *name).collect::<Vec<_>>(), names(".toml"));
        assert_eq!(TABLES.iter().map(|(name, _)| *name).collect::<Vec<_>>(), names(".csv"));
        assert!(list().lines().take(SCENES.len()).all(|line| line.len() > 30), "{}", list());
    }

    #[test]
    fn the_new_scene_can_be_planned() {
        let scene = Scene::parse("scene", Path::new(""), NEW, &[]).unwrap();
        assert!(Plan::<2>::of(&scene).and_then(|plan| plan.report(1)).unwrap().to_string().contains("built      contact"));
    }
}
