//! How condition numbers, iterations and seconds grow with `1/h`, beside what theory predicts.

use serde::Serialize;

use super::{laplacian::LaplacianSolve, preconditioning::Preconditioning};
use crate::study::fit::Power;

/// Finest grids that a fit takes: on coarse ones the walls show.
const FINEST: usize = 3;

/// Exponents of `1/h` for one preconditioner.
#[derive(Debug, Clone, Serialize)]
pub struct Growth {
    /// Dimension of the box.
    pub dimension: usize,
    /// Preconditioner.
    pub method: Preconditioning,
    /// Of the condition number.
    pub condition: Exponent,
    /// Of the iterations.
    pub iterations: Exponent,
    /// Of the seconds of the solve.
    pub seconds: Exponent,
}

/// An exponent.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Exponent {
    /// Fitted to the last three points, if there are at least two.
    pub fitted: Option<f64>,
    /// Predicted.
    pub predicted: f64,
}

impl Growth {
    /// That of all solves of a dimension with a preconditioner.
    pub fn of(solves: &[LaplacianSolve], dimension: usize, method: Preconditioning) -> Growth {
        let [condition, iterations] = if method.multigrid() { [0.0, 0.0] } else { [2.0, 1.0] };
        let exponent = |predicted: f64, value: fn(&LaplacianSolve) -> f64| {
            let points: Vec<(f64, f64)> = of(solves, dimension, method).map(|solve| (solve.cells as f64, value(solve))).collect();
            Exponent::of(&points, predicted)
        };
        Growth {
            dimension,
            method,
            condition: exponent(condition, |solve| solve.condition),
            iterations: exponent(iterations, |solve| solve.iterations as f64),
            seconds: exponent(iterations + dimension as f64, |solve| solve.solve_seconds),
        }
    }
}

impl Exponent {
    /// The one of `y ~ x^p`, fitted to the last points in logarithms.
    pub fn of(points: &[(f64, f64)], predicted: f64) -> Exponent {
        let finest = &points[points.len().saturating_sub(FINEST)..];
        Exponent { fitted: Power::fit(finest).map(|power| power.exponent), predicted }
    }
}

/// The solves of a dimension with a preconditioner, from the coarsest grid to the finest.
pub fn of(solves: &[LaplacianSolve], dimension: usize, method: Preconditioning) -> impl Iterator<Item = &LaplacianSolve> {
    solves.iter().filter(move |solve| solve.dimension == dimension && solve.method == method)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exponent(points: &[(f64, f64)]) -> Option<f64> {
        Exponent::of(points, 1.0).fitted
    }

    #[test]
    fn a_power_is_recovered_from_its_finest_points() {
        let points: Vec<(f64, f64)> = [4.0, 16.0, 32.0, 64.0, 96.0].map(|x: f64| (x, 0.4 * x.powf(1.7))).to_vec();
        assert!((exponent(&points).expect("there are points") - 1.7).abs() < 1e-12);
        let mut bent = points;
        bent[0].1 = 1e6;
        assert!((exponent(&bent).expect("there are points") - 1.7).abs() < 1e-12, "the coarse ones do not count");
    }

    #[test]
    fn what_stays_has_exponent_zero() {
        assert_eq!(exponent(&[(16.0, 6.0), (32.0, 6.0)]), Some(0.0));
    }

    #[test]
    fn too_little_gives_no_exponent() {
        for points in [&[][..], &[(16.0, 3.0)], &[(16.0, 3.0), (16.0, 4.0)], &[(16.0, 0.0), (32.0, 4.0)]] {
            assert_eq!(exponent(points), None);
        }
    }
}
