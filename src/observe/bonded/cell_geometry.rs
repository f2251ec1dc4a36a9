//! Place and form of one closed outline or membrane.

use std::f64::consts::PI;

use nalgebra::{Matrix3, SVector, Vector2, Vector3};

use super::membranes::{axis, middle};
use crate::{interaction::Measure, linalg::ROUNDING};

/// A cell at an instant: the outline through the centres of its beads in 2D, the surface of triangles between them in 3D.
///
/// Its axes are those of the ellipse or the ellipsoid whose second moments are those of what it encloses. They are not numbers where an outline
/// crosses itself so that it encloses nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellGeometry<const D: usize> {
    /// Mean of the centres of its beads.
    pub center: SVector<f64, D>,
    /// The area that it encloses, in 3D the volume.
    pub enclosed: f64,
    /// Its perimeter, in 3D its surface.
    pub boundary: f64,
    /// What it encloses over what a circle or a sphere of the same boundary does: `4 pi A / P^2` in 2D, `6 sqrt(pi) V / S^(3/2)` in 3D.
    pub reduced: f64,
    /// Taylor's deformation `(L - B) / (L + B)` with the longest axis `L` and the shortest axis `B` (Taylor 1934, doi:10.1098/rspa.1934.0169).
    pub deformation: f64,
    /// Angle from x of the long axis, as the first two axes of space see it, in radians, from `-pi/2` to `pi/2`; not a number of a circle.
    pub inclination: f64,
}

/// The boundary of a cell of so many beads: edges of its outline in 2D, triangles in 3D, with corners counted from its first bead.
pub fn facets<const D: usize>(measure: &Measure, beads: usize) -> Vec<[usize; D]> {
    let faces = measure.faces(beads);
    match measure {
        Measure::EnclosedArea => (0..beads).map(|bead| std::array::from_fn(|corner| (bead + corner) % beads)).collect(),
        Measure::Volume(_) | Measure::Surface(_) => faces.iter().map(|face| std::array::from_fn(|corner| face[corner])).collect(),
    }
}

impl<const D: usize> CellGeometry<D> {
    /// That of a cell of beads with these centres and these [`facets`].
    pub fn of(beads: &[SVector<f64, D>], facets: &[[usize; D]]) -> CellGeometry<D> {
        let Moments { enclosed, boundary, first, second } = Moments::of(beads, facets);
        let mean = first / enclosed;
        let spread = second / enclosed - mean * mean.transpose();
        let [long, short] = extremes::<D>(&spread).map(f64::sqrt);
        let full = if D == 2 { boundary.powi(2) / (4.0 * PI) } else { boundary.powf(1.5) / (6.0 * PI.sqrt()) };
        CellGeometry {
            center: beads[0] + beads.iter().map(|bead| bead - beads[0]).sum::<SVector<f64, D>>() / beads.len() as f64,
            enclosed: enclosed.abs(),
            boundary,
            reduced: enclosed.abs() / full,
            deformation: (long - short) / (long + short),
            inclination: inclination(&spread),
        }
    }
}

/// See [`CellGeometry::inclination`].
fn inclination(spread: &Matrix3<f64>) -> f64 {
    let doubled = Vector2::new(spread.m11 - spread.m22, 2.0 * spread.m12);
    if doubled.norm() <= ROUNDING * (spread.m11 + spread.m22) { f64::NAN } else { axis(&doubled) }
}

/// The largest and the smallest eigenvalue of a symmetric matrix, in 2D of its first two rows; not numbers where entries are none.
fn extremes<const D: usize>(matrix: &Matrix3<f64>) -> [f64; 2] {
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return [f64::NAN; 2];
    }
    if D == 2 {
        let (mean, half) = (0.5 * (matrix.m11 + matrix.m22), (0.5 * (matrix.m11 - matrix.m22)).hypot(matrix.m12));
        return [mean + half, mean - half];
    }
    let values = matrix.symmetric_eigenvalues();
    [values.max(), values.min()]
}

/// The mean over the beads of a ring of the angle from x at which the middle of all sees them, in radians, from `-pi` to `pi`. Angles go on from bead to
/// bead, so that the mean turns by as much as all beads do.
pub fn mean_phase(ring: &[Vector2<f64>]) -> f64 {
    let middle = middle(ring);
    let arms: Vec<Vector2<f64>> = ring.iter().map(|bead| bead - middle).collect();
    let (mut from_first, mut sum) = (0.0, 0.0);
    for pair in arms.windows(2) {
        from_first += pair[0].perp(&pair[1]).atan2(pair[0].dot(&pair[1]));
        sum += from_first;
    }
    let mean = arms[0].y.atan2(arms[0].x) + sum / ring.len() as f64;
    mean.sin().atan2(mean.cos())
}

/// Integrals over what a boundary encloses, of places from its first corner; in 2D without third components.
struct Moments {
    enclosed: f64,
    boundary: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

impl Moments {
    /// Sums over the simplices between the first corner and each facet: of the integral of `x x` over one of them, with corners `a`, .. and the origin,
    /// each `a a` is a part `1 / ((D + 1) (D + 2))` of its content, and so is the square of their sum.
    fn of<const D: usize>(corners: &[SVector<f64, D>], facets: &[[usize; D]]) -> Moments {
        let place = |corner: &usize| {
            let way = corners[*corner] - corners[0];
            Vector3::from_fn(|axis, _| if axis < D { way[axis] } else { 0.0 })
        };
        let mut sums = Moments { enclosed: 0.0, boundary: 0.0, first: Vector3::zeros(), second: Matrix3::zeros() };
        for facet in facets {
            let arms: Vec<Vector3<f64>> = facet.iter().map(place).collect();
            let (content, size) = match arms[..] {
                [one, two] => (0.5 * one.xy().perp(&two.xy()), (two - one).norm()),
                [one, two, three] => (one.dot(&two.cross(&three)) / 6.0, 0.5 * (two - one).cross(&(three - one)).norm()),
                _ => unreachable!("facets are edges or triangles"),
            };
            let sum: Vector3<f64> = arms.iter().sum();
            let squares = arms.iter().map(|arm| arm * arm.transpose()).sum::<Matrix3<f64>>() + sum * sum.transpose();
            sums.enclosed += content;
            sums.boundary += size;
            sums.first += sum * (content / (D + 1) as f64);
            sums.second += squares * (content / ((D + 1) * (D + 2)) as f64);
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::TAU, rc::Rc};

    use nalgebra::{Rotation2, Rotation3};

    use super::*;

    /// Points on an ellipse at equal parameters, the affine image of a regular polygon.
    fn ellipse([long, short]: [f64; 2], count: usize, turned: f64) -> Vec<Vector2<f64>> {
        let place = |point: usize| {
            let (sin, cos) = f64::sin_cos(TAU * point as f64 / count as f64);
            Vector2::new(17.0, -3.0) * long + Rotation2::new(turned) * Vector2::new(long * cos, short * sin)
        };
        (0..count).map(place).collect()
    }

    fn of_ring(ring: &[Vector2<f64>]) -> CellGeometry<2> {
        CellGeometry::of(ring, &facets(&Measure::EnclosedArea, ring.len()))
    }

    #[test]
    fn points_on_an_ellipse_have_its_deformation_and_inclination_in_any_unit_and_either_way_around() {
        for (scale, angle) in [(1.0, 0.4), (1e-6, -1.2), (1e6, 1.5)] {
            let mut ring = ellipse([2.0 * scale, 0.5 * scale], 40, angle);
            for _ in 0..2 {
                let found = of_ring(&ring);
                // (2 - 0.5) / (2 + 0.5)
                assert!((found.deformation - 0.6).abs() < 1e-10 && (found.inclination - angle).abs() < 1e-10, "{found:?}");
                assert!((found.center - Vector2::new(34.0, -6.0) * scale).norm() < 1e-11 * scale, "{found:?}");
                ring.reverse();
            }
        }
    }

    #[test]
    fn a_regular_polygon_encloses_its_area() {
        for count in [3, 6, 48] {
            let (step, found) = (TAU / count as f64, of_ring(&ellipse([1.5, 1.5], count, 0.3)));
            let (area, perimeter) = (0.5 * count as f64 * 2.25 * step.sin(), 3.0 * count as f64 * (0.5 * step).sin());
            assert!((found.enclosed - area).abs() < 1e-12 && (found.boundary - perimeter).abs() < 1e-12);
            assert!((found.reduced - 0.5 * step / (0.5 * step).tan()).abs() < 1e-12, "{found:?}");
            assert!(found.deformation.abs() < 1e-12 && found.inclination.is_nan(), "{found:?}");
        }
    }

    /// An octahedron has the second moments of a sphere, and its affine image those of an ellipsoid.
    #[test]
    fn an_octahedron_that_is_drawn_out_has_the_deformation_of_its_axes() {
        let triangles = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let facets = facets(&Measure::Surface(Rc::new(triangles)), 6);
        let corners = |axes: Vector3<f64>, turn: f64| -> Vec<Vector3<f64>> {
            let ends = (0..3).flat_map(|axis| [1.0, -1.0].map(|end| Vector3::ith(axis, end * axes[axis])));
            ends.map(|end| Vector3::new(7.0, 8.0, 9.0) + Rotation3::from_axis_angle(&Vector3::z_axis(), turn) * end).collect()
        };
        let found = CellGeometry::of(&corners(Vector3::new(3.0, 1.0, 2.0), 0.3), &facets);
        // 4/3 abc
        assert!((found.enclosed - 8.0).abs() < 1e-12 && (found.center - Vector3::new(7.0, 8.0, 9.0)).norm() < 1e-12, "{found:?}");
        assert!((found.deformation - 0.5).abs() < 1e-12 && (found.inclination - 0.3).abs() < 1e-12, "{found:?}");
        let found = CellGeometry::of(&corners(Vector3::repeat(1.0), 0.3), &facets);
        let surface = 4.0 * 3.0_f64.sqrt();
        assert!((found.boundary - surface).abs() < 1e-12 && found.deformation.abs() < 1e-12 && found.inclination.is_nan(), "{found:?}");
        assert!((found.reduced - 8.0 * PI.sqrt() / surface.powf(1.5)).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn the_mean_phase_turns_as_the_beads_do() {
        let ring = ellipse([2.0, 0.5], 24, 0.0);
        let middle = middle(&ring);
        let off = |ring: &[Vector2<f64>], start: f64, angle: f64| {
            let off = mean_phase(ring) - start - angle;
            (off - TAU * (off / TAU).round()).abs()
        };
        let start = mean_phase(&ring);
        for step in 0..50 {
            let angle = 0.37 * f64::from(step);
            let turned: Vec<Vector2<f64>> = ring.iter().map(|bead| middle + Rotation2::new(angle) * (bead - middle)).collect();
            assert!(off(&turned, start, angle) < 1e-12, "{step}");
        }
        // beads that go around along their outline by one place have turned by one part of it in the mean
        let treaded: Vec<Vector2<f64>> = (0..24).map(|bead| ring[(bead + 1) % 24]).collect();
        assert!(off(&treaded, start, TAU / 24.0) < 1e-12);
    }

    #[test]
    fn an_outline_that_encloses_nothing_has_no_deformation() {
        let crossed = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
        assert!(!of_ring(&crossed).deformation.is_finite());
    }
}
