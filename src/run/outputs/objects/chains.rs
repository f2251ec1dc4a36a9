//! `chains.csv`: lines and rings.

use nalgebra::SVector;

use super::super::context::{Context, Wanted};
use super::table::{NamedNumber, ObjectRow, Objects, opened, vector};
use super::turns::AngleColumns;
use crate::{
    observe::{ChainGeometry, Form, Tied, tied},
    run::View,
};

/// The chains of a run.
struct Chains {
    chains: Vec<Tied>,
    /// Of all bodies up to the last bead.
    radii: Vec<f64>,
}

/// Where there are chains, unless `output.objects = false`. Collective.
///
/// # Errors
/// The file cannot be read or written.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    let Some(simulation) = context.simulation.filter(|_| context.scene.writes_objects()) else { return Ok(None) };
    let mut chains = tied(simulation.interactions());
    chains.retain(|tied| !matches!(tied.form, Form::Cell(_)));
    let beads = chains.iter().map(|chain| chain.beads.end).max().unwrap_or(0);
    let radii = simulation.whole_part(0..beads).into_iter().map(|(_, radius)| radius).collect();
    opened(context, Chains { chains, radii })
}

impl Chains {
    /// Those with ends.
    fn lines(&self) -> impl Iterator<Item = &Tied> {
        self.chains.iter().filter(|chain| chain.form == Form::Line)
    }

    fn entries<const D: usize>(&self, geometry: &ChainGeometry<D>) -> Vec<NamedNumber> {
        let mut entries = vector("", &geometry.center);
        if self.lines().next().is_some() {
            let ends = geometry.end_to_end.unwrap_or_else(|| SVector::repeat(f64::NAN));
            entries.push(("end_to_end".into(), ends.norm()));
            entries.extend(vector("end_to_end", &ends));
            if D == 3 {
                entries.push(("azimuth".into(), ends[1].atan2(ends[0])));
                entries.push(("polar".into(), ends[0].hypot(ends[1]).atan2(ends[2])));
            }
        }
        entries.extend([("contour_length".into(), geometry.contour_length), ("gyration".into(), geometry.gyration)]);
        entries
    }
}

/// The angle from x of a vector in the plane.
fn angle<const D: usize>(vector: &SVector<f64, D>) -> f64 {
    vector[1].atan2(vector[0])
}

impl<const D: usize> Objects<D> for Chains {
    fn names(&self) -> [&'static str; 2] {
        ["chains.csv", "chain"]
    }

    fn count(&self) -> usize {
        self.chains.len()
    }

    fn angle(&self) -> Option<AngleColumns> {
        (D == 2 && self.lines().next().is_some()).then_some(AngleColumns { followed: "angle", plain: None })
    }

    fn angles(&self, view: &View<D>) -> Vec<(usize, f64)> {
        let Some(centers) = view.whole_centers() else { return Vec::new() };
        self.lines().map(|line| angle(&(centers[line.beads.end - 1] - centers[line.beads.start]))).enumerate().collect()
    }

    fn rows(&self, view: &View<D>) -> Vec<ObjectRow> {
        let Some(centers) = view.whole_centers() else { return Vec::new() };
        let row = |chain: &Tied| {
            let (beads, radii) = (&centers[chain.beads.clone()], &self.radii[chain.beads.clone()]);
            let geometry = ChainGeometry::of(beads, radii, chain.form == Form::Ring);
            let angle = geometry.end_to_end.filter(|_| D == 2).map(|ends| angle(&ends));
            ObjectRow { number: chain.number, entries: self.entries(&geometry), angle }
        };
        self.chains.iter().map(row).collect()
    }
}
