//! The velocities of the grid near surfaces as they are at the end of a step: how far from them, and what jumps have there beyond those of steady flow.

use nalgebra::SVector;

use crate::{
    error::Result,
    grid::Grid,
    petsc::Vector,
    system::{
        Level,
        bodies::BodyTypes,
        level::CORE,
        points::{Point, within},
    },
};

/// Distance from a surface, in cells, up to which viscous fluxes are of fourth order.
pub const BAND: f64 = 2.0;

/// How far from a surface interpolation on it reaches, in cells.
const REACH: f64 = 3.0;

/// Those near bodies that have come to new centres.
pub struct NearSurfaces {
    /// Distances from the nearest surface, in cells, negative inside; infinite where it is far.
    pub gaps: Vector,
    /// What the jump of that body has there beyond that of steady flow, on both sides.
    pub unsteady: Vector,
    /// Velocities of this rank as near as viscous fluxes need them, with their components.
    pub near: Vec<(usize, usize)>,
}

/// A velocity near a body.
struct Nearest<const D: usize> {
    place: usize,
    component: usize,
    body: usize,
    offset: SVector<f64, D>,
}

impl NearSurfaces {
    /// Near bodies at these centres, with multipliers that change as after a level. Collective.
    pub fn new<const D: usize>(
        grid: &Grid<D>,
        body_types: &BodyTypes<D>,
        centers: &[SVector<f64, D>],
        level: &Level<D>,
    ) -> Result<NearSurfaces> {
        let (mut gaps, mut unsteady) = (level.fluid.like()?, level.fluid.like()?);
        gaps.fill(f64::INFINITY)?;
        let spacing = grid.spacing().max();
        let nearest = nearest(grid, body_types, centers, &gaps)?;
        let mut near = Vec::new();
        {
            let (mut gaps, mut unsteady) = (gaps.local_mut()?, unsteady.local_mut()?);
            for alike in nearest.chunk_by(|one, other| (one.body, one.component) == (other.body, other.component)) {
                let (body, component) = (alike[0].body, alike[0].component);
                let modes = &body_types.surface(body).modes;
                let offsets: Vec<f64> = alike.iter().flat_map(|found| found.offset.iter().copied()).collect();
                let mut jumps = vec![0.0; alike.len()];
                if let Some(unsteady) = level.unsteady_jump(body_types, body) {
                    unsteady.add(modes.as_ref(), &offsets, component, &mut jumps);
                }
                for (Nearest { place, offset, .. }, jump) in alike.iter().zip(jumps) {
                    (gaps[*place], unsteady[*place]) = ((offset.norm() - modes.radius()) / spacing, jump);
                    if gaps[*place].abs() < BAND {
                        near.push((*place, component));
                    }
                }
            }
        }
        Ok(NearSurfaces { gaps, unsteady, near })
    }

    /// What interpolation from inside a body misses of the velocities outside it.
    pub fn missed(&self) -> Result<Vector> {
        let mut missed = self.unsteady.like()?;
        let (gaps, unsteady) = (self.gaps.local()?, self.unsteady.local()?);
        for ((missed, gap), unsteady) in missed.local_mut()?.iter_mut().zip(gaps.iter()).zip(unsteady.iter()) {
            *missed = if *gap > 0.0 { -unsteady } else { 0.0 };
        }
        Ok(missed)
    }
}

/// The velocities of this rank near bodies at these centres, each with the nearest of them, body by body.
fn nearest<const D: usize>(
    grid: &Grid<D>,
    body_types: &BodyTypes<D>,
    centers: &[SVector<f64, D>],
    shape: &Vector,
) -> Result<Vec<Nearest<D>>> {
    let (own, spacing) = (shape.range()?, grid.spacing().max());
    let mut gaps: Vec<f64> = vec![f64::INFINITY; own.len()];
    let mut nearest: Vec<Nearest<D>> = Vec::new();
    for (body, center) in centers.iter().enumerate() {
        let radius = body_types.surface(body).modes.radius();
        let deepest = (REACH * spacing).min((1.0 - CORE) * radius);
        within(grid, center, radius + REACH * spacing, |Point { component, place, offset, .. }| {
            let gap = offset.norm() - radius;
            if own.contains(&place) && gap > -deepest && gap < gaps[place - own.start] {
                gaps[place - own.start] = gap;
                nearest.push(Nearest { place: place - own.start, component, body, offset });
            }
        });
    }
    // of a place that two bodies claim the nearer one has the last word
    nearest.retain(|found| found.offset.norm() - body_types.surface(found.body).modes.radius() <= gaps[found.place]);
    Ok(nearest)
}
