//! A mesh of second-order triangles whose edges follow the surfaces of disks.

use std::collections::HashMap;

use nalgebra::Vector2;

use super::{
    cloud::{Cloud, Place, image_offset},
    element::ShapeFunctions,
};
use crate::{
    error::{Error, Result},
    geometry::{Ball, Corner, Domain},
};

/// A triangle of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Its vertices counter-clockwise, then the middles of the edges that begin at each.
    pub nodes: [usize; 6],
    /// The periodic image of the box that each node is taken from.
    pub images: [[i32; 2]; 6],
}

/// The fluid around disks, cut into triangles; each edge on a surface is a parabola through three of its points.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// The box.
    pub domain: Domain<2>,
    /// The disks, their centres in the box.
    pub disks: Vec<Ball<2>>,
    /// Where nodes are: vertices, then middles of edges.
    pub nodes: Vec<Vector2<f64>>,
    /// What each node lies on.
    pub places: Vec<Place>,
    /// Number of vertices.
    pub vertices: usize,
    /// The triangles.
    pub triangles: Vec<Triangle>,
}

/// The edge between two vertices: the smaller first, then the image of the other as seen from it.
type EdgeKey = (usize, usize, [i32; 2]);

fn edge(one: Corner, two: Corner) -> EdgeKey {
    let (one, two) = if one.0 < two.0 { (one, two) } else { (two, one) };
    (one.0, two.0, [two.1[0] - one.1[0], two.1[1] - one.1[1]])
}

fn edges(triangle: &[Corner; 3]) -> [EdgeKey; 3] {
    [0, 1, 2].map(|corner| edge(triangle[corner], triangle[(corner + 1) % 3]))
}

impl Mesh {
    /// The mesh of the given triangles between vertices.
    ///
    /// # Errors
    /// [`Error::Refused`] when the triangles do not fit box and disks.
    pub fn new(cloud: Cloud, triangles: &[[Corner; 3]]) -> Result<Mesh> {
        let mut sides: HashMap<EdgeKey, usize> = HashMap::new();
        triangles.iter().flat_map(edges).for_each(|edge| *sides.entry(edge).or_default() += 1);
        check_edges(&cloud, triangles, &sides)?;
        let disks = cloud.disks.iter().map(|disk| Ball { center: cloud.domain.wrap(disk.center), radius: disk.radius }).collect();
        let vertices = cloud.points.len();
        let mut mesh = Mesh { domain: cloud.domain, disks, nodes: cloud.points, places: cloud.places, vertices, triangles: Vec::new() };
        let mut middles: HashMap<EdgeKey, usize> = HashMap::new();
        for triangle in triangles {
            let mut made = Triangle { nodes: [0; 6], images: [[0; 2]; 6] };
            for (side, edge) in edges(triangle).into_iter().enumerate() {
                let (one, two) = (triangle[side], triangle[(side + 1) % 3]);
                let middle = *middles.entry(edge).or_insert_with(|| mesh.add_middle(edge, sides[&edge] == 1));
                (made.nodes[side], made.images[side]) = one;
                (made.nodes[side + 3], made.images[side + 3]) = (middle, if one.0 == edge.0 { one.1 } else { two.1 });
            }
            mesh.triangles.push(made);
        }
        mesh.place_middles();
        mesh.check_shapes()?;
        Ok(mesh)
    }

    /// Adds the node in the middle of an edge, which lies on a surface or a wall if only one triangle has it.
    fn add_middle(&mut self, (one, two, _): EdgeKey, outer: bool) -> usize {
        let place = match (self.places[one], self.places[two]) {
            (Place::Surface(disk), _) if outer => Place::Surface(disk),
            (Place::Wall(one), Place::Wall(two)) if outer => Place::Wall([0, 1].map(|axis| one[axis].filter(|_| one[axis] == two[axis]))),
            _ => Place::Fluid,
        };
        self.nodes.push(Vector2::zeros());
        self.places.push(place);
        self.nodes.len() - 1
    }

    /// Puts all middles where they belong: halfway between their vertices, or on a surface.
    pub fn place_middles(&mut self) {
        for triangle in 0..self.triangles.len() {
            let triangle = self.triangles[triangle];
            for side in 0..3 {
                let (ends, middle) = ([side, (side + 1) % 3], side + 3);
                let sum: Vector2<f64> = ends.iter().map(|&end| self.position(&triangle, end)).sum();
                let point = 0.5 * sum - image_offset(&self.domain, triangle.images[middle]);
                let node = triangle.nodes[middle];
                self.nodes[node] = match self.places[node] {
                    Place::Surface(disk) => {
                        let arm = self.arm(disk, &point);
                        point + arm * (self.disks[disk].radius / arm.norm() - 1.0)
                    }
                    _ => point,
                };
            }
        }
    }

    /// From the centre of the nearest image of a disk to a point.
    pub fn arm(&self, disk: usize, point: &Vector2<f64>) -> Vector2<f64> {
        self.domain.nearest_image(point - self.disks[disk].center)
    }

    /// Where a node of a triangle lies.
    fn position(&self, triangle: &Triangle, node: usize) -> Vector2<f64> {
        self.nodes[triangle.nodes[node]] + image_offset(&self.domain, triangle.images[node])
    }

    /// The form of a triangle.
    pub fn shape(&self, triangle: &Triangle) -> ShapeFunctions {
        ShapeFunctions::new([0, 1, 2, 3, 4, 5].map(|node| self.position(triangle, node)))
    }

    /// The areas of the disks as the mesh has them: all that the triangles leave of the box.
    pub fn disk_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.disks.len()];
        for triangle in &self.triangles {
            for side in 0..3 {
                let Place::Surface(disk) = self.places[triangle.nodes[side + 3]] else { continue };
                let arms = [side, side + 3, (side + 1) % 3].map(|node| self.arm(disk, &self.nodes[triangle.nodes[node]]));
                // along a parabola, the disk to the right
                areas[disk] -= (4.0 * (arms[0].perp(&arms[1]) + arms[1].perp(&arms[2])) - arms[0].perp(&arms[2])) / 6.0;
            }
        }
        areas
    }

    /// The velocity of walls that meet, that of the wall across the first axis where it exists.
    pub fn wall_velocity(&self, walls: [Option<bool>; 2]) -> Vector2<f64> {
        let across = |axis: usize| match (walls[axis], self.domain.axes[axis].walls()) {
            (Some(upper), Some(velocities)) => Some(velocities[usize::from(upper)]),
            _ => None,
        };
        across(0).or(across(1)).unwrap_or_default()
    }

    /// The smallest angle of all triangles with straight edges, in radians.
    pub fn smallest_angle(&self) -> f64 {
        self.triangles.iter().map(|triangle| self.shape(triangle).smallest_angle()).fold(f64::INFINITY, f64::min)
    }

    /// Whether no triangle is turned inside out, anywhere in it.
    pub fn regular(&self) -> bool {
        self.triangles.iter().all(|triangle| self.shape(triangle).regular())
    }

    fn check_shapes(&self) -> Result<()> {
        match self.regular() {
            true => Ok(()),
            false => Err(misfit("a triangle is turned inside out")),
        }
    }
}

fn misfit(what: &str) -> Error {
    Error::refused(format!("method.constraint = \"fitted\": no mesh fits ({what}); refine [resolution] or enlarge domain.size"))
}

/// Each edge must have two triangles, or one if it lies on a surface or a wall; each vertex there begins one such edge.
fn check_edges(cloud: &Cloud, triangles: &[[Corner; 3]], sides: &HashMap<EdgeKey, usize>) -> Result<()> {
    let distinct = |[one, two, three]: &[Corner; 3]| one.0 != two.0 && two.0 != three.0 && three.0 != one.0;
    if !triangles.iter().all(distinct) {
        return Err(misfit("a triangle reaches around the box"));
    }
    let on_boundary = |&(one, two, image): &EdgeKey| match (cloud.places[one], cloud.places[two]) {
        (Place::Surface(one_disk), Place::Surface(two_disk)) => {
            let centers = [(one, [0, 0]), (two, image)].map(|corner| cloud.center_seen_from(one_disk, &cloud.position(corner)));
            one_disk == two_disk && (centers[0] - centers[1]).norm() < cloud.disks[one_disk].radius
        }
        (Place::Wall(one), Place::Wall(two)) => (0..2).any(|axis| one[axis].is_some() && one[axis] == two[axis]),
        _ => false,
    };
    let outer: Vec<&EdgeKey> = sides.iter().filter(|(_, count)| **count == 1).map(|(edge, _)| edge).collect();
    let wanted = cloud.places.iter().filter(|place| **place != Place::Fluid).count();
    if sides.values().any(|&count| count > 2) || outer.len() != wanted || !outer.into_iter().all(on_boundary) {
        return Err(misfit("its edges do not follow the surfaces"));
    }
    Ok(())
}
