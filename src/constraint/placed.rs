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

/// Bodies are alike that have one surface, not an equal one.
impl<const D: usize> PartialEq for Placed<D> {
    fn eq(&self, other: &Placed<D>) -> bool {
        self.center == other.center && Rc::ptr_eq(&self.surface, &other.surface)
    }
}

impl<const D: usize> Placed<D> {
    /// The smallest ball about its centre that holds it.
    pub fn ball(&self) -> Ball<D> {
        let [_, radius] = self.surface.modes.bounds();
        Ball { center: self.center, radius }
    }

    /// Whether a point lies outside.
    pub fn outside(&self, point: &SVector<f64, D>) -> bool {
        let offset = point - self.center;
        self.outside_test()(offset.norm_squared(), &|| offset)
    }

    /// What tells of a point whether it lies outside, by the square of its distance from the centre, or where that does not tell by its offset.
    pub fn outside_test(&self) -> impl Fn(f64, &dyn Fn() -> SVector<f64, D>) -> bool {
        let (modes, [inner, outer]) = (&self.surface.modes, self.surface.modes.bounds().map(|radius| radius * radius));
        move |square, offset| square > outer || square > inner && modes.outside(offset().as_slice())
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

/// Where a body and its neighbours were, with which surfaces, when its blocks were assembled; while nothing of it changes, the blocks hold.
#[derive(Clone, PartialEq)]
pub struct Situation<const D: usize> {
    /// The body.
    pub body: usize,
    placed: Vec<(usize, Placed<D>)>,
}

impl<const D: usize> Situation<D> {
    /// That of a body.
    pub fn of(surrounded: &Surrounded<D>) -> Situation<D> {
        let own = std::iter::once((surrounded.body, surrounded.placed.clone()));
        Situation { body: surrounded.body, placed: own.chain(surrounded.neighbours.iter().cloned()).collect() }
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
