//! The outline of a red cell at rest: a closed chain of equal links along the profile of Evans and Fung (1972).

use std::f64::consts::TAU;

use nalgebra::Vector2;

/// Half the thickness over the radius, `sin t (a + b cos^2 t + c cos^4 t)` at `cos t` radii from the axis (doi:10.1016/0026-2862(72)90069-6).
const PROFILE: [f64; 3] = [0.1036, 1.0013, -0.5614];

/// Half the thickness of a red cell of radius 1 where `square` is the square of the distance from its axis, and `rise` the root of what that lacks of 1.
pub fn half_thickness(rise: f64, square: f64) -> f64 {
    rise * (PROFILE[0] + square * (PROFILE[1] + square * PROFILE[2]))
}

/// Rounds of evening out the links; each leaves a small part of what they differ by.
const ROUNDS: usize = 200;

/// Places of the beads of a cell about its middle, counterclockwise, its long axis along the first: each is a `link` away from the next.
pub fn biconcave(beads: usize, link: f64) -> Vec<Vector2<f64>> {
    let mut steps = vec![TAU / beads as f64; beads];
    let mut places = along(&steps);
    for _ in 0..ROUNDS {
        let lengths = lengths(&places);
        steps.iter_mut().zip(&lengths).for_each(|(step, length)| *step /= length);
        let whole = TAU / steps.iter().sum::<f64>();
        steps.iter_mut().for_each(|step| *step *= whole);
        places = along(&steps);
    }
    let mean = lengths(&places).iter().sum::<f64>() / beads as f64;
    places.iter().map(|place| place * (link / mean)).collect()
}

/// The turns from one link of a closed chain to the next, counterclockwise, one at each bead.
pub fn turns(places: &[Vector2<f64>]) -> Vec<f64> {
    let count = places.len();
    let link = |bead: usize| places[(bead + 1) % count] - places[bead % count];
    let turn = |bead: usize| {
        let (before, after) = (link(bead + count - 1), link(bead));
        before.perp(&after).atan2(before.dot(&after))
    };
    (0..count).map(turn).collect()
}

/// Points of the profile after each of these steps of its parameter.
fn along(steps: &[f64]) -> Vec<Vector2<f64>> {
    let mut parameter = 0.0;
    let point = |step: &f64| {
        let (sin, cos) = f64::sin_cos(parameter);
        parameter += step;
        let square = cos * cos;
        Vector2::new(cos, half_thickness(sin, square))
    };
    steps.iter().map(point).collect()
}

fn lengths(places: &[Vector2<f64>]) -> Vec<f64> {
    (0..places.len()).map(|bead| (places[(bead + 1) % places.len()] - places[bead]).norm()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_a_cell_are_equal_and_turn_once_around_inwards_at_the_dimples() {
        for beads in [12, 24, 41] {
            let places = biconcave(beads, 0.7);
            assert!(lengths(&places).iter().all(|length| (length - 0.7).abs() < 1e-9), "{beads}: {:?}", lengths(&places));
            let turns = turns(&places);
            assert!((turns.iter().sum::<f64>() - TAU).abs() < 1e-12);
            assert!(turns.iter().any(|turn| *turn < 0.0) && turns[0] > TAU / beads as f64);
        }
    }
}
