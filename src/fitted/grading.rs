//! How long the edges of a mesh should be: small where surfaces are near each other, and, if it is wanted, near disks.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use crate::geometry::{Ball, Domain};

/// Elements that stand side by side in the narrowest part of a gap, at least.
const ELEMENTS_IN_GAP: f64 = 3.0;

/// Growth of edges with the distance from disks.
const GROWTH: f64 = 0.15;

/// Longest edges over those at disks, where edges grow.
const MOST_GROWN: f64 = 8.0;

/// Fewest edges along a side of the box, where edges grow.
const FEWEST_ALONG: f64 = 8.0;

/// Lengths of edges where no gap makes them shorter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeLengths {
    /// At the surfaces of disks.
    pub at_disks: f64,
    /// Growth with the distance from the nearest disk.
    pub growth: f64,
    /// Far from all disks.
    pub longest: f64,
}

/// A surface that bounds the fluid.
#[derive(Debug, Clone, Copy)]
enum Surface {
    /// A periodic image of a disk.
    Disk(Ball<2>),
    /// The wall at this coordinate of an axis.
    Wall { axis: usize, at: f64 },
}

/// The wanted length of edges at every point of the box.
///
/// It is the length asked for at that distance from disks, or the part of the local gap that lets three elements stand in it. The gap at a point is the
/// sum of its distances from the two nearest surfaces.
pub struct Grading {
    domain: Domain<2>,
    lengths: EdgeLengths,
    cells: [usize; 2],
    /// For each cell of a coarse lattice, the surfaces of which two are the nearest at any of its points.
    near: Vec<Vec<Surface>>,
}

impl From<f64> for EdgeLengths {
    /// The same everywhere.
    fn from(length: f64) -> EdgeLengths {
        EdgeLengths { at_disks: length, growth: 0.0, longest: length }
    }
}

impl EdgeLengths {
    /// Edges that grow with the distance from disks in a box of this size.
    pub fn growing(at_disks: f64, size: &Vector2<f64>) -> EdgeLengths {
        let longest = (MOST_GROWN * at_disks).min(size.min() / FEWEST_ALONG).max(at_disks);
        EdgeLengths { at_disks, growth: GROWTH, longest }
    }

    /// About how many squares on edges cover a box of this area, with disks given as radii and how many have them.
    pub fn squares(&self, area: f64, disks: impl Iterator<Item = (f64, f64)>) -> f64 {
        let EdgeLengths { at_disks, growth, longest } = *self;
        let grown = longest / at_disks;
        // the integral of 1 / length^2 around a disk, to where edges are the longest
        let around = |(radius, count): (f64, f64)| {
            let straight = radius / at_disks * (1.0 - 1.0 / grown) / growth;
            count * TAU * (straight + (grown.ln() - 1.0 + 1.0 / grown) / (growth * growth))
        };
        let near = if growth > 0.0 { disks.map(around).sum() } else { 0.0 };
        (area / (longest * longest) + near).min(area / (at_disks * at_disks))
    }
}

impl Surface {
    fn distance(&self, point: &Vector2<f64>) -> f64 {
        match self {
            Surface::Disk(disk) => (point - disk.center).norm() - disk.radius,
            Surface::Wall { axis, at } => (point[*axis] - at).abs(),
        }
    }

    fn is_disk(&self) -> bool {
        matches!(self, Surface::Disk(_))
    }

    /// Whether it is a wall across this axis.
    fn across(&self, along: usize) -> bool {
        matches!(self, Surface::Wall { axis, .. } if *axis == along)
    }
}

impl Grading {
    /// The grading around disks.
    pub fn new(domain: &Domain<2>, disks: &[Ball<2>], lengths: EdgeLengths) -> Grading {
        let (all, EdgeLengths { at_disks, growth, longest }) = (surfaces(domain, disks), lengths);
        let grown = if growth > 0.0 { (longest - at_disks) / growth } else { 0.0 };
        // about four surfaces a cell
        let per_cell = (domain.volume() / (1.0 + disks.len() as f64)).sqrt();
        let cells = [0, 1].map(|axis| ((2.0 * domain.size[axis] / per_cell).ceil() as usize).clamp(1, 1000));
        let edges = Vector2::from_fn(|axis, _| domain.size[axis] / cells[axis] as f64);
        let near = (0..cells[0] * cells[1]).map(|cell| {
            let center = Vector2::new((cell / cells[1]) as f64 + 0.5, (cell % cells[1]) as f64 + 0.5).component_mul(&edges);
            // the two nearest disks may lie beyond two walls that meet in a corner
            let disks = all.iter().filter(|surface| !surface.across(0) && !surface.across(1));
            let farther = two_smallest(disks.map(|surface| surface.distance(&center)))[1];
            let reach = farther.min(grown.max(3.0 * longest)) + edges.norm();
            all.iter().copied().filter(|surface| surface.distance(&center) <= reach).collect()
        });
        Grading { domain: domain.clone(), lengths, cells, near: near.collect() }
    }

    /// The longest edges.
    pub fn longest(&self) -> f64 {
        self.lengths.longest
    }

    /// The wanted length of edges at a point, which need not lie in the box.
    pub fn length(&self, point: &Vector2<f64>) -> f64 {
        (self.gap(point) / ELEMENTS_IN_GAP).min(self.grown(point))
    }

    /// The distance from the nearest surface, negative in a disk.
    pub fn distance(&self, point: &Vector2<f64>) -> f64 {
        let (point, near) = self.near(point);
        near.iter().map(|surface| surface.distance(&point)).fold(f64::INFINITY, f64::min)
    }

    /// The length asked for at a point's distance from disks.
    fn grown(&self, point: &Vector2<f64>) -> f64 {
        let EdgeLengths { at_disks, growth, longest } = self.lengths;
        if growth == 0.0 {
            return longest;
        }
        let (point, near) = self.near(point);
        let distances = near.iter().filter(|surface| surface.is_disk()).map(|surface| surface.distance(&point).max(0.0));
        (at_disks + growth * distances.fold(f64::INFINITY, f64::min)).min(longest)
    }

    /// The sum of the distances from the two nearest surfaces; walls that meet in a corner leave no gap between them.
    fn gap(&self, point: &Vector2<f64>) -> f64 {
        let (point, near) = self.near(point);
        let along =
            |axis: usize| two_smallest(near.iter().filter(|surface| !surface.across(1 - axis)).map(|one| one.distance(&point).max(0.0)));
        (0..2).map(|axis| along(axis).iter().sum()).fold(f64::INFINITY, f64::min)
    }

    /// The image of a point in the box, and the surfaces near it.
    fn near(&self, point: &Vector2<f64>) -> (Vector2<f64>, &[Surface]) {
        let point = self.domain.wrap(*point);
        let cell = [0, 1].map(|axis| {
            let cells = self.cells[axis] as f64;
            (point[axis] / self.domain.size[axis] * cells).clamp(0.0, cells - 1.0) as usize
        });
        (point, &self.near[cell[0] * self.cells[1] + cell[1]])
    }
}

fn two_smallest(distances: impl Iterator<Item = f64>) -> [f64; 2] {
    distances.fold([f64::INFINITY; 2], |[first, second], distance| [first.min(distance), second.min(distance.max(first))])
}

/// Walls, and the images of disks that lie within a box of the box.
fn surfaces(domain: &Domain<2>, disks: &[Ball<2>]) -> Vec<Surface> {
    let images = |axis: usize| if domain.periodic(axis) { -1..=1 } else { 0..=0 };
    let mut all = Vec::new();
    for axis in (0..2).filter(|&axis| !domain.periodic(axis)) {
        all.extend([0.0, domain.size[axis]].map(|at| Surface::Wall { axis, at }));
    }
    for disk in disks {
        let center = domain.wrap(disk.center);
        for x in images(0) {
            for y in images(1) {
                let offset = Vector2::new(f64::from(x), f64::from(y)).component_mul(&domain.size);
                all.push(Surface::Disk(Ball { center: center + offset, radius: disk.radius }));
            }
        }
    }
    all
}
