//! The quantities that every run measures, one entry each, by what they are about.

mod bonded;
mod contacts;
mod inertia;
mod motions;
mod shear;
mod steps;
mod wall;

use std::rc::Rc;

use super::{column::SeriesColumn, quantity::Quantity};
use crate::dimension::same;
pub use steps::seconds;

/// The quantities of a run in the order of their columns; those that a scene does not call for have none.
pub fn quantities<const D: usize>() -> Vec<Quantity<D>> {
    if D == 2 { same(in_plane()) } else { same(in_space()) }
}

fn in_plane() -> Vec<Quantity<2>> {
    all()
}

fn in_space() -> Vec<Quantity<3>> {
    all()
}

fn all<const D: usize>() -> Vec<Quantity<D>> {
    [
        steps::times(),
        shear::viscosity(),
        contacts::contacts(),
        steps::solves(),
        contacts::friction(),
        inertia::of_flow(),
        bonded::chains(),
        bonded::membranes(),
        bonded::clusters(),
        motions::velocities(),
        shear::stress(),
        wall::loaded(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// All columns of `series.csv`, each once, in space.
pub fn columns() -> Vec<Rc<SeriesColumn>> {
    let mut all: Vec<Rc<SeriesColumn>> = Vec::new();
    for column in quantities::<3>().iter().flat_map(Quantity::columns) {
        if all.iter().all(|known| known.name != column.name) {
            all.push(column.clone());
        }
    }
    all.push(steps::seconds());
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_that_two_quantities_share_has_one_meaning() {
        let (plane, space) = (quantities::<2>(), quantities::<3>());
        for column in plane.iter().flat_map(Quantity::columns).chain(space.iter().flat_map(Quantity::columns)) {
            let known = columns().into_iter().find(|known| known.name == column.name);
            assert_eq!(known.as_ref(), Some(column), "{}", column.name);
            assert!(!column.meaning.is_empty(), "{} has no meaning", column.name);
        }
    }
}
