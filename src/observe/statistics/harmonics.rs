//! What oscillates with a known frequency: its first harmonics in each cycle, by least squares.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::{mean, standard_error, student};

/// Harmonics that are told.
pub const HARMONICS: usize = 5;

/// Fewest values in a cycle: those of a fit, and as many again.
const FEWEST_IN_CYCLE: usize = 4 * HARMONICS + 2;

/// The harmonics of a quantity in its cycles.
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonics {
    /// Those of the sine and of the cosine of each multiple of the frequency, in the mean over the cycles, with half the width of the 95 % interval of the mean
    /// over more cycles; no width of a single cycle.
    pub parts: Vec<[(f64, Option<f64>); 2]>,
    /// Whole cycles that count.
    pub cycles: usize,
    /// When the first of them begins.
    pub from: f64,
}

/// The harmonics of values at times over whole cycles, of which the first, in which it starts, is left out where there are others; nothing without a whole cycle
/// with enough values.
pub fn harmonics(values: &[(f64, f64)], frequency: f64) -> Option<Harmonics> {
    let last = values.last()?.0;
    let whole = (last * frequency * (1.0 + 1e-9)).floor() as usize;
    let first = usize::from(whole > 1);
    let fits: Vec<Vec<f64>> = (first..whole).map(|cycle| fit(values, frequency, cycle)).collect::<Option<_>>()?;
    let count = fits.len();
    let part = |place: usize| {
        let of_cycles: Vec<f64> = fits.iter().map(|fit| fit[place]).collect();
        (mean(&of_cycles), (count > 1).then(|| student(count as f64 - 1.0) * standard_error(&of_cycles)))
    };
    let parts = (0..HARMONICS).map(|order| [part(1 + 2 * order), part(2 + 2 * order)]).collect();
    (count > 0).then_some(Harmonics { parts, cycles: count, from: first as f64 / frequency })
}

/// The mean, and the parts of sine and cosine of the harmonics, of one cycle.
fn fit(values: &[(f64, f64)], frequency: f64, cycle: usize) -> Option<Vec<f64>> {
    let phase = |time: f64| time * frequency - cycle as f64;
    let within: Vec<_> = values.iter().filter(|(time, value)| (-1e-9..=1.0 + 1e-9).contains(&phase(*time)) && value.is_finite()).collect();
    if within.len() < FEWEST_IN_CYCLE {
        return None;
    }
    let wave = |time: f64, column: usize| match column {
        0 => 1.0,
        _ if column % 2 == 1 => (TAU * phase(time) * column.div_ceil(2) as f64).sin(),
        _ => (TAU * phase(time) * column.div_ceil(2) as f64).cos(),
    };
    let matrix = DMatrix::from_fn(within.len(), 1 + 2 * HARMONICS, |row, column| wave(within[row].0, column));
    let wanted = DVector::from_iterator(within.len(), within.iter().map(|(_, value)| *value));
    let found = matrix.svd(true, true).solve(&wanted, 1e-10).ok()?;
    Some(found.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(cycles: f64, value: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let frequency = 0.4;
        let times = (0..).map(|step| (f64::from(step) + 0.3 * f64::from(step).sin()) / 40.0 / frequency);
        times.take_while(|time| *time <= cycles / frequency).map(|time| (time, value(TAU * frequency * time))).collect()
    }

    #[test]
    fn harmonics_of_steps_that_differ_are_found() {
        let values = sampled(3.02, |phase| 7.0 + 2.0 * phase.sin() - 3.0 * phase.cos() + 0.5 * (3.0 * phase).cos());
        let found = harmonics(&values, 0.4).expect("three cycles");
        assert_eq!((found.cycles, found.from), (2, 2.5));
        let expected = [[2.0, -3.0], [0.0, 0.0], [0.0, 0.5], [0.0, 0.0], [0.0, 0.0]];
        for (found, expected) in found.parts.iter().zip(expected) {
            for ((value, half_width), expected) in found.iter().zip(expected) {
                assert!((value - expected).abs() < 1e-9 && half_width.is_some_and(|half| half < 1e-9));
            }
        }
    }

    #[test]
    fn the_interval_holds_what_cycles_scatter_about() {
        // an amplitude that is another one in each cycle
        let values = sampled(9.02, |phase| (2.0 + 0.3 * ((phase / TAU).floor() * 2.4).sin()) * phase.sin());
        let found = harmonics(&values, 0.4).expect("nine cycles");
        let (value, half_width) = (found.parts[0][0].0, found.parts[0][0].1.expect("eight cycles"));
        assert!((value - 2.0).abs() < half_width && (0.1..0.3).contains(&half_width), "{value} {half_width}");
    }

    #[test]
    fn less_than_a_cycle_has_none() {
        assert_eq!(harmonics(&sampled(0.9, f64::sin), 0.4), None);
        assert_eq!(harmonics(&[], 0.4), None);
        assert_eq!(harmonics(&sampled(1.02, f64::sin), 0.4).map(|found| found.cycles), Some(1));
    }
}
