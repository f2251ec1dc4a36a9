//! The cells around one inclusion and the links between their centres.

use nalgebra::SVector;

use crate::{
    constraint::patch::Patch,
    geometry::{Ball, fraction},
    grid::{Grid, Index, Node, dirichlet, stencil::moved},
};

/// Links of which an inclusion fills less are not part of it.
const SMALLEST_PART: f64 = 1e-6;

/// Two neighbouring cells, by their numbers in a list of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// The cells.
    pub cells: [usize; 2],
    /// Weight in a Laplacian.
    pub weight: f64,
    /// Part of the box between their centres, as wide as a cell, that the inclusion fills.
    pub part: f64,
}

/// Cells that belong to an inclusion, with the links between them.
pub struct LinkedCells<const D: usize> {
    /// Their unknowns.
    pub unknowns: Vec<u32>,
    /// Their centres, from that of the inclusion.
    pub offsets: Vec<SVector<f64, D>>,
    /// Links, with the weights of the Laplacian.
    pub links: Vec<Link>,
}

impl<const D: usize> LinkedCells<D> {
    /// The cells whose centres an inclusion covers, and all links between them.
    pub fn covered(grid: &Grid<D>, ball: &Ball<D>) -> Self {
        let offset = |index: Index<D>| grid.position(D, index) - ball.center;
        LinkedCells::chosen(grid, ball, |one, two| offset(one).norm().max(offset(two).norm()) <= ball.radius)
    }

    /// The cells at the ends of links of which an inclusion fills a part, and these links.
    pub fn touched(grid: &Grid<D>, ball: &Ball<D>) -> Self {
        LinkedCells::chosen(grid, ball, |one, two| part(grid, ball, one, two) > SMALLEST_PART)
    }

    fn chosen(grid: &Grid<D>, ball: &Ball<D>, belongs: impl Fn(Index<D>, Index<D>) -> bool) -> Self {
        let patch = Patch::around(grid, D, &ball.center, ball.radius + 2.0 * grid.spacing().max());
        let mut found = LinkedCells { unknowns: Vec::new(), offsets: Vec::new(), links: Vec::new() };
        let mut numbers = vec![None; patch.len()];
        let pairs = patch.indices().flat_map(|one| (0..D).map(move |axis| (one, axis)));
        let inside = |index: Index<D>| (0..D).all(|axis| index[axis] < patch.start()[axis] + patch.extent()[axis] as isize);
        for (one, axis) in pairs {
            let two = moved(one, axis, 1);
            if !inside(two) || !belongs(one, two) {
                continue;
            }
            let cells = [one, two].map(|index| *numbers[patch.place(index)].get_or_insert_with(|| found.add(grid, ball, index)));
            found.links.push(Link { cells, weight: grid.spacing()[axis].powi(-2), part: part(grid, ball, one, two) });
        }
        found
    }

    fn add(&mut self, grid: &Grid<D>, ball: &Ball<D>, index: Index<D>) -> usize {
        let Node::Unknown(unknown) = grid.node(D, index) else { unreachable!("every cell has an unknown") };
        self.unknowns.push(unknown as u32);
        self.offsets.push(grid.position(D, index) - ball.center);
        self.unknowns.len() - 1
    }
}

/// Part of the box between two neighbouring centres that a ball fills.
fn part<const D: usize>(grid: &Grid<D>, ball: &Ball<D>, one: Index<D>, two: Index<D>) -> f64 {
    fraction(ball, &((grid.position(D, one) + grid.position(D, two)) * 0.5), &grid.spacing())
}

/// Cells of which a ball fills a part, with minus that part: what confines a unit source to the outside.
pub fn filled_parts<const D: usize>(grid: &Grid<D>, ball: &Ball<D>) -> (Vec<u32>, Vec<f64>) {
    let patch = Patch::around(grid, D, &ball.center, ball.radius + grid.spacing().max());
    let cells = patch.indices().filter(|&index| dirichlet::within(grid, index));
    let parts = cells.map(|index| (grid.node(D, index), -fraction(ball, &grid.position(D, index), &grid.spacing())));
    parts
        .filter_map(
            |(node, part)| if let (Node::Unknown(unknown), true) = (node, part < 0.0) { Some((unknown as u32, part)) } else { None },
        )
        .unzip()
}
