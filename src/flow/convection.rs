//! Convection on the staggered grid, `N = div (u u)`, in the form that conserves momentum and kinetic energy.
//!
//! Fluxes of a velocity component pass through the faces of the cells around its points, with means of two neighbours for both factors (Harlow and
//! Welch 1965, doi:10.1063/1.1761178): for a velocity without divergence `sum u . N = 0` to rounding. Nothing is convected through a wall; through open ends what
//! flows in and out is.

use nalgebra::SVector;

use super::OpenEnds;
use crate::{
    error::Result,
    grid::{Block, Grid, Index, Node},
    petsc::{Scatter, Vector},
};

/// The place of a value that is zero: on a wall, or beyond one.
const ZERO: u32 = u32::MAX;

/// Convection on the blocks of a grid.
pub struct Convection<const D: usize> {
    grid: Grid<D>,
    /// The cells of this rank and one layer around them.
    extent: [usize; D],
    /// For each component, where the value at each index of these cells is: among the own ones, or behind them among those fetched.
    places: Vec<Vec<u32>>,
    fetched: Scatter,
    /// Values on open ends and beyond them.
    ends: Vec<EndValue<D>>,
    /// Values of the components on these cells.
    values: Vec<Vec<f64>>,
}

/// A value on an open end, or one beyond it that makes the mean of two that of the end.
struct EndValue<const D: usize> {
    component: usize,
    /// Among the values of the component.
    place: usize,
    index: Index<D>,
    upper: bool,
    /// The place of the value on the other side.
    mirrored: Option<usize>,
}

impl<const D: usize> Convection<D> {
    /// That of a grid; `shape` is any fluid vector. Collective.
    ///
    /// # Errors
    /// PETSc has no memory for it.
    pub fn new(grid: &Grid<D>, shape: &Vector) -> Result<Convection<D>> {
        let own = shape.range()?;
        let cells = grid.partition().block(grid.rank());
        let extent: [usize; D] = std::array::from_fn(|axis| cells.end[axis] - cells.start[axis] + 2);
        let around = Block { start: [0; D], end: extent };
        let (mut wanted, mut places, mut ends) = (Vec::new(), Vec::new(), Vec::new());
        let open = OpenEnds::undisturbed(grid);
        let stride = |axis: usize| -> usize { extent[axis + 1..].iter().product() };
        for component in 0..D {
            let place = |(place, index): (usize, [usize; D])| {
                let index: [isize; D] = std::array::from_fn(|axis| (cells.start[axis] + index[axis]) as isize - 1);
                if let Some(open) = &open
                    && let Some(upper) = open.end(grid, component, &index)
                {
                    let step = stride(open.axis());
                    let mirrored = (component != open.axis()).then(|| if upper { place - step } else { place + step });
                    ends.push(EndValue { component, place, index, upper, mirrored });
                    return ZERO;
                }
                if !(0..D).all(|axis| grid.between_walls(component, axis, index[axis])) {
                    return ZERO;
                }
                match grid.fluid_node(component, index) {
                    Node::Wall(_) => ZERO,
                    Node::Unknown(unknown) if own.contains(&unknown) => (unknown - own.start) as u32,
                    Node::Unknown(unknown) => {
                        wanted.push(unknown);
                        (own.len() + wanted.len() - 1) as u32
                    }
                }
            };
            places.push(around.indices().enumerate().map(place).collect::<Vec<u32>>());
        }
        let values = vec![vec![0.0; around.len()]; D];
        Ok(Convection { grid: grid.clone(), extent, places, fetched: Scatter::new(shape, &wanted)?, ends, values })
    }

    /// Writes the convection of a velocity into the momentum rows of `out`; those of continuity are zero. Collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn evaluate(&mut self, velocity: &Vector, out: &mut Vector) -> Result<()> {
        self.fetch(velocity)?;
        if let Some(ends) = OpenEnds::of(&self.grid, velocity)? {
            self.fill_ends(&ends);
        }
        out.fill(0.0)?;
        let mut rows = out.local_mut()?;
        for component in 0..D {
            let first = self.grid.partition().block(self.grid.rank()).start;
            let rows = &mut rows[self.grid.local_range(component)];
            for (row, index) in rows.iter_mut().zip(self.grid.block(component).indices()) {
                *row = self.outflow(component, std::array::from_fn(|axis| index[axis] + 1 - first[axis]));
            }
        }
        Ok(())
    }

    fn fetch(&mut self, velocity: &Vector) -> Result<()> {
        let (others, own) = (self.fetched.fetch(velocity)?, velocity.local()?);
        for (places, values) in self.places.iter().zip(&mut self.values) {
            for (place, value) in places.iter().zip(values) {
                *value = match *place {
                    ZERO => 0.0,
                    place if (place as usize) < own.len() => own[place as usize],
                    place => others[place as usize - own.len()],
                };
            }
        }
        Ok(())
    }

    fn fill_ends(&mut self, ends: &OpenEnds<D>) {
        for EndValue { component, place, index, upper, mirrored } in &self.ends {
            let (at, values) = (ends.at(&self.grid, *upper, *component, *index), &mut self.values[*component]);
            values[*place] = mirrored.map_or(at, |mirrored| 2.0 * at - values[mirrored]);
        }
    }

    /// What flows out of the cell around a point, over its volume.
    #[inline]
    fn outflow(&self, component: usize, index: [usize; D]) -> f64 {
        let spacing: SVector<f64, D> = self.grid.spacing();
        let at = (0..D).fold(0, |place, axis| place * self.extent[axis] + index[axis]);
        let stride = |axis: usize| -> usize { self.extent[axis + 1..].iter().product() };
        let own = &self.values[component];
        let back = stride(component);
        let mut sum = 0.0;
        for axis in 0..D {
            let (step, carrier) = (stride(axis), &self.values[axis]);
            let flux = |lower: usize, upper: usize| {
                let carried = own[lower] + own[upper];
                // through the middle of a cell, or at its edge between two faces
                let through = if axis == component { carried } else { carrier[upper - back] + carrier[upper] };
                0.25 * through * carried
            };
            sum += (flux(at, at + step) - flux(at - step, at)) / spacing[axis];
        }
        sum
    }
}

/// Largest speed along an axis of a velocity, on all ranks.
///
/// # Errors
/// PETSc fails.
pub fn fastest<const D: usize>(grid: &Grid<D>, velocity: &Vector) -> Result<f64> {
    let values = velocity.local()?;
    let largest = |axis: usize| values[grid.local_range(axis)].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    Ok(velocity.session().world().max((0..D).map(largest).fold(0.0, f64::max)))
}
