//! Volume fractions: the part of a box that a ball fills.
//!
//! In the plane the area is exact: each edge of the rectangle, seen from the centre of the disk, sweeps triangles where it lies in the
//! disk and sectors where it does not. In space the areas of slices are integrated; between the heights at which a slice
//! changes its shape they are smooth but for roots at the ends, which a cubic substitution removes (relative error below 1e-9).

use std::sync::LazyLock;

use nalgebra::{Complex, SVector, Vector2};

use super::Ball;
use crate::linalg::gauss_legendre;

/// Gauss's rule of 12 points on `[-1, 1]`.
static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(12));

/// The part, from 0 to 1, of the box of the given centre and edge lengths that the ball fills; exact in 2D.
///
/// Periodic images are the caller's business.
///
/// # Panics
/// If the dimension is neither 2 nor 3.
pub fn fraction<const D: usize>(ball: &Ball<D>, center: &SVector<f64, D>, size: &SVector<f64, D>) -> f64 {
    if !touches(ball, center, size) {
        return 0.0;
    }
    let (offset, radius) = (center - ball.center, ball.radius);
    let farthest = offset.zip_map(size, |offset, size| offset.abs() + 0.5 * size);
    if farthest.norm() <= radius {
        return 1.0;
    }
    let (lower, upper) = (offset - size * 0.5, offset + size * 0.5);
    let rectangle = [lower, upper].map(|corner| Vector2::new(corner[0], corner[1]));
    let filled = match D {
        2 => disk_area(radius, &rectangle),
        3 => slices(radius, &rectangle, [lower[2], upper[2]]),
        _ => panic!("volume fractions exist in dimension 2 and 3, not {D}"),
    };
    (filled / size.product()).clamp(0.0, 1.0)
}

/// Whether the ball reaches into the box of the given centre and edge lengths.
pub fn touches<const D: usize>(ball: &Ball<D>, center: &SVector<f64, D>, size: &SVector<f64, D>) -> bool {
    (center - ball.center).zip_map(size, |offset, size| (offset.abs() - 0.5 * size).max(0.0)).norm() < ball.radius
}

/// Area that the disk around the origin and the rectangle between two corners have in common.
fn disk_area(radius: f64, [lower, upper]: &[Vector2<f64>; 2]) -> f64 {
    // a slice at the very end of a ball
    if radius == 0.0 {
        return 0.0;
    }
    let corners = [*lower, Vector2::new(upper[0], lower[1]), *upper, Vector2::new(lower[0], upper[1])];
    let edges: [Swept; 4] = std::array::from_fn(|corner| swept(radius, corners[corner], corners[(corner + 1) % 4]));
    let angle: f64 = if lower.max() <= 0.0 && upper.min() >= 0.0 {
        edges.iter().map(|edge| edge.turn.arg()).sum()
    } else {
        // seen from outside, a rectangle takes less than half a turn
        edges.iter().map(|edge| edge.turn).product::<Complex<f64>>().arg()
    };
    edges.iter().map(|edge| edge.triangle).sum::<f64>() + 0.5 * radius * radius * angle
}

/// What a segment sweeps of a disk as seen from its centre, positive if it runs counter-clockwise.
struct Swept {
    /// Area where it lies in the disk.
    triangle: f64,
    /// A number whose angle is that by which it turns where it lies outside.
    turn: Complex<f64>,
}

fn swept(radius: f64, start: Vector2<f64>, end: Vector2<f64>) -> Swept {
    let along = end - start;
    let turn = |from: Vector2<f64>, to: Vector2<f64>| Complex::new(from.dot(&to), from.perp(&to)) / (radius * radius);
    // |start + t along|^2 = radius^2
    let (square, half) = (along.norm_squared(), start.dot(&along));
    let root = half * half - square * (start.norm_squared() - radius * radius);
    if root <= 0.0 {
        return Swept { triangle: 0.0, turn: turn(start, end) };
    }
    let [enter, leave] = [-1.0, 1.0].map(|sign: f64| ((sign * root.sqrt() - half) / square).clamp(0.0, 1.0));
    let (first, last) = (start + along * enter, start + along * leave);
    let outside = |from, to, length: f64| if length > 0.0 { turn(from, to) } else { Complex::new(1.0, 0.0) };
    Swept { triangle: 0.5 * first.perp(&last), turn: outside(start, first, enter) * outside(last, end, 1.0 - leave) }
}

/// Volume that the ball around the origin and the rectangle between two heights have in common.
fn slices(radius: f64, rectangle: &[Vector2<f64>; 2], [bottom, top]: [f64; 2]) -> f64 {
    let area = |height: f64| disk_area((radius * radius - height * height).max(0.0).sqrt(), rectangle);
    let heights = turning_heights(radius, rectangle, [bottom.max(-radius), top.min(radius)]);
    let [nearest, farthest] = distances(rectangle);
    let piece = |ends: &[f64]| {
        let (start, length) = (ends[0], ends[1] - ends[0]);
        // no slice of a piece passes a corner or an edge
        let middle = radius * radius - (start + 0.5 * length).powi(2);
        if middle <= nearest {
            return 0.0;
        } else if middle >= farthest {
            return length * (rectangle[1] - rectangle[0]).product();
        }
        let at = |t: f64| 6.0 * t * (1.0 - t) * area(start + length * t * t * (3.0 - 2.0 * t));
        0.5 * length * RULE.iter().map(|(node, weight)| weight * at(0.5 * (1.0 + node))).sum::<f64>()
    };
    heights.windows(2).map(piece).sum()
}

/// Squares of the distances of the nearest and the farthest point of a rectangle from the origin.
fn distances([lower, upper]: &[Vector2<f64>; 2]) -> [f64; 2] {
    let nearest = lower.zip_map(upper, |lower, upper| lower.max(-upper).max(0.0));
    [nearest.norm_squared(), lower.abs().sup(&upper.abs()).norm_squared()]
}

/// Heights, in order, at which the circle of a slice passes an edge or a corner of the rectangle, with both ends.
fn turning_heights(radius: f64, [lower, upper]: &[Vector2<f64>; 2], [bottom, top]: [f64; 2]) -> Vec<f64> {
    let columns = [0.0, lower[0], upper[0]];
    let distances = columns.iter().flat_map(|x| [0.0, lower[1], upper[1]].map(|y| x * x + y * y));
    let turns = distances.map(|squared| (radius * radius - squared).sqrt()).filter(|height| !height.is_nan());
    let mut heights: Vec<f64> = turns.flat_map(|height| [-height, height]).filter(|height| bottom < *height && *height < top).collect();
    heights.extend([bottom, top]);
    heights.sort_by(f64::total_cmp);
    heights
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn half_planes_and_quadrants_cut_what_they_should() {
        let ball = Ball { center: Vector2::new(0.3, -0.2), radius: 0.5 };
        let of = |x: f64, y: f64, width: f64, height: f64| fraction(&ball, &Vector2::new(x, y), &Vector2::new(width, height));
        assert!((of(0.3, -0.2, 4.0, 4.0) * 16.0 - ball.volume()).abs() < 1e-14);
        assert!((of(1.3, -0.2, 2.0, 4.0) * 8.0 - 0.5 * ball.volume()).abs() < 1e-14);
        assert!((of(1.3, 0.8, 2.0, 2.0) * 4.0 - 0.25 * ball.volume()).abs() < 1e-14);
        // a segment of height 0.2: r^2 acos(0.6) - 0.3 * 0.4
        assert!((of(1.6, -0.2, 2.0, 4.0) * 8.0 - (0.25 * 0.6_f64.acos() - 0.12)).abs() < 1e-14);
        assert_eq!((of(0.3, -0.2, 0.1, 0.1), of(2.0, 2.0, 0.1, 0.1)), (1.0, 0.0));
    }

    #[test]
    fn octants_and_caps_of_a_sphere_have_the_volumes_of_the_textbook() {
        let ball = Ball { center: Vector3::new(0.3, -0.2, 0.1), radius: 0.5 };
        let of = |offset: [f64; 3]| fraction(&ball, &(ball.center + Vector3::from(offset)), &Vector3::repeat(2.0)) * 8.0;
        assert!((of([1.0, 1.0, 1.0]) * 8.0 - ball.volume()).abs() < 1e-9);
        // a cap of height 0.2: pi h^2 (3 r - h) / 3
        let cap = std::f64::consts::PI * 0.04 * 1.3 / 3.0;
        for axis in 0..3 {
            let mut offset = [0.0; 3];
            offset[axis] = -1.3;
            assert!((of(offset) - cap).abs() < 1e-9, "cap along axis {axis}: {}", of(offset));
        }
    }

    #[test]
    fn a_ball_at_a_corner_of_cells_fills_a_part_of_each() {
        let (edge, ball) = (1.0 / 12.0, Ball { center: Vector3::new(3.0, 4.0, 5.0), radius: 1.0 });
        let first = ball.center * 12.0 - Vector3::repeat(13.0);
        let middle = |place: usize| (first + Vector3::from_fn(|axis, _| (place / 26_usize.pow(axis as u32) % 26) as f64 + 0.5)) * edge;
        let filled: Vec<f64> = (0..26_usize.pow(3)).map(|place| fraction(&ball, &middle(place), &Vector3::repeat(edge))).collect();
        assert!(filled.iter().all(|part| (0.0..=1.0).contains(part)));
        assert!((filled.iter().sum::<f64>() * edge.powi(3) / ball.volume() - 1.0).abs() < 1e-9);
    }

    /// Cells of unequal edges, some of which the ball just touches, fill up to its volume.
    fn cells_add_up<const D: usize>(ball: &Ball<D>, tolerance: f64) {
        let size = SVector::<f64, D>::from_fn(|axis, _| 0.2 + 0.01 * axis as f64);
        let indices =
            (0..12_usize.pow(D as u32)).map(|place| SVector::<f64, D>::from_fn(|axis, _| (place / 12_usize.pow(axis as u32) % 12) as f64));
        let sum: f64 = indices.map(|index| fraction(ball, &(index.component_mul(&size) - size * 6.0), &size)).sum();
        assert!((sum * size.product() / ball.volume() - 1.0).abs() < tolerance, "{sum}");
    }

    #[test]
    fn fractions_of_all_cells_add_up_to_the_ball() {
        cells_add_up(&Ball { center: Vector2::new(0.013, -0.05), radius: 0.777 }, 1e-13);
        cells_add_up(&Ball { center: Vector2::new(0.1, 0.105), radius: 0.8 }, 1e-13);
        cells_add_up(&Ball { center: Vector3::new(0.013, -0.05, 0.02), radius: 0.777 }, 1e-9);
        cells_add_up(&Ball { center: Vector3::new(0.1, 0.105, 0.11), radius: 0.8 }, 1e-9);
    }
}
