//! How long bodies in Stokes flow take to move as seen by what is near them, and how far a step errs: what the length of a step depends on.
//!
//! What moves along as a whole changes nothing: bodies are followed relative to their neighbours, to walls and to the mean shear, so that the number of
//! steps for a strain does not grow with the box. The error of a step is how far the velocities that carried bodies are from the mean of those before and after it, the trapezoidal rule: of
//! third order in the step where velocities are smooth, as the errors of both rules are, and of first order where contacts come and go, as their error is then.

use nalgebra::SVector;

use crate::geometry::{Ball, Domain, near_pairs, near_walls};

/// Gaps, in radii of the largest body, up to which bodies and walls see each other.
const SIGHT: f64 = 2.0;

/// How many times what it may move relative to its neighbours a body moves relative to the mean of all.
const ALONE: f64 = 10.0;

/// How many times what bodies err on average a single one may.
const WORST: f64 = 10.0;

/// The time in which the first body moves by its radius: relative to a neighbour, by the smaller diameter of both and their gap; relative to a wall, by its
/// radius and the gap; relative to the mean motion of all bodies, by ten radii. Or that in which the box is sheared by a strain of one. Infinite if
/// nothing moves. The velocities are those of the balls where they are, images not wrapped.
pub fn time_of_travel<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], velocities: &[SVector<f64, D>]) -> f64 {
    let carried: Vec<SVector<f64, D>> =
        balls.iter().zip(velocities).map(|(ball, velocity)| velocity - domain.carried(&ball.center)).collect();
    let reach = SIGHT * balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let by_neighbours = near_pairs(domain, balls, reach).into_iter().map(|pair| {
        let relative = carried[pair.first] - carried[pair.second] - domain.carried(&pair.separation);
        (2.0 * balls[pair.first].radius.min(balls[pair.second].radius) + pair.gap.max(0.0)) / relative.norm()
    });
    let by_walls = near_walls(domain, balls, reach).into_iter().filter_map(|near| {
        let [lower, upper] = domain.axes[near.axis].ends()?;
        let relative = velocities[near.body] - if near.upper { upper } else { lower };
        Some((balls[near.body].radius + near.gap.max(0.0)) / relative.norm())
    });
    let own: Vec<SVector<f64, D>> = balls.iter().zip(&carried).map(|(ball, velocity)| velocity - between_walls(domain, ball)).collect();
    let mean = own.iter().sum::<SVector<f64, D>>() / own.len().max(1) as f64;
    let alone = balls.iter().zip(&own).map(|(ball, velocity)| ALONE * ball.radius / (velocity - mean).norm());
    by_neighbours.chain(by_walls).chain(alone).fold(1.0 / strain_rate(domain), f64::min)
}

/// The longest step in which bodies of these radii err by a part of their radius at most, after a last step in which they erred by so much. Infinite if they did
/// not.
pub fn accurate_step<const D: usize>(errors: &[(SVector<f64, D>, f64)], last_step: f64, error: f64) -> f64 {
    let squares: Vec<f64> = errors.iter().map(|(error, radius)| error.norm_squared() / radius.powi(2)).collect();
    // a sum of nothing is -0
    let mean = (squares.iter().fold(0.0, |sum, square| sum + square) / squares.len().max(1) as f64).sqrt();
    let worst = squares.iter().copied().fold(0.0, f64::max).sqrt();
    last_step * (error / mean.max(worst / WORST)).cbrt()
}

/// The velocity at the place of a ball in fluid that is sheared between walls which move.
fn between_walls<const D: usize>(domain: &Domain<D>, ball: &Ball<D>) -> SVector<f64, D> {
    let part = |axis: usize| {
        let [lower, upper] = domain.axes[axis].ends()?;
        Some(lower + (upper - lower) * (ball.center[axis] / domain.size[axis]))
    };
    (0..D).filter_map(part).sum()
}

/// The rate at which a box is sheared, by its images or by its walls.
pub(super) fn strain_rate<const D: usize>(domain: &Domain<D>) -> f64 {
    let by_walls = (0..D).filter_map(|axis| domain.axes[axis].ends().map(|[lower, upper]| (upper - lower).norm() / domain.size[axis]));
    by_walls.fold(domain.shear_rate().abs(), f64::max)
}

#[cfg(test)]
mod tests {
    use nalgebra::vector;

    use super::*;
    use crate::geometry::Axis;

    fn channel(height: f64, speed: f64) -> Domain<2> {
        let walls = Axis::Walls { lower: vector![-speed, 0.0], upper: vector![speed, 0.0] };
        Domain { size: vector![20.0, height], axes: [Axis::Periodic, walls] }
    }

    fn ball(x: f64, y: f64) -> Ball<2> {
        Ball { center: vector![x, y], radius: 1.0 }
    }

    #[test]
    fn shear_takes_as_many_steps_in_boxes_of_any_height() {
        for height in [12.0, 24.0, 48.0] {
            let domain = channel(height, 0.5 * height);
            let balls = [ball(3.0, 2.0), ball(3.5, 4.2), ball(9.0, height - 3.0)];
            let velocities = balls.map(|ball| vector![ball.center[1] - 0.5 * height, 0.0]);
            assert!((time_of_travel(&domain, &balls, &velocities) - 1.0).abs() < 1e-12, "{height}");
        }
    }

    #[test]
    fn bodies_that_move_as_one_have_all_the_time() {
        let domain = Domain { size: vector![20.0, 20.0], axes: [Axis::Periodic; 2] };
        let balls = [ball(3.0, 2.0), ball(3.5, 4.2)];
        assert_eq!(time_of_travel(&domain, &balls, &[vector![5.0, 1.0]; 2]), f64::INFINITY);
        // towards each other: a diameter and the gap
        let gap = (0.25_f64 + 2.2 * 2.2).sqrt() - 2.0;
        assert!((time_of_travel(&domain, &balls, &[vector![0.0, 1.0], vector![0.0, -1.0]]) - (2.0 + gap) / 2.0).abs() < 1e-12);
    }

    #[test]
    fn walls_at_rest_count_where_they_are_near() {
        let domain = channel(40.0, 0.0);
        assert!((time_of_travel(&domain, &[ball(3.0, 1.5)], &[vector![0.0, -1.0]]) - 1.5).abs() < 1e-12);
        assert_eq!(time_of_travel(&domain, &[ball(3.0, 20.0)], &[vector![0.0, -1.0]]), f64::INFINITY);
    }

    #[test]
    fn errors_of_third_order_ask_for_short_steps() {
        let errors = vec![(vector![0.08, 0.0], 1.0); 4];
        assert!((accurate_step(&errors, 0.05, 0.01) - 0.025).abs() < 1e-12);
        assert_eq!(accurate_step(&[(vector![0.0, 0.0], 1.0)], 0.05, 0.01), f64::INFINITY);
        assert_eq!(accurate_step::<2>(&[], 0.05, 0.01), f64::INFINITY);
        // one of many
        let mut errors = vec![(vector![0.0, 0.0], 1.0); 10_000];
        errors[7].0 = vector![0.8, 0.0];
        assert!((accurate_step(&errors, 0.05, 0.01) - 0.025).abs() < 1e-12);
    }
}
