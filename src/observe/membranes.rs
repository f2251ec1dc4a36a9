//! How red cells lie and move: what their membranes enclose, how they incline, and how far a membrane has gone around.

use nalgebra::{SVector, Vector2};

use crate::{
    interaction::{Area, enclosed},
    simulation::{Setup, State},
};

/// Cells at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MembraneNumbers {
    /// Mean area that a membrane encloses, through the centres of its beads.
    pub enclosed_area: f64,
    /// Largest part by which one differs from that at rest.
    pub area_error: f64,
    /// Angle from x of the long axis of cells in radians, from `-pi/2` to `pi/2`, of the mean of their orientations.
    pub inclination: f64,
    /// Angle from the long axis of the first cell to its first bead, in radians, from `-pi` to `pi` (an axis has two ends, so that it jumps by `pi` where
    /// the inclination does): it turns as the membrane does, like the tread of a tank.
    pub tread: f64,
}

impl MembraneNumbers {
    /// Those of a state that holds all bodies; nothing without cells.
    pub fn of<const D: usize>(setup: &Setup<D>, state: &State<D>) -> Option<MembraneNumbers> {
        let areas = setup.interactions.areas();
        let rings: Vec<Vec<Vector2<f64>>> = areas.iter().map(|area| ring(state, area)).collect();
        let first = rings.first()?;
        let found: Vec<f64> = rings.iter().map(|ring| enclosed(ring)).collect();
        let errors = found.iter().zip(&areas).map(|(found, area)| (found / area.area - 1.0).abs());
        let mean: Vector2<f64> = rings.iter().map(|ring| orientation(ring).normalize()).sum();
        let to_first = first[0] - middle(first);
        let turned = to_first.y.atan2(to_first.x) - axis(&orientation(first));
        Some(MembraneNumbers {
            enclosed_area: found.iter().sum::<f64>() / found.len() as f64,
            area_error: errors.fold(0.0, f64::max),
            inclination: axis(&mean),
            tread: turned.sin().atan2(turned.cos()),
        })
    }
}

fn ring<const D: usize>(state: &State<D>, area: &Area) -> Vec<Vector2<f64>> {
    let flat = |center: &SVector<f64, D>| center.fixed_rows::<2>(0).into_owned();
    state.bodies[area.bodies.clone()].iter().map(|body| flat(&body.center)).collect()
}

fn middle(ring: &[Vector2<f64>]) -> Vector2<f64> {
    ring.iter().sum::<Vector2<f64>>() / ring.len() as f64
}

/// The mean square of beads' distances from the middle as a vector with twice the angle of the longest of them.
fn orientation(ring: &[Vector2<f64>]) -> Vector2<f64> {
    let middle = middle(ring);
    let doubled = |bead: &Vector2<f64>| {
        let offset = bead - middle;
        Vector2::new(offset.x * offset.x - offset.y * offset.y, 2.0 * offset.x * offset.y)
    };
    ring.iter().map(doubled).sum()
}

/// The angle of an axis with this orientation.
fn axis(orientation: &Vector2<f64>) -> f64 {
    0.5 * orientation.y.atan2(orientation.x)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::body::ChainForm;

    #[test]
    fn a_cell_is_inclined_as_it_is_turned() {
        for angle in [-1.2, 0.0, 0.4, 1.5] {
            let ring = ChainForm::cell(0.1, 24, 0.21).at(&Vector2::new(3.0, 1.0), &Vector3::new(0.0, 0.0, angle));
            assert!((axis(&orientation(&ring)) - angle).abs() < 1e-9);
        }
    }
}
