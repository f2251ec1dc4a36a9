//! Vertices on surfaces and walls.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    cloud::{Cloud, Place},
    grading::Grading,
};
use crate::{
    geometry::{Ball, Domain},
    linalg::ROUNDING,
};

/// Steps by which a line is measured, in wanted lengths of edges.
const MEASURING_STEP: f64 = 0.1;

/// Part of an edge by which vertices leave their place at random: four on a circle would have no unique triangulation.
pub const DISORDER: f64 = 1e-3;

/// Fewest vertices on a line, so that periodic images of edges are told apart.
const FEWEST: usize = 4;

/// The vertices on all surfaces and walls.
pub fn boundary(domain: &Domain<2>, disks: &[Ball<2>], grading: &Grading) -> Cloud {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut disorder = || DISORDER * (random.random::<f64>() - 0.5);
    let mut cloud = Cloud { domain: domain.clone(), disks: disks.to_vec(), points: Vec::new(), places: Vec::new() };
    for axis in (0..2).filter(|&axis| !domain.periodic(axis)) {
        for upper in [false, true] {
            wall(grading, axis, upper, &mut disorder, &mut cloud);
        }
    }
    for (disk, ball) in disks.iter().enumerate() {
        let start = TAU * disorder() / DISORDER;
        let point = |angle: f64| ball.center + ball.radius * Vector2::new((start + angle).cos(), (start + angle).sin());
        for angle in divide(TAU, true, &mut disorder, |angle| grading.length(&point(angle)) / ball.radius) {
            cloud.push(point(angle), Place::Surface(disk));
        }
    }
    cloud
}

/// The vertices of a wall; corners belong to the walls across the first axis.
fn wall(grading: &Grading, axis: usize, upper: bool, disorder: &mut dyn FnMut() -> f64, cloud: &mut Cloud) {
    let (size, along, closed) = (cloud.domain.size, 1 - axis, cloud.domain.periodic(1 - axis));
    let point = |place: f64| {
        let mut point = Vector2::zeros();
        (point[axis], point[along]) = (if upper { size[axis] } else { 0.0 }, place);
        point
    };
    let mut places = divide(size[along], closed, disorder, |place| grading.length(&point(place)));
    match (closed, axis) {
        (true, _) => {}
        (false, 0) => places.push(size[along]),
        (false, _) => _ = places.remove(0),
    }
    for place in places {
        let mut walls = [None; 2];
        walls[axis] = Some(upper);
        if !closed && (place == 0.0 || place == size[along]) {
            walls[along] = Some(place > 0.0);
        }
        cloud.push(point(place), Place::Wall(walls));
    }
}

/// The least whole number of edges that are shorter than wanted, also where rounding has them just as long: else a unit of length could change a mesh.
pub fn whole_number(edges: f64) -> f64 {
    (edges * (1.0 + ROUNDING)).ceil()
}

/// Divides a line, closed or not, into edges of the wanted lengths; the first place is 0.
fn divide(whole: f64, closed: bool, disorder: &mut dyn FnMut() -> f64, length: impl Fn(f64) -> f64) -> Vec<f64> {
    let (mut places, mut edges) = (vec![0.0], vec![0.0]);
    let (mut place, mut count) = (0.0, 0.0);
    while place < whole {
        let edge = length(place);
        let step = (MEASURING_STEP * edge).min(whole - place);
        (place, count) = (place + step, count + step / edge);
        places.push(place);
        edges.push(count);
    }
    let number = (whole_number(count) as usize).max(FEWEST);
    let mut measured = 1;
    let place_of = |edge: usize| {
        let free = if edge == 0 && !closed { 0.0 } else { disorder() };
        let wanted = ((edge as f64 + free) * count / number as f64).max(0.0);
        while edges[measured] < wanted {
            measured += 1;
        }
        let part = (wanted - edges[measured - 1]) / (edges[measured] - edges[measured - 1]);
        places[measured - 1] + part * (places[measured] - places[measured - 1])
    };
    (0..number).map(place_of).collect()
}
