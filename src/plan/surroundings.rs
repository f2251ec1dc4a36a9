//! Which bodies have their near neighbours in opposite places, as in lattices and midway between walls.
//!
//! The flow around such a body has a parity: of the modes that a lone neighbour excites, every other one is still. The orders that are left carry
//! what two opposite neighbours do at once, which is not the sum of what each does alone.

use nalgebra::SVector;

use crate::geometry::{Ball, Domain, near_pairs, near_walls};

/// Largest gap to a neighbour that counts, in radii.
const REACH: f64 = 1.0;

/// How far a place may be from the opposite one, in radii.
const SLACK: f64 = 1e-3;

/// A neighbour as a body sees it: where its surface is nearest, and its curvature.
type Neighbour<const D: usize> = (SVector<f64, D>, f64);

/// For each body, whether it has near neighbours and each of them has another one opposite.
pub fn opposite_neighbours<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Vec<bool> {
    let of_body = neighbours(domain, balls);
    balls.iter().zip(&of_body).map(|(ball, neighbours)| !neighbours.is_empty() && in_opposite_places(neighbours, ball.radius)).collect()
}

fn neighbours<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Vec<Vec<Neighbour<D>>> {
    let mut of_body = vec![Vec::new(); balls.len()];
    let largest = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let mut add = |body: usize, gap: f64, normal: SVector<f64, D>, curvature: f64| {
        if gap < REACH * balls[body].radius {
            of_body[body].push((normal * (balls[body].radius + gap), curvature));
        }
    };
    for pair in near_pairs(domain, balls, REACH * largest) {
        let normal = pair.separation.normalize();
        add(pair.first, pair.gap, normal, 1.0 / balls[pair.second].radius);
        add(pair.second, pair.gap, -normal, 1.0 / balls[pair.first].radius);
    }
    for near in near_walls(domain, balls, REACH * largest) {
        let mut normal = SVector::zeros();
        normal[near.axis] = if near.upper { 1.0 } else { -1.0 };
        add(near.body, near.gap, normal, 0.0);
    }
    of_body
}

fn in_opposite_places<const D: usize>(neighbours: &[Neighbour<D>], radius: f64) -> bool {
    let opposite = |(place, curvature): &Neighbour<D>, (other, others): &Neighbour<D>| {
        (place + other).norm() < SLACK * radius && (curvature - others).abs() * radius < SLACK
    };
    neighbours.iter().all(|one| neighbours.iter().any(|other| opposite(one, other)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    const WALLS: Axis<2> = Axis::Walls { lower: SVector::<f64, 2>::new(0.0, 0.0), upper: SVector::<f64, 2>::new(0.0, 0.0) };

    fn found<const D: usize>(size: [f64; D], axes: [Axis<D>; D], centers: &[[f64; D]]) -> Vec<bool> {
        let balls: Vec<Ball<D>> = centers.iter().map(|center| Ball { center: SVector::from(*center), radius: 1.0 }).collect();
        opposite_neighbours(&Domain { size: SVector::from(size), axes }, &balls)
    }

    #[test]
    fn lattices_have_opposite_neighbours_and_loose_ones_have_none() {
        let periodic = [Axis::Periodic; 3];
        assert_eq!(found([2.8; 3], periodic, &[[0.7, 0.8, 0.9]]), [true]);
        assert_eq!(found([3.0; 3], periodic, &[[0.7; 3], [2.2; 3]]), [true, true]);
        assert_eq!(found([3.0; 3], periodic, &[[0.7; 3], [2.2, 2.2, 2.3]]), [false, false]);
        assert_eq!(found([8.0; 3], periodic, &[[0.7; 3]]), [false]);
    }

    #[test]
    fn a_body_midway_between_walls_has_opposite_neighbours() {
        assert_eq!(found([6.0, 2.4], [Axis::Periodic, WALLS], &[[3.0, 1.2]]), [true]);
        assert_eq!(found([6.0, 2.4], [Axis::Periodic, WALLS], &[[3.0, 1.1]]), [false]);
    }
}
