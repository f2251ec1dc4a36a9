//! `turbid animate`: the frames of a run as an animated picture.

use std::path::{Path, PathBuf};

use crate::{
    error::{Error, Result},
    observe::{AnimationFrame, Plane},
    output::{read_frames, say, write_whole},
    petsc::Session,
    scene::Scene,
};

/// What to draw.
pub struct AnimationArguments<'a> {
    /// Output folder of the run.
    pub folder: &'a Path,
    /// File to write.
    pub out: PathBuf,
    /// Width in pixels.
    pub width: u32,
    /// Length.
    pub seconds: f64,
}

/// Draws the frames of a run; the first rank does.
pub fn animate(session: &Session, film: &AnimationArguments) -> Result<()> {
    let world = session.world();
    let draw = || {
        if !(film.seconds.is_finite() && film.seconds > 0.0) {
            return Err(Error::refused(format!("--seconds {}: must be positive", film.seconds)));
        }
        refuse_ending(&film.out)?;
        let scene = Scene::read(&film.folder.join("scene.toml"), &[])?;
        let frames = if scene.dimension() == 2 { frames::<2>(&scene, film.folder)? } else { frames::<3>(&scene, film.folder)? };
        if frames.is_empty() {
            return Err(Error::refused(format!("{}: holds no frames; only runs with a [time] section write them", film.folder.display())));
        }
        write_whole(&film.out, &Plane::of(&scene).film(&scene, frames).apng(film.width as usize, film.seconds))?;
        say(&film.out.display().to_string())
    };
    world.on_first_rank(draw)
}

/// Programs tell formats by their endings, and only one is written.
fn refuse_ending(out: &Path) -> Result<()> {
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    if matches!(ending.as_deref(), Some("png" | "apng")) {
        return Ok(());
    }
    let better = out.with_extension("png");
    Err(Error::refused(format!("--out {}: an animation is an animated PNG; name it {}", out.display(), better.display())))
}

fn frames<const D: usize>(scene: &Scene, folder: &Path) -> Result<Vec<AnimationFrame>> {
    let plane = Plane::of(scene);
    Ok(read_frames::<D>(folder)?.into_iter().map(|stored| plane.frame(stored.time, stored.bodies)).collect())
}
