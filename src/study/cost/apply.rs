//! Writes the scene with the setting that was found.

use std::path::Path;

use super::{findings::Findings, format::percent};
use crate::{
    error::{Error, Result},
    output::{say, write_whole},
    scene::Scene,
};

/// Writes a scene with the cheapest measured setting that reaches the wanted error; comments stay.
///
/// # Errors
/// There is no such setting, or the file cannot be written.
pub fn apply(file: &Path, scene: &Scene, findings: &Findings) -> Result<()> {
    let Some(cheapest) = findings.cheapest() else {
        return Err(Error::Diverged(format!(
            "--apply {}: nothing is written, because no measured setting is known to reach {}; allow finer ones with --resolutions or --budget",
            file.display(),
            percent(findings.wanted)
        )));
    };
    let mut changes = cheapest.setting.overrides();
    // what the scene says already need not be written
    changes.retain(|change| *change != format!("method.constraint={}", scene.method.constraint.word()));
    let made = Scene::parse(&scene.name, Path::new("."), &scene.movable_text()?, &changes)?;
    write_whole(file, made.text.as_bytes())?;
    say(&format!("applied: {}: {}, {}", file.display(), cheapest.setting.method, cheapest.setting.words()))
}
