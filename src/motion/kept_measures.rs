//! What chains and cells keep whatever the step: the lengths of rods, and the areas and volumes of membranes.
//!
//! Rows of their rates miss them by what is of higher order in the step. Places after it are therefore moved to the nearest, beads weighed alike, in which all
//! measures of a chain are kept: Newton's method on all of them at once, `x - J^T (J J^T)^-1 m(x)` with the gradients `J` of the measures.

use std::ops::Range;

use nalgebra::SVector;

use crate::{
    body::Twist,
    error::{Error, Result},
    interaction::{Interactions, Spring},
    linalg::ROUNDING,
    linalg::Skyline,
};

/// Newton's iterations.
const NEWTON: usize = 50;

/// Part by which diagonal entries are larger, so that measures that depend on others have a factor.
const DEPENDENT: f64 = 1e-10;

/// Part of its length by which a rod may miss it before it is kept: where it turns farther in a step, its direction means nothing.
const LARGEST_MISSED: f64 = 0.25;

/// How far bodies may be from where all that a chain keeps is kept, in distances of neighbours.
const LARGEST_LEFT: f64 = 1e-6;

/// What to do about a step in which chains cannot be followed.
const REMEDY: &str = "choose a shorter time.step, or \"auto\"";

/// A measure that a chain misses over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Missed {
    /// By what part of its length the rod that missed it most did so before it was kept, and its bodies.
    pub rod: (f64, [usize; 2]),
    /// How far bodies are from where measures are kept in the end, in distances of neighbours.
    pub left: f64,
}

impl Missed {
    /// Ends a step from a time that turns rods, or changes cells, farther than they can be followed.
    pub fn check(&self, time: f64, step: f64) -> Result<()> {
        let (part, [one, other]) = self.rod;
        let text = if part > LARGEST_MISSED {
            format!(
                "at time {time} the rod from body {one} to body {other} would change its length by a part of {part:.2} in a step of {step:.3e}; {REMEDY}"
            )
        } else if self.left > LARGEST_LEFT || self.left.is_nan() {
            format!(
                "at time {time} no places are found in which rods keep their lengths and cells their areas and volumes after a step of {step:.3e}; {REMEDY}"
            )
        } else {
            return Ok(());
        };
        Err(Error::StepTooLong { text, step })
    }
}

/// Changes motions over a step so that what chains keep is kept after it, and tells what it was missed by; nothing if no body had to be moved.
pub fn keep<const D: usize>(
    interactions: &Interactions<D>,
    centers: &[SVector<f64, D>],
    moves: &mut [Twist<D>],
    step: f64,
) -> Option<Missed> {
    let mut worst: Option<Missed> = None;
    for chain in interactions.chains() {
        let before = &centers[chain.clone()];
        let mut places: Vec<SVector<f64, D>> =
            before.iter().zip(&moves[chain.clone()]).map(|(center, twist)| center + twist.velocity * step).collect();
        let Some(missed) = keep_chain(interactions, &chain, &mut places) else { continue };
        for ((twist, place), center) in moves[chain].iter_mut().zip(&places).zip(before) {
            twist.velocity = (place - center) / step;
        }
        worst = Some(worst.map_or(missed, |worst| Missed {
            rod: if missed.rod.0 > worst.rod.0 { missed.rod } else { worst.rod },
            left: worst.left.max(missed.left),
        }));
    }
    worst
}

/// Moves the bodies of a chain; nothing if all that it keeps is kept.
fn keep_chain<const D: usize>(interactions: &Interactions<D>, chain: &Range<usize>, places: &mut [SVector<f64, D>]) -> Option<Missed> {
    let mut springs = rigid(interactions, chain, places);
    if springs.iter().all(|spring| spring.value == 0.0) {
        return None;
    }
    let (rod, unit) = (rod_most_off(&springs, places, chain.start), (places[1] - places[0]).norm());
    let mut left = f64::INFINITY;
    for _ in 0..NEWTON {
        let mut forces: Vec<f64> = springs.iter().map(|spring| spring.value).collect();
        gram(&springs, chain).solve(&mut forces);
        for (spring, force) in springs.iter().zip(forces) {
            spring.ends.iter().for_each(|(body, gradient)| places[body - chain.start] -= gradient * force);
        }
        springs = rigid(interactions, chain, places);
        let last = std::mem::replace(&mut left, springs.iter().map(off).fold(0.0, f64::max) / unit);
        if left == 0.0 || left < ROUNDING && left > 0.5 * last || !left.is_finite() {
            break;
        }
    }
    Some(Missed { rod, left })
}

/// What cannot give way, in the order of the last body of each, so that those of neighbours are beside each other.
fn rigid<const D: usize>(interactions: &Interactions<D>, chain: &Range<usize>, places: &[SVector<f64, D>]) -> Vec<Spring<D>> {
    let mut springs = interactions.springs_of(chain, &|body: usize| places[body - chain.start]);
    springs.retain(|spring| spring.stiffness.is_infinite());
    springs.sort_by_key(|spring| spring.ends.iter().map(|(body, _)| *body).max());
    springs
}

/// How far bodies are from where a measure is kept.
fn off<const D: usize>(spring: &Spring<D>) -> f64 {
    let square: f64 = spring.ends.iter().map(|(_, gradient)| gradient.norm_squared()).sum();
    spring.value.abs() / square.sqrt()
}

/// The rod that misses its length by the largest part of it: that part, and its bodies.
fn rod_most_off<const D: usize>(springs: &[Spring<D>], places: &[SVector<f64, D>], first: usize) -> (f64, [usize; 2]) {
    let rods = springs.iter().filter_map(|spring| match spring.ends[..] {
        [(one, _), (other, _)] => {
            let length = (places[other - first] - places[one - first]).norm() - spring.value;
            Some((spring.value.abs() / length, [one, other]))
        }
        _ => None,
    });
    rods.fold((0.0, [0; 2]), |worst, rod| if rod.0 > worst.0 { rod } else { worst })
}

/// The factor of the products of the gradients of measures of a chain.
fn gram<const D: usize>(springs: &[Spring<D>], chain: &Range<usize>) -> Skyline {
    let mut of_body: Vec<Vec<(usize, SVector<f64, D>)>> = vec![Vec::new(); chain.len()];
    for (row, spring) in springs.iter().enumerate() {
        spring.ends.iter().for_each(|(body, gradient)| of_body[body - chain.start].push((row, *gradient)));
    }
    let first = |spring: &Spring<D>| spring.ends.iter().map(|(body, _)| of_body[body - chain.start][0].0).min().unwrap_or(0);
    let mut matrix = Skyline::new(springs.iter().map(first).collect());
    for rows in &of_body {
        for (place, (row, gradient)) in rows.iter().enumerate() {
            rows[..place].iter().for_each(|(column, other)| matrix.add(*row, *column, gradient.dot(other)));
            matrix.add(*row, *row, gradient.norm_squared() * (1.0 + DEPENDENT));
        }
    }
    matrix.factor()
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use nalgebra::Vector2;

    use super::*;
    use crate::interaction::{Bonds, Stretch};

    /// Three disks on two rods that turn by a radian in a step: lengths are kept, and so is where the middle goes.
    #[test]
    fn rods_are_kept_however_far_they_turn() {
        for unit in [1e-9, 1.0, 1e9] {
            let rod = |bodies: [usize; 2]| Stretch { bodies, length: 1.2 * unit, stiffness: f64::INFINITY };
            let interactions = Interactions::default().with(Bonds {
                stretches: Rc::new(vec![rod([0, 1]), rod([1, 2])]),
                bends: Rc::default(),
                hinges: Rc::default(),
                conserved: Rc::default(),
                chains: Rc::new(std::iter::once(0..3).collect()),
            });
            let centers = [0.0, 1.2, 2.4].map(|x| Vector2::new(x, 0.3) * unit);
            let moves = |along: f64, up: f64| Twist { velocity: Vector2::new(along, up) * unit, spin: nalgebra::Matrix2::zeros() };
            let mut moves = [moves(1.0, -2.4), moves(1.0, 0.0), moves(1.0, 2.4)];
            let missed = keep(&interactions, &centers, &mut moves, 0.5).unwrap();
            assert!((missed.rod.0 - (2.0_f64.sqrt() - 1.0)).abs() < 1e-12 && missed.left < 1e-12, "{missed:?}");
            let places: Vec<Vector2<f64>> = centers.iter().zip(&moves).map(|(center, twist)| center + twist.velocity * 0.5).collect();
            for pair in places.windows(2) {
                assert!(((pair[1] - pair[0]).norm() / (1.2 * unit) - 1.0).abs() < 1e-12);
            }
            let middle: Vector2<f64> = places.iter().sum::<Vector2<f64>>() / 3.0;
            assert!((middle / unit - Vector2::new(1.7, 0.3)).norm() < 1e-12, "{middle}");
            assert_eq!(keep(&interactions, &centers, &mut [Twist::zero(); 3], 0.5).map_or(0.0, |missed| missed.rod.0), 0.0);
        }
    }
}
