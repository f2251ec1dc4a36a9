//! Exponents of growth, fitted to what was measured.

use crate::study::fit::Power;

/// Finest grids that a fit takes: on coarse ones the walls show.
const FINEST: usize = 3;

/// The exponent p of `y = C x^p` that fits the last points best, in logarithms; nothing if there are fewer than two points.
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    Power::fit(&points[points.len().saturating_sub(FINEST)..]).map(|power| power.exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

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
