//! Bodies in their places, and what is near them.

use std::rc::Rc;

use nalgebra::SVector;

use crate::{
    geometry::{Ball, Pair},
    surface::SurfaceTable,
};

/// A body in its place.
#[derive(Clone)]
pub struct Placed<const D: usize> {
    /// Its centre, in the box or, for an image, beyond it.
    pub center: SVector<f64, D>,
    /// Its surface.
    pub surface: Rc<SurfaceTable<D>>,
}

impl<const D: usize> Placed<D> {
    /// It as a ball.
    pub fn ball(&self) -> Ball<D> {
        Ball { center: self.center, radius: self.surface.modes.radius() }
    }

    /// Whether a point lies outside.
    pub fn outside(&self, point: &SVector<f64, D>) -> bool {
        (point - self.center).norm_squared() > self.surface.modes.radius().powi(2)
    }
}

/// A neighbour whose inside may meet the interpolation on a body's surface: its number, and it in the image next to the body.
pub type Neighbour<const D: usize> = (usize, Placed<D>);

/// A body among its neighbours.
#[derive(Clone, Copy)]
pub struct Surrounded<'a, const D: usize> {
    /// Its number.
    pub body: usize,
    /// It in its place.
    pub placed: &'a Placed<D>,
    /// Those near it.
    pub neighbours: &'a [Neighbour<D>],
}

/// Where a body and its neighbours were when its blocks were assembled; while nothing of it changes, the blocks hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Situation<const D: usize> {
    /// The body.
    pub body: usize,
    centers: Vec<(usize, SVector<f64, D>)>,
}

impl<const D: usize> Situation<D> {
    /// That of a body.
    pub fn of(surrounded: &Surrounded<D>) -> Situation<D> {
        let own = std::iter::once((surrounded.body, surrounded.placed.center));
        let others = surrounded.neighbours.iter().map(|(other, image)| (*other, image.center));
        Situation { body: surrounded.body, centers: own.chain(others).collect() }
    }
}

/// For each body, those whose gap to it is smaller than `reach`.
pub fn neighbours<const D: usize>(placed: &[Placed<D>], pairs: &[Pair<D>], reach: f64) -> Vec<Vec<Neighbour<D>>> {
    let mut neighbours: Vec<Vec<Neighbour<D>>> = vec![Vec::new(); placed.len()];
    for pair in pairs.iter().filter(|pair| pair.gap < reach) {
        for (body, other, separation) in [(pair.first, pair.second, pair.separation), (pair.second, pair.first, -pair.separation)] {
            let image = Placed { center: placed[body].center + separation, surface: placed[other].surface.clone() };
            neighbours[body].push((other, image));
        }
    }
    neighbours
}
