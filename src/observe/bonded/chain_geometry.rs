//! Place and form of one chain.

use nalgebra::SVector;

use super::chains::gyration_tensor;

/// A chain at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainGeometry<const D: usize> {
    /// Mean of the centres of its beads, weighted by their volumes, in 2D by their areas.
    pub center: SVector<f64, D>,
    /// From the first bead to the last; nothing of a ring, which has no ends.
    pub end_to_end: Option<SVector<f64, D>>,
    /// Sum of the lengths of its bonds, of a ring with the one that closes it.
    pub contour_length: f64,
    /// Root of the mean square distance of beads from their mean.
    pub gyration: f64,
}

impl<const D: usize> ChainGeometry<D> {
    /// That of a chain of beads with these centres and radii, one or more.
    pub fn of(beads: &[SVector<f64, D>], radii: &[f64], ring: bool) -> ChainGeometry<D> {
        let (first, last) = (beads[0], beads[beads.len() - 1]);
        let weights = || radii.iter().map(|radius| (radius / radii[0]).powi(D as i32));
        let offset = beads.iter().zip(weights()).map(|(bead, weight)| (bead - first) * weight).sum::<SVector<f64, D>>();
        let along: f64 = beads.windows(2).map(|bond| (bond[1] - bond[0]).norm()).sum();
        ChainGeometry {
            center: first + offset / weights().sum::<f64>(),
            end_to_end: (!ring).then(|| last - first),
            contour_length: along + if ring { (first - last).norm() } else { 0.0 },
            gyration: gyration_tensor(beads).trace().sqrt(),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::f64::consts::TAU;

    use nalgebra::{Vector2, Vector3};

    use super::*;

    #[test]
    fn a_straight_chain_is_as_long_as_its_bonds() {
        for scale in [1.0, 1e-6] {
            let way = Vector3::new(2.0, 3.0, 6.0) * scale;
            let beads: Vec<Vector3<f64>> = (0..5).map(|bead| Vector3::repeat(40.0 * scale) + way * f64::from(bead)).collect();
            let found = ChainGeometry::of(&beads, &[0.5 * scale; 5], false);
            assert!((found.center - beads[2]).norm() < 1e-12 * scale && (found.end_to_end.unwrap() - way * 4.0).norm() < 1e-12 * scale);
            // the mean of 4, 1, 0, 1, 4 is 2
            let expected = [28.0 * scale, 7.0 * 2.0_f64.sqrt() * scale];
            assert!((found.contour_length - expected[0]).abs() < 1e-12 * scale && (found.gyration - expected[1]).abs() < 1e-12 * scale);
        }
    }

    #[test]
    fn large_beads_weigh_by_their_area_in_2d_and_by_their_volume_in_3d() {
        let flat = ChainGeometry::of(&[Vector2::zeros(), Vector2::x()], &[1.0, 2.0], false);
        let in_space = ChainGeometry::of(&[Vector3::zeros(), Vector3::x()], &[1.0, 2.0], false);
        assert!((flat.center - Vector2::x() * 0.8).norm() < 1e-15 && (in_space.center - Vector3::x() * (8.0 / 9.0)).norm() < 1e-15);
    }

    #[test]
    fn a_ring_has_no_ends_and_the_length_of_all_its_bonds() {
        let ring: Vec<Vector2<f64>> =
            (0..6).map(|bead| Vector2::new(f64::cos(TAU * f64::from(bead) / 6.0), f64::sin(TAU * f64::from(bead) / 6.0))).collect();
        let found = ChainGeometry::of(&ring, &[0.1; 6], true);
        assert!(found.end_to_end.is_none() && (found.contour_length - 6.0).abs() < 1e-14 && (found.gyration - 1.0).abs() < 1e-14);
    }
}
