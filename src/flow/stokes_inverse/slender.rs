//! The flow along a slender box, solved apart.
//!
//! A pressure `P(x)` that varies along a channel of height H alone drives a mean velocity `-P' H^2/12`, and no more: for waves of length
//! l the Schur complement of the pressure is `(2 pi H / l)^2 / 12`, which the projection form takes for one. So a box takes iterations in
//! proportion to its aspect. These flows, one mean velocity and one pressure at each station,
//!
//! ```text
//! u = U(x) s(y, z) e_x,  p = P(x):     U' = <r_p>,     P' = (<w r_u> - U + <w s> U'') / k
//! ```
//!
//! with the profile s of a uniform gradient, its permeability k and the weights w of a force in the mean velocity, are sums along the box. What
//! they leave is local, and for the inverse that is refined.

use std::ops::Range;

use super::{Stokes, StokesInverse, cross_section::CrossSection, projection::ProjectionInverse};
use crate::{error::Result, grid::Grid, parallel::World, petsc::Vector};

/// Schur complement of the longest wave along a box, below which the flow along it is solved apart.
const SLENDER: f64 = 0.25;

/// The projection form refined for slender boxes: it gets what the flow along the box leaves.
pub struct SlenderInverse {
    along: FlowAlong,
    local: ProjectionInverse,
    left: Vector,
    flow: Vector,
}

impl SlenderInverse {
    /// Refines an inverse.
    pub fn new<const D: usize>(stokes: &Stokes<D>, along: FlowAlong, local: ProjectionInverse) -> Result<Self> {
        Ok(SlenderInverse { along, local, left: stokes.vector()?, flow: stokes.vector()? })
    }
}

impl<const D: usize> StokesInverse<D> for SlenderInverse {
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()> {
        self.along.solve(stokes.session().world(), rows, &mut self.flow)?;
        stokes.multiply(&self.flow, &mut self.left)?;
        stokes.balance(&mut self.left)?;
        self.left.scale(-1.0)?;
        self.left.add(1.0, rows)?;
        self.local.precondition(stokes, &self.left, output)?;
        output.add(1.0, &self.flow)
    }
}

/// The flow along the longest axis of a box.
pub struct FlowAlong {
    section: CrossSection,
    inertia: f64,
    stations: usize,
    spacing: f64,
    periodic: bool,
    /// Where this rank's velocities along the axis and its pressures lie in a fluid vector, what balances their rows, and for each of
    /// them its station and its point in the cross-section.
    velocities: Places,
    pressures: Places,
}

/// Unknowns of a field on this rank.
struct Places {
    range: Range<usize>,
    factor: f64,
    places: Vec<(usize, usize)>,
}

impl FlowAlong {
    /// That of a box, if it is slender and walls hold the flow along it.
    pub fn of<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>) -> Option<FlowAlong> {
        let axis = grid.domain().size.imax();
        let periodic = grid.domain().periodic(axis);
        let section = CrossSection::new(grid, axis, stokes.shift())?;
        let waves = if periodic { 2.0 } else { 1.0 };
        let wave_number = waves * std::f64::consts::PI / grid.domain().size[axis];
        let places = |field: usize| Places::new(stokes, grid, field, axis);
        (wave_number.powi(2) * section.permeability < SLENDER).then(|| FlowAlong {
            inertia: section.inertia(),
            section,
            stations: grid.cells()[axis],
            spacing: grid.spacing()[axis],
            periodic,
            velocities: places(axis),
            pressures: places(D),
        })
    }

    /// The flow for balanced rows.
    fn solve(&self, world: &World, rows: &Vector, flow: &mut Vector) -> Result<()> {
        let (forces, sources) = self.means(world, &rows.local()?);
        let velocity = self.velocity(&forces, &sources);
        let pressure = self.pressure(&forces, &velocity);
        flow.fill(0.0)?;
        let mut values = flow.local_mut()?;
        for (value, &(station, point)) in values[self.velocities.range.clone()].iter_mut().zip(&self.velocities.places) {
            *value = velocity[station] * self.section.profile[point];
        }
        for (value, &(station, _)) in values[self.pressures.range.clone()].iter_mut().zip(&self.pressures.places) {
            *value = pressure[station];
        }
        Ok(())
    }

    /// Means of weighed momentum rows and of continuity rows over the cross-section at every station.
    fn means(&self, world: &World, rows: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut sums = vec![0.0; 2 * self.stations];
        for (row, &(station, point)) in rows[self.velocities.range.clone()].iter().zip(&self.velocities.places) {
            sums[station] += row * self.section.weights[point] / self.velocities.factor;
        }
        for (row, &(station, _)) in rows[self.pressures.range.clone()].iter().zip(&self.pressures.places) {
            sums[self.stations + station] += row / self.pressures.factor;
        }
        world.sum(&mut sums);
        sums.iter_mut().for_each(|sum| *sum /= self.section.weights.len() as f64);
        let sources = sums.split_off(self.stations);
        (sums, sources)
    }

    /// The mean velocity at the faces, from what continuity asks for; a periodic box has a constant one besides, which forces drive.
    fn velocity(&self, forces: &[f64], sources: &[f64]) -> Vec<f64> {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / self.stations as f64;
        let (mut velocity, surplus) = (vec![0.0; self.stations], mean(sources));
        for station in 1..self.stations {
            velocity[station] = velocity[station - 1] + self.spacing * (sources[station - 1] - surplus);
        }
        if self.periodic {
            let constant = mean(forces) - mean(&velocity);
            velocity.iter_mut().for_each(|velocity| *velocity += constant);
        }
        velocity
    }

    /// The pressure in the cells, without its mean.
    fn pressure(&self, forces: &[f64], velocity: &[f64]) -> Vec<f64> {
        let count = self.stations;
        let mut pressure = vec![0.0; count];
        for face in 1..count {
            // beyond the last face a closed box has a wall, as it has at the first
            let bend = velocity[face - 1] - 2.0 * velocity[face] + velocity[(face + 1) % count];
            let drag = velocity[face] - self.inertia * bend / self.spacing.powi(2);
            pressure[face] = pressure[face - 1] + self.spacing * (forces[face] - drag) / self.section.permeability;
        }
        let mean = pressure.iter().sum::<f64>() / count as f64;
        pressure.iter_mut().for_each(|pressure| *pressure -= mean);
        pressure
    }
}

impl Places {
    fn new<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>, field: usize, axis: usize) -> Places {
        let place = |index: [usize; D]| (index[axis], CrossSection::point(grid, axis, &index));
        let (range, factor) = stokes.balanced_fields().swap_remove(field);
        Places { range, factor, places: grid.block(field).indices().map(place).collect() }
    }
}
