//! Bodies as disks on a picture plane: frames of an animation, or a still.

use super::FrameBody;
use crate::scene::{AxisSection, Drive, Scene};

/// What must be known of a film before its first frame is drawn.
#[derive(Clone, Debug)]
pub struct Film {
    /// Width and height of the box, whose lower left corner is the origin; `y` points up.
    pub size: [f64; 2],
    /// Which directions are periodic; the others end at solid walls.
    pub periodic: [bool; 2],
    /// Time of each frame.
    pub times: Vec<f64>,
    /// Speeds of the disks of all frames in turn, or every second, fourth, .. of them, so that there are never more than 2^22.
    pub speeds: Vec<f64>,
    /// Speeds so far, and of how many one is kept.
    seen: usize,
    stride: usize,
}

/// Most speeds from which the colours of a film are found.
pub const MOST_SPEEDS: usize = 1 << 22;

impl Film {
    /// No frame yet of a box with this size, periodic in some directions.
    pub fn new(size: [f64; 2], periodic: [bool; 2]) -> Film {
        Film { size, periodic, times: Vec::new(), speeds: Vec::new(), seen: 0, stride: 1 }
    }

    /// Takes note of the next frame.
    pub fn add(&mut self, frame: &AnimationFrame) {
        self.times.push(frame.time);
        frame.disks.iter().for_each(|disk| self.add_speed(disk.speed, MOST_SPEEDS));
    }

    fn add_speed(&mut self, speed: f64, most: usize) {
        if self.seen.is_multiple_of(self.stride) {
            if self.speeds.len() == most {
                self.speeds = self.speeds.iter().step_by(2).copied().collect();
                self.stride *= 2;
            }
            if self.seen.is_multiple_of(self.stride) {
                self.speeds.push(speed);
            }
        }
        self.seen += 1;
    }
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

    /// A film of a scene's box without frames.
    pub fn film(self, scene: &Scene) -> Film {
        let axes = [self.across, self.up];
        Film::new(axes.map(|axis| scene.domain.size[axis]), axes.map(|axis| scene.domain.axes[axis] == AxisSection::Periodic))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_keeps_evenly_spread_speeds_and_never_more_than_the_most() {
        let mut film = Film::new([1.0; 2], [true; 2]);
        for speed in 0..100 {
            film.add_speed(f64::from(speed), 8);
            assert!(film.speeds.len() <= 8);
        }
        let expected: Vec<f64> = (0..100).step_by(16).map(f64::from).collect();
        assert_eq!(film.speeds, expected);
    }
}
