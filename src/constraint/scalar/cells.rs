//! Blocks of an inclusion whose multipliers are sources in cells: C and J take each cell for itself.

use nalgebra::{SMatrix, SVector};

use super::{
    envelope::Envelope,
    graph::{CellEdge, CellGraph, filled_parts},
    inclusion::{Inclusion, InclusionBlocks},
};
use crate::{
    constraint::{
        body::{BodyBlocks, BodyRows, FreeInverse, Plans, Walls},
        layout::MultiplierLayout,
        places::{Entries, EntriesMut},
        rows::Rows,
    },
    geometry::Ball,
    grid::Grid,
};

/// Sources in cells.
struct CellBlocks<const D: usize> {
    /// The cells, as unknowns.
    unknowns: Vec<usize>,
    /// Their centres, from that of the inclusion.
    offsets: Vec<SVector<f64, D>>,
    volume: f64,
    /// Once planned, their places when rows are added to, and when values are taken.
    places: [Vec<u32>; 2],
    /// E: the values by which a body that conducts gives way to sources; a rigid one does not.
    compliance: Option<Envelope>,
}

/// The Laplacian of the edges between cells alone.
struct Laplacian(Vec<CellEdge>);

impl FreeInverse for Laplacian {
    fn apply(&self, input: &[f64], output: &mut [f64]) {
        output.fill(0.0);
        for &CellEdge { cells: [one, two], weight } in &self.0 {
            let flux = weight * (input[one] - input[two]);
            output[one] += flux;
            output[two] -= flux;
        }
    }
}

/// The blocks of an inclusion from its cells, E, and the edges whose Laplacian stands for the inverse.
pub fn blocks<const D: usize>(
    grid: &Grid<D>,
    ball: &Ball<D>,
    cells: CellGraph<D>,
    compliance: Option<Envelope>,
    edges: Vec<CellEdge>,
) -> InclusionBlocks<D> {
    let (unknowns, parts) = filled_parts(grid, ball);
    let volume = grid.spacing().product();
    let inclusion = Inclusion {
        constant: vec![1.0; cells.unknowns.len()],
        measure: volume,
        // a source of strength 1 all over the inclusion flows out with strength a/D
        reaction: ball.radius * ball.radius / D as f64,
        source: Rows::new(unknowns, parts),
        by_source: Vec::new(),
        alone: Box::new(Laplacian(edges)),
    };
    let CellGraph { unknowns, offsets, .. } = cells;
    InclusionBlocks { body: Box::new(CellBlocks { unknowns, offsets, volume, places: Default::default(), compliance }), inclusion }
}

impl<const D: usize> BodyBlocks<D> for CellBlocks<D> {
    fn count(&self) -> usize {
        self.unknowns.len()
    }

    fn plan(&mut self, _layout: &MultiplierLayout, plans: &mut Plans) {
        self.places = [&mut plans.spread, &mut plans.read].map(|places| places.each(&self.unknowns));
    }

    fn spread(&self, factor: f64, c: &[f64], _scratch: &mut Vec<f64>, rows: &mut EntriesMut) {
        self.places[0].iter().zip(c).for_each(|(&place, c)| *rows.at(place) += factor * c);
    }

    fn read(&self, u: Entries, _walls: Walls, _scratch: &mut Vec<f64>, out: &mut [f64]) {
        out.iter_mut().zip(&self.places[1]).for_each(|(out, &place)| *out = u.from(place)[0]);
    }

    fn rows(&self) -> BodyRows<'_, D> {
        BodyRows::Own(None)
    }

    fn add_local(&self, own: &[f64], _all: Entries, out: &mut [f64]) {
        if let Some(compliance) = &self.compliance {
            compliance.add_potential(own, out);
        }
    }

    fn coefficients(&self, known: &dyn Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        self.offsets.iter().map(|offset| known(offset)[0]).collect()
    }

    fn first_moment(&self, c: &[f64]) -> SMatrix<f64, D, D> {
        let dipole: SVector<f64, D> = self.offsets.iter().zip(c).map(|(offset, c)| offset * (self.volume * c)).sum();
        SMatrix::from_fn(|component, axis| if component == 0 { dipole[axis] } else { 0.0 })
    }
}
