//! How red cells lie and move: what their membranes enclose, how they incline, and how far a membrane has gone around.

use nalgebra::{SVector, Vector2};

use crate::interaction::{Conserved, Interactions};

/// Cells at an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct MembraneNumbers {
    /// Of each measure that membranes keep: its name, its mean, and the largest part by which one differs from that at rest. In 2D the area that
    /// beads' centres enclose, in 3D volume and surface.
    pub kept: Vec<(&'static str, f64, f64)>,
    /// Angle from x of the long axis of cells, as the first two axes of space see them, in radians, from `-pi/2` to `pi/2`, of the mean of their orientations.
    pub inclination: f64,
    /// Angle from the long axis of the first cell to its first bead, in radians, from `-pi` to `pi` (an axis has two ends, so that it jumps by `pi` where
    /// the inclination does): it turns as the membrane does, like the tread of a tank.
    pub tread: f64,
}

impl MembraneNumbers {
    /// Those of all bodies with these centres; nothing without cells.
    pub fn of<const D: usize>(interactions: &Interactions<D>, centers: &[SVector<f64, D>]) -> Option<MembraneNumbers> {
        let conserved = interactions.conserved();
        let membranes: Vec<&[Conserved]> = conserved.chunk_by(|one, other| one.bodies == other.bodies).collect();
        let outlines: Vec<Vec<Vector2<f64>>> = membranes.iter().map(|membrane| outline(centers, &membrane[0])).collect();
        let first = outlines.first()?;
        let mean: Vector2<f64> = outlines.iter().map(|outline| orientation(outline).normalize()).sum();
        let to_first = first[0] - middle(first);
        let turned = to_first.y.atan2(to_first.x) - axis(&orientation(first));
        Some(MembraneNumbers {
            kept: (0..membranes[0].len()).map(|measure| kept(centers, membranes.iter().map(|membrane| &membrane[measure]))).collect(),
            inclination: axis(&mean),
            tread: turned.sin().atan2(turned.cos()),
        })
    }
}

/// Mean and largest error of a measure of all membranes.
fn kept<'a, const D: usize>(centers: &[SVector<f64, D>], all: impl Iterator<Item = &'a Conserved>) -> (&'static str, f64, f64) {
    let (mut name, mut sum, mut count, mut worst) = ("", 0.0, 0.0, 0.0_f64);
    for conserved in all {
        let found = conserved.measured(&|body: usize| centers[body]);
        (name, sum, count) = (conserved.measure.name(), sum + found, count + 1.0);
        worst = worst.max((found / conserved.value - 1.0).abs());
    }
    (name, sum / count, worst)
}

/// The beads of a membrane as the first two axes of space see them.
fn outline<const D: usize>(centers: &[SVector<f64, D>], conserved: &Conserved) -> Vec<Vector2<f64>> {
    let flat = |center: &SVector<f64, D>| center.fixed_rows::<2>(0).into_owned();
    centers[conserved.bodies.clone()].iter().map(flat).collect()
}

/// The mean place.
pub(super) fn middle(ring: &[Vector2<f64>]) -> Vector2<f64> {
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
pub(super) fn axis(orientation: &Vector2<f64>) -> f64 {
    0.5 * orientation.y.atan2(orientation.x)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::body::{ChainForm, Outline};

    #[test]
    fn a_cell_is_inclined_as_it_is_turned() {
        for angle in [-1.2, 0.0, 0.4, 1.5] {
            let ring = ChainForm::cell(&Outline::default(), 0.1, 24, 0.21).at(&Vector2::new(3.0, 1.0), &Vector3::new(0.0, 0.0, angle));
            assert!((axis(&orientation(&ring)) - angle).abs() < 1e-9);
        }
    }
}
