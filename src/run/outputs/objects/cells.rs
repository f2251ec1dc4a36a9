//! `cells.csv`: cells and, in 2D, rings.

use std::ops::Range;

use nalgebra::Vector2;

use super::super::context::{Context, Wanted};
use super::table::{NamedNumber, ObjectRow, Objects, opened, vector};
use super::turns::AngleColumns;
use crate::{
    interaction::Measure,
    observe::{CellGeometry, Form, Tied, facets, mean_phase, tied},
    run::View,
};

/// What encloses an area or a volume.
struct Cell<const D: usize> {
    number: usize,
    beads: Range<usize>,
    facets: Vec<[usize; D]>,
}

/// Those of a run.
struct Cells<const D: usize>(Vec<Cell<D>>);

/// Where there are cells, in 2D or rings, unless `output.objects = false`. Collective.
///
/// # Errors
/// The file cannot be read or written.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    let Some(simulation) = context.simulation.filter(|_| context.scene.writes_objects()) else { return Ok(None) };
    let cell = |Tied { number, beads, form }: Tied| {
        let measure = match form {
            Form::Cell(measure) => measure,
            Form::Ring if D == 2 => Measure::EnclosedArea,
            Form::Ring | Form::Line => return None,
        };
        Some(Cell { number, facets: facets(&measure, beads.len()), beads })
    };
    opened(context, Cells(tied(simulation.interactions()).into_iter().filter_map(cell).collect()))
}

/// Names of what a cell encloses, of its boundary, and of what it encloses over what a circle or sphere does.
const fn names<const D: usize>() -> [&'static str; 3] {
    if D == 2 { ["area", "perimeter", "reduced_area"] } else { ["volume", "surface", "reduced_volume"] }
}

fn entries<const D: usize>(geometry: &CellGeometry<D>) -> Vec<NamedNumber> {
    let CellGeometry { center, enclosed, boundary, reduced, deformation, inclination } = geometry;
    let named = names::<D>().into_iter().zip([*enclosed, *boundary, *reduced]);
    let mut entries = vector("", center);
    entries.extend(named.chain([("deformation", *deformation), ("inclination", *inclination)]).map(|(name, number)| (name.into(), number)));
    entries
}

impl<const D: usize> Cells<D> {
    /// The mean phases of all of them, in 2D.
    fn phases<'a>(&'a self, view: &'a View<D>) -> impl Iterator<Item = f64> + 'a {
        let centers = view.whole_centers().filter(|_| D == 2).unwrap_or(&[]);
        let cells = if centers.is_empty() { &[] } else { &self.0[..] };
        cells.iter().map(|cell| {
            let ring: Vec<Vector2<f64>> = centers[cell.beads.clone()].iter().map(|bead| Vector2::new(bead[0], bead[1])).collect();
            mean_phase(&ring)
        })
    }
}

impl<const D: usize> Objects<D> for Cells<D> {
    fn names(&self) -> [&'static str; 2] {
        ["cells.csv", "cell"]
    }

    fn count(&self) -> usize {
        self.0.len()
    }

    fn angle(&self) -> Option<AngleColumns> {
        (D == 2).then_some(AngleColumns { followed: "tread", plain: Some("phase") })
    }

    fn angles(&self, view: &View<D>) -> Vec<(usize, f64)> {
        self.phases(view).enumerate().collect()
    }

    fn rows(&self, view: &View<D>) -> Vec<ObjectRow> {
        let Some(centers) = view.whole_centers() else { return Vec::new() };
        let mut phases = self.phases(view);
        let row = |cell: &Cell<D>| {
            let geometry = CellGeometry::of(&centers[cell.beads.clone()], &cell.facets);
            ObjectRow { number: cell.number, entries: entries(&geometry), angle: phases.next() }
        };
        self.0.iter().map(row).collect()
    }
}
