//! The blocks of the `sharp` method, applied body by body.

use std::rc::Rc;

use nalgebra::{DMatrixView, DMatrixViewMut, SMatrix, SVector};

use super::{Neighbour, Placed, spread::OnWall};
use crate::{
    constraint::{
        Layout,
        dense::LocalBlock,
        interpolant::Interpolant,
        places::{Places, from},
        rows::Rows,
    },
    error::Result,
    linalg::dot,
    petsc::{Scatter, Session, Vector},
    surface::SurfaceTable,
};

/// Most surfaces of one kind that are projected on their modes together.
const TOGETHER: usize = 16;

/// What one body adds: dense in its multipliers, on the lattice points near its surface.
pub struct BodyBlocks<const D: usize> {
    /// Its surface.
    pub surface: Rc<SurfaceTable<D>>,
    /// What they were assembled for.
    pub situation: Situation<D>,
    /// Rows of C.
    pub rows: Rows,
    /// What passes to walls.
    pub on_walls: Vec<OnWall>,
    /// J, before values at the points are projected on the modes.
    pub interpolant: Interpolant<D>,
    /// Dense blocks of E in the rows of this body.
    pub local: Vec<LocalBlock>,
}

/// Where a body and its neighbours were when its blocks were assembled; while nothing of it changes, the blocks hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Situation<const D: usize> {
    /// The body.
    pub body: usize,
    centers: Vec<(usize, SVector<f64, D>)>,
}

impl<const D: usize> Situation<D> {
    /// That of a body among its neighbours.
    pub fn of((body, placed): (usize, &Placed<D>), neighbours: &[Neighbour<D>]) -> Situation<D> {
        let own = std::iter::once((body, placed.center));
        Situation { body, centers: own.chain(neighbours.iter().map(|(other, image)| (*other, image.center))).collect() }
    }
}

/// The blocks of this rank's bodies.
pub struct SharpBlocks<const D: usize> {
    bodies: Vec<BodyBlocks<D>>,
    /// For each of them, the index of its first multiplier in this rank's part, and the places of the first multipliers of
    /// its blocks of E.
    multiplier_places: Vec<(usize, Vec<u32>)>,
    /// Entries of fluid vectors that interpolation takes from other ranks.
    sampled: Scatter,
    /// Entries of fluid vectors of other ranks to which rows of C belong.
    spread: Scatter,
    /// Multipliers of other ranks that E takes.
    multipliers: Scatter,
}

impl<const D: usize> SharpBlocks<D> {
    /// Joins the blocks of this rank's bodies; `fluid` is any fluid vector.
    pub fn new(session: &Session, fluid: &Vector, layout: &Layout, mut bodies: Vec<BodyBlocks<D>>) -> Result<SharpBlocks<D>> {
        let multipliers = Vector::new(session, layout.local_unknowns())?;
        let (mut sampled, mut spread, mut taken) = (Places::new(fluid)?, Places::new(fluid)?, Places::new(&multipliers)?);
        let mut multiplier_places = Vec::with_capacity(bodies.len());
        for body in &mut bodies {
            body.interpolant.plan(&mut sampled);
            body.rows.plan(&mut spread);
            let places = body.local.iter().map(|block| taken.of(layout.global(block.body), block.transposed.nrows()));
            multiplier_places.push((layout.local(body.situation.body), places.collect()));
        }
        let (sampled, spread, multipliers) = (sampled.scatter(fluid)?, spread.scatter(fluid)?, taken.scatter(&multipliers)?);
        Ok(SharpBlocks { bodies, multiplier_places, sampled, spread, multipliers })
    }

    /// The blocks of the bodies, one by one.
    pub fn into_bodies(self) -> Vec<BodyBlocks<D>> {
        self.bodies
    }

    /// Coefficients of a velocity, known at each offset from the centre, in the modes of one of the bodies.
    pub fn coefficients(&self, local: usize, known: impl Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        self.bodies[local].surface.coefficients(known)
    }

    /// First moment of what one of the bodies does to the fluid.
    pub fn first_moment(&self, local: usize, multipliers: &[f64]) -> SMatrix<f64, D, D> {
        self.bodies[local].surface.first_moment(multipliers)
    }

    /// What this rank's bodies exert directly on the lower and the upper wall across each axis, with its multipliers `c`.
    pub fn on_walls(&self, c: &[f64]) -> [[SVector<f64, D>; 2]; D] {
        let mut forces = [[SVector::zeros(); 2]; D];
        for (body, (first, _)) in self.bodies.iter().zip(&self.multiplier_places) {
            for OnWall { axis, upper, component, values } in &body.on_walls {
                forces[*axis][usize::from(*upper)][*component] += dot(values, &c[*first..][..values.len()]);
            }
        }
        forces
    }

    /// `rows += factor * C c`, with this rank's multipliers `c`.
    pub fn spread(&mut self, factor: f64, c: &[f64], rows: &mut Vector) -> Result<()> {
        {
            let (mut own, mut others, mut scratch) = (rows.local_mut()?, self.spread.places()?, Vec::new());
            for (body, (first, _)) in self.bodies.iter().zip(&self.multiplier_places) {
                body.rows.add(factor, &c[*first..][..body.surface.modes.count()], &mut scratch, &mut own, &mut others);
            }
        }
        self.spread.add_back(rows)
    }

    /// `out = J u`, this rank's multipliers, for the velocity of a fluid vector (zero on walls).
    pub fn sample(&mut self, fluid: &Vector, out: &mut [f64]) -> Result<()> {
        self.sample_bodies(fluid, false, out)
    }

    /// As [`sample`](Self::sample), for a velocity that is that of the moving walls there.
    pub fn sample_with_walls(&mut self, fluid: &Vector, out: &mut [f64]) -> Result<()> {
        self.sample_bodies(fluid, true, out)
    }

    fn sample_bodies(&mut self, fluid: &Vector, with_walls: bool, out: &mut [f64]) -> Result<()> {
        let (others, own) = (self.sampled.fetch(fluid)?, fluid.local()?);
        let (mut scratch, mut velocities) = (Vec::new(), Vec::new());
        let mut first = 0;
        for alike in self.bodies.chunk_by(|body, next| Rc::ptr_eq(&body.surface, &next.surface)) {
            for bodies in alike.chunks(TOGETHER) {
                let surface = &bodies[0].surface;
                let rows = surface.points() * D;
                velocities.resize(bodies.len() * rows, 0.0);
                for (body, velocities) in bodies.iter().zip(velocities.chunks_exact_mut(rows)) {
                    body.interpolant.apply(&own, &others, &mut scratch, velocities);
                    if with_walls {
                        velocities.iter_mut().zip(&body.interpolant.wall_values).for_each(|(value, wall)| *value += wall);
                    }
                }
                let count = surface.modes.count();
                DMatrixViewMut::from_slice(&mut out[first..][..bodies.len() * count], count, bodies.len()).gemm(
                    1.0,
                    surface.projector(),
                    &DMatrixView::from_slice(&velocities, rows, bodies.len()),
                    0.0,
                );
                first += bodies.len() * count;
            }
        }
        Ok(())
    }

    /// `out += E c`.
    pub fn add_local(&mut self, c: &Vector, out: &mut Vector) -> Result<()> {
        let (others, own, mut out) = (self.multipliers.fetch(c)?, c.local()?, out.local_mut()?);
        for (body, (first, places)) in self.bodies.iter().zip(&self.multiplier_places) {
            let out = &mut out[*first..][..body.surface.modes.count()];
            for (LocalBlock { transposed, .. }, place) in body.local.iter().zip(places) {
                let modes = transposed.nrows();
                let c = &from(&own, &others, *place)[..modes];
                out.iter_mut().zip(transposed.as_slice().chunks_exact(modes)).for_each(|(out, row)| *out += dot(row, c));
            }
        }
        Ok(())
    }
}
