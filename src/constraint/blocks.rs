//! The blocks of the linear system that bodies contribute, applied body by body.

use std::rc::Rc;

use nalgebra::DMatrix;

use crate::{
    constraint::Layout,
    error::Result,
    petsc::{Matrix, RowBuilder, Scatter, Session, Vector},
    surface::SurfaceTable,
};

/// What one body adds: dense in its multipliers, on the lattice points near its surface.
pub struct BodyBlocks<const D: usize> {
    /// Its surface.
    pub surface: Rc<SurfaceTable<D>>,
    /// Index of its first multiplier in this rank's part.
    pub first: usize,
    /// Indices, in fluid vectors, of the lattice points it touches.
    pub places: Vec<i32>,
    /// Rows of C: for each, the place, then one value a multiplier in `spread_values`.
    pub spread_rows: Vec<u32>,
    /// Values of C, multipliers running fastest.
    pub spread_values: Vec<f64>,
    /// Interpolation at the surface points: for each component of each point, where its terms end in `sample_terms`.
    pub sample_ends: Vec<u32>,
    /// Terms of the interpolation: place and weight.
    pub sample_terms: Vec<(u32, f64)>,
    /// Interpolated values that come from moving walls, one for each component of each point.
    pub wall_values: Vec<f64>,
    /// Dense blocks of E in the rows of this body: first multiplier, on all ranks, of the body whose columns it has.
    pub local: Vec<(usize, DMatrix<f64>)>,
}

/// The blocks of all bodies.
pub struct Blocks<const D: usize> {
    bodies: Vec<BodyBlocks<D>>,
    scatter: Scatter,
    local: Matrix,
}

impl<const D: usize> Blocks<D> {
    /// Joins the blocks of this rank's bodies; `fluid` is any fluid vector.
    pub fn new(session: &Session, fluid: &Vector, layout: &Layout, mut bodies: Vec<BodyBlocks<D>>) -> Result<Blocks<D>> {
        let mut rows = RowBuilder::default();
        for body in &mut bodies {
            let blocks = std::mem::take(&mut body.local);
            for row in 0..body.surface.modes.count() {
                for (first, block) in &blocks {
                    block.row(row).iter().enumerate().for_each(|(column, &value)| rows.push(first + column, value));
                }
                rows.end_row();
            }
        }
        let wanted: Vec<i32> = bodies.iter().flat_map(|body| body.places.iter().copied()).collect();
        let scatter = Scatter::new(fluid, &wanted)?;
        let local = Matrix::from_rows(session, layout.local_unknowns(), rows)?;
        Ok(Blocks { bodies, scatter, local })
    }

    /// `rows += factor * C c`, with this rank's multipliers `c`.
    pub fn spread(&mut self, factor: f64, c: &[f64], rows: &mut Vector) -> Result<()> {
        {
            let mut places = self.scatter.places()?;
            let mut rest = &mut places[..];
            for body in &self.bodies {
                let (mine, others) = rest.split_at_mut(body.places.len());
                body.spread(factor, c, mine);
                rest = others;
            }
        }
        self.scatter.add_back(rows)
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
        let values = self.scatter.fetch(fluid)?;
        let mut rest = &values[..];
        for body in &self.bodies {
            let (mine, others) = rest.split_at(body.places.len());
            body.sample(mine, with_walls.then_some(&body.wall_values), out);
            rest = others;
        }
        Ok(())
    }

    /// `out += E c`.
    pub fn add_local(&self, c: &Vector, out: &mut Vector) -> Result<()> {
        self.local.multiply_add(c, out)
    }
}

impl<const D: usize> BodyBlocks<D> {
    fn spread(&self, factor: f64, c: &[f64], places: &mut [f64]) {
        let count = self.surface.modes.count();
        let c = &c[self.first..][..count];
        for (place, values) in self.spread_rows.iter().zip(self.spread_values.chunks_exact(count)) {
            places[*place as usize] += factor * values.iter().zip(c).map(|(value, c)| value * c).sum::<f64>();
        }
    }

    fn sample(&self, places: &[f64], walls: Option<&Vec<f64>>, out: &mut [f64]) {
        let mut begin = 0;
        let interpolated = self.sample_ends.iter().enumerate().map(|(row, &end)| {
            let terms = &self.sample_terms[std::mem::replace(&mut begin, end as usize)..end as usize];
            terms.iter().map(|&(place, weight)| weight * places[place as usize]).sum::<f64>() + walls.map_or(0.0, |walls| walls[row])
        });
        let interpolated: Vec<f64> = interpolated.collect();
        let out = &mut out[self.first..][..self.surface.modes.count()];
        out.fill(0.0);
        self.surface.project(&interpolated, out);
    }
}
