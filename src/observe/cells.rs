//! Fields at the centres of the cells, as frames hold them.

use nalgebra::SVector;

use crate::{
    constraint::IndexBox,
    error::Result,
    flow::OpenEnds,
    geometry::Ball,
    grid::{Grid, Index, Node, operators::signed, stencil::moved},
    petsc::{Scatter, Vector},
};

/// Brings velocities from the faces of this rank's cells to their centres; made once for a grid.
pub struct CellCenters<const D: usize> {
    grid: Grid<D>,
    faces: Scatter,
    /// For each cell and component, the places of its two faces; none for a face on a wall, where the velocity is zero, or on an open end.
    places: Vec<[Option<usize>; 2]>,
}

impl<const D: usize> CellCenters<D> {
    /// Plans the exchange of faces between ranks; `fluid` is any fluid vector.
    pub fn new(grid: &Grid<D>, fluid: &Vector) -> Result<CellCenters<D>> {
        let (mut wanted, mut places) = (Vec::new(), Vec::new());
        for cell in grid.block(D).indices() {
            for component in 0..D {
                let lower = signed(cell);
                places.push([lower, moved(lower, component, 1)].map(|face| match grid.fluid_node(component, face) {
                    Node::Unknown(unknown) => {
                        wanted.push(unknown);
                        Some(wanted.len() - 1)
                    }
                    Node::Wall(_) => None,
                }));
            }
        }
        Ok(CellCenters { grid: grid.clone(), faces: Scatter::new(fluid, &wanted)?, places })
    }

    /// The velocity of a fluid vector at the centres of this rank's cells, in the order of its block.
    pub fn velocity(&mut self, fluid: &Vector) -> Result<Vec<SVector<f64, D>>> {
        let faces = self.faces.fetch(fluid)?;
        let mean = |sides: &[Option<usize>; 2]| 0.5 * sides.iter().flatten().map(|&place| faces[place]).sum::<f64>();
        let mut velocities: Vec<SVector<f64, D>> =
            self.places.chunks(D).map(|cell| SVector::from_fn(|component, _| mean(&cell[component]))).collect();
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

/// Which of this rank's cells have their centre inside a body: 1, and 0 outside, in the order of its block.
pub fn inside<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>]) -> Vec<f64> {
    let mut inside = vec![0.0; grid.block(D).len()];
    visit_inside(grid, balls, |_, cell| inside[cell] = 1.0);
    inside
}

/// Calls `found` with the number of a ball and the place in this rank's block of a cell whose centre it holds, for all of them.
pub(super) fn visit_inside<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>], mut found: impl FnMut(usize, usize)) {
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
