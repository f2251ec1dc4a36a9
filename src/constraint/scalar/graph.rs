//! The cells around one inclusion and the edges between their centres.

use nalgebra::SVector;

use crate::{
    constraint::index_box::IndexBox,
    geometry::{Ball, fraction, touches},
    grid::{Grid, Index, Node, dirichlet, stencil::moved},
};

/// Two neighbouring cells, by their numbers in a list of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellEdge {
    /// The cells.
    pub cells: [usize; 2],
    /// Weight in a Laplacian.
    pub weight: f64,
}

/// Cells that belong to an inclusion, with the edges between them.
pub struct CellGraph<const D: usize> {
    /// Their unknowns.
    pub unknowns: Vec<usize>,
    /// Their centres, from that of the inclusion.
    pub offsets: Vec<SVector<f64, D>>,
    /// Edges, with the weights of the Laplacian.
    pub edges: Vec<CellEdge>,
    /// The middles of the edges, from the centre of the inclusion.
    pub middles: Vec<SVector<f64, D>>,
}

impl<const D: usize> CellGraph<D> {
    /// The cells whose centres an inclusion covers, and all edges between them.
    pub fn covered(grid: &Grid<D>, ball: &Ball<D>) -> Self {
        let outside = |index: Index<D>| (grid.position(D, index) - ball.center).norm() > ball.radius;
        CellGraph::chosen(grid, ball, |ends| !ends.into_iter().any(outside))
    }

    /// The edges whose boxes, from centre to centre and as wide as a cell, an inclusion touches, and the cells at their ends.
    pub fn touched(grid: &Grid<D>, ball: &Ball<D>) -> Self {
        CellGraph::chosen(grid, ball, |ends| touches(ball, &middle(grid, ends), &grid.spacing()))
    }

    fn chosen(grid: &Grid<D>, ball: &Ball<D>, belongs: impl Fn([Index<D>; 2]) -> bool) -> Self {
        let indices = IndexBox::around(grid, D, &ball.center, ball.radius + 2.0 * grid.spacing().max());
        let mut found = CellGraph { unknowns: Vec::new(), offsets: Vec::new(), edges: Vec::new(), middles: Vec::new() };
        let mut numbers = vec![None; indices.len()];
        let pairs = indices.indices().flat_map(|one| (0..D).map(move |axis| (one, axis)));
        let within = |index: Index<D>| (0..D).all(|axis| index[axis] < indices.start()[axis] + indices.extent()[axis] as isize);
        for (one, axis) in pairs {
            let ends = [one, moved(one, axis, 1)];
            if within(ends[1]) && belongs(ends) {
                let cells = ends.map(|index| *numbers[indices.place(index)].get_or_insert_with(|| found.add(grid, ball, index)));
                found.edges.push(CellEdge { cells, weight: grid.spacing()[axis].powi(-2) });
                found.middles.push(middle(grid, ends) - ball.center);
            }
        }
        found
    }

    fn add(&mut self, grid: &Grid<D>, ball: &Ball<D>, index: Index<D>) -> usize {
        let Node::Unknown(unknown) = grid.node(D, index) else { unreachable!("every cell has an unknown") };
        self.unknowns.push(unknown);
        self.offsets.push(grid.position(D, index) - ball.center);
        self.unknowns.len() - 1
    }
}

fn middle<const D: usize>(grid: &Grid<D>, [one, two]: [Index<D>; 2]) -> SVector<f64, D> {
    (grid.position(D, one) + grid.position(D, two)) * 0.5
}

/// Cells of which a ball fills a part, with minus that part: what confines a unit source to the outside.
pub fn filled_parts<const D: usize>(grid: &Grid<D>, ball: &Ball<D>) -> (Vec<usize>, Vec<f64>) {
    let indices = IndexBox::around(grid, D, &ball.center, ball.radius + grid.spacing().max());
    let cells = indices.indices().filter(|&index| dirichlet::within(grid, index));
    let part = |index: Index<D>| match grid.node(D, index) {
        Node::Unknown(unknown) => Some((unknown, -fraction(ball, &grid.position(D, index), &grid.spacing()))),
        Node::Wall(_) => None,
    };
    cells.filter_map(part).filter(|(_, part)| *part < 0.0).unzip()
}
