//! Inclusions in their places, and what they add to the linear system.

use std::rc::Rc;

use nalgebra::SVector;

use super::ScalarSetup;
use crate::{
    constraint::{MultiplierLayout, Placed, ScalarBlocks, Surrounded, neighbours, surrounded},
    error::Result,
    geometry::{Ball, near_pairs},
    grid::Grid,
    petsc::{Session, Vector},
    surface::SurfaceTable,
};

/// The inclusions with their centres in the box; those of equal size share a surface.
fn place<const D: usize>(setup: &ScalarSetup<D>, grid: &Grid<D>) -> Vec<Placed<D>> {
    let mut body_types: Vec<(f64, usize, Rc<SurfaceTable<D>>)> = Vec::new();
    let mut surface = |radius: f64, order: usize| {
        let known = body_types.iter().position(|(of_radius, of_order, _)| *of_radius == radius && *of_order == order);
        let kind = known.unwrap_or_else(|| {
            body_types.push((radius, order, Rc::new(SurfaceTable::scalar(radius, order, grid.mean_spacing()))));
            body_types.len() - 1
        });
        body_types[kind].2.clone()
    };
    let place = |&(ball, order): &(Ball<D>, usize)| Placed { center: setup.domain.wrap(ball.center), surface: surface(ball.radius, order) };
    setup.inclusions.iter().map(place).collect()
}

/// Who holds the multipliers of which inclusion.
pub fn layout<const D: usize>(setup: &ScalarSetup<D>, grid: &Grid<D>, rank: usize) -> MultiplierLayout {
    let centers: Vec<SVector<f64, D>> = setup.inclusions.iter().map(|(ball, _)| setup.domain.wrap(ball.center)).collect();
    MultiplierLayout::new(grid, &centers, &setup.counts(grid), rank)
}

/// The blocks of this rank's inclusions.
pub fn assemble<const D: usize>(
    session: &Session,
    field: &Vector,
    grid: &Grid<D>,
    setup: &ScalarSetup<D>,
    layout: &MultiplierLayout,
) -> Result<ScalarBlocks<D>> {
    let (placed, method) = (place(setup, grid), setup.method());
    let (balls, reach): (Vec<Ball<D>>, f64) = (placed.iter().map(Placed::ball).collect(), method.reach() * grid.spacing().max());
    let neighbours = neighbours(&placed, &near_pairs(&setup.domain, &balls, reach), reach);
    let own: Vec<Surrounded<D>> = surrounded(&placed, &neighbours).into_iter().filter(|body| layout.holds(body.body)).collect();
    ScalarBlocks::new(session, field, layout, method.assemble(grid, &own, Vec::new()))
}
