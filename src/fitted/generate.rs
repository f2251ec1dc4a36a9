//! How a mesh comes about: vertices on surfaces and walls, a lattice far from them, and circumcentres where triangles are too large or too thin
//! (Chew 1993, Ruppert 1995), then some smoothing.

use std::collections::HashMap;

use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    boundary::{DISORDER, boundary, whole_number},
    cloud::{Cloud, Place},
    grading::{EdgeLengths, Grading},
    mesh::Mesh,
};
use crate::{
    error::{Error, Result},
    geometry::{Ball, Corner, Domain, near_pairs, near_walls},
};

/// Narrowest gap, in radii, that a mesh is made for: its elements number about as one over the root of the gap.
const NARROWEST: f64 = 1e-5;

/// Rounds of refinement that are allowed.
const MOST_ROUNDS: usize = 60;

/// Rounds of smoothing.
const SMOOTHING_ROUNDS: usize = 6;

/// Radius of a circumcircle, over the wanted length of edges, above which a triangle is too large; 0.577 would make all edges that long.
const LARGEST_RADIUS: f64 = 0.72;

/// Radius of a circumcircle, over the shortest edge, above which a triangle is too thin: its smallest angle is below 27 degrees.
const THINNEST: f64 = 1.1;

/// Distances that vertices keep from each other and from surfaces, over the wanted length of edges.
const LEAST_DISTANCE: f64 = 0.45;

/// Distance of the lattice from surfaces, over the wanted length of edges.
const LATTICE_DISTANCE: f64 = 0.7;

/// Diameter of the circumcircles that are met on the way, over the longest edge.
const REACH: f64 = 4.0;

/// Makes a mesh of the fluid around disks; the same on every rank.
///
/// # Errors
/// [`Error::Refused`] when the box is too small for such edges, or disks touch.
pub fn generate(domain: &Domain<2>, disks: &[Ball<2>], lengths: impl Into<EdgeLengths>) -> Result<Mesh> {
    check_gaps(domain, disks)?;
    let grading = Grading::new(domain, disks, lengths.into());
    let mut cloud = boundary(domain, disks, &grading);
    add_lattice(&mut cloud, &grading);
    let reach = REACH * grading.longest() + disks.iter().map(|disk| 2.0 * disk.radius).fold(0.0, f64::max);
    let mut triangles = refine(&mut cloud, &grading, reach)?;
    for _ in 0..SMOOTHING_ROUNDS {
        smooth(&mut cloud, &triangles, &grading);
        triangles = cloud.triangles(reach)?;
    }
    let triangles = refine(&mut cloud, &grading, reach)?;
    Mesh::new(cloud, &triangles)
}

/// A gap without width has no room for a mesh.
fn check_gaps(domain: &Domain<2>, disks: &[Ball<2>]) -> Result<()> {
    let reach = NARROWEST * disks.iter().map(|disk| disk.radius).fold(0.0, f64::max);
    let pairs = near_pairs(domain, disks, reach).into_iter().map(|pair| (pair.first, pair.gap));
    let walls = near_walls(domain, disks, reach).into_iter().map(|pair| (pair.body, pair.gap));
    match pairs.chain(walls).find(|&(disk, gap)| gap < NARROWEST * disks[disk].radius) {
        None => Ok(()),
        Some((disk, gap)) => Err(Error::refused(format!(
            "method.constraint = \"fitted\": body {disk} leaves a gap of {:.1e} radii, and no mesh fits below {NARROWEST:.0e}; \
             move bodies apart or set method.constraint = \"sharp\"",
            gap / disks[disk].radius
        ))),
    }
}

/// Adds a lattice of equilateral triangles where edges may have their full length.
fn add_lattice(cloud: &mut Cloud, grading: &Grading) {
    let (size, longest) = (cloud.domain.size, grading.longest());
    let columns = whole_number(size.x / longest);
    let rows = 2.0 * whole_number(size.y / (longest * 3_f64.sqrt()));
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for row in 0..rows as usize {
        for column in 0..columns as usize {
            let place = Vector2::new(column as f64 + 0.25 + 0.5 * (row % 2) as f64, row as f64 + 0.5);
            let free = Vector2::from_fn(|_, _| DISORDER * random.random::<f64>());
            let point = (place + free).component_div(&Vector2::new(columns, rows)).component_mul(&size);
            let coarse = grading.length(&point) > 0.95 * longest;
            if coarse && grading.distance(&point) > LATTICE_DISTANCE * longest {
                cloud.push(point, Place::Fluid);
            }
        }
    }
}

/// Adds circumcentres until no triangle is too large or too thin, where there is room; returns the triangles.
fn refine(cloud: &mut Cloud, grading: &Grading, reach: f64) -> Result<Vec<[Corner; 3]>> {
    for _ in 0..MOST_ROUNDS {
        let triangles = cloud.triangles(reach)?;
        let wanted = wanted(cloud, &triangles, grading);
        if wanted.is_empty() {
            return Ok(triangles);
        }
        wanted.into_iter().for_each(|point| cloud.push(point, Place::Fluid));
    }
    Err(Error::Diverged(format!(
        "the mesh is not fine enough after {MOST_ROUNDS} rounds of refinement; another resolution.spacing may help"
    )))
}

/// Circumcentres of bad triangles that leave room to each other, the worst first.
fn wanted(cloud: &Cloud, triangles: &[[Corner; 3]], grading: &Grading) -> Vec<Vector2<f64>> {
    let mut candidates: Vec<(f64, f64, Vector2<f64>)> =
        triangles.iter().filter_map(|triangle| candidate(cloud, triangle, grading)).collect();
    candidates.sort_by(|one, two| two.0.total_cmp(&one.0));
    let edge = candidates.iter().map(|candidate| candidate.1).fold(0.0, f64::max);
    let mut nearby = NearbyPoints { domain: &cloud.domain, edge, cells: HashMap::new() };
    candidates.into_iter().filter_map(|(_, radius, center)| nearby.admit(center, 0.9 * radius).then_some(center)).collect()
}

/// How bad a triangle is, the radius of its circumcircle, and the circumcentre; nothing if it is good or there is no room.
fn candidate(cloud: &Cloud, triangle: &[Corner; 3], grading: &Grading) -> Option<(f64, f64, Vector2<f64>)> {
    let points = triangle.map(|corner| cloud.position(corner));
    let (center, radius) = circumcircle(&points)?;
    let shortest = (0..3).map(|corner| (points[corner] - points[(corner + 1) % 3]).norm()).fold(f64::INFINITY, f64::min);
    let length = grading.length(&center);
    let badness = (radius / (LARGEST_RADIUS * length)).max(radius / (THINNEST * shortest));
    let size = cloud.domain.size;
    let outside = (0..2).any(|axis| !cloud.domain.periodic(axis) && !(0.0..size[axis]).contains(&center[axis]));
    let room = radius > LEAST_DISTANCE * length && !outside && grading.distance(&center) > LEAST_DISTANCE * length;
    (badness > 1.0 && room).then(|| (badness, radius, cloud.domain.wrap(center)))
}

/// Centre and radius of the circle through three points; nothing if they lie on a line.
fn circumcircle(points: &[Vector2<f64>; 3]) -> Option<(Vector2<f64>, f64)> {
    let (one, two) = (points[1] - points[0], points[2] - points[0]);
    let area = 2.0 * one.perp(&two);
    if area.abs() < 1e-14 * one.norm() * two.norm() {
        return None;
    }
    let to_center =
        Vector2::new(two.y * one.norm_squared() - one.y * two.norm_squared(), one.x * two.norm_squared() - two.x * one.norm_squared());
    let to_center = to_center / area;
    Some((points[0] + to_center, to_center.norm()))
}

/// New vertices by cells of a lattice, to see who is near.
struct NearbyPoints<'a> {
    domain: &'a Domain<2>,
    /// Edge of a cell, no shorter than any distance asked for.
    edge: f64,
    cells: HashMap<[i64; 2], Vec<Vector2<f64>>>,
}

impl NearbyPoints<'_> {
    /// Takes in a point if none is nearer than a distance.
    fn admit(&mut self, point: Vector2<f64>, distance: f64) -> bool {
        let cell = |point: Vector2<f64>| [(point.x / self.edge).floor() as i64, (point.y / self.edge).floor() as i64];
        let images = |axis: usize| if self.domain.periodic(axis) { -1..=1 } else { 0..=0 };
        for offset in images(0).flat_map(|x| images(1).map(move |y| [x, y])) {
            let image = point + super::cloud::image_offset(self.domain, offset);
            let [x, y] = cell(image);
            let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y]));
            let near = around.filter_map(|cell| self.cells.get(&cell)).flatten();
            if near.into_iter().any(|other| (other - image).norm() < distance) {
                return false;
            }
        }
        self.cells.entry(cell(point)).or_default().push(point);
        true
    }
}

/// Moves each vertex of the fluid to the mean of the centres of its triangles, if it keeps its distance from surfaces.
fn smooth(cloud: &mut Cloud, triangles: &[[Corner; 3]], grading: &Grading) {
    let mut moves = vec![(Vector2::zeros(), 0.0); cloud.points.len()];
    for triangle in triangles {
        let points = triangle.map(|corner| cloud.position(corner));
        let center = (points[0] + points[1] + points[2]) / 3.0;
        for (corner, point) in triangle.iter().zip(points) {
            moves[corner.0].0 += center - point;
            moves[corner.0].1 += 1.0;
        }
    }
    for (vertex, (sum, count)) in moves.into_iter().enumerate() {
        let moved = cloud.points[vertex] + sum / f64::max(count, 1.0);
        let inside = (0..2).all(|axis| cloud.domain.periodic(axis) || (0.0..cloud.domain.size[axis]).contains(&moved[axis]));
        if cloud.places[vertex] == Place::Fluid && inside && grading.distance(&moved) > 0.6 * grading.length(&moved) {
            cloud.points[vertex] = cloud.domain.wrap(moved);
        }
    }
}
