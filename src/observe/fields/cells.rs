//! Fields at the centres of the cells, as frames hold them.

use nalgebra::SVector;

use crate::{
    constraint::IndexBox,
    error::Result,
    flow::OpenEnds,
    geometry::Ball,
    grid::{Grid, Index, Node, operators::signed, stencil::moved},
    linalg::lagrange,
    petsc::{Scatter, Vector, WantedRun},
};

/// Brings velocities from the faces of this rank's cells, and pressures, to the centres of cells whose edges lie along the axes; made once for a grid.
///
/// On an oblique grid the centre of such a cell lies beside that of a cell of the grid: values are interpolated along x between four of these.
pub struct CellCenters<const D: usize> {
    grid: Grid<D>,
    /// For each of the cells [`beside`]: component by component the lower faces of all cells, then the upper ones; zero on walls and on open ends.
    faces: Scatter,
}

/// Cells along x from each one's own between whose centres is interpolated.
const BESIDE: [isize; 4] = [-1, 0, 1, 2];

impl<const D: usize> CellCenters<D> {
    /// Plans the exchange of faces between ranks; `fluid` is any fluid vector.
    pub fn new(grid: &Grid<D>, fluid: &Vector) -> Result<CellCenters<D>> {
        let sides = (0..2 * D).map(|side| (side / 2, side % 2));
        Ok(CellCenters { grid: grid.clone(), faces: scatter(grid, fluid, sides)? })
    }

    /// The velocity of a fluid vector at the centres of this rank's cells, in the order of its block.
    pub fn velocity(&mut self, fluid: &Vector) -> Result<Vec<SVector<f64, D>>> {
        let (faces, cells) = (self.faces.fetch(fluid)?, self.grid.block(D).len());
        let mean = |from: &[f64], cell: usize, component: usize| {
            0.5 * (from[2 * component * cells + cell] + from[(2 * component + 1) * cells + cell])
        };
        let of_cell = |(cell, weights): (usize, [f64; 4])| {
            SVector::from_fn(|component, _| {
                faces.chunks_exact(2 * D * cells).zip(weights).map(|(from, weight)| weight * mean(from, cell, component)).sum()
            })
        };
        let mut velocities: Vec<SVector<f64, D>> = weights(&self.grid).enumerate().map(of_cell).collect();
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

    /// The pressure of a fluid vector there.
    pub fn pressure(&self, fluid: &Vector) -> Result<Vec<f64>> {
        if self.grid.slope() == 0.0 {
            return Ok(fluid.local()?[self.grid.local_range(D)].to_vec());
        }
        let mut pressures = scatter(&self.grid, fluid, [(D, 0)].into_iter())?;
        let (pressures, cells) = (pressures.fetch(fluid)?, self.grid.block(D).len());
        let of_cell =
            |(cell, weights): (usize, [f64; 4])| pressures.chunks_exact(cells).zip(weights).map(|(from, weight)| weight * from[cell]).sum();
        Ok(weights(&self.grid).enumerate().map(of_cell).collect())
    }
}

/// The exchange of values of the cells [`beside`] this rank's: for each of these, field by field with the side of the cell on which it stands, 0 below, 1 above.
fn scatter<const D: usize>(grid: &Grid<D>, fluid: &Vector, sides: impl Iterator<Item = (usize, usize)> + Clone) -> Result<Scatter> {
    let (cells, mut wanted, mut place) = (grid.block(D).len(), Vec::new(), 0);
    for &along_x in beside(grid) {
        for (field, side) in sides.clone() {
            add_values(grid, field, side, along_x, place, &mut wanted);
            place += cells;
        }
    }
    Scatter::of_runs(fluid, place, wanted.into_iter())
}

/// For each of this rank's cells the weights of the values [`beside`] it at the centre of the upright cell of its index.
pub(super) fn weights<const D: usize>(grid: &Grid<D>) -> impl Iterator<Item = [f64; 4]> + use<'_, D> {
    let alone = grid.slope() == 0.0;
    let of_height = move |y: f64| lagrange(&BESIDE.map(|cell| cell as f64), -grid.slope() * y / grid.spacing()[0]);
    let of_row = move |row: usize| if alone { [1.0, 0.0, 0.0, 0.0] } else { of_height((row as f64 + 0.5) * grid.spacing()[1]) };
    grid.block(D).indices().map(move |cell| of_row(cell[1]))
}

/// Cells along x from each one's own, between whose centres values at upright cells are interpolated.
pub(super) fn beside<const D: usize>(grid: &Grid<D>) -> &'static [isize] {
    if grid.slope() == 0.0 { &[0] } else { &BESIDE }
}

/// Adds the faces on one side (0 below, 1 above) along the axis of a field, or the pressures, of cells so far along x from this rank's, whose places start with
/// `place`.
fn add_values<const D: usize>(grid: &Grid<D>, field: usize, side: usize, along_x: isize, mut place: usize, wanted: &mut Vec<WantedRun>) {
    let cells = grid.block(D);
    for cell in cells.flattened(D - 1).indices() {
        let mut face = moved(signed(cell), 0, along_x);
        if field < D {
            face = moved(face, field, side as isize);
        }
        let mut left = cells.end[D - 1] - cells.start[D - 1];
        while left > 0 {
            let (node, follow) = grid.fluid_run(field, face);
            let length = follow.min(left);
            if let Node::Unknown(first) = node {
                wanted.push(WantedRun { place, first, length });
            }
            (place, left, face[D - 1]) = (place + length, left - length, face[D - 1] + length as isize);
        }
    }
}

/// Which of this rank's cells, drawn along the axes, have their centre inside a body: 1, and 0 outside, in the order of its block.
pub fn inside<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>]) -> Vec<f64> {
    let mut inside = vec![0.0; grid.block(D).len()];
    visit_inside(grid, balls, |_, cell| inside[cell] = 1.0);
    inside
}

/// Calls `found` with the number of a ball and the place in this rank's block of a cell whose centre it holds, for all of them.
pub fn visit_inside<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>], mut found: impl FnMut(usize, usize)) {
    for (number, ball) in balls.iter().enumerate() {
        let center = grid.domain().wrap(ball.center);
        let within = |index: &Index<D>| (grid.upright_center(*index) - center).norm() <= ball.radius;
        // lines of an oblique grid lie half a cell aside at most
        let aside = if grid.slope() == 0.0 { 0.0 } else { grid.spacing()[0] };
        let around = IndexBox::around(grid, D, &center, ball.radius + aside);
        around.indices().filter(within).filter_map(|index| own_place(grid, index)).for_each(|place| found(number, place));
    }
}

/// The place in this rank's block of a cell, in the box or an image of it, if it is one of this rank's.
pub(super) fn own_place<const D: usize>(grid: &Grid<D>, cell: Index<D>) -> Option<usize> {
    let (block, wrapped) = (grid.block(D), grid.wrapped(cell));
    (0..D).all(|axis| (block.start[axis]..block.end[axis]).contains(&wrapped[axis])).then(|| block.offset(wrapped))
}
