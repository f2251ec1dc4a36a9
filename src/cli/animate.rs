//! `turbid animate`: the frames of a run as an animated picture.

use std::path::{Path, PathBuf};

use crate::{
    error::{Error, Result},
    observe::{AnimationFrame, Plane, species_of},
    output::{FrameFile, convert_to_video, ffmpeg_present, say, scene_and_frames, write_whole_with},
    petsc::Session,
    picture::AnimationFormat,
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
        let target = target(&film.out)?;
        let (scene, files) = scene_and_frames(film.folder)?;
        match scene.dimension() {
            2 => write::<2>(&scene, &files, film, target)?,
            _ => write::<3>(&scene, &files, film, target)?,
        }
        say(&film.out.display().to_string())
    };
    world.on_first_rank(draw)
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Target {
    Animation(AnimationFormat),
    /// In this format, by another program.
    Video(&'static str),
}

/// The format that the ending of a file tells.
fn target(out: &Path) -> Result<Target> {
    let refuse = |reason: &str| Err(Error::refused(format!("--out {}: {reason}", out.display())));
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let video = |format| match ffmpeg_present() {
        true => Ok(Target::Video(format)),
        false => {
            let others = ["gif", "png"].map(|ending| out.with_extension(ending).display().to_string()).join(" or ");
            refuse(&format!("takes ffmpeg, which is not installed; install it, or name the animation {others}"))
        }
    };
    match ending.as_deref() {
        Some("png" | "apng") => Ok(Target::Animation(AnimationFormat::Png)),
        Some("gif") => Ok(Target::Animation(AnimationFormat::Gif)),
        Some("mp4") => video("mp4"),
        Some("webm") => video("webm"),
        _ => refuse("must end with .png (animated PNG), .gif, or with ffmpeg installed .mp4 or .webm"),
    }
}

/// Writes the animation; a video by way of an animated PNG beside it.
fn write<const D: usize>(scene: &Scene, files: &[FrameFile], film: &AnimationArguments, target: Target) -> Result<()> {
    match target {
        Target::Animation(format) => draw_frames::<D>(scene, files, film, format, &film.out),
        Target::Video(format) => {
            let stills = film.out.with_extension(format!("{}.png", std::process::id()));
            let made = draw_frames::<D>(scene, files, film, AnimationFormat::Png, &stills)
                .and_then(|()| convert_to_video(&stills, format, &film.out));
            // what cannot be removed now is only in the way
            let _ = std::fs::remove_file(&stills);
            made
        }
    }
}

/// Reads the frames twice, one at a time: for what their colours depend on, and to draw them.
fn draw_frames<const D: usize>(
    scene: &Scene,
    files: &[FrameFile],
    arguments: &AnimationArguments,
    format: AnimationFormat,
    out: &Path,
) -> Result<()> {
    let plane = Plane::of(scene);
    let read = |file: &FrameFile| -> Result<AnimationFrame> {
        let stored = file.read::<D>()?;
        let flow = if scene.output.colour == Colour::Vorticity { file.vorticity::<D>(plane)? } else { None };
        let groups = match scene.output.colour {
            Colour::Chain => file.chains()?,
            Colour::Species => species_of(&stored.bodies.iter().map(|body| body.radius).collect::<Vec<_>>()),
            Colour::Speed | Colour::NonAffine | Colour::Vorticity => Vec::new(),
        };
        let wall = plane.wall(scene, stored.size.as_slice());
        Ok(AnimationFrame { wall, ..plane.frame(stored.time, stored.offset.unwrap_or(0.0), stored.bodies, &groups, flow) })
    };
    let mut film = plane.film(scene);
    for file in files {
        film.add(&read(file)?);
    }
    if film.colour == Colour::Vorticity && film.coloured.is_empty() {
        let remedy =
            "no frame of the run holds the flow: run it again with output.fields = true, or set output.colour = \"speed\" in scene.toml";
        return Err(scene.refuse("output.colour", "\"vorticity\"", remedy));
    }
    let mut broken = None;
    let frames = files.iter().map_while(|file| read(file).map_err(|error| broken = Some(error)).ok());
    let written = write_whole_with(out, |out| film.write(format, out, arguments.width as usize, arguments.seconds, frames));
    broken.map_or(written, Err)
}
