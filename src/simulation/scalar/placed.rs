//! Inclusions in their places, and what they add to the linear system.

use std::rc::Rc;

use super::{ScalarSetup, system::Member};
use crate::{
    constraint::{INTERPOLATION_REACH, Layout, PlacedInclusion, ScalarBlocks, assemble_inclusion},
    error::Result,
    geometry::{Ball, near_pairs},
    grid::Grid,
    petsc::{Session, Vector},
    surface::ScalarSurface,
};

/// The inclusions with their centres in the box; those of equal size share a surface.
pub fn place<const D: usize>(setup: &ScalarSetup<D>, grid: &Grid<D>) -> Vec<PlacedInclusion<D>> {
    let mut kinds: Vec<(f64, usize, Rc<ScalarSurface<D>>)> = Vec::new();
    let mut place = |(ball, order): &(Ball<D>, usize)| {
        let known = kinds.iter().position(|(radius, of_order, _)| *radius == ball.radius && of_order == order);
        let kind = known.unwrap_or_else(|| {
            kinds.push((ball.radius, *order, Rc::new(ScalarSurface::new(ball.radius, *order, grid.mean_spacing()))));
            kinds.len() - 1
        });
        PlacedInclusion { center: setup.domain.wrap(ball.center), surface: kinds[kind].2.clone() }
    };
    setup.inclusions.iter().map(&mut place).collect()
}

/// This rank's inclusions as members of the system.
pub fn members<const D: usize>(layout: &Layout, placed: &[PlacedInclusion<D>]) -> Vec<Member> {
    let member = |&body: &usize| {
        let (modes, first) = (&placed[body].surface.modes, layout.local(body));
        Member { range: first..first + modes.count(), values: Rc::new(modes.isolated_values()) }
    };
    layout.local_bodies.iter().map(member).collect()
}

/// The blocks of this rank's inclusions.
pub fn assemble<const D: usize>(
    session: &Session,
    field: &Vector,
    (grid, setup): (&Grid<D>, &ScalarSetup<D>),
    (layout, placed): (&Layout, &[PlacedInclusion<D>]),
) -> Result<ScalarBlocks> {
    let balls: Vec<Ball<D>> = placed.iter().map(|placed| Ball { center: placed.center, radius: placed.surface.modes.radius() }).collect();
    let mut neighbours: Vec<Vec<(usize, PlacedInclusion<D>)>> = vec![Vec::new(); placed.len()];
    for pair in near_pairs(&setup.domain, &balls, INTERPOLATION_REACH * grid.spacing().max()) {
        for (body, other, separation) in [(pair.first, pair.second, pair.separation), (pair.second, pair.first, -pair.separation)] {
            let image = PlacedInclusion { center: placed[body].center + separation, surface: placed[other].surface.clone() };
            neighbours[body].push((other, image));
        }
    }
    let inclusion = |&body: &usize| assemble_inclusion(grid, layout, (body, &placed[body]), &neighbours[body]);
    ScalarBlocks::new(session, field, layout, layout.local_bodies.iter().map(inclusion).collect())
}
