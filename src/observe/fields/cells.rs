//! Fields at the centres of the cells, as frames hold them.

use nalgebra::SVector;

use crate::{
    constraint::IndexBox,
    error::Result,
    flow::OpenEnds,
    geometry::Ball,
    grid::{Grid, Index, Node, operators::signed, stencil::moved},
    petsc::{Scatter, Vector, WantedRun},
};

/// Brings velocities from the faces of this rank's cells to their centres; made once for a grid.
pub struct CellCenters<const D: usize> {
    grid: Grid<D>,
    /// Component by component the lower faces of all cells, then the upper ones; zero on walls and on open ends.
    faces: Scatter,
}

impl<const D: usize> CellCenters<D> {
    /// Plans the exchange of faces between ranks; `fluid` is any fluid vector.
    pub fn new(grid: &Grid<D>, fluid: &Vector) -> Result<CellCenters<D>> {
        let (cells, mut wanted) = (grid.block(D).len(), Vec::new());
        for side in 0..2 * D {
            add_faces(grid, (side / 2, side % 2), side * cells, &mut wanted);
        }
        let faces = Scatter::of_runs(fluid, 2 * D * cells, wanted.into_iter())?;
        Ok(CellCenters { grid: grid.clone(), faces })
    }

    /// The velocity of a fluid vector at the centres of this rank's cells, in the order of its block.
    pub fn velocity(&mut self, fluid: &Vector) -> Result<Vec<SVector<f64, D>>> {
        let (faces, cells) = (self.faces.fetch(fluid)?, self.grid.block(D).len());
        let mean = |cell: usize, component: usize| 0.5 * (faces[2 * component * cells + cell] + faces[(2 * component + 1) * cells + cell]);
        let mut velocities: Vec<SVector<f64, D>> = (0..cells).map(|cell| SVector::from_fn(|component, _| mean(cell, component))).collect();
        if let Some(ends) = OpenEnds::of(&self.grid, fluid)? {
            let axis = ends.axis();
            for (velocity, cell) in velocities.iter_mut().zip(self.grid.block(D).indices()) {
                for face in [signed(cell), moved(signed(cell), axis, 1)] {
                    velocity[axis] += ends.end(&self.grid, axis, &face).map_or(0.0, |upper| 0.5 * ends.at(&self.grid, upper, axis, face));
                }
            }
        }
        Ok(velocities)
    }
}

/// Adds the faces of this rank's cells on one side along an axis (0 below, 1 above), whose places start with `place`.
fn add_faces<const D: usize>(grid: &Grid<D>, (axis, side): (usize, usize), mut place: usize, wanted: &mut Vec<WantedRun>) {
    let cells = grid.block(D);
    for cell in cells.flattened(D - 1).indices() {
        let (mut face, mut left) = (moved(signed(cell), axis, side as isize), cells.end[D - 1] - cells.start[D - 1]);
        while left > 0 {
            let (node, follow) = grid.fluid_run(axis, face);
            let length = follow.min(left);
            if let Node::Unknown(first) = node {
                wanted.push(WantedRun { place, first, length });
            }
            (place, left, face[D - 1]) = (place + length, left - length, face[D - 1] + length as isize);
        }
    }
}

/// Which of this rank's cells have their centre inside a body: 1, and 0 outside, in the order of its block.
pub fn inside<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>]) -> Vec<f64> {
    let mut inside = vec![0.0; grid.block(D).len()];
    visit_inside(grid, balls, |_, cell| inside[cell] = 1.0);
    inside
}

/// Calls `found` with the number of a ball and the place in this rank's block of a cell whose centre it holds, for all of them.
pub fn visit_inside<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>], mut found: impl FnMut(usize, usize)) {
    for (number, ball) in balls.iter().enumerate() {
        let center = grid.domain().wrap(ball.center);
        let within = |index: &Index<D>| (grid.position(D, *index) - center).norm() <= ball.radius;
        let around = IndexBox::around(grid, D, &center, ball.radius);
        around.indices().filter(within).filter_map(|index| own_place(grid, index)).for_each(|place| found(number, place));
    }
}

/// The place in this rank's block of a cell, in the box or an image of it, if it is one of this rank's.
pub(super) fn own_place<const D: usize>(grid: &Grid<D>, cell: Index<D>) -> Option<usize> {
    let (block, wrapped) = (grid.block(D), grid.wrapped(cell));
    (0..D).all(|axis| (block.start[axis]..block.end[axis]).contains(&wrapped[axis])).then(|| block.offset(wrapped))
}
