//! Velocities where the box is open: what flows in at one end is given, what flows out at the other is carried out of the box.
//!
//! The operators have walls there, whose velocity is put on the right-hand sides: every inverse serves. A velocity leaves the box with the mean flow,
//! `u_t + U u_x = 0`, from one step to the next; what that brings too much or too little is evened out in the shape of the inflow, so that as much
//! leaves as comes. In Stokes flow the outflow is as the inflow.

use crate::{
    error::Result,
    grid::{
        Block, Grid, Index,
        operators::signed,
        stencil::{Site, moved},
    },
    petsc::Vector,
};

/// Velocities at both ends, on the lattices of their components, on every rank.
#[derive(Debug, Clone)]
pub struct OpenEnds<const D: usize> {
    axis: usize,
    /// At the outflow: for each component, its values across the axis.
    outflow: Vec<Vec<f64>>,
}

impl<const D: usize> OpenEnds<D> {
    /// The ends of a box with an outflow as the inflow; nothing if none is open.
    pub fn undisturbed(grid: &Grid<D>) -> Option<OpenEnds<D>> {
        let (axis, _) = grid.domain().open()?;
        let mut ends = OpenEnds { axis, outflow: vec![vec![0.0; cross_section(grid, axis)]; D] };
        for index in across(grid, axis) {
            let place = place(grid, axis, &index);
            ends.outflow[axis][place] = ends.at_inflow(grid, axis, index);
        }
        Some(ends)
    }

    /// The ends that a flow has; nothing if none is open. Collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn of(grid: &Grid<D>, fluid: &Vector) -> Result<Option<OpenEnds<D>>> {
        Self::after(grid, fluid, 0.0)
    }

    /// The ends a step after a flow; nothing if none is open. Collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn after(grid: &Grid<D>, fluid: &Vector, step: f64) -> Result<Option<OpenEnds<D>>> {
        let Some((axis, _)) = grid.domain().open() else { return Ok(None) };
        let mut ends = OpenEnds { axis, outflow: Vec::new() };
        let passed = grid.domain().mean_inflow() * step / grid.spacing()[axis];
        ends.outflow = (0..D).map(|component| ends.carried(grid, fluid, component, passed)).collect::<Result<_>>()?;
        ends.even_out(grid);
        Ok(Some(ends))
    }

    /// The axis that is open.
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// The velocity at an index of a component on an end (or beyond it, for components along it): at the outflow or the inflow.
    pub fn at(&self, grid: &Grid<D>, upper: bool, component: usize, index: Index<D>) -> f64 {
        if upper { self.outflow[component][place(grid, self.axis, &index)] } else { self.at_inflow(grid, component, index) }
    }

    /// The end on which an index of a component lies, or for which it stands: whether that is the upper one. None beyond walls of other axes.
    pub fn end(&self, grid: &Grid<D>, component: usize, index: &Index<D>) -> Option<bool> {
        if !(0..D).all(|axis| axis == self.axis || grid.between_walls(component, axis, index[axis])) {
            return None;
        }
        let beyond = isize::from(component != self.axis);
        match index[self.axis] {
            lower if lower == -beyond => Some(false),
            upper if upper == grid.cells()[self.axis] as isize => Some(true),
            _ => None,
        }
    }

    /// The velocity at a site on an end; nothing elsewhere.
    pub fn at_site(&self, grid: &Grid<D>, site: &Site<D>) -> Option<f64> {
        let (Site::Lattice { field, index } | Site::Wall { field, index, .. }) = site;
        Some(self.at(grid, self.end(grid, *field, index)?, *field, *index))
    }

    /// Adds what flows in and out to rows of momentum and continuity that are not balanced.
    pub fn add_rows(&self, grid: &Grid<D>, rows: &mut Vector) -> Result<()> {
        let mut rows = rows.local_mut()?;
        let (spacing, last) = (grid.spacing()[self.axis], grid.cells()[self.axis] as isize - 1);
        for field in 0..=D {
            // lattice beside the ends, and the weight of the ends there
            let (beside, weight) = match field {
                _ if field == self.axis => ([1, last], [spacing.powi(-2); 2]),
                _ if field == D => ([0, last], [1.0 / spacing, -1.0 / spacing]),
                _ => ([0, last], [2.0 * spacing.powi(-2); 2]),
            };
            let component = if field == D { self.axis } else { field };
            for (row, index) in rows[grid.local_range(field)].iter_mut().zip(grid.block(field).indices()) {
                for upper in [false, true] {
                    if index[self.axis] as isize == beside[usize::from(upper)] {
                        *row += weight[usize::from(upper)] * self.at(grid, upper, component, signed(index));
                    }
                }
            }
        }
        Ok(())
    }

    fn at_inflow(&self, grid: &Grid<D>, component: usize, index: Index<D>) -> f64 {
        if component == self.axis { grid.domain().inflow_at(&grid.position(component, index)) } else { 0.0 }
    }

    /// A component at the upper end when the flow has passed a part of a cell.
    fn carried(&self, grid: &Grid<D>, fluid: &Vector, component: usize, passed: f64) -> Result<Vec<f64>> {
        let (axis, values) = (self.axis, fluid.local()?);
        let last = grid.cells()[axis] - 1;
        let mut carried = vec![0.0; cross_section(grid, axis)];
        for source in 0..D {
            for (value, index) in values[grid.local_range(source)].iter().zip(grid.block(source).indices()) {
                let mut add = |index: Index<D>, weight: f64| carried[place(grid, axis, &index)] += weight * value;
                if source == component && component == axis {
                    // the face on the end has what the last cells let through, and those along them
                    if index[axis] == last {
                        add(signed(index), 1.0);
                    }
                } else if source == component {
                    // a line through the last two points, half a cell and one and a half from the end
                    if index[axis] == last {
                        add(signed(index), 1.5 - passed);
                    } else if index[axis] + 1 == last {
                        add(signed(index), passed - 0.5);
                    }
                } else if component == axis && index[axis] == last {
                    let weight = (1.0 - passed) * grid.spacing()[axis] / grid.spacing()[source];
                    let above = signed(index);
                    add(above, weight);
                    // the other of the two cells whose side this face is
                    let below = moved(signed(index), source, -1);
                    add(signed(grid.wrapped(below)), -weight);
                }
            }
        }
        fluid.session().world().sum(&mut carried);
        Ok(carried)
    }

    /// Lets as much leave as comes.
    fn even_out(&mut self, grid: &Grid<D>) {
        let (mut missing, mut comes) = (0.0, 0.0);
        for index in across(grid, self.axis) {
            let inflow = self.at_inflow(grid, self.axis, index);
            missing += inflow - self.outflow[self.axis][place(grid, self.axis, &index)];
            comes += inflow;
        }
        for index in across(grid, self.axis) {
            let inflow = self.at_inflow(grid, self.axis, index);
            self.outflow[self.axis][place(grid, self.axis, &index)] += missing / comes * inflow;
        }
    }
}

/// Places of values across an axis: one more than cells along each other one.
fn cross_section<const D: usize>(grid: &Grid<D>, axis: usize) -> usize {
    (0..D).filter(|&across| across != axis).map(|across| grid.cells()[across] + 1).product()
}

/// The place of an index across an axis.
fn place<const D: usize>(grid: &Grid<D>, axis: usize, index: &Index<D>) -> usize {
    let along = |across: usize| {
        let (index, cells) = (index[across], grid.cells()[across] as isize);
        (if grid.domain().periodic(across) { index.rem_euclid(cells) } else { index }) as usize
    };
    (0..D).filter(|&across| across != axis).fold(0, |place, across| place * (grid.cells()[across] + 1) + along(across))
}

/// The indices across an axis of the component along it.
fn across<const D: usize>(grid: &Grid<D>, axis: usize) -> impl Iterator<Item = Index<D>> {
    let end = std::array::from_fn(|across| if across == axis { 1 } else { grid.cells()[across] });
    Block { start: [0; D], end }.indices().map(signed)
}
