//! Inclusions in their places, and what they add to the linear system.

use std::rc::Rc;

use nalgebra::SVector;

use super::ScalarSetup;
use crate::{
    constraint::{INTERPOLATION_REACH, InclusionMethod, Layout, PlacedInclusion, ScalarBlocks},
    error::Result,
    geometry::{Ball, near_pairs},
    grid::Grid,
    petsc::{Session, Vector},
    surface::ScalarSurface,
};

/// The inclusions with their centres in the box; those of equal size share a surface.
pub fn place<const D: usize>(setup: &ScalarSetup<D>, grid: &Grid<D>) -> Vec<PlacedInclusion<D>> {
    let mut kinds: Vec<(f64, usize, Rc<ScalarSurface<D>>)> = Vec::new();
    let mut surface = |radius: f64, order: usize| {
        let known = kinds.iter().position(|(of_radius, of_order, _)| *of_radius == radius && *of_order == order);
        let kind = known.unwrap_or_else(|| {
            kinds.push((radius, order, Rc::new(ScalarSurface::new(radius, order, grid.mean_spacing()))));
            kinds.len() - 1
        });
        kinds[kind].2.clone()
    };
    let place = |&(ball, order): &(Ball<D>, usize)| PlacedInclusion {
        ball: Ball { center: setup.domain.wrap(ball.center), ..ball },
        surface: setup.method.on_surfaces().then(|| surface(ball.radius, order)),
    };
    setup.inclusions.iter().map(place).collect()
}

/// Who holds the multipliers of which inclusion.
pub fn layout<const D: usize>(setup: &ScalarSetup<D>, grid: &Grid<D>, rank: usize) -> Layout {
    let centers: Vec<SVector<f64, D>> = setup.inclusions.iter().map(|(ball, _)| setup.domain.wrap(ball.center)).collect();
    Layout::new(grid, &centers, &setup.counts(grid), rank)
}

/// The blocks of this rank's inclusions.
pub fn assemble<const D: usize>(
    session: &Session,
    field: &Vector,
    (grid, setup): (&Grid<D>, &ScalarSetup<D>),
    layout: &Layout,
) -> Result<ScalarBlocks> {
    let placed = place(setup, grid);
    let neighbours = if setup.method == InclusionMethod::Sharp { neighbours(grid, setup, &placed) } else { vec![Vec::new(); placed.len()] };
    let inclusion = |&body: &usize| setup.method.assemble(grid, layout, (body, &placed[body]), &neighbours[body]);
    ScalarBlocks::new(session, field, layout, layout.local_bodies.iter().map(inclusion).collect())
}

/// For each inclusion, the images of others that its interpolation may meet.
fn neighbours<const D: usize>(
    grid: &Grid<D>,
    setup: &ScalarSetup<D>,
    placed: &[PlacedInclusion<D>],
) -> Vec<Vec<(usize, PlacedInclusion<D>)>> {
    let balls: Vec<Ball<D>> = placed.iter().map(|placed| placed.ball).collect();
    let mut neighbours = vec![Vec::new(); placed.len()];
    for pair in near_pairs(&setup.domain, &balls, INTERPOLATION_REACH * grid.spacing().max()) {
        for (body, other, separation) in [(pair.first, pair.second, pair.separation), (pair.second, pair.first, -pair.separation)] {
            let ball = Ball { center: placed[body].ball.center + separation, ..placed[other].ball };
            let image = PlacedInclusion { ball, surface: placed[other].surface.clone() };
            neighbours[body].push((other, image));
        }
    }
    neighbours
}
