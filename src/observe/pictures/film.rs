//! Bodies as disks on a picture plane, and the vorticity behind them: frames of an animation, or a still.

use super::{picture::NON_AFFINE, plane::Bond, scale::SpeedScale};
use crate::{
    body::planes,
    geometry::Protocol,
    observe::FrameBody,
    scene::{AffineFlow, AxisSection, Colour, Drive, Scene},
};

/// What must be known of a film before its first frame is drawn.
#[derive(Clone, Debug)]
pub struct Film {
    /// Width and height of the box, whose lower left corner is the origin; `y` points up.
    pub size: [f64; 2],
    /// Which directions are periodic.
    pub periodic: [bool; 2],
    /// Which directions end at solid walls.
    pub walls: [bool; 2],
    /// What is coloured: the disks by their speed or by the chain they belong to, or the flow behind them by its vorticity.
    pub colour: Colour,
    /// What is written above the box.
    pub title: String,
    /// Names of the axes to the right and up.
    pub axes: [&'static str; 2],
    /// What colours stand for, with its unit.
    pub quantity: String,
    /// By what coloured values are divided before they are shown.
    pub unit: f64,
    /// What colours show at least, in that unit: smaller values are those of a system at rest.
    pub least: f64,
    /// How fast the box above moves to the right, past this one.
    pub slide: f64,
    /// Rate of the shear, where there is one: strain is told beside time.
    pub rate: Option<f64>,
    /// Whether bodies are shown as balls.
    pub balls: bool,
    /// Time of each frame.
    pub times: Vec<f64>,
    /// What is coloured of all frames in turn, or every second, fourth, .. value of it, so that there are never more than 2^22.
    pub coloured: Vec<f64>,
    /// Values so far, and of how many one is kept.
    count: usize,
    stride: usize,
}

/// Most values from which the colours of a film are found.
pub const MOST_VALUES: usize = 1 << 22;

impl Film {
    /// No frame yet of a box with this size, periodic in some directions.
    pub fn new(size: [f64; 2], periodic: [bool; 2], colour: Colour) -> Film {
        let (title, quantity) = (String::new(), String::new());
        Film {
            size,
            periodic,
            walls: periodic.map(|periodic| !periodic),
            colour,
            title,
            quantity,
            axes: ["x", "y"],
            unit: 1.0,
            least: 0.0,
            slide: 0.0,
            rate: None,
            balls: false,
            times: Vec::new(),
            coloured: Vec::new(),
            count: 0,
            stride: 1,
        }
    }

    /// Takes note of the next frame.
    pub fn add(&mut self, frame: &AnimationFrame) {
        self.times.push(frame.time);
        match self.colour {
            Colour::Speed | Colour::NonAffine => frame.disks.iter().for_each(|disk| self.add_value(disk.speed, MOST_VALUES)),
            Colour::Chain | Colour::Species => (),
            Colour::Vorticity => frame.vorticity.iter().flat_map(|cut| &cut.values).for_each(|&value| self.add_value(value, MOST_VALUES)),
        }
    }

    /// Whether colours are those of a number.
    pub fn has_bar(&self) -> bool {
        !self.colour.of_bodies()
    }

    /// Time and strain in words.
    pub fn time_label(&self, time: f64) -> String {
        let strain = self.rate.map_or(String::new(), |rate| format!(", strain {:.3}", rate.abs() * time));
        format!("time {time:.3}{strain}")
    }

    fn add_value(&mut self, value: f64, most: usize) {
        let value = value / self.unit;
        if self.count.is_multiple_of(self.stride) {
            if self.coloured.len() == most {
                self.coloured = self.coloured.iter().step_by(2).copied().collect();
                self.stride *= 2;
            }
            if self.count.is_multiple_of(self.stride) {
                self.coloured.push(value);
            }
        }
        self.count += 1;
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
    /// Contact forces before them, as lines.
    pub contacts: Vec<Bond>,
    /// The vorticity behind them.
    pub vorticity: Option<FlowCut>,
    /// Where an upper wall is that has left the end of the box: its coordinate to the right or up.
    pub wall: Option<PlaneWall>,
}

/// A wall across one of the two directions of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneWall {
    /// 0 if it is across the direction to the right, 1 if across that up.
    pub direction: usize,
    /// Its coordinate there.
    pub position: f64,
}

/// A number for each cell that a plane cuts.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowCut {
    /// Cells to the right and up.
    pub cells: [usize; 2],
    /// Row by row from the bottom, as many numbers as there are cells.
    pub values: Vec<f64>,
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
    /// Speed to colour by, from zero to the 99.5th percentile of the whole film, unless the flow or chains are coloured.
    pub speed: f64,
    /// The velocity to the right of which it is the magnitude with others; an image so many boxes above is as much faster.
    pub along: f64,
    /// Number of its chain, cell, cluster or species, to colour by that.
    pub group: Option<usize>,
}

/// The axes that point right and up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    across: usize,
    up: usize,
    /// Speed at which the box above slides to the right, where that is always the same.
    sliding: f64,
    /// The motion that is subtracted from speeds, if any is.
    affine: Option<AffineFlow>,
}

impl Plane {
    /// The plane of a scene's pictures.
    pub fn of(scene: &Scene) -> Plane {
        let [across, up] = scene.plane_of_pictures();
        let sliding = match scene.flow.drive {
            Some(Drive::ShearedBox(Protocol::Steady(rate))) if [across, up] == [0, 1] => rate * scene.domain.size[1],
            _ => 0.0,
        };
        let affine = AffineFlow::of(scene).filter(|_| scene.output.colour == Colour::NonAffine);
        Plane { across, up, sliding, affine }
    }

    /// The axes that point right and up.
    pub fn axes(self) -> [usize; 2] {
        [self.across, self.up]
    }

    /// The wall that a load moves, if the plane cuts it, in a box of this size now.
    pub fn wall(self, scene: &Scene, size: &[f64]) -> Option<PlaneWall> {
        let axis = scene.domain.loaded_axis()?;
        let direction = self.axes().iter().position(|own| *own == axis)?;
        Some(PlaneWall { direction, position: size[axis] })
    }

    /// Which component of the vorticity is that in the plane, and the sign with which it is counterclockwise as seen.
    pub fn vorticity<const D: usize>(self) -> (usize, f64) {
        let place = |plane: (usize, usize)| planes::<D>().iter().position(|own| *own == plane);
        let counterclockwise = place((self.up, self.across)).map(|component| (component, 1.0));
        counterclockwise.or_else(|| place((self.across, self.up)).map(|component| (component, -1.0))).expect("two axes span a plane")
    }

    /// Bodies at a time, when images above the box are displaced by a shift along x, before the flow that the plane cuts, seen from the front: spheres further back come first. Of each body by its number the number
    /// of its group, where groups are coloured.
    pub fn frame<const D: usize>(
        self,
        time: f64,
        shift: f64,
        mut bodies: Vec<FrameBody<D>>,
        groups: &[Option<usize>],
        vorticity: Option<FlowCut>,
    ) -> AnimationFrame {
        if let Some(depth) = (0..D).find(|&axis| axis != self.across && axis != self.up) {
            bodies.sort_by(|one, two| two.center[depth].total_cmp(&one.center[depth]));
        }
        let disk = |body: &FrameBody<D>| AnimatedDisk {
            center: [body.center[self.across], body.center[self.up]],
            radius: body.radius,
            // a turning mark is drawn on disks only
            angle: if D == 2 { body.rotation[(1, 0)].atan2(body.rotation[(0, 0)]) } else { f64::NAN },
            speed: self.affine.map_or(body.velocity.norm(), |affine| affine.deviation(body.center.as_slice(), body.velocity.as_slice())),
            along: body.velocity[self.across],
            group: groups.get(body.number).copied().flatten(),
        };
        let shift = if self.axes() == [0, 1] { shift } else { 0.0 };
        AnimationFrame { time, shift, disks: bodies.iter().map(disk).collect(), contacts: Vec::new(), vorticity, wall: None }
    }

    /// A film of a scene's box without frames.
    pub fn film(self, scene: &Scene) -> Film {
        let periodic = self.axes().map(|axis| scene.domain.axes[axis] == AxisSection::Periodic);
        let (scale, colour) = (SpeedScale::of(scene), scene.output.colour);
        let (quantity, unit, least) = match colour {
            Colour::Vorticity => (SpeedScale::name("vorticity", scale.rate.1), scale.rate.0, 0.0),
            Colour::NonAffine => (SpeedScale::name(NON_AFFINE, scale.words), scale.unit, scale.least),
            _ => (SpeedScale::name("speed", scale.words), scale.unit, scale.least),
        };
        Film {
            walls: self.axes().map(|axis| matches!(scene.domain.axes[axis], AxisSection::Walls { .. })),
            title: scene.shown_title().to_owned(),
            axes: self.axes().map(|axis| ["x", "y", "z"][axis]),
            quantity,
            unit,
            least,
            slide: if self.affine.is_some() { 0.0 } else { self.sliding },
            rate: scene.shear_rate().filter(|_| scene.steady_shear()),
            balls: scene.dimension() == 3,
            ..Film::new(self.axes().map(|axis| scene.domain.size[axis]), periodic, colour)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_keeps_evenly_spread_values_and_never_more_than_the_most() {
        let mut film = Film::new([1.0; 2], [true; 2], Colour::Speed);
        for speed in 0..100 {
            film.add_value(f64::from(speed), 8);
            assert!(film.coloured.len() <= 8);
        }
        let expected: Vec<f64> = (0..100).step_by(16).map(f64::from).collect();
        assert_eq!(film.coloured, expected);
    }

    #[test]
    fn vorticity_is_counterclockwise_as_seen() {
        let with = |up| Plane { across: 0, up, sliding: 0.0, affine: None };
        assert_eq!(with(1).vorticity::<2>(), (0, 1.0));
        assert_eq!(with(1).vorticity::<3>(), (2, 1.0));
        // seen along y, the component about y is clockwise
        assert_eq!(with(2).vorticity::<3>(), (1, -1.0));
    }
}
