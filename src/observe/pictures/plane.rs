//! The plane of a picture.

use nalgebra::SVector;

use crate::{
    geometry::{Ball, Domain},
    grid::Grid,
    scene::Scene,
};

/// Most samples along the longer side.
const SAMPLES: f64 = 420.0;

/// Most samples a cell: more show nothing new, and in 3D each takes 192 nodes.
const SAMPLES_PER_CELL: f64 = 4.0;

/// Names of the axes.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// The plane with its samples.
pub struct CutPlane<const D: usize> {
    domain: Domain<D>,
    /// The axes that point right and up.
    pub axes: [usize; 2],
    /// A point of it.
    through: SVector<f64, D>,
    /// Width and height.
    pub size: [f64; 2],
    /// Number of samples along both.
    pub samples: [usize; 2],
    /// Which of them repeat.
    pub periodic: [bool; 2],
    /// Which of them end at solid walls.
    pub walls: [bool; 2],
    /// How far to the right the box above lies.
    pub shift: f64,
}

impl<const D: usize> CutPlane<D> {
    /// The plane of a scene's pictures, sampled as finely as a picture shows and the grid has something to show.
    pub fn of(scene: &Scene, domain: &Domain<D>, grid: &Grid<D>) -> Self {
        let (axes, mut through) = (scene.plane_of_pictures(), domain.size * 0.5);
        if let (Some(depth), Some(place)) = (scene.depth_of_pictures(), scene.output.plane_at) {
            through[depth] = place;
        }
        let size = axes.map(|axis| domain.size[axis]);
        let density = (SAMPLES / size[0].max(size[1])).min(SAMPLES_PER_CELL / grid.spacing().min());
        let samples = size.map(|length| (density * length).ceil().max(8.0) as usize);
        let periodic = axes.map(|axis| domain.periodic(axis));
        let walls = axes.map(|axis| domain.axes[axis].walled());
        let shift = if axes == [0, 1] { domain.shift() } else { 0.0 };
        CutPlane { axes, through, size, samples, periodic, walls, shift, domain: domain.clone() }
    }

    /// Where it cuts the axis across it, in words; nothing in two dimensions.
    pub fn place(&self) -> Option<String> {
        let depth = (0..D).find(|axis| !self.axes.contains(axis))?;
        Some(format!("cut at {} = {}", NAMES[depth], (self.through[depth] * 1e6).round() / 1e6))
    }

    /// The names of its axes.
    pub fn names(&self) -> [&'static str; 2] {
        self.axes.map(|axis| NAMES[axis])
    }

    /// The components of a vector in it.
    pub fn within(&self, vector: &SVector<f64, D>) -> [f64; 2] {
        self.axes.map(|axis| vector[axis])
    }

    /// The samples, row by row.
    pub fn points(&self) -> Vec<SVector<f64, D>> {
        let point = |place: usize| {
            let mut point = self.through;
            for (side, index) in [place % self.samples[0], place / self.samples[0]].into_iter().enumerate() {
                point[self.axes[side]] = (index as f64 + 0.5) * self.size[side] / self.samples[side] as f64;
            }
            point
        };
        (0..self.samples[0] * self.samples[1]).map(point).collect()
    }

    /// Centre and radius of the disk in which the plane cuts a ball, if it does.
    pub fn cut(&self, ball: &Ball<D>) -> Option<([f64; 2], f64)> {
        let from_plane = self.domain.nearest_image(ball.center - self.through);
        let depths = (0..D).filter(|axis| !self.axes.contains(axis));
        let height: f64 = depths.map(|axis| from_plane[axis] * from_plane[axis]).sum();
        let squared = ball.radius * ball.radius - height;
        (squared > 0.0).then(|| (self.within(&ball.center), squared.sqrt()))
    }
}

/// A plane cut through a suspension, ready to be drawn.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Line of text above the box; an empty one takes no room.
    pub title: String,
    /// Smaller text below it: time, strain, plane; an empty one takes no room.
    pub subtitle: String,
    /// Names of the axes to the right and up.
    pub axes: [&'static str; 2],
    /// Width and height of the box, whose lower left corner is the origin.
    pub size: [f64; 2],
    /// Which directions are periodic.
    pub periodic: [bool; 2],
    /// Which directions end at solid walls.
    pub walls: [bool; 2],
    /// How far to the right the box above lies, if it repeats.
    pub shift: f64,
    /// How fast it moves to the right, past this one.
    pub slide: f64,
    /// The bodies cut by the plane.
    pub bodies: Vec<Disk>,
    /// What ties bodies that the plane cuts.
    pub bonds: Vec<Bond>,
    /// Contacts of bodies that the plane cuts, as wide as their forces are large.
    pub contacts: Vec<Bond>,
    /// Groups of bodies that have a colour, by their numbers, and what they are.
    pub legend: Vec<(usize, String)>,
    /// Number of samples along each direction.
    pub samples: [usize; 2],
    /// Velocity at the sample centres `((i + 0.5) / samples * size)`, at index `j * samples[0] + i`.
    pub velocity: Vec<[f64; 2]>,
    /// What to colour by at the same points: the speed, which may include the component out of the plane, a scalar, or the vorticity.
    pub coloured: Vec<f64>,
    /// The name of it, with its symbol and unit.
    pub quantity: String,
    /// What colours show at least: smaller values are those of a system at rest.
    pub least: f64,
    /// The least speed of a body that is drawn.
    pub least_speed: f64,
    /// Whether it has either sign, so that colours part at zero; else it is not negative.
    pub signed: bool,
}

/// A bond of two bodies: a thick line between their centers.
#[derive(Clone, Copy, Debug)]
pub struct Bond {
    /// Center of the first body, in or out of the box.
    pub from: [f64; 2],
    /// From it to the center of the other.
    pub way: [f64; 2],
    /// Width.
    pub width: f64,
}

/// The cut of one body: a filled circle.
#[derive(Clone, Debug)]
pub struct Disk {
    /// Center, in or out of the box: periodic directions wrap it.
    pub center: [f64; 2],
    /// Radius.
    pub radius: f64,
    /// Velocity of the center, drawn as a tick in the disk; none is drawn for a body at rest.
    pub velocity: [f64; 2],
    /// Number of the chain, cell, cluster or species by which it is coloured; else it is dark.
    pub group: Option<usize>,
}
