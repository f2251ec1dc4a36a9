//! Power laws, fitted to what was measured.

use serde::Serialize;

use crate::linalg::line;

/// `y = factor x^exponent`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Power {
    /// Its value at 1.
    pub factor: f64,
    /// Its slope in logarithms.
    pub exponent: f64,
}

impl Power {
    /// The one that fits points best, in logarithms; nothing if there are fewer than two abscissas, or values that have no logarithm.
    pub fn fit(points: &[(f64, f64)]) -> Option<Power> {
        let logarithms: Vec<(f64, f64)> = points.iter().map(|&(x, y)| (x.ln(), y.ln())).collect();
        let [logarithm, exponent] = line(&logarithms)?;
        exponent.is_finite().then(|| Power { factor: logarithm.exp(), exponent })
    }

    /// Its value.
    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }

    /// Where it has a value; nothing if it is constant.
    pub fn reaches(&self, y: f64) -> Option<f64> {
        let x = (y / self.factor).powf(1.0 / self.exponent);
        (x.is_finite() && x > 0.0).then_some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_recovered_and_inverted() {
        let points: Vec<(f64, f64)> = [0.5, 0.25, 0.1].map(|x: f64| (x, 3.0 * x.powf(2.5))).to_vec();
        let power = Power::fit(&points).expect("there are points");
        assert!((power.factor - 3.0).abs() < 1e-12 && (power.exponent - 2.5).abs() < 1e-12, "{power:?}");
        assert!((power.reaches(power.at(0.3)).expect("it falls") - 0.3).abs() < 1e-12);
    }

    #[test]
    fn too_little_gives_no_power_and_a_constant_reaches_nothing() {
        for points in [&[][..], &[(1.0, 2.0)], &[(1.0, 2.0), (1.0, 3.0)], &[(1.0, 0.0), (2.0, 1.0)]] {
            assert_eq!(Power::fit(points), None);
        }
        assert_eq!(Power { factor: 2.0, exponent: 0.0 }.reaches(1.0), None);
    }
}
