//! Convection on the staggered grid, `N = div (u u)`, in the form that conserves momentum and kinetic energy.
//!
//! Fluxes of a velocity component pass through the faces of the cells around its points, with means of two neighbours for both factors (Harlow and
//! Welch 1965, doi:10.1063/1.1761178): for a velocity without divergence `sum u . N = 0` to rounding. Nothing is convected through a wall; through open ends what
//! flows in and out is. In a sheared box the velocity is the disturbance of the shear; what is carried and carries is both together, in the frame of the point ([`Grid::frame_velocity`]).

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
    /// What the shear of a sheared box adds to the first component; empty in other boxes.
    shear: Vec<f64>,
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
        let height = |index: [usize; D]| grid.position(0, std::array::from_fn(|axis| (cells.start[axis] + index[axis]) as isize - 1));
        let sheared = grid.domain().slide().is_some();
        let shear = if sheared { around.indices().map(|index| grid.domain().carried(&height(index))[0]).collect() } else { Vec::new() };
        let values = vec![vec![0.0; around.len()]; D];
        Ok(Convection { grid: grid.clone(), extent, places, fetched: Scatter::new(shape, &wanted)?, shear, ends, values })
    }

    /// The grid, with its images where they were when this was made.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
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
        let (mut rows, sheared) = (out.local_mut()?, !self.shear.is_empty());
        for component in 0..D {
            let first = self.grid.partition().block(self.grid.rank()).start;
            let rows = &mut rows[self.grid.local_range(component)];
            let frames = along_y(&self.grid, component, |point| if sheared { self.grid.frame_velocity(point)[0] } else { 0.0 });
            for (row, index) in rows.iter_mut().zip(self.grid.block(component).indices()) {
                *row = self.outflow(component, std::array::from_fn(|axis| index[axis] + 1 - first[axis]), frames[index[1]]);
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
        self.values[0].iter_mut().zip(&self.shear).for_each(|(value, shear)| *value += shear);
        Ok(())
    }

    fn fill_ends(&mut self, ends: &OpenEnds<D>) {
        for EndValue { component, place, index, upper, mirrored } in &self.ends {
            let (at, values) = (ends.at(&self.grid, *upper, *component, *index), &mut self.values[*component]);
            values[*place] = mirrored.map_or(at, |mirrored| 2.0 * at - values[mirrored]);
        }
    }

    /// What flows out of the cell around a point, over its volume, in a frame that moves along the first axis.
    #[inline]
    fn outflow(&self, component: usize, index: [usize; D], frame: f64) -> f64 {
        let spacing: SVector<f64, D> = self.grid.spacing();
        let at = (0..D).fold(0, |place, axis| place * self.extent[axis] + index[axis]);
        let stride = |axis: usize| -> usize { self.extent[axis + 1..].iter().product() };
        let own = &self.values[component];
        let back = stride(component);
        let mut sum = -0.5 * frame * (own[at + stride(0)] - own[at - stride(0)]) / spacing[0];
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

/// A value that depends on the height of a component's points alone, for each index along y.
fn along_y<const D: usize>(grid: &Grid<D>, component: usize, value: impl Fn(&SVector<f64, D>) -> f64) -> Vec<f64> {
    let at = |row: usize| {
        let mut index = [0; D];
        index[1] = row as isize;
        value(&grid.position(component, index))
    };
    (0..grid.cells()[1]).map(at).collect()
}

/// Largest speed along an axis of a velocity, on all ranks; in a sheared box with that of the shear in the frames of convection.
///
/// # Errors
/// PETSc fails.
pub fn fastest<const D: usize>(grid: &Grid<D>, velocity: &Vector) -> Result<f64> {
    let values = velocity.local()?;
    let largest = |axis: usize| values[grid.local_range(axis)].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let along_shear = || {
        let shear = along_y(grid, 0, |point| (grid.domain().carried(point) - grid.frame_velocity(point))[0]);
        let total = values[grid.local_range(0)].iter().zip(grid.block(0).indices()).map(|(value, index)| value + shear[index[1]]);
        total.fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let first = if grid.domain().slide().is_some() { along_shear() } else { largest(0) };
    Ok(velocity.session().world().max((1..D).map(largest).fold(first, f64::max)))
}
