//! The blocks of the linear system that bodies contribute, whatever the method.

use std::{collections::HashMap, ops::Range, rc::Rc};

use nalgebra::{DMatrixView, DMatrixViewMut, SMatrix, SVector};

use super::{
    body::{BodyBlocks, BodyRows, FreeInverse, InteriorBlocks, Plans, WallForces, Walls},
    layout::MultiplierLayout,
    method::FlowMethod,
    placed::{Neighbour, Placed, Situation, Surrounded},
    places::{Entries, EntriesMut, Places},
};
use crate::{
    body::planes,
    error::Result,
    grid::Grid,
    petsc::{Scatter, Session, Vector},
};

/// Most surfaces of one kind that are projected on their modes together.
const TOGETHER: usize = 16;

/// The blocks of this rank's bodies, which are counted in the order of the layout.
pub struct Blocks<const D: usize> {
    bodies: Vec<Box<dyn BodyBlocks<D>>>,
    /// Where each of them was; empty if none is kept for another assembly.
    situations: Vec<Situation<D>>,
    /// For each of them, its multipliers in this rank's part.
    ranges: Vec<Range<usize>>,
    /// Entries of vectors of the grid that are taken from other ranks.
    read: Scatter,
    /// Entries of vectors of the grid of other ranks to which rows of C belong.
    spread: Scatter,
    /// Multipliers of other ranks that E takes.
    multipliers: Scatter,
}

/// The blocks of this rank's bodies and their numbering.
pub struct Assembled<const D: usize> {
    /// Who holds which multipliers.
    pub layout: MultiplierLayout,
    /// The blocks.
    pub blocks: Blocks<D>,
    /// Number of bodies whose blocks are new.
    pub new: usize,
}

impl<const D: usize> Assembled<D> {
    /// The blocks of all that a method makes rigid; bodies that did not move, nor their neighbours, keep those of an earlier assembly.
    /// `shape` is any vector of the grid's unknowns. Collective.
    pub fn new(
        grid: &Grid<D>,
        shape: &Vector,
        method: &FlowMethod<D>,
        bodies: &[Surrounded<D>],
        earlier: Option<Blocks<D>>,
    ) -> Result<Assembled<D>> {
        let session = shape.session();
        let rank = session.world().rank();
        let own: Vec<Surrounded<D>> = bodies.iter().filter(|body| grid.owner(&body.placed.center) == rank).copied().collect();
        let situations: Vec<Situation<D>> = own.iter().map(Situation::of).collect();
        let (mut kept, mut memory) = (HashMap::new(), Vec::new());
        for (blocks, situation) in earlier.into_iter().flat_map(|earlier| earlier.bodies.into_iter().zip(earlier.situations)) {
            if situations.binary_search_by_key(&situation.body, |own| own.body).is_ok_and(|found| situations[found] == situation) {
                kept.insert(situation.body, blocks);
            } else {
                memory.extend(blocks.into_memory());
            }
        }
        let moved: Vec<Surrounded<D>> = own.iter().filter(|body| !kept.contains_key(&body.body)).copied().collect();
        let mut assembled = method.assemble(grid, &moved, memory).into_iter();
        let blocks: Vec<_> = own.iter().filter_map(|body| kept.remove(&body.body).or_else(|| assembled.next())).collect();
        let counts = match method.on_surfaces() {
            true => bodies.iter().map(|body| body.placed.surface.modes.count()).collect(),
            false => {
                let counts = own.iter().zip(&blocks).flat_map(|(body, blocks)| [body.body as f64, blocks.count() as f64]);
                let mut all = vec![0; bodies.len()];
                let found = session.world().gather(&counts.collect::<Vec<f64>>());
                found.chunks(2).for_each(|found| all[found[0] as usize] = found[1] as usize);
                all
            }
        };
        let layout = MultiplierLayout::new(grid, &bodies.iter().map(|body| body.placed.center).collect::<Vec<_>>(), &counts, rank);
        let blocks = Blocks { situations, ..Blocks::new(session, shape, &layout, blocks)? };
        Ok(Assembled { layout, blocks, new: moved.len() })
    }
}

/// Bodies in their places, each among its neighbours.
pub fn surrounded<'a, const D: usize>(placed: &'a [Placed<D>], neighbours: &'a [Vec<Neighbour<D>>]) -> Vec<Surrounded<'a, D>> {
    placed.iter().zip(neighbours).enumerate().map(|(body, (placed, neighbours))| Surrounded { body, placed, neighbours }).collect()
}

/// Where the multipliers of rotations are among those of a body.
pub fn rotations<const D: usize>() -> Range<usize> {
    D..D + planes::<D>().len()
}

impl<const D: usize> Blocks<D> {
    /// Joins the blocks of this rank's bodies, in the order of the layout; `shape` is any vector of the grid's unknowns.
    pub fn new(session: &Session, shape: &Vector, layout: &MultiplierLayout, mut bodies: Vec<Box<dyn BodyBlocks<D>>>) -> Result<Blocks<D>> {
        let multipliers = Vector::new(session, layout.local_unknowns())?;
        let mut plans = Plans { read: Places::new(shape)?, spread: Places::new(shape)?, multipliers: Places::new(&multipliers)? };
        bodies.iter_mut().for_each(|body| body.plan(layout, &mut plans));
        let ranges = layout.local_bodies.iter().map(|&body| layout.local(body)..layout.local(body) + layout.count(body)).collect();
        let (read, spread) = (plans.read.scatter(shape)?, plans.spread.scatter(shape)?);
        Ok(Blocks { bodies, situations: Vec::new(), ranges, read, spread, multipliers: plans.multipliers.scatter(&multipliers)? })
    }

    /// Each of this rank's bodies with its multipliers in this rank's part.
    pub fn each(&self) -> impl Iterator<Item = (&dyn BodyBlocks<D>, Range<usize>)> {
        self.bodies.iter().map(Box::as_ref).zip(self.ranges.iter().cloned())
    }

    /// `rows += factor * C c`, with this rank's multipliers `c`.
    pub fn spread(&mut self, factor: f64, c: &[f64], rows: &mut Vector) -> Result<()> {
        {
            let (mut own, others, mut scratch) = (rows.local_mut()?, self.spread.places(), Vec::new());
            let mut rows = EntriesMut { own: &mut own, others };
            for (body, range) in self.bodies.iter().zip(&self.ranges) {
                body.spread(factor, &c[range.clone()], &mut scratch, &mut rows);
            }
        }
        self.spread.add_back(rows)
    }

    /// `out = J u`, this rank's multipliers, for a vector of the grid's unknowns that are zero on walls.
    pub fn interpolate(&mut self, u: &Vector, out: &mut [f64]) -> Result<()> {
        interpolate(&self.bodies, &mut self.read, u, Walls::Still, None, out)
    }

    /// As [`interpolate`](Self::interpolate), for a velocity that is that of the moving walls there.
    pub fn interpolate_with_walls(&mut self, u: &Vector, out: &mut [f64]) -> Result<()> {
        interpolate(&self.bodies, &mut self.read, u, Walls::Moving, None, out)
    }

    /// `out = J u + E c`, this rank's multipliers, for a vector of the grid's unknowns that are zero on walls.
    pub fn velocity(&mut self, u: &Vector, c: &Vector, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.multipliers.fetch(c)?, c.local()?);
        let all = Entries { own: &own, others };
        interpolate(&self.bodies, &mut self.read, u, Walls::Still, Some(all), out)?;
        for (body, range) in self.bodies.iter().zip(&self.ranges) {
            body.add_local(&own[range.clone()], all, &mut out[range.clone()]);
        }
        Ok(())
    }

    /// `out += E c`, for bodies all of whose blocks are projected on their modes.
    pub fn add_local(&mut self, c: &Vector, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.multipliers.fetch(c)?, c.local()?);
        let all = Entries { own: &own, others };
        for (body, range) in self.bodies.iter().zip(&self.ranges) {
            body.add_local(&own[range.clone()], all, &mut out[range.clone()]);
        }
        Ok(())
    }

    /// Turns multipliers of rotations into the spin-ups that they give; others are as they were.
    pub fn spin_up(&self, multipliers: &mut [f64]) {
        for (body, range) in self.bodies.iter().zip(&self.ranges) {
            let of_rotation = body.interior().map_or(0.0, InteriorBlocks::spin_up_of_rotation);
            multipliers[range.clone()][rotations::<D>()].iter_mut().for_each(|value| *value *= of_rotation);
        }
    }

    /// `rows += factor *` what spin-ups of bodies, in the places of multipliers of rotations, add to them.
    pub fn spread_spin_up(&mut self, factor: f64, spin_ups: &[f64], rows: &mut Vector) -> Result<()> {
        {
            let (mut own, others) = (rows.local_mut()?, self.spread.places());
            let mut rows = EntriesMut { own: &mut own, others };
            for (body, range) in self.bodies.iter().zip(&self.ranges) {
                if let Some(interior) = body.interior() {
                    interior.spread_spin_up(factor, &spin_ups[range.clone()][rotations::<D>()], &mut rows);
                }
            }
        }
        self.spread.add_back(rows)
    }

    /// `out +=` what spin-ups of bodies, in the places of multipliers of rotations, add to the velocities on surfaces.
    pub fn add_spin_up(&mut self, spin_ups: &Vector, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.multipliers.fetch(spin_ups)?, spin_ups.local()?);
        let all = Entries { own: &own, others };
        for (body, range) in self.bodies.iter().zip(&self.ranges) {
            if let Some(interior) = body.interior() {
                interior.add_spin_up(all, &mut out[range.clone()]);
            }
        }
        Ok(())
    }

    /// What the rows of one of the bodies make of a velocity known at each offset from its centre.
    pub fn coefficients(&self, local: usize, known: impl Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        self.bodies[local].coefficients(&known)
    }

    /// First moment `integral of F_i r_j` of what one of the bodies does to the fluid.
    pub fn first_moment(&self, local: usize, multipliers: &[f64]) -> SMatrix<f64, D, D> {
        self.bodies[local].first_moment(multipliers)
    }

    /// What this rank's bodies exert on the lower and the upper wall across each axis besides what the rows beside it have.
    pub fn on_walls(&self, c: &[f64]) -> WallForces<D> {
        let mut forces = [[SVector::zeros(); 2]; D];
        self.each().for_each(|(body, range)| body.add_on_walls(&c[range], &mut forces));
        forces
    }

    /// Approximate inverse of the diagonal block of one of the bodies in the rows that are not rigid, unless its
    /// rows are those of surface modes.
    pub fn free_inverse(&self, local: usize) -> Option<Rc<dyn FreeInverse>> {
        match self.bodies[local].rows() {
            BodyRows::Surface(_) => None,
            BodyRows::Own(inverse) => inverse.cloned(),
        }
    }
}

/// `out = J u`, with what of `E c` is projected with it if multipliers are given, of bodies that read entries of vectors of the grid.
fn interpolate<const D: usize>(
    bodies: &[Box<dyn BodyBlocks<D>>],
    read: &mut Scatter,
    u: &Vector,
    walls: Walls,
    c: Option<Entries>,
    out: &mut [f64],
) -> Result<()> {
    let (others, own) = (read.fetch(u)?, u.local()?);
    let u = Entries { own: &own, others };
    let (mut scratch, mut values, mut first) = (Vec::new(), Vec::new(), 0);
    let same = |body: &dyn BodyBlocks<D>, next: &dyn BodyBlocks<D>| {
        body.rows().surface().zip(next.rows().surface()).is_some_and(|(one, other)| Rc::ptr_eq(one, other))
    };
    for alike in bodies.chunk_by(|body, next| same(body.as_ref(), next.as_ref())) {
        let Some(surface) = alike[0].rows().surface() else {
            let count = alike[0].count();
            alike[0].read(u, walls, &mut scratch, &mut out[first..][..count]);
            first += count;
            continue;
        };
        let (rows, count) = (surface.projector().ncols(), surface.modes.count());
        for bodies in alike.chunks(TOGETHER) {
            values.resize(bodies.len() * rows, 0.0);
            for (body, values) in bodies.iter().zip(values.chunks_exact_mut(rows)) {
                body.read(u, walls, &mut scratch, values);
                c.into_iter().for_each(|c| body.add_at_points(c, values));
            }
            let (values, out) = (DMatrixView::from_slice(&values, rows, bodies.len()), &mut out[first..][..bodies.len() * count]);
            DMatrixViewMut::from_slice(out, count, bodies.len()).gemm(1.0, surface.projector(), &values, 0.0);
            let interiors = bodies.iter().zip(out.chunks_exact_mut(count)).filter_map(|(body, out)| body.interior().zip(Some(out)));
            interiors.for_each(|(interior, out)| interior.read_inside(u, out));
            first += bodies.len() * count;
        }
    }
    Ok(())
}
