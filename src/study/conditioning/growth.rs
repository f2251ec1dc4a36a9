//! How condition numbers, iterations and seconds grow with `1/h`, beside what theory predicts.

use serde::Serialize;

use super::{fit::exponent, laplacian::Solve, method::Method};

/// Exponents of `1/h` for one preconditioner.
#[derive(Debug, Clone, Serialize)]
pub struct Growth {
    /// Dimension of the box.
    pub dimension: usize,
    /// Preconditioner.
    pub method: Method,
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
    pub fn of(solves: &[Solve], dimension: usize, method: Method) -> Growth {
        let [condition, iterations] = if method.multigrid() { [0.0, 0.0] } else { [2.0, 1.0] };
        let exponent = |predicted: f64, value: fn(&Solve) -> f64| {
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
    /// The one of `y ~ x^p`.
    pub fn of(points: &[(f64, f64)], predicted: f64) -> Exponent {
        Exponent { fitted: exponent(points), predicted }
    }
}

/// The solves of a dimension with a preconditioner, from the coarsest grid to the finest.
pub fn of(solves: &[Solve], dimension: usize, method: Method) -> impl Iterator<Item = &Solve> {
    solves.iter().filter(move |solve| solve.dimension == dimension && solve.method == method)
}
