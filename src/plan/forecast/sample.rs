//! A part of a scene that is solved soon.

use nalgebra::SVector;

use crate::{
    body::pack,
    geometry::Domain,
    setup::{Inertia, Setup, SuspendedBody},
};

/// Bodies of a sample.
pub const SAMPLE: usize = 40;

/// Cells per radius of a sample that has all bodies.
const COARSE: f64 = 4.0;

/// Most cells of a sample, and the most times that its longest side is as long as its shortest.
const MOST_CELLS: f64 = 1e5;
const SLENDER: f64 = 16.0;

/// Least side of a sample that was cut, in diameters of its largest body.
const ROOM: f64 = 1.5;

/// Gap between the bodies of a sample, in radii.
const GAP: f64 = 0.02;

/// By how much the box of a sample grows when its bodies do not fit, and how often.
const WIDER: f64 = 1.1;
const TRIES: usize = 12;

/// A part of a setup that is solved soon; nothing if its bodies find no room or still take too many cells.
pub fn sample<const D: usize>(setup: &Setup<D>) -> Option<Setup<D>> {
    let all = setup.bodies.len();
    if all <= SAMPLE && small(setup.domain.size, coarse(setup).spacing) {
        return Some(coarse(setup));
    }
    let part = (SAMPLE as f64 / all as f64).min(1.0).powf(1.0 / D as f64);
    let given = Setup { domain: Domain { size: setup.domain.size * part, ..setup.domain.clone() }, ..setup.clone() };
    let part = if small(given.domain.size, given.spacing) { given } else { coarse(&given) };
    let size = shrunk(&part)?;
    let kept = (all as f64 * size.product() / setup.domain.volume()).round().clamp(all.min(1) as f64, SAMPLE as f64) as usize;
    let places: Vec<usize> = (0..kept).map(|place| place * all / kept).collect();
    let chosen: Vec<SuspendedBody<D>> = places.iter().map(|&place| part.bodies[place]).collect();
    let dense = |inertia: &Inertia<D>| Inertia {
        fluid: inertia.fluid,
        bodies: places.iter().map(|&place| inertia.bodies[place]).collect(),
        starts: places.iter().map(|&place| inertia.starts[place]).collect(),
    };
    let inertia = part.inertia.as_ref().map(dense);
    // what ties bodies names them, and some of these are left out
    let (interactions, trajectories) = (part.interactions.untied(), part.trajectories.of_bodies(&places));
    let radii: Vec<f64> = chosen.iter().map(|suspended| suspended.body.ball.radius).collect();
    (0..TRIES).find_map(|wider| {
        let domain = Domain { size: size * WIDER.powi(wider as i32), axes: setup.domain.axes };
        let centers = pack(&domain, &[], &radii, GAP, 1).ok()?;
        let mut bodies = chosen.clone();
        bodies.iter_mut().zip(centers).for_each(|(suspended, center)| suspended.body.ball.center = center);
        let (interactions, trajectories) = (interactions.clone(), trajectories.clone());
        Some(Setup { domain, bodies, inertia: inertia.clone(), interactions, trajectories, ..part.clone() })
    })
}

/// Whether a box has few cells, and not many more along one axis than along another.
fn small<const D: usize>(size: SVector<f64, D>, spacing: f64) -> bool {
    (size / spacing).product() <= MOST_CELLS && size.max() <= SLENDER * size.min()
}

/// The size of a box with its longest sides cut until it is small; nothing if its largest body then has no room.
fn shrunk<const D: usize>(setup: &Setup<D>) -> Option<SVector<f64, D>> {
    let widest = setup.bodies.iter().map(|suspended| 2.0 * suspended.body.ball.radius).fold(0.0, f64::max);
    let mut size = setup.domain.size;
    while !small(size, setup.spacing) {
        let longest = size.imax();
        size[longest] *= 0.5;
        if size[longest] < ROOM * widest {
            return None;
        }
    }
    Some(size)
}

/// The setup on a grid that is coarse for its smallest body.
fn coarse<const D: usize>(setup: &Setup<D>) -> Setup<D> {
    let smallest = setup.bodies.iter().map(|suspended| suspended.body.ball.radius).fold(f64::INFINITY, f64::min);
    let spacing = if smallest.is_finite() { setup.spacing.max(smallest / COARSE) } else { setup.spacing };
    let carried = |suspended: &SuspendedBody<D>| {
        let order = suspended.order.min((suspended.body.ball.radius / spacing) as usize);
        SuspendedBody { order, ..*suspended }
    };
    Setup { spacing, bodies: setup.bodies.iter().map(carried).collect(), ..setup.clone() }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::Scene;

    /// Of interactions that name bodies none goes with others: rows of joints and bonds would look for beads that are not there.
    #[test]
    fn a_sample_of_some_beads_has_no_rows_that_name_others() {
        let text = "domain.size = [100.0, 100.0]\nflow.viscosity = 1.0\nresolution.cells_per_radius = 4\ntime.end = 1.0\n\
                    [[chains]]\nradius = 0.5\nbeads = 3\nstretch = \"rigid\"\nbend = 5.0\njoints = \"fixed\"\n\
                    centers = [[20.0, 20.0], [21.05, 20.0], [22.1, 20.0], [70.0, 60.0], [71.05, 60.0], [72.1, 60.0]]\n";
        let scene = Scene::parse("scene", Path::new("."), text, &[]).unwrap();
        let whole = Setup::<2>::of(&scene).unwrap();
        let part = sample(&whole).unwrap();
        assert!(part.bodies.len() < whole.bodies.len());
        let centers = |setup: &Setup<2>| setup.bodies.iter().map(|suspended| suspended.body.ball.center).collect::<Vec<_>>();
        assert_eq!(whole.interactions.welds(&centers(&whole)).len(), 6);
        assert!(part.interactions.welds(&centers(&part)).is_empty());
    }
}
