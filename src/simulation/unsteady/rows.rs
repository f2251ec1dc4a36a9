//! The right-hand side of a step: what the flow brings from earlier times.
//!
//! ```text
//! rho (g1 u0 + g2 u-)/dt + rho (e1 N0 + e0 N-), with the other sign
//! ```
//!
//! outside bodies of the extended flows. Inside, where the flow is a rigid motion, convection is `w x (w x r)` and more of that motion, and the
//! field is drawn to it, at a rate that belongs to the grid: left to itself it grows at high Reynolds numbers, and set anew in every step it
//! forgets so much that forces do not converge with shorter ones.

use nalgebra::SVector;

use super::{
    level::{Extended, Level, each_inside},
    scheme::StepWeights,
};
use crate::{
    error::Result,
    grid::Grid,
    petsc::{Scatter, Vector},
    simulation::bodies::BodyTypes,
};

/// Rate at which the inside is drawn to the rigid motion, over that of viscosity and convection across a cell.
const RELAXATION: f64 = 2.0;

/// The levels from which a step starts, the last one first.
pub struct Past<'a, const D: usize> {
    /// One or two.
    pub levels: &'a [(&'a Level<D>, &'a Extended)],
    /// Of the step.
    pub weights: StepWeights,
    /// Mass per volume over viscosity.
    pub inverse_diffusivity: f64,
    /// Part of what the inside is not as it should be that is kept.
    pub kept: f64,
}

/// The part that is kept inside over a step in a flow of a largest speed.
pub fn kept<const D: usize>(grid: &Grid<D>, step: f64, inverse_diffusivity: f64, fastest: f64) -> f64 {
    let spacing = grid.spacing().max();
    (-RELAXATION * step * (1.0 / (inverse_diffusivity * spacing * spacing) + fastest / spacing)).exp()
}

impl<const D: usize> Past<'_, D> {
    /// The momentum rows, not balanced, for bodies that have come to new centres; inside those of `kinds` with jump functions they are those of
    /// rigid motions. Collective.
    pub fn rows(&self, grid: &Grid<D>, kinds: Option<&BodyTypes<D>>, centers: &[SVector<f64, D>]) -> Result<Vector> {
        let mut rows = self.levels[0].1.velocity.like()?;
        for (place, (_, extended)) in self.levels.iter().enumerate() {
            let [history, convection] = self.factors(place);
            rows.add(history, &extended.velocity)?;
            rows.add(convection, &extended.convection)?;
        }
        rows.local_mut()?[grid.local_range(D)].fill(0.0);
        if let Some(kinds) = kinds {
            self.replace_inside(grid, kinds, centers, &mut rows)?;
        }
        Ok(rows)
    }

    /// What a velocity and its convection of a level weigh.
    fn factors(&self, level: usize) -> [f64; 2] {
        [-self.weights.rate[level + 1], -self.weights.extrapolation[level]].map(|weight| weight * self.inverse_diffusivity)
    }

    fn replace_inside(&self, grid: &Grid<D>, kinds: &BodyTypes<D>, centers: &[SVector<f64, D>], rows: &mut Vector) -> Result<()> {
        let points = inside(grid, kinds, centers);
        let places: Vec<usize> = points.iter().map(|point| point.place).collect();
        let mut scatter = Scatter::new(rows, &places)?;
        let mut wanted: Vec<f64> = scatter.fetch(rows)?.iter().map(|row| -row).collect();
        for (level, (at, _)) in self.levels.iter().enumerate() {
            let [history, convection] = self.factors(level);
            let velocities = scatter.fetch(&at.fluid)?;
            for ((wanted, point), velocity) in wanted.iter_mut().zip(&points).zip(velocities.iter()) {
                let rigid = at.rigid(point);
                let along = (at.twists[point.body].spin * rigid)[point.component];
                let field = rigid[point.component] + self.kept * at.deviation(kinds, point, *velocity);
                *wanted += history * field + convection * along;
            }
        }
        scatter.places()?.copy_from_slice(&wanted);
        scatter.add_back(rows)
    }
}

impl<const D: usize> Level<D> {
    /// Where a point inside a body is, seen from the centre that the body had.
    fn offset(&self, point: &Inside<D>) -> SVector<f64, D> {
        point.offset + point.center - self.centers[point.body]
    }

    /// The rigid motion of the body there.
    fn rigid(&self, point: &Inside<D>) -> SVector<f64, D> {
        self.twists[point.body].at(&self.offset(point))
    }

    /// What the field inside a body, extended to a point that was outside, differs from its motion by.
    fn deviation(&self, kinds: &BodyTypes<D>, point: &Inside<D>, velocity: f64) -> f64 {
        let (offset, &Inside { body, component, .. }) = (self.offset(point), point);
        let was_outside = offset.norm() > kinds.surface(body).modes.radius();
        velocity - if was_outside { self.jump(kinds, body, &offset, component) } else { 0.0 } - self.rigid(point)[component]
    }
}

/// An unknown inside a body of this rank.
struct Inside<const D: usize> {
    place: usize,
    body: usize,
    component: usize,
    /// Centre of the body, not wrapped into the box.
    center: SVector<f64, D>,
    offset: SVector<f64, D>,
}

fn inside<const D: usize>(grid: &Grid<D>, kinds: &BodyTypes<D>, centers: &[SVector<f64, D>]) -> Vec<Inside<D>> {
    let mut points = Vec::new();
    for (body, &center) in centers.iter().enumerate() {
        let radius = kinds.surface(body).modes.radius();
        each_inside(grid, &center, radius, |component, place, offset| points.push(Inside { place, body, component, center, offset }));
    }
    points
}
