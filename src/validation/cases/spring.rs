//! Two spheres on a spring beside the exact motion of two equal spheres along the line of their centres.

use super::Case;
use crate::{error::Result, petsc::Session, validation::follow::follow};

/// Distance of the centres at the start and at rest, in radii.
const DISTANCES: [f64; 2] = [3.0, 4.0];
const END: f64 = 2.0;

/// Spheres of radius 1, each with the resistance 1 alone, on a spring that exerts a unit force over a unit length.
pub fn case() -> Case {
    Case {
        name: "displacement of two spheres on a spring",
        source: "Brenner 1961, two equal spheres",
        resolution: "a/h = 3, films, 40 steps".into(),
        reference: exact_separation(),
        tolerance: 1e-2,
        solve: Box::new(separation),
    }
}

/// Resistance of each of two equal spheres that approach each other or part at equal speeds, over that of one alone; `distance` of the centres in radii.
///
/// Source: H. Brenner, Chem. Eng. Sci. 16 (1961) 242, a sphere before a plane free surface, in which the other sphere is its mirror image.
fn resistance(distance: f64) -> f64 {
    /// Beyond this a term is less than rounding, and its parts overflow.
    const MOST: f64 = 300.0;
    let alpha = (0.5 * distance).acosh();
    let term = |n: f64| {
        let twice = 2.0 * n + 1.0;
        let above = 4.0 * (0.5 * twice * alpha).cosh().powi(2) + (twice * alpha.sinh()).powi(2);
        let below = 2.0 * (twice * alpha).sinh() - twice * (2.0 * alpha).sinh();
        n * (n + 1.0) / ((twice - 2.0) * (twice + 2.0)) * (above / below - 1.0)
    };
    let terms = (1..).map(f64::from).take_while(|n| (2.0 * n + 1.0) * alpha < MOST);
    4.0 / 3.0 * alpha.sinh() * terms.map(term).sum::<f64>()
}

/// How far the spheres have gone apart, by the fourth-order method of Runge and Kutta.
fn exact_separation() -> f64 {
    let [start, rest] = DISTANCES;
    let (steps, rate) = (200, |distance: f64| 2.0 * (rest - distance) / resistance(distance));
    let step = END / f64::from(steps);
    let mut distance = start;
    for _ in 0..steps {
        let first = rate(distance);
        let second = rate(distance + 0.5 * step * first);
        let third = rate(distance + 0.5 * step * second);
        let fourth = rate(distance + step * third);
        distance += step / 6.0 * (first + 2.0 * (second + third) + fourth);
    }
    distance - start
}

fn separation(session: &Session) -> Result<f64> {
    let [start, rest] = DISTANCES;
    let size = [24.0, 20.0, 20.0];
    let centers = [-0.5, 0.5].map(|side| [0.5 * size[0] + side * start, 0.5 * size[1], 0.5 * size[2]]);
    let text = format!(
        "domain.size = {size:?}\nflow.viscosity = {viscosity:?}\nresolution.cells_per_radius = 3\nmethod.inverse = \"transform\"\n\
         lubrication.model = \"pairwise\"\ntime = {{ end = {END:?}, step = {step:?} }}\n\
         chains = [{{ centers = {centers:?}, beads = 2, radius = 1.0, spacing = {spacing:?}, stretch = 1.0 }}]\n",
        viscosity = 1.0 / (6.0 * std::f64::consts::PI),
        step = END / 40.0,
        spacing = 0.5 * rest,
    );
    let mut distance = f64::NAN;
    follow::<3>(session, &text, |simulation, _| {
        let centers = simulation.state().centers();
        distance = (centers[1] - centers[0]).norm();
        Ok(())
    })?;
    Ok(distance - start)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spheres far apart have the mobility of Rotne and Prager, those near each other the resistance of a film: radius over twice the gap.
    #[test]
    fn resistances_have_their_limits() {
        let far = 200.0_f64;
        let mobility = 1.0 - 1.5 / far + far.powi(-3);
        assert!((resistance(far) * mobility - 1.0).abs() < 1e-8, "{}", resistance(far) * mobility);
        let near = 1e-4;
        assert!((resistance(2.0 + near) * 2.0 * near - 1.0).abs() < 2e-3, "{}", resistance(2.0 + near));
    }
}
