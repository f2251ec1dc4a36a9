//! The error of time steps, told apart from that of the grid.

use super::record::Measured;

/// What steps of second order change, value by value: so much times the square of their mean length.
#[derive(Debug, Clone, PartialEq)]
pub struct StepError {
    coefficients: Vec<f64>,
}

impl StepError {
    /// That of changes which steps of another length made on one grid.
    pub fn of(changes: &[f64], [from, to]: [f64; 2]) -> StepError {
        StepError { coefficients: changes.iter().map(|change| change / (to * to - from * from)).collect() }
    }

    /// A run to a time as it were with vanishing steps.
    pub fn taken_from(&self, run: &Measured, end: f64) -> Measured {
        let square = run.mean_step(end).length().powi(2);
        let values = run.values.iter().zip(&self.coefficients).map(|(value, coefficient)| value - coefficient * square).collect();
        Measured { values, ..run.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::cost::record::tests::run;

    #[test]
    fn two_lengths_of_steps_tell_the_value_of_vanishing_ones() {
        let with = |steps: usize| Measured { steps, ..run(1.0, 7.0 + 3.0 / (steps * steps) as f64) };
        let (long, short) = (with(10), with(23));
        let change = short.values[0] - long.values[0];
        let error = StepError::of(&[change], [10, 23].map(|steps: usize| 1.0 / steps as f64));
        for steps in [5, 10, 40] {
            assert!((error.taken_from(&with(steps), 1.0).values[0] - 7.0).abs() < 1e-12);
        }
    }
}
