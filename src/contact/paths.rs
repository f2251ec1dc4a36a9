//! Paths of a step: which pairs come near each other on the way, however far bodies fly.
//!
//! Each body is enclosed in a ball around its straight path, seen from the common motion of all. Pairs of
//! such balls that meet are all pairs that can meet, periodic images included. Where images slide, the common motion is
//! a shear, in which all images of a body take the same part; balls are larger for what it does to pairs.

use nalgebra::SVector;

use super::{Contact, Problem};
use crate::geometry::{Ball, near_pairs, near_walls};

/// What becomes of a pair in a step.
pub(super) struct Path<const D: usize> {
    /// The pair before the step.
    pub contact: Contact<D>,
    /// Smallest gap on the way.
    pub smallest_gap: f64,
    /// Gap after the step.
    pub last_gap: f64,
}

/// All pairs with a gap below `margin` (in radii) somewhere on the way, and others; pairs of which nobody gives way are left out.
pub(super) fn paths<const D: usize>(problem: &Problem<D>, velocities: &[SVector<f64, D>], margin: f64) -> Vec<Path<D>> {
    let moves: Vec<_> = velocities.iter().map(|velocity| velocity * problem.step).collect();
    let mut paths = body_paths(problem, &moves, margin);
    paths.extend(wall_paths(problem, &moves, margin));
    paths
}

/// Balls that enclose what bodies cover in a step, seen from the common motion, in the places of half the step.
pub(super) fn swept_balls<const D: usize>(problem: &Problem<D>, moves: &[SVector<f64, D>], margin: f64) -> Vec<Ball<D>> {
    let Problem { domain, balls, step, .. } = *problem;
    let own: Vec<_> = balls.iter().zip(moves).map(|(ball, own)| own - domain.carried(&ball.center) * step).collect();
    let common = common_move(&own);
    // of two that meet, half the strain moves one centre aside by that part of their distance along y
    let strain = (domain.shear_rate() * step).abs();
    let around = |((ball, moved), own): ((&Ball<D>, &SVector<f64, D>), &SVector<f64, D>)| {
        let swept = (own - common).norm() / 2.0;
        let radius = ball.radius * (1.0 + margin / 2.0) * (1.0 + strain / 2.0) + swept * (1.0 + strain);
        Ball { center: ball.center + moved / 2.0, radius }
    };
    balls.iter().zip(moves).zip(&own).map(around).collect()
}

fn body_paths<const D: usize>(problem: &Problem<D>, moves: &[SVector<f64, D>], margin: f64) -> Vec<Path<D>> {
    let Problem { domain, balls, step, .. } = *problem;
    let halfway = domain.after(step / 2.0);
    let swept = swept_balls(problem, moves, margin);
    let mut paths = Vec::new();
    for pair in near_pairs(&halfway, &swept, 0.0) {
        let (first, second) = (pair.first, pair.second);
        if first == second || !(problem.gives_way(first) || problem.gives_way(second)) {
            continue;
        }
        let image = halfway.image(pair.separation - (swept[second].center - swept[first].center));
        let relative = moves[second] - moves[first] + domain.sliding() * (image[1] as f64 * step);
        let contact = Contact::between(domain, balls, [first, second], pair.separation - relative / 2.0);
        let radii = balls[first].radius + balls[second].radius;
        let separation = contact.normal * contact.separation;
        let nearest = (separation + relative * time_of_approach(&separation, &relative)).norm() - radii;
        let last_gap = (separation + relative).norm() - radii;
        paths.push(Path { contact, smallest_gap: nearest.min(contact.gap).min(last_gap), last_gap });
    }
    paths
}

fn wall_paths<const D: usize>(problem: &Problem<D>, moves: &[SVector<f64, D>], margin: f64) -> Vec<Path<D>> {
    let Problem { domain, balls, weights, .. } = *problem;
    let reach = |body: usize| margin * balls[body].radius + moves[body].norm();
    let longest = (0..balls.len()).map(reach).fold(0.0, f64::max);
    let near = near_walls(domain, balls, longest).into_iter();
    near.filter(|pair| weights[pair.body].is_finite() && pair.gap <= reach(pair.body))
        .map(|pair| {
            let contact = Contact::of_wall(domain, balls, pair.body, pair.axis, pair.upper);
            let last_gap = contact.gap + contact.opening(moves);
            Path { contact, smallest_gap: contact.gap.min(last_gap), last_gap }
        })
        .collect()
}

/// Part of the step after which two bodies are nearest.
fn time_of_approach<const D: usize>(separation: &SVector<f64, D>, relative: &SVector<f64, D>) -> f64 {
    let length = relative.norm();
    if length > 0.0 { (-separation.dot(&(relative / length)) / length).clamp(0.0, 1.0) } else { 0.0 }
}

/// The median of the moves, axis by axis: a few fast bodies do not change it.
fn common_move<const D: usize>(moves: &[SVector<f64, D>]) -> SVector<f64, D> {
    SVector::from_fn(|axis, _| {
        let mut components: Vec<f64> = moves.iter().map(|own| own[axis]).collect();
        let middle = components.len() / 2;
        if components.is_empty() { 0.0 } else { *components.select_nth_unstable_by(middle, f64::total_cmp).1 }
    })
}
