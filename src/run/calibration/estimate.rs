//! Errors estimated from the answers of several grids.
//!
//! The sharp method is of second order, `q(h) = q + A h^2`, and its modes converge faster: of two grids with `c > b` cells per radius the
//! finer one is off by `|q_c - q_b| / ((c/b)^2 - 1)`. The estimate is the largest that any coarser grid gives, twice over: two
//! grids that happen to agree are not believed if a third one does not.

use serde::{Deserialize, Serialize};

use super::answers::{CalibrationAnswer, EstimatedQuantity};

/// Estimates are multiplied by this.
const SAFETY: f64 = 2.0;

/// Two grids alone are not believed below this over the square of the cells per radius.
///
/// Measured on 34 scenes with known answers: with 4 cells per radius and no narrow gap answers are off by up to 0.5 %, whatever the
/// difference to 3 cells.
const FLOOR_OF_TWO: f64 = 0.1;

/// More grids are not believed below this part of the accuracy.
const FLOOR_OF_MORE: f64 = 0.25;

/// The estimated error of a quantity, relative to its root mean square over the bodies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// What is estimated.
    pub quantity: EstimatedQuantity,
    /// The error, a bar that the true one should not exceed.
    pub error: f64,
}

/// The errors of the last of several grids, each with its cells per radius and its answers; nothing for a single grid.
pub fn estimates(grids: &[(f64, Vec<CalibrationAnswer>)], accuracy: f64) -> Vec<Estimate> {
    let Some(((cells, last), coarser)) = grids.split_last().filter(|(_, coarser)| !coarser.is_empty()) else { return Vec::new() };
    let floor = if coarser.len() == 1 { FLOOR_OF_TWO / (cells * cells) } else { FLOOR_OF_MORE * accuracy };
    let of = |place: usize| {
        let against =
            |(other, answers): &(f64, Vec<CalibrationAnswer>)| last[place].distance(&answers[place]) / ((cells / other).powi(2) - 1.0);
        let largest = coarser.iter().map(against).fold(0.0, f64::max);
        Estimate { quantity: last[place].quantity, error: floor.max(SAFETY * largest) }
    };
    (0..last.len()).map(of).collect()
}

/// The largest of them, if there is one.
pub fn worst(estimates: &[Estimate]) -> Option<Estimate> {
    estimates.iter().copied().max_by(|one, two| one.error.total_cmp(&two.error))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(cells: f64, drag: f64) -> (f64, Vec<CalibrationAnswer>) {
        (cells, vec![CalibrationAnswer { quantity: EstimatedQuantity::Drag, values: vec![drag, 0.0] }])
    }

    fn error(grids: &[(f64, f64)], accuracy: f64) -> f64 {
        let grids: Vec<_> = grids.iter().map(|&(cells, drag)| grid(cells, drag)).collect();
        worst(&estimates(&grids, accuracy)).map_or(f64::NAN, |estimate| estimate.error)
    }

    #[test]
    fn an_error_of_second_order_is_estimated_with_its_safety() {
        let of_grid = |cells: f64| (cells, 1.0 + 0.5 / (cells * cells));
        let (found, true_error) = (error(&[3.0, 4.0, 6.0, 12.0].map(of_grid), 1e-9), 0.5 / 144.0);
        assert!((found / true_error - SAFETY).abs() < 0.02, "{found} for {true_error}");
    }

    #[test]
    fn grids_that_agree_by_chance_are_not_believed_against_a_third() {
        assert!(error(&[(3.0, 0.9), (4.0, 1.0), (6.0, 1.0)], 1e-9) > 0.06);
    }

    #[test]
    fn no_bar_is_narrower_than_its_floor() {
        assert_eq!(error(&[(3.0, 1.0), (4.0, 1.0)], 1e-9), FLOOR_OF_TWO / 16.0);
        assert_eq!(error(&[(3.0, 1.0), (4.0, 1.0), (6.0, 1.0)], 1e-2), FLOOR_OF_MORE * 1e-2);
        assert!(worst(&estimates(&[grid(3.0, 1.0)], 1e-2)).is_none());
    }
}
