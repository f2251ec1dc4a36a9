//! Gauss-Legendre quadrature.

use std::f64::consts::PI;

/// Nodes and weights on `[-1, 1]`, weights summing to 2: Newton on `P_n` from `cos(pi (i + 3/4)/(n + 1/2))`.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|index| {
            let guess = (PI * (index as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let node = (0..6).fold(guess, |node, _| {
                let (value, slope) = legendre(count, node);
                node - value / slope
            });
            let (_, slope) = legendre(count, node);
            (node, 2.0 / ((1.0 - node * node) * slope * slope))
        })
        .collect()
}

/// `P_n(x)` and its derivative, for `|x| < 1`.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (0.0, 1.0);
    for index in 1..=degree {
        let n = index as f64;
        (before, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n);
    }
    (value, degree as f64 * (x * value - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_up_to_twice_its_points() {
        for count in [1, 2, 5, 16, 40] {
            let rule = gauss_legendre(count);
            for degree in (0..2 * count as i32).step_by(2) {
                let found: f64 = rule.iter().map(|(node, weight)| weight * node.powi(degree)).sum();
                assert!((found - 2.0 / f64::from(degree + 1)).abs() < 1e-14, "{count} points, degree {degree}: {found}");
            }
        }
    }
}
