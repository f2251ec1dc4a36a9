//! `turbid animate`: the frames of a run as an animated picture.

use std::path::{Path, PathBuf};

use crate::{
    error::{Error, Result},
    observe::{AnimationFrame, Plane, species_of},
    output::{FrameFile, say, write_whole_with},
    petsc::Session,
    scene::{Colour, Scene},
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
        match scene.dimension() {
            2 => draw_frames::<2>(&scene, film)?,
            _ => draw_frames::<3>(&scene, film)?,
        }
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

/// Reads the frames twice, one at a time: for what their colours depend on, and to draw them.
fn draw_frames<const D: usize>(scene: &Scene, arguments: &AnimationArguments) -> Result<()> {
    let (plane, files) = (Plane::of(scene), FrameFile::of_run(arguments.folder)?);
    if files.is_empty() {
        let folder = arguments.folder.display();
        return Err(Error::refused(format!("{folder}: holds no frames; only runs with a [time] section write them")));
    }
    let read = |file: &FrameFile| -> Result<AnimationFrame> {
        let stored = file.read::<D>()?;
        let flow = if scene.output.colour == Colour::Vorticity { file.vorticity::<D>(plane)? } else { None };
        let groups = match scene.output.colour {
            Colour::Chain => file.chains()?,
            Colour::Species => species_of(&stored.bodies.iter().map(|body| body.radius).collect::<Vec<_>>()),
            Colour::Speed | Colour::Vorticity => Vec::new(),
        };
        Ok(plane.frame(stored.time, stored.bodies, &groups, flow))
    };
    let mut film = plane.film(scene);
    for file in &files {
        film.add(&read(file)?);
    }
    if film.colour == Colour::Vorticity && film.coloured.is_empty() {
        let remedy =
            "no frame of the run holds the flow: run it again with output.fields = true, or set output.colour = \"speed\" in scene.toml";
        return Err(scene.refuse("output.colour", "\"vorticity\"", remedy));
    }
    let mut broken = None;
    let frames = files.iter().map_while(|file| read(file).map_err(|error| broken = Some(error)).ok());
    let written = write_whole_with(&arguments.out, |out| film.write(out, arguments.width as usize, arguments.seconds, frames));
    broken.map_or(written, Err)
}
