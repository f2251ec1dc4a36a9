//! The membrane of a red cell in space at rest: corners of a triangulated surface along the profile of Evans and Fung (1972).
//!
//! An icosahedron whose faces are divided into `f^2` triangles is blown up to a sphere and then pressed to the profile: `10 f^2 + 2` corners.

use std::collections::{BTreeMap, HashMap};

use nalgebra::{Vector2, Vector3};

use super::outline::half_thickness;

/// A closed surface of triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Membrane {
    /// Its corners, about the middle.
    pub places: Vec<Vector3<f64>>,
    /// Corners of each triangle, counterclockwise as seen from outside.
    pub triangles: Vec<[usize; 3]>,
}

/// An edge of a closed surface, with the triangles beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Its ends.
    pub ends: [usize; 2],
    /// The third corner of the triangle in which the ends follow each other, and that of the other triangle.
    pub wings: [usize; 2],
}

impl Membrane {
    /// A red cell of so many corners, its axis along the second of space, of which the two nearest are a `link` apart. Nothing if no cell has so many.
    pub fn biconcave(corners: usize, link: f64) -> Option<Membrane> {
        let sphere = Membrane::sphere(parts(corners)?);
        let press = |place: &Vector3<f64>| {
            let across = Vector2::new(place.x, place.z).norm();
            Vector3::new(place.x, half_thickness(place.y, across * across), place.z)
        };
        let places: Vec<Vector3<f64>> = sphere.places.iter().map(press).collect();
        let nearest = nearest(&places, &sphere.triangles);
        Some(Membrane { places: places.iter().map(|place| place * (link / nearest)).collect(), ..sphere })
    }

    /// A sphere of radius 1: each edge of an icosahedron in so many parts.
    pub fn sphere(parts: usize) -> Membrane {
        let (corners, faces) = icosahedron();
        let (mut places, mut numbers, mut triangles) = (Vec::new(), HashMap::new(), Vec::new());
        for face in faces {
            let mut corner = |steps: [usize; 3]| {
                // the same corner of two faces has the same weights of the same ends
                let key: BTreeMap<usize, usize> = face.into_iter().zip(steps).filter(|(_, steps)| *steps > 0).collect();
                *numbers.entry(key).or_insert_with_key(|key| {
                    places.push(key.iter().map(|(&end, &steps)| corners[end] * steps as f64).sum::<Vector3<f64>>().normalize());
                    places.len() - 1
                })
            };
            for (row, place) in (0..parts).flat_map(|row| (0..parts - row).map(move |place| (row, place))) {
                let mut at = |row: usize, place: usize| corner([parts - row - place, place, row]);
                triangles.push([at(row, place), at(row, place + 1), at(row + 1, place)]);
                if row + place + 2 <= parts {
                    triangles.push([at(row, place + 1), at(row + 1, place + 1), at(row + 1, place)]);
                }
            }
        }
        Membrane { places, triangles }
    }

    /// All edges, each once.
    pub fn edges(&self) -> Vec<Edge> {
        let mut beside = BTreeMap::new();
        for &[one, two, three] in &self.triangles {
            for (ends, wing) in [([one, two], three), ([two, three], one), ([three, one], two)] {
                beside.insert(ends, wing);
            }
        }
        let edge = |(&[one, two], &wing): (&[usize; 2], &usize)| {
            let other = beside.get(&[two, one]).filter(|_| one < two)?;
            Some(Edge { ends: [one, two], wings: [wing, *other] })
        };
        beside.iter().filter_map(edge).collect()
    }
}

/// The smallest distance of two corners: along an edge, or across, where a membrane is thin.
fn nearest(places: &[Vector3<f64>], triangles: &[[usize; 3]]) -> f64 {
    let sides = triangles.iter().flat_map(|&[one, two, three]| [[one, two], [two, three], [three, one]]);
    let along = sides.map(|[one, two]| (places[one] - places[two]).norm()).fold(f64::INFINITY, f64::min);
    let cell = |place: &Vector3<f64>| [place.x, place.y, place.z].map(|coordinate| (coordinate / along).floor() as i64);
    let (mut earlier, mut nearest) = (HashMap::<[i64; 3], Vec<Vector3<f64>>>::new(), along);
    for place in places {
        let home = cell(place);
        for number in 0..27 {
            let beside = [home[0] + number % 3 - 1, home[1] + number / 3 % 3 - 1, home[2] + number / 9 - 1];
            let others = earlier.get(&beside).into_iter().flatten();
            nearest = others.map(|other| (place - other).norm()).fold(nearest, f64::min);
        }
        earlier.entry(home).or_default().push(*place);
    }
    nearest
}

/// Parts of an icosahedron's edge, at least two, that make so many corners.
pub fn parts(corners: usize) -> Option<usize> {
    let parts = ((corners.checked_sub(2)? / 10) as f64).sqrt().round() as usize;
    (parts >= 2 && 10 * parts * parts + 2 == corners).then_some(parts)
}

fn icosahedron() -> ([Vector3<f64>; 12], [[usize; 3]; 20]) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let corner = |number: usize| {
        let (sign, other) =
            (if number.is_multiple_of(2) { 1.0 } else { -1.0 }, if (number / 2).is_multiple_of(2) { golden } else { -golden });
        match number / 4 {
            0 => Vector3::new(sign, other, 0.0),
            1 => Vector3::new(0.0, sign, other),
            _ => Vector3::new(other, 0.0, sign),
        }
        .normalize()
    };
    let corners: [Vector3<f64>; 12] = std::array::from_fn(corner);
    let near = |one: usize, two: usize| (corners[one] - corners[two]).norm() < 1.2;
    let outward = |[one, two, three]: [usize; 3]| corners[one].dot(&corners[two].cross(&corners[three])) > 0.0;
    let all = (0..12).flat_map(|one| (one + 1..12).flat_map(move |two| (two + 1..12).map(move |three| [one, two, three])));
    let mut faces = all.filter(|&[one, two, three]| near(one, two) && near(two, three) && near(three, one));
    let face = |_| {
        let [one, two, three] = faces.next().unwrap_or_default();
        if outward([one, two, three]) { [one, two, three] } else { [one, three, two] }
    };
    (corners, std::array::from_fn(face))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Euler's formula, and the volume of a sphere and of the profile (by slices).
    #[test]
    fn surfaces_are_closed_and_enclose_what_they_should() {
        let volume = |membrane: &Membrane| {
            let corner = |corner: usize| membrane.places[corner];
            membrane.triangles.iter().map(|&[a, b, c]| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0).sum::<f64>()
        };
        for parts in [2, 3, 4, 8] {
            let sphere = Membrane::sphere(parts);
            let (corners, faces, edges) = (sphere.places.len(), sphere.triangles.len(), sphere.edges());
            assert_eq!((corners, faces, edges.len()), (10 * parts * parts + 2, 20 * parts * parts, 30 * parts * parts));
            let missing = 1.0 - volume(&sphere) / (4.0 / 3.0 * std::f64::consts::PI);
            assert!((0.0..0.8 / (parts * parts) as f64).contains(&missing), "{parts}: {missing}");
        }
        let cell = Membrane::biconcave(642, 1.0).unwrap();
        let radius = cell.places.iter().map(|place| place.x.hypot(place.z)).fold(0.0, f64::max);
        let rings = (0..1000).map(|ring| (f64::from(ring) + 0.5) / 1000.0);
        let exact: f64 = rings.map(|at| 2.0 * half_thickness((1.0 - at * at).sqrt(), at * at) * std::f64::consts::TAU * at / 1000.0).sum();
        let part = volume(&cell) / radius.powi(3) / exact;
        assert!((0.96..1.0).contains(&part), "{part}");
    }

    #[test]
    fn numbers_of_corners_that_no_cell_has_are_told() {
        assert_eq!([42, 92, 162, 252].map(parts), [Some(2), Some(3), Some(4), Some(5)]);
        assert_eq!([0, 1, 12, 41, 43, 100].map(parts), [None; 6]);
    }
}
