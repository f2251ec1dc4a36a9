//! `turbid animate`: the frames of a run as an animated picture.

use std::path::{Path, PathBuf};

use nalgebra::SVector;

use crate::{
    error::{Error, Result},
    output::{AnimatedDisk, Animation, AnimationFrame, FrameBody, read_frames, write_whole},
    petsc::Session,
    scene::{AxisSection, Scene},
};

/// What to draw.
pub struct Film<'a> {
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
#[allow(clippy::print_stdout)]
pub fn animate(session: &Session, film: &Film) -> Result<()> {
    let world = session.world();
    let draw = || {
        if !(film.seconds.is_finite() && film.seconds > 0.0) {
            return Err(Error::Refused(format!("--seconds {}: must be positive", film.seconds)));
        }
        let scene = Scene::read(&film.folder.join("scene.toml"), &[])?;
        let frames = if scene.dimension() == 2 { frames::<2>(&scene, film.folder)? } else { frames::<3>(&scene, film.folder)? };
        if frames.is_empty() {
            return Err(Error::Refused(format!("{}: holds no frames; only runs with a [time] section write them", film.folder.display())));
        }
        let [across, up] = axes(&scene);
        let periodic = [across, up].map(|axis| scene.domain.axes[axis] == AxisSection::Periodic);
        let animation = Animation { size: [scene.domain.size[across], scene.domain.size[up]], periodic, frames };
        write_whole(&film.out, &animation.apng(film.width as usize, film.seconds))?;
        println!("{}", film.out.display());
        Ok(())
    };
    world.agree(if world.rank() == 0 { draw() } else { Ok(()) })
}

/// The axes that point right and up: gravity, if there is any, pulls down.
fn axes(scene: &Scene) -> [usize; 2] {
    let gravity = scene.gravity.as_deref().unwrap_or_default();
    let strongest = (1..gravity.len()).max_by(|&one, &two| gravity[one].abs().total_cmp(&gravity[two].abs()));
    [0, strongest.filter(|&axis| gravity[axis] != 0.0).unwrap_or(1)]
}

fn frames<const D: usize>(scene: &Scene, folder: &Path) -> Result<Vec<AnimationFrame>> {
    let [across, up] = axes(scene);
    let depth = (0..D).find(|&axis| axis != across && axis != up);
    let disk = |body: &FrameBody<D>| AnimatedDisk {
        center: [body.center[across], body.center[up]],
        radius: body.radius,
        angle: if D == 2 { body.rotation[(1, 0)].atan2(body.rotation[(0, 0)]) } else { f64::NAN },
        speed: body.velocity.norm(),
    };
    let frame = |mut stored: crate::output::StoredFrame<D>| {
        let distance = |center: &SVector<f64, D>| depth.map_or(0.0, |axis| center[axis]);
        // far ones first
        stored.bodies.sort_by(|one, two| distance(&two.center).total_cmp(&distance(&one.center)));
        AnimationFrame { time: stored.time, disks: stored.bodies.iter().map(disk).collect() }
    };
    Ok(read_frames::<D>(folder)?.into_iter().map(frame).collect())
}
