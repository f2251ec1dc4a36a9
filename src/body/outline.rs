//! Outlines of cells: closed chains of equal links along the profile of Evans and Fung (1972), or along an ellipse.

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

/// Points of a curve from which its area and its length are measured.
const FINE: usize = 4000;

/// Thinnest and thickest outlines, over the profile or over a circle.
const THINNEST: f64 = 0.1;
const THICKEST: [f64; 2] = [1.8, 1.0];

/// The form that a membrane without bending has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RestShape {
    /// The profile of Evans and Fung.
    #[default]
    Biconcave,
    /// An ellipse.
    Ellipse,
    /// A circle: that of vesicles, whose closed membranes have no curvature of their own.
    Circle,
}

/// The outline of a cell: in which form it is placed, and in which one it does not bend.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outline {
    /// The form without bending.
    pub rest: RestShape,
    /// `4 pi area / perimeter^2` of the smooth outline as it is placed: the profile thinner or thicker, or an ellipse. Nothing for that of the profile and
    /// of the circle.
    pub reduced_area: Option<f64>,
}

impl Outline {
    /// Places of the beads of a cell about its middle, counterclockwise, its long axis along the first: each is a `link` away from the next.
    pub fn places(&self, beads: usize, link: f64) -> Vec<Vector2<f64>> {
        let thickness = self.thickness();
        let along = |steps: &[f64]| self.along(thickness, steps);
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

    /// The turns at the beads without bending.
    pub fn turns(&self, beads: usize, link: f64) -> Vec<f64> {
        match self.rest {
            RestShape::Circle => vec![TAU / beads as f64; beads],
            RestShape::Biconcave | RestShape::Ellipse => turns(&self.places(beads, link)),
        }
    }

    /// Least and largest reduced area that such an outline may have.
    pub fn reduced_areas(&self) -> [f64; 2] {
        [THINNEST, self.thickest()].map(|thickness| self.reduced_area_of(thickness))
    }

    /// How thick it is over the profile, or an ellipse over a circle.
    fn thickness(&self) -> f64 {
        let Some(wanted) = self.reduced_area else { return 1.0 };
        let (mut low, mut high) = (THINNEST, self.thickest());
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if self.reduced_area_of(middle) < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    fn thickest(&self) -> f64 {
        THICKEST[usize::from(self.rest != RestShape::Biconcave)]
    }

    fn reduced_area_of(&self, thickness: f64) -> f64 {
        let curve = self.along(thickness, &vec![TAU / FINE as f64; FINE]);
        let area: f64 = 0.5 * (0..FINE).map(|point| curve[point].perp(&curve[(point + 1) % FINE])).sum::<f64>();
        2.0 * TAU * area / lengths(&curve).iter().sum::<f64>().powi(2)
    }

    /// Points of an outline of this thickness after each of these steps of its parameter.
    fn along(&self, thickness: f64, steps: &[f64]) -> Vec<Vector2<f64>> {
        let mut parameter = 0.0;
        let point = |step: &f64| {
            let (sin, cos) = f64::sin_cos(parameter);
            parameter += step;
            let height = if self.rest == RestShape::Biconcave { half_thickness(sin, cos * cos) } else { sin };
            Vector2::new(cos, thickness * height)
        };
        steps.iter().map(point).collect()
    }
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

fn lengths(places: &[Vector2<f64>]) -> Vec<f64> {
    (0..places.len()).map(|bead| (places[(bead + 1) % places.len()] - places[bead]).norm()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_a_cell_are_equal_and_turn_once_around_inwards_at_the_dimples() {
        for beads in [12, 24, 41] {
            let places = Outline::default().places(beads, 0.7);
            assert!(lengths(&places).iter().all(|length| (length - 0.7).abs() < 1e-9), "{beads}: {:?}", lengths(&places));
            let turns = turns(&places);
            assert!((turns.iter().sum::<f64>() - TAU).abs() < 1e-12);
            assert!(turns.iter().any(|turn| *turn < 0.0) && turns[0] > TAU / beads as f64);
        }
    }

    #[test]
    fn outlines_have_the_reduced_area_that_is_asked_for_and_circles_turn_alike() {
        for (rest, reduced_area) in [(RestShape::Biconcave, 0.5), (RestShape::Ellipse, 0.7), (RestShape::Circle, 0.7)] {
            let outline = Outline { rest, reduced_area: Some(reduced_area) };
            let found = |beads: usize| {
                let places = outline.places(beads, 1.0);
                assert!(lengths(&places).iter().all(|length| (length - 1.0).abs() < 1e-8), "{rest:?}");
                let area: f64 = 0.5 * (0..beads).map(|bead| places[bead].perp(&places[(bead + 1) % beads])).sum::<f64>();
                2.0 * TAU * area / (beads * beads) as f64
            };
            // a polygon encloses less than the curve, by the square of its links
            let errors = [48, 96].map(|beads| found(beads) / reduced_area - 1.0);
            assert!(errors[1].abs() < 2e-3 && (errors[0] / errors[1] - 4.0).abs() < 1.0, "{rest:?}: {errors:?}");
        }
        let [profile, circle] = [Outline::default(), Outline { rest: RestShape::Circle, reduced_area: None }];
        assert!(profile.reduced_areas()[0] < 0.1 && profile.reduced_areas()[1] > 0.53 && (circle.reduced_areas()[1] - 1.0).abs() < 1e-6);
        let vesicle = Outline { reduced_area: Some(0.8), ..circle };
        assert!(vesicle.turns(40, 1.0).iter().all(|turn| *turn == TAU / 40.0));
    }
}
