//! The convection of a level: what rows outside bodies take of it, and what rows inside.
//!
//! The field `u` on the grid is convected in flux form, across surfaces too, so that what one row loses another one gains: convection adds up to nothing,
//! and the force by tractions is the balance of momentum of the grid. Beside a surface at rest that is all: `u` vanishes there, and what its kink errs by in a
//! strip of a cell is of second order. A surface that moves carries its kink along. With the rigid motion `R`, `w = u - R`, the jump `D` by tangential tractions, `N(u) = B(u, u)`
//! and the bilinear flux form `B`:
//!
//! ```text
//! outside   N(u) + theta [B(R, D) + B(D, R)],    B(R, D) + B(D, R) = [N(R + D) - N(R - D)] / 2
//! inside    (1 - theta) N(u) + theta [N(R) + N(w)],    N(R) + N(w) = [N(u) + N(2 R - u)] / 2
//! ```
//!
//! What is linear in `w` sees the jump; what is quadratic does not need it. At the start of a run the layers on surfaces are thinner than a cell. Rows of their own on either side of
//! them are biased sideways then, and `theta` is zero; it goes to one as layers grow.

use nalgebra::SVector;

use crate::{
    error::Result,
    flow::{Convection, fastest},
    grid::Grid,
    parallel::World,
    petsc::{Scatter, Vector},
    system::{
        Level,
        level::{Band, Extended, Near},
    },
};

/// Largest jump of what is convected, over the largest speed of the flow. Behind a boundary layer thinner than a cell jump functions go on with its slope to
/// speeds that are nowhere in the flow.
const LARGEST_JUMP: f64 = 1.0;

/// Rates at which layers that began with a run grow across a cell, over those of viscosity and of the flow across it.
const GROWTH: [f64; 2] = [0.5, 0.25];

/// Distances from a surface, in cells, between which the slip that a layer bridges is measured.
const OUTSIDE_LAYER: [f64; 2] = [1.5, 3.0];

/// What remains after a step of the part of layers that is thinner than a cell.
pub fn young<const D: usize>(grid: &Grid<D>, step: f64, inverse_diffusivity: f64, fastest: f64) -> f64 {
    let spacing = grid.spacing().max();
    (-step * (GROWTH[0] / (inverse_diffusivity * spacing * spacing) + GROWTH[1] * fastest / spacing)).exp()
}

impl<const D: usize> Level<D> {
    /// The flow extended into bodies with their jumps, and its convection on the grid of that time. Collective.
    pub fn extended(&self, band: Option<&Band>, convection: &mut Convection<D>) -> Result<Extended<D>> {
        let mut carried = self.fluid.like()?;
        convection.evaluate(&self.fluid, &mut carried)?;
        let sums = [sums(convection.grid(), &self.fluid)?, sums(convection.grid(), &carried)?];
        let Some(band) = band else {
            return Ok(Extended { velocity: self.fluid.copied()?, convection: carried, inside: None, sums });
        };
        let mut scatter = Scatter::new(&self.fluid, &band.places)?;
        let velocity = self.with_jumps(&mut scatter, &band.whole)?;
        if !self.moves() {
            return Ok(Extended { velocity, convection: carried, inside: None, sums });
        }
        let inside = self.inside(&band.near, &carried, convection)?;
        self.add_linear(band, &mut scatter, convection, &mut carried)?;
        Ok(Extended { velocity, convection: carried, inside: Some(inside), sums })
    }

    /// Whether any body does.
    fn moves(&self) -> bool {
        self.twists.iter().any(|twist| twist.velocity.norm() > 0.0 || twist.spin.norm() > 0.0)
    }

    /// The convection of rows inside, where that of the field on the grid is known. Collective.
    fn inside(&self, near: &[Near], of_field: &Vector, convection: &mut Convection<D>) -> Result<Vector> {
        let (mut mirrored, mut inside) = (self.fluid.copied()?, of_field.like()?);
        let mut values = mirrored.local_mut()?;
        near.iter().for_each(|near| values[near.place] = 2.0 * near.rigid - values[near.place]);
        drop(values);
        convection.evaluate(&mirrored, &mut inside)?;
        mirrored.copy_from(of_field)?;
        let (mut rows, other) = (mirrored.local_mut()?, inside.local()?);
        for &Near { place, .. } in near {
            rows[place] += 0.5 * self.resolved * (other[place] - rows[place]);
        }
        drop((rows, other));
        Ok(mirrored)
    }

    /// Adds what is linear in the jumps to the convection of rows outside. Collective.
    fn add_linear(&self, band: &Band, scatter: &mut Scatter, convection: &mut Convection<D>, carried: &mut Vector) -> Result<()> {
        let largest = LARGEST_JUMP * fastest(convection.grid(), &self.fluid)?;
        for (place, jump) in scatter.places().iter_mut().zip(&band.tangential) {
            *place = self.resolved * jump.clamp(-largest, largest);
        }
        let mut rigid = self.fluid.like()?;
        let mut values = rigid.local_mut()?;
        band.near.iter().for_each(|near| values[near.place] = near.rigid);
        drop(values);
        let mut other = self.fluid.like()?;
        scatter.add_back(&mut other)?;
        other.scale(-2.0)?;
        scatter.add_back(&mut rigid)?;
        let mut rows = self.fluid.like()?;
        convection.evaluate(&rigid, &mut rows)?;
        carried.add(0.5, &rows)?;
        rigid.add(1.0, &other)?;
        convection.evaluate(&rigid, &mut rows)?;
        carried.add(-0.5, &rows)
    }

    /// Thickness of the layer of fluid that each body carries along, in cells: the slip it bridges over the slope at the surface. Zero before anything is known, infinite
    /// where bodies are closer to each other than the layer is measured. Collective.
    pub fn layers(&self, world: &World, band: &Band, grid: &Grid<D>) -> Result<Vec<f64>> {
        let (spacing, values) = (grid.spacing().max(), self.fluid.local()?);
        // squares of slips and their number, by body and component
        let mut slips = vec![0.0; 2 * D * self.centers.len()];
        for near in &band.near {
            if (OUTSIDE_LAYER[0] * spacing..OUTSIDE_LAYER[1] * spacing).contains(&near.gap) {
                let first = 2 * (D * near.body + near.component);
                slips[first] += (values[near.place] - near.rigid).powi(2);
                slips[first + 1] += 1.0;
            }
        }
        world.sum(&mut slips);
        let mut slopes = band.slopes.clone();
        world.sum(&mut slopes);
        let sum = |terms: &[f64]| terms.chunks_exact(2).map(|term| term[0] / term[1].max(1.0)).sum::<f64>();
        let of_body = |(slips, slopes): (&[f64], &[f64])| {
            let (slip, slope) = (sum(slips).sqrt(), sum(slopes).sqrt());
            let measured = slips.iter().skip(1).step_by(2).all(|count| *count > 0.0);
            match slope > 0.0 {
                true if measured => slip / (slope * spacing),
                true => f64::INFINITY,
                false => 0.0,
            }
        };
        Ok(slips.chunks_exact(2 * D).zip(slopes.chunks_exact(2 * D)).map(of_body).collect())
    }
}

/// Sums of the components of a velocity over the grid. Collective.
pub fn sums<const D: usize>(grid: &Grid<D>, velocity: &Vector) -> Result<SVector<f64, D>> {
    let values = velocity.local()?;
    let mut sums = SVector::<f64, D>::from_fn(|axis, _| values[grid.local_range(axis)].iter().sum());
    velocity.session().world().sum(sums.as_mut_slice());
    Ok(sums)
}
