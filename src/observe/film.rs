//! Bodies as disks on a picture plane: frames of an animation, or a still.

use super::FrameBody;
use crate::scene::{AxisSection, Drive, Scene};

/// A film of disks in a box, ready to be drawn.
#[derive(Clone, Debug)]
pub struct Animation {
    /// Width and height of the box, whose lower left corner is the origin; `y` points up.
    pub size: [f64; 2],
    /// Which directions are periodic; the others end at solid walls.
    pub periodic: [bool; 2],
    /// The frames in the order of time.
    pub frames: Vec<AnimationFrame>,
}

/// What is seen at one time.
#[derive(Clone, Debug)]
pub struct AnimationFrame {
    /// Time, in any unit.
    pub time: f64,
    /// How far to the right the box above lies, if it repeats.
    pub shift: f64,
    /// The disks; each covers those before it.
    pub disks: Vec<AnimatedDisk>,
}

/// One body at one time.
#[derive(Clone, Copy, Debug)]
pub struct AnimatedDisk {
    /// Center, in or out of the box: periodic directions wrap it.
    pub center: [f64; 2],
    /// Radius.
    pub radius: f64,
    /// Angle of the mark that shows rotation, counterclockwise from `x`; not a number for a disk without mark.
    pub angle: f64,
    /// Speed to colour by, from zero to the 99.5th percentile of the whole film.
    pub speed: f64,
}

/// The axes that point right and up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    across: usize,
    up: usize,
    /// Speed at which the box above slides to the right.
    sliding: f64,
}

impl Plane {
    /// The plane of a scene: gravity, if there is any, pulls down.
    pub fn of(scene: &Scene) -> Plane {
        let gravity = scene.gravity.as_deref().unwrap_or_default();
        let strongest = (1..gravity.len()).max_by(|&one, &two| gravity[one].abs().total_cmp(&gravity[two].abs()));
        let up = strongest.filter(|&axis| gravity[axis] != 0.0).unwrap_or(1);
        let sliding = match scene.flow.drive {
            Some(Drive::ShearedBox(rate)) if up == 1 => rate * scene.domain.size[1],
            _ => 0.0,
        };
        Plane { across: 0, up, sliding }
    }

    /// Bodies at a time, seen from the front: spheres further back come first.
    pub fn frame<const D: usize>(self, time: f64, mut bodies: Vec<FrameBody<D>>) -> AnimationFrame {
        if let Some(depth) = (0..D).find(|&axis| axis != self.across && axis != self.up) {
            bodies.sort_by(|one, two| two.center[depth].total_cmp(&one.center[depth]));
        }
        let disk = |body: &FrameBody<D>| AnimatedDisk {
            center: [body.center[self.across], body.center[self.up]],
            radius: body.radius,
            // a turning mark is drawn on disks only
            angle: if D == 2 { body.rotation[(1, 0)].atan2(body.rotation[(0, 0)]) } else { f64::NAN },
            speed: body.velocity.norm(),
        };
        AnimationFrame { time, shift: self.sliding * time, disks: bodies.iter().map(disk).collect() }
    }

    /// Frames of a scene's box as a film.
    pub fn film(self, scene: &Scene, frames: Vec<AnimationFrame>) -> Animation {
        let axes = [self.across, self.up];
        let periodic = axes.map(|axis| scene.domain.axes[axis] == AxisSection::Periodic);
        Animation { size: axes.map(|axis| scene.domain.size[axis]), periodic, frames }
    }
}
