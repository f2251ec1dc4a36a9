//! The right-hand side of a step: what the flow brings from earlier times.
//!
//! ```text
//! rho (g1 u0 + g2 u-)/dt + rho (e0 N0 + e1 N- + e2 N--), with the other sign
//! ```
//!
//! outside bodies of the extended flows. Inside, where the flow is a rigid motion, the field is drawn to it, at a rate that belongs to the grid: left to itself it grows at
//! high Reynolds numbers, and set anew in every step it forgets so much that forces do not converge with shorter ones. The rigid motion nearest to what is drawn over a body is
//! kept: the draw would be a force on the flow otherwise, up to a tenth of the drag on coarse grids, and a torque, which took 2 % of the spin of a disk in shear at a Reynolds number of 5.

use nalgebra::SVector;

use super::{
    convected::sums,
    inside::{Inside, inside, nearest_rigid},
    near_surfaces::NearSurfaces,
    scheme::StepWeights,
    viscous_flux::viscous_defect,
};
use crate::{
    error::Result,
    grid::{Grid, Index, Node, operators::signed},
    petsc::{Scatter, Vector, WantedRun},
    system::{Level, bodies::BodyTypes, level::Extended, points::Point},
};

/// Rate at which the inside is drawn to the rigid motion, over that of viscosity and convection across a cell.
const RELAXATION: f64 = 2.0;

/// The levels from which a step starts, the last one first.
pub struct Past<'a, const D: usize> {
    /// One to three, of which convection is extrapolated; the last one or two are the history.
    pub levels: &'a [(&'a Level<D>, &'a Extended<D>)],
    /// Of the step.
    pub weights: StepWeights,
    /// Of the convection of the levels.
    pub convection: [f64; 3],
    /// Of the last two, of which what viscous fluxes lack is taken.
    pub viscous: [f64; 2],
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
    /// The momentum rows, not balanced, for bodies that have come to new centres; inside those of `body_types` with jump functions they are those of
    /// rigid motions, and beside `surfaces`, where these are known, viscous fluxes are of fourth order. Collective.
    pub fn rows(
        &self,
        grid: &Grid<D>,
        body_types: Option<&BodyTypes<D>>,
        centers: &[SVector<f64, D>],
        surfaces: Option<&NearSurfaces>,
    ) -> Result<Vector> {
        let mut rows = self.levels[0].1.velocity.like()?;
        for (level, (_, extended)) in self.levels.iter().enumerate() {
            let [history, convection] = self.factors(level);
            self.add_followed(grid, level, &[(history, &extended.velocity), (convection, &extended.convection)], &mut rows)?;
        }
        rows.local_mut()?[grid.local_range(D)].fill(0.0);
        if let Some(body_types) = body_types {
            let mut known = rows.like()?;
            self.levels.iter().zip(self.viscous).try_for_each(|((_, extended), factor)| known.add(factor, &extended.velocity))?;
            self.replace_inside(grid, body_types, centers, [&mut rows, &mut known])?;
            if let Some(surfaces) = surfaces {
                // a layer thinner than a cell, as at the start, has no third differences
                rows.add(1.0, &viscous_defect(grid, surfaces, &known, self.levels[0].0.resolved)?)?;
            }
        }
        Ok(rows)
    }

    /// Adds fields of a level, as the frames of their points see them. Collective.
    fn add_followed(&self, grid: &Grid<D>, level: usize, weighed: &[(f64, &Vector)], to: &mut Vector) -> Result<()> {
        let Some(mut followed) = self.followed(grid, level, to)? else {
            return weighed.iter().filter(|(factor, _)| *factor != 0.0).try_for_each(|(factor, field)| to.add(*factor, field));
        };
        let mut sum = to.like()?;
        weighed.iter().try_for_each(|(factor, field)| sum.add(*factor, field))?;
        to.local_mut()?.iter_mut().zip(followed.fetch(&sum)?.iter()).for_each(|(row, value)| *row += value);
        Ok(())
    }

    /// What rows lose of momentum against those of the field on the grid, which conserve it: a sum over the grid. Collective.
    pub fn lost(&self, grid: &Grid<D>, rows: &Vector) -> Result<SVector<f64, D>> {
        let mut lost = -sums(grid, rows)?;
        for (level, (_, extended)) in self.levels.iter().enumerate() {
            self.factors(level).iter().zip(&extended.sums).for_each(|(factor, sum)| lost += sum * *factor);
        }
        Ok(lost)
    }

    fn since(&self, level: usize) -> f64 {
        self.levels[0].0.time + self.weights.step - self.levels[level].0.time
    }

    /// Where the frames of this rank's velocities saw their points at a level, if they move. Collective.
    fn followed(&self, grid: &Grid<D>, level: usize, shape: &Vector) -> Result<Option<Scatter>> {
        if grid.domain().slide().is_none() {
            return Ok(None);
        }
        let (mut place, mut wanted) = (0, Vec::new());
        for component in 0..D {
            let (block, shifts) = (grid.block(component), grid.frame_shifts(component, self.since(level)));
            for start in block.flattened(D - 1).indices() {
                let (mut index, end) = (start, block.end[D - 1]);
                while index[D - 1] < end {
                    let mut followed = signed(index);
                    followed[0] -= shifts[index[1]];
                    let (first, follow) = unknown(grid, component, followed);
                    // in two dimensions ways differ along the row
                    let alike = |rows: &[isize]| rows.iter().take_while(|shift| **shift == rows[0]).count();
                    let length = follow.min(end - index[D - 1]).min(if D == 2 { alike(&shifts[index[1]..]) } else { usize::MAX });
                    wanted.push(WantedRun { place, first, length });
                    (place, index[D - 1]) = (place + length, index[D - 1] + length);
                }
            }
        }
        Scatter::of_runs(shape, place, wanted.into_iter()).map(Some)
    }

    /// The same for points inside bodies of this rank.
    fn followed_points(&self, grid: &Grid<D>, level: usize, points: &[Inside<D>]) -> Vec<usize> {
        let shifts: Vec<Vec<isize>> = (0..D).map(|component| grid.frame_shifts(component, self.since(level))).collect();
        let followed = |inside: &Inside<D>| {
            let Point { component, mut index, .. } = inside.point;
            index[0] -= shifts[component][index[1].rem_euclid(grid.cells()[1] as isize) as usize];
            unknown(grid, component, index).0
        };
        points.iter().map(followed).collect()
    }

    /// What a velocity and its convection of a level weigh.
    fn factors(&self, level: usize) -> [f64; 2] {
        let rate = self.weights.rate.get(level + 1).copied().unwrap_or(0.0);
        [rate, self.convection[level]].map(|weight| -weight * self.inverse_diffusivity)
    }

    /// Makes rows inside bodies those of rigid motions, and takes from the known flow what it differs from them by there.
    fn replace_inside(
        &self,
        grid: &Grid<D>,
        types: &BodyTypes<D>,
        centers: &[SVector<f64, D>],
        [rows, known]: [&mut Vector; 2],
    ) -> Result<()> {
        let points = inside(grid, types, centers, self.levels[0].0.time + self.weights.step);
        let places: Vec<usize> = points.iter().map(|inside| inside.point.place).collect();
        let mut scatter = Scatter::new(rows, &places)?;
        let mut wanted: Vec<f64> = scatter.fetch(rows)?.iter().map(|row| -row).collect();
        let (mut deviations, mut removed) = (vec![0.0; points.len()], vec![0.0; points.len()]);
        for (level, (at, extended)) in self.levels.iter().enumerate() {
            let [history, convection] = self.factors(level);
            let mut followed;
            let scatter = if grid.domain().slide().is_some() {
                followed = Scatter::new(rows, &self.followed_points(grid, level, &points))?;
                &mut followed
            } else {
                &mut scatter
            };
            let carried = scatter.fetch(extended.inside())?;
            wanted.iter_mut().zip(carried).for_each(|(wanted, carried)| *wanted += convection * carried);
            if history != 0.0 {
                let of_level = at.deviations(types, &points, scatter.fetch(&at.fluid)?);
                wanted.iter_mut().zip(&points).for_each(|(wanted, point)| *wanted += history * at.rigid(point));
                deviations.iter_mut().zip(&of_level).for_each(|(deviation, of_level)| *deviation += history * of_level);
                removed.iter_mut().zip(&of_level).for_each(|(removed, of_level)| *removed -= self.viscous[level] * of_level);
            }
        }
        self.draw(&points, &deviations, &mut wanted);
        scatter.places().copy_from_slice(&wanted);
        scatter.add_back(rows)?;
        scatter.places().copy_from_slice(&removed);
        scatter.add_back(known)
    }

    /// Adds what is kept of deviations: all of the rigid motion of each body that is nearest to them, of its spin as much as of the layer is resolved, and part of the rest.
    fn draw(&self, points: &[Inside<D>], deviations: &[f64], wanted: &mut [f64]) {
        let mut first = 0;
        for of_body in points.chunk_by(|one, other| one.body == other.body) {
            let range = first..first + of_body.len();
            let deviations = &deviations[range.clone()];
            let rigid = nearest_rigid(of_body, deviations, self.levels[0].0.resolved);
            let kept = rigid.iter().zip(deviations).map(|(rigid, deviation)| rigid + self.kept * (deviation - rigid));
            wanted[range.clone()].iter_mut().zip(kept).for_each(|(wanted, kept)| *wanted += kept);
            first = range.end;
        }
    }
}

impl<const D: usize> Level<D> {
    /// Where a point inside a body was, seen from the centre that the body had: the point goes along with its frame.
    fn offset(&self, inside: &Inside<D>) -> SVector<f64, D> {
        inside.point.offset + inside.center - self.centers[inside.body] - inside.point.frame * (inside.time - self.time)
    }

    /// The rigid motion of the body there, in a sheared box less the shear.
    fn rigid(&self, inside: &Inside<D>) -> f64 {
        (self.twists[inside.body].at(&self.offset(inside)) - inside.point.shear)[inside.point.component]
    }

    /// What the fields inside bodies, extended to points that were outside, differ from their motions by.
    fn deviations(&self, body_types: &BodyTypes<D>, points: &[Inside<D>], velocities: &[f64]) -> Vec<f64> {
        let mut deviations: Vec<f64> = points.iter().zip(velocities).map(|(inside, velocity)| velocity - self.rigid(inside)).collect();
        let mut first = 0;
        for group in points.chunk_by(Inside::alike) {
            let (body, component) = (group[0].body, group[0].point.component);
            let radius = body_types.surface(body).modes.radius();
            let offsets = (first..).zip(group.iter().map(|inside| self.offset(inside)));
            let (places, offsets): (Vec<usize>, Vec<SVector<f64, D>>) = offsets.filter(|(_, offset)| offset.norm() > radius).unzip();
            let offsets: Vec<f64> = offsets.iter().flat_map(|offset| offset.iter().copied()).collect();
            let jumps = self.jumps_at(body_types, body, &offsets, component);
            places.iter().zip(jumps).for_each(|(place, jump)| deviations[*place] -= jump);
            first += group.len();
        }
        deviations
    }
}

/// Where the velocity at an index that no wall bounds is in fluid vectors, and how many follow it there and along the last axis.
fn unknown<const D: usize>(grid: &Grid<D>, component: usize, index: Index<D>) -> (usize, usize) {
    match grid.fluid_run(component, index) {
        (Node::Unknown(unknown), follow) => (unknown, follow),
        (Node::Wall(_), _) => unreachable!("a sheared box has no walls"),
    }
}
