//! The plane of a picture: that of the first two axes, through the middle of the box.

use nalgebra::SVector;

use crate::{
    geometry::{Ball, Domain},
    grid::Grid,
};

/// Most samples along the longer side.
const SAMPLES: f64 = 420.0;

/// Most samples a cell: more show nothing new, and in 3D each takes 192 nodes.
const SAMPLES_PER_CELL: f64 = 4.0;

/// The plane with its samples.
pub struct CutPlane<const D: usize> {
    domain: Domain<D>,
    /// Width and height.
    pub size: [f64; 2],
    /// Number of samples along both.
    pub samples: [usize; 2],
    /// Which of them repeat.
    pub periodic: [bool; 2],
    /// How far to the right the box above lies.
    pub shift: f64,
}

impl<const D: usize> CutPlane<D> {
    /// The plane, sampled as finely as a picture shows and the grid has something to show.
    pub fn of(domain: &Domain<D>, grid: &Grid<D>) -> Self {
        let size = [domain.size[0], domain.size[1]];
        let density = (SAMPLES / size[0].max(size[1])).min(SAMPLES_PER_CELL / grid.spacing().min());
        let samples = size.map(|length| (density * length).ceil().max(8.0) as usize);
        let periodic = [domain.periodic(0), domain.periodic(1)];
        CutPlane { size, samples, periodic, shift: domain.shift(), domain: domain.clone() }
    }

    /// The samples, row by row.
    pub fn points(&self) -> Vec<SVector<f64, D>> {
        let point = |place: usize| {
            let mut point = self.domain.size * 0.5;
            for (axis, index) in [place % self.samples[0], place / self.samples[0]].into_iter().enumerate() {
                point[axis] = (index as f64 + 0.5) * self.size[axis] / self.samples[axis] as f64;
            }
            point
        };
        (0..self.samples[0] * self.samples[1]).map(point).collect()
    }

    /// Centre and radius of the disk in which the plane cuts a ball, if it does.
    pub fn cut(&self, ball: &Ball<D>) -> Option<([f64; 2], f64)> {
        let from_plane = self.domain.nearest_image(ball.center - self.domain.size * 0.5);
        let height: f64 = from_plane.iter().skip(2).map(|offset| offset * offset).sum();
        let squared = ball.radius * ball.radius - height;
        (squared > 0.0).then(|| ([ball.center[0], ball.center[1]], squared.sqrt()))
    }
}

/// A plane cut through a suspension, ready to be drawn.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Line of text above the box; an empty one takes no room.
    pub title: String,
    /// Width and height of the box, whose lower left corner is the origin.
    pub size: [f64; 2],
    /// Which directions are periodic; the others end at solid walls.
    pub periodic: [bool; 2],
    /// How far to the right the box above lies, if it repeats.
    pub shift: f64,
    /// The bodies cut by the plane.
    pub bodies: Vec<Disk>,
    /// What ties bodies that the plane cuts.
    pub bonds: Vec<Bond>,
    /// Number of samples along each direction.
    pub samples: [usize; 2],
    /// Velocity at the sample centres `((i + 0.5) / samples * size)`, at index `j * samples[0] + i`.
    pub velocity: Vec<[f64; 2]>,
    /// What to colour by at the same points: the speed, which may include the component out of the plane, a scalar, or the vorticity.
    pub coloured: Vec<f64>,
    /// The name of it.
    pub quantity: &'static str,
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
    /// Number of the chain, cell or cluster by which it is coloured; else it is dark.
    pub chain: Option<usize>,
}
