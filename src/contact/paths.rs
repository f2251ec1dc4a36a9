//! Paths of a step: which pairs come near each other on the way, however far bodies fly.
//!
//! Each body is enclosed in a ball around its straight path, seen from the common motion of all. Pairs of
//! such balls that meet are all pairs that can meet, periodic images included. Where images slide, the common motion is
//! a shear, in which all images of a body take the same part; balls are larger for what it does to pairs.

use nalgebra::SVector;

use super::{Contact, Problem};
use crate::{
    geometry::{Ball, near_pairs, near_walls},
    parallel::Peers,
};

/// What becomes of a pair in a step.
pub(crate) struct Path<const D: usize> {
    /// The pair before the step.
    pub contact: Contact<D>,
    /// Smallest gap on the way.
    pub smallest_gap: f64,
    /// Gap after the step.
    pub last_gap: f64,
}

/// How bodies move in a step.
pub(crate) struct Motions<'a, const D: usize> {
    /// Their velocities.
    pub velocities: &'a [SVector<f64, D>],
    /// How all of them move together.
    pub common: SVector<f64, D>,
}

/// All pairs with a gap below `margin` (in radii) somewhere on the way, and others; pairs of which nobody gives way are left out, and those
/// that concern no body of which `own` is true.
pub(crate) fn paths<const D: usize>(problem: &Problem<D>, motions: &Motions<D>, margin: f64, own: impl Fn(usize) -> bool) -> Vec<Path<D>> {
    let mut paths = body_paths(problem, motions, margin, &own);
    paths.extend(wall_paths(problem, motions, margin).filter(|path| own(path.contact.body)));
    paths
}

/// How the bodies of all ranks move together, seen from the images: the median. Collective.
pub(crate) fn common_motion<const D: usize>(peers: Peers, problem: &Problem<D>, velocities: &[SVector<f64, D>]) -> SVector<f64, D> {
    let own: Vec<_> =
        problem.balls.iter().zip(velocities).map(|(ball, own)| (own - problem.domain.carried(&ball.center)) * problem.step).collect();
    SVector::from_fn(|axis, _| median(peers, own.iter().map(|own| own[axis]).collect()))
}

/// Balls that enclose what bodies cover in a step, seen from the common motion, in the places of half the step.
pub(crate) fn swept_balls<const D: usize>(problem: &Problem<D>, motions: &Motions<D>, margin: f64) -> Vec<Ball<D>> {
    let Problem { domain, balls, step, .. } = *problem;
    // of two that meet, half the strain moves one centre aside by that part of their distance along y
    let strain = (domain.shear_rate() * step).abs();
    let around = |(ball, velocity): (&Ball<D>, &SVector<f64, D>)| {
        let own = (velocity - domain.carried(&ball.center)) * step;
        let swept = (own - motions.common).norm() / 2.0;
        // a wall is no ball
        let own_radius = if ball.radius.is_finite() { ball.radius } else { 0.0 };
        let radius = own_radius * (1.0 + margin / 2.0) * (1.0 + strain / 2.0) + swept * (1.0 + strain);
        Ball { center: ball.center + velocity * step / 2.0, radius }
    };
    balls.iter().zip(motions.velocities).map(around).collect()
}

fn body_paths<const D: usize>(problem: &Problem<D>, motions: &Motions<D>, margin: f64, own: &impl Fn(usize) -> bool) -> Vec<Path<D>> {
    let Problem { domain, balls, step, .. } = *problem;
    let halfway = domain.after(step / 2.0);
    let swept = swept_balls(problem, motions, margin);
    let moved = |body: usize| motions.velocities[body] * step;
    let mut paths = Vec::new();
    for pair in near_pairs(&halfway, &swept, 0.0) {
        let (first, second) = (pair.first, pair.second);
        if first == second || !(problem.gives_way(first) || problem.gives_way(second)) || !(own(first) || own(second)) {
            continue;
        }
        if problem.wall.is_some_and(|wall| wall.apart([first, second])) {
            continue;
        }
        let image = halfway.image(pair.separation - (swept[second].center - swept[first].center));
        let relative = moved(second) - moved(first) + domain.sliding() * (image[1] as f64 * step);
        let contact = Contact::between(domain, balls, [first, second], pair.separation - relative / 2.0);
        if problem.within_cluster(&contact) {
            continue;
        }
        let radii = balls[first].radius + balls[second].radius;
        let separation = contact.normal * contact.separation;
        let nearest = (separation + relative * time_of_approach(&separation, &relative)).norm() - radii;
        let last_gap = (separation + relative).norm() - radii;
        paths.push(Path { contact, smallest_gap: nearest.min(contact.gap).min(last_gap), last_gap });
    }
    paths
}

fn wall_paths<const D: usize>(problem: &Problem<D>, motions: &Motions<D>, margin: f64) -> impl Iterator<Item = Path<D>> {
    let Problem { domain, balls, weights, step, wall, .. } = *problem;
    let approach = wall.map_or(0.0, |wall| motions.velocities[wall.place].norm() * step);
    let reach = move |body: usize| margin * balls[body].radius + motions.velocities[body].norm() * step + approach;
    let balls_alone = &balls[..wall.map_or(balls.len(), |wall| wall.place)];
    let longest = (0..balls_alone.len()).map(reach).fold(0.0, f64::max);
    let loaded = move |axis: usize, upper: bool| wall.filter(|wall| upper && axis == wall.axis);
    let near = near_walls(domain, balls_alone, longest).into_iter().filter(move |pair| match loaded(pair.axis, pair.upper) {
        Some(wall) => !wall.carries(pair.body),
        None => weights[pair.body].is_finite(),
    });
    near.filter(move |pair| pair.gap <= reach(pair.body)).map(move |pair| {
        let contact = match loaded(pair.axis, pair.upper) {
            Some(wall) => Contact::of_plane(domain, balls, [pair.body, wall.place]),
            None => Contact::of_wall(domain, balls, pair.body, pair.axis, pair.upper),
        };
        let last_gap = contact.gap + step * contact.opening(motions.velocities);
        Path { contact, smallest_gap: contact.gap.min(last_gap), last_gap }
    })
}

/// Part of the step after which two bodies are nearest.
fn time_of_approach<const D: usize>(separation: &SVector<f64, D>, relative: &SVector<f64, D>) -> f64 {
    let length = relative.norm();
    if length > 0.0 { (-separation.dot(&(relative / length)) / length).clamp(0.0, 1.0) } else { 0.0 }
}

/// The median of the values of all ranks, 0 if there is none; a few that lie far away do not change it. Collective.
///
/// Found digit by digit of the numbers' order, so that it takes a few small sums over the ranks however many values there are.
fn median(peers: Peers, values: Vec<f64>) -> f64 {
    let mut total = [values.len() as f64];
    peers.sum(&mut total);
    if total[0] == 0.0 {
        return 0.0;
    }
    let mut rank_in_order = total[0] as usize / 2;
    let mut keys: Vec<u64> = values.into_iter().map(sortable).collect();
    let mut found = 0;
    for shift in (0..8).rev().map(|byte| 8 * byte) {
        let mut counts = [0.0; 256];
        keys.iter().for_each(|key| counts[(key >> shift) as usize & 255] += 1.0);
        peers.sum(&mut counts);
        let mut byte = 0;
        while counts[byte] as usize <= rank_in_order {
            rank_in_order -= counts[byte] as usize;
            byte += 1;
        }
        keys.retain(|key| (key >> shift) as usize & 255 == byte);
        found |= (byte as u64) << shift;
    }
    number(found)
}

/// A key in whose order numbers are sorted.
fn sortable(number: f64) -> u64 {
    let bits = number.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// The number of a key.
fn number(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 1 { key & !(1 << 63) } else { !key })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_that_of_the_sorted_numbers() {
        for count in [0, 1, 2, 5, 100, 1001] {
            let values: Vec<f64> = (0..count).map(|place| f64::from(place * 7919 % 1009 - 500) * 1.7f64.powi(place % 90 - 45)).collect();
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            assert_eq!(median(Peers::Alone, values), sorted.get(count as usize / 2).copied().unwrap_or(0.0));
        }
    }
}
