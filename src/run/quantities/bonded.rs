//! Chains, red cells and rigid clusters.

use crate::{
    observe::{MembraneNumbers, mean_orientation},
    run::{quantity::Quantity, view::View},
};

/// How chains lie.
pub fn chains<const D: usize>() -> Vec<Quantity<D>> {
    let orientation = "mean of `p p`, `p` the unit vector along which the beads of a chain are spread most";
    vec![
        Quantity::new("bond_energy", "energy; 2D: energy/length", "energy of stretched and bent bonds", |view| {
            Some(view.chains()?.bond_energy)
        }),
        Quantity::new("end_to_end", "length", "mean distance of the ends of chains that are no rings", |view| view.chains()?.end_to_end),
        Quantity::new("gyration", "length", "mean radius of gyration of chains", |view| Some(view.chains()?.gyration)),
        // chains without a bead between two others have no curvature
        Quantity::new("curvature", "1/length", "root mean square turn at a bead over the mean length of its bonds", |view| {
            Some(view.chains()?.curvature).filter(|curvature| curvature.is_finite())
        }),
        Quantity::new("chain_orientation", "", orientation, |view| Some(view.chains()?.orientation)),
    ]
}

/// How red cells lie, and how well their membranes keep what they enclose.
pub fn membranes<const D: usize>() -> Vec<Quantity<D>> {
    vec![
        mean("enclosed_area", "enclosed_area", "area", "2D cells: mean area through the centres of beads"),
        worst("area_error", "enclosed_area", "2D cells: largest relative change of one"),
        mean("enclosed_volume", "enclosed_volume", "volume", "3D cells: mean volume"),
        worst("volume_error", "enclosed_volume", "3D cells: largest relative change of one"),
        mean("surface", "surface", "area", "3D cells: mean surface"),
        worst("surface_error", "surface", "3D cells: largest relative change of one"),
        Quantity::new("inclination", "radians", "mean angle of the long axis of cells from x", |view| Some(view.membranes()?.inclination)),
        Quantity::new("tread", "radians", "tank-treading angle: from the long axis of the first cell to its first bead", |view| {
            Some(view.membranes()?.tread)
        }),
    ]
}

/// The mean of a measure that membranes keep.
fn mean<const D: usize>(name: &str, measure: &'static str, unit: &'static str, meaning: &'static str) -> Quantity<D> {
    Quantity::new(name, unit, meaning, move |view: &View<D>| Some(kept(view.membranes()?, measure)?.0))
}

/// The largest relative error of a measure.
fn worst<const D: usize>(name: &str, measure: &'static str, meaning: &'static str) -> Quantity<D> {
    Quantity::new(name, "ratio", meaning, move |view: &View<D>| Some(kept(view.membranes()?, measure)?.1))
}

fn kept(numbers: &MembraneNumbers, measure: &str) -> Option<(f64, f64)> {
    numbers.kept.iter().find(|(name, ..)| *name == measure).map(|&(_, mean, worst)| (mean, worst))
}

/// How rigid clusters lie.
pub fn clusters<const D: usize>() -> Vec<Quantity<D>> {
    vec![Quantity::new("orientation", "", "mean of `p p` over clusters, `p` from the first ball to the farthest one", |view| {
        let simulation = view.motion?.simulation;
        mean_orientation(view.world, simulation.interactions(), simulation.state())
    })]
}
