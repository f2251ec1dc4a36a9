//! What couples the multipliers of one inclusion with the scalar: few modes on its surface, or one multiplier in each of its cells.

use std::rc::Rc;

use super::{envelope::Envelope, links::Link};
use crate::{
    constraint::{
        Layout,
        dense::LocalBlock,
        places::{Places, from},
        rows::Rows,
    },
    linalg::dot,
};

/// The blocks C, J and E of one inclusion, with what stands for the inverse of `J A^{-1} C + E`.
pub enum Coupling {
    /// Multipliers that are modes on the surface.
    Modes(Modes),
    /// Multipliers that are sources in cells.
    Cells(Cells),
}

/// Modes on the surface: rows dense in them.
#[derive(Default)]
pub struct Modes {
    /// Rows of C.
    pub rows: Rows,
    /// Rows of the transpose of J.
    pub sampled: Rows,
    /// Blocks of E.
    pub local: Vec<LocalBlock>,
    /// Once planned, the places of the first multipliers of the blocks of E.
    pub local_places: Vec<u32>,
    /// What a unit source adds to the values on the surface through the jumps.
    pub by_source: Vec<f64>,
    /// The value on the surface of a lonely inclusion per unit of each multiplier.
    pub values: Rc<Vec<f64>>,
}

/// Sources in cells: C and J take each cell for itself.
pub struct Cells {
    /// The cells, as unknowns.
    pub unknowns: Vec<u32>,
    /// Once planned, their places when rows are added to, and when values are taken.
    pub places: [Vec<u32>; 2],
    /// E: the values by which a body that conducts gives way to sources; a rigid one does not.
    pub compliance: Option<Envelope>,
    /// Weights of the Laplacian, between the cells alone, that stands for the inverse.
    pub links: Vec<Link>,
}

/// What is collected while places are planned.
pub struct Plans {
    /// Fields, where values are taken.
    pub sampled: Places,
    /// Fields, where rows are added to.
    pub spread: Places,
    /// Multipliers.
    pub multipliers: Places,
}

/// Multipliers as this rank sees them.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    /// This rank's.
    pub own: &'a [f64],
    /// Those of other ranks that were asked for.
    pub others: &'a [f64],
    /// Those of the inclusion.
    pub inclusion: &'a [f64],
}

impl Coupling {
    /// Finds the places of all that is touched.
    pub fn plan(&mut self, layout: &Layout, plans: &mut Plans) {
        match self {
            Coupling::Modes(modes) => {
                modes.sampled.plan(&mut plans.sampled);
                modes.rows.plan(&mut plans.spread);
                let place = |block: &LocalBlock| plans.multipliers.of(layout.global(block.body), block.transposed.nrows());
                modes.local_places = modes.local.iter().map(place).collect();
            }
            Coupling::Cells(cells) => {
                let of = |places: &mut Places| cells.unknowns.iter().map(|&unknown| places.of(unknown as usize, 1)).collect();
                cells.places = [of(&mut plans.spread), of(&mut plans.sampled)];
            }
        }
    }

    /// `rows += factor * C c`.
    pub fn spread(&self, factor: f64, c: &[f64], own: &mut [f64], others: &mut [f64]) {
        match self {
            Coupling::Modes(modes) => modes.rows.add(factor, c, &mut Vec::new(), own, others),
            Coupling::Cells(cells) => {
                for (&place, c) in cells.places[0].iter().zip(c) {
                    let place = place as usize;
                    let row = if place < own.len() { &mut own[place] } else { &mut others[place - own.len()] };
                    *row += factor * c;
                }
            }
        }
    }

    /// `out = J u`.
    pub fn sample(&self, own: &[f64], others: &[f64], out: &mut [f64]) {
        match self {
            Coupling::Modes(Modes { sampled: Rows { places, values, .. }, .. }) => {
                out.fill(0.0);
                for (&place, tests) in places.iter().zip(values.chunks_exact(out.len())) {
                    let value = from(own, others, place)[0];
                    out.iter_mut().zip(tests).for_each(|(out, test)| *out += value * test);
                }
            }
            Coupling::Cells(cells) => out.iter_mut().zip(&cells.places[1]).for_each(|(out, &place)| *out = from(own, others, place)[0]),
        }
    }

    /// `out += E c + source e`.
    pub fn add_local(&self, c: Seen, source: f64, out: &mut [f64]) {
        match self {
            Coupling::Modes(modes) => {
                out.iter_mut().zip(&modes.by_source).for_each(|(out, value)| *out += source * value);
                for (LocalBlock { transposed, .. }, place) in modes.local.iter().zip(&modes.local_places) {
                    let count = transposed.nrows();
                    let c = &from(c.own, c.others, *place)[..count];
                    out.iter_mut().zip(transposed.as_slice().chunks_exact(count)).for_each(|(out, row)| *out += dot(row, c));
                }
            }
            Coupling::Cells(Cells { compliance: Some(compliance), .. }) => compliance.add_potential(c.inclusion, out),
            Coupling::Cells(_) => {}
        }
    }

    /// About the inverse of `J A^{-1} C + E` of a lonely inclusion, applied to values without a constant.
    pub fn invert(&self, values: &[f64], out: &mut [f64]) {
        match self {
            Coupling::Modes(modes) => {
                out.iter_mut().zip(values.iter().zip(modes.values.iter())).for_each(|(out, (value, of))| *out = value / of)
            }
            Coupling::Cells(cells) => {
                out.fill(0.0);
                for &Link { cells: [one, two], weight } in &cells.links {
                    let flux = weight * (values[one] - values[two]);
                    out[one] += flux;
                    out[two] -= flux;
                }
            }
        }
    }
}
