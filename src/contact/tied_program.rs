//! The program of an island of tied bodies, free of units: `min 1/2 |x|^2` subject to `B x = b` and `A x + c >= 0`.
//!
//! Its solution is `x = B^T y + A^T z` with `z >= 0` and slacks `s = A x + c >= 0`, of which one is zero in each row. Rows have norm 1. A guess of who presses,
//! `z > s`, is followed as long as it leads to a better one, each time by exact equations (Hintermüller, Ito and Kunisch 2002,
//! doi:10.1137/S1052623401383558); where it does not lead to the solution, the interior point (Clarabel) makes the guess.

use clarabel::{
    algebra::CscMatrix,
    qdldl::{QDLDLFactorisation, QDLDLSettings},
};

use super::solver::clarabel::solve_general;

/// Guesses tried from one start.
const GUESSES: usize = 12;
/// What makes equations that repeat each other solvable, and how often their solution is corrected for it.
const SOFTNESS: f64 = 1e-9;
const CORRECTIONS: usize = 12;
/// A residual that is none, and the largest with which an answer is one.
const EXACT: f64 = 1e-11;
const TOLERANCE: f64 = 1e-5;

/// A program with equations.
pub(super) struct TiedProgram {
    /// One column for each row of `B`, then of `A`.
    pub transposed: CscMatrix<f64>,
    /// `b`.
    pub equations: Vec<f64>,
    /// `c`.
    pub offsets: Vec<f64>,
}

/// Multipliers of inequalities, their slacks, and how far they are from the solution: the largest `|min(z, s)|` and miss of an equation.
struct PressTrial {
    multipliers: Vec<f64>,
    slacks: Vec<f64>,
    residual: f64,
}

impl TiedProgram {
    /// The multipliers of the inequalities, from a guess of which press; none if no unknowns meet all rows, or none are found.
    pub fn solve(&self, guess: &[bool]) -> Option<Vec<f64>> {
        let quick = self.follow(guess);
        if let Some(trial) = quick.as_ref().filter(|trial| trial.residual <= EXACT) {
            return Some(clipped(trial));
        }
        let general = solve_general(&self.transposed, &self.equations, &self.offsets)?;
        if general.infeasible {
            return None;
        }
        let presses: Vec<bool> = general.multipliers.iter().zip(&general.slacks).map(|(multiplier, slack)| multiplier > slack).collect();
        let trials = quick.into_iter().chain(self.follow(&presses));
        let best = trials.min_by(|one, other| one.residual.total_cmp(&other.residual)).filter(|trial| trial.residual <= TOLERANCE);
        Some(best.map_or(general.multipliers, |trial| clipped(&trial)))
    }

    /// The best that exact equations lead to from a guess of which inequalities press.
    fn follow(&self, guess: &[bool]) -> Option<PressTrial> {
        let (mut presses, mut best): (Vec<bool>, Option<PressTrial>) = (guess.to_vec(), None);
        for _ in 0..GUESSES {
            let Some(trial) = self.pressed(&presses) else { break };
            let next: Vec<bool> = trial.multipliers.iter().zip(&trial.slacks).map(|(multiplier, slack)| multiplier > slack).collect();
            if best.as_ref().is_none_or(|best| trial.residual < best.residual) {
                best = Some(trial);
            }
            if next == presses {
                break;
            }
            presses = next;
        }
        best
    }

    /// The least unknowns that meet the equations and leave no slack where inequalities press.
    fn pressed(&self, presses: &[bool]) -> Option<PressTrial> {
        let equal = self.equations.len();
        let rows: Vec<usize> = (0..equal).chain((0..presses.len()).filter(|&row| presses[row]).map(|row| equal + row)).collect();
        let sides: Vec<f64> = rows.iter().map(|&row| if row < equal { self.equations[row] } else { -self.offsets[row - equal] }).collect();
        let mut factors = self.factors(&rows)?;
        let unknowns = self.transposed.m;
        let (mut x, mut forces) = (vec![0.0; unknowns], vec![0.0; rows.len()]);
        let (mut missed, mut earlier) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..CORRECTIONS {
            let missing: Vec<f64> = rows.iter().zip(&sides).map(|(&row, side)| side - self.product(row, &x)).collect();
            missed = missing.iter().fold(0.0, |largest: f64, missing| largest.max(missing.abs()));
            if missed <= 0.01 * EXACT || missed > 0.5 * earlier {
                break;
            }
            earlier = missed;
            let mut change = [vec![0.0; unknowns], missing].concat();
            factors.solve(&mut change);
            forces.iter_mut().zip(&change[unknowns..]).for_each(|(force, change)| *force -= change);
            x = self.pushed(&rows, &forces);
        }
        let mut multipliers = vec![0.0; presses.len()];
        rows.iter().zip(&forces).skip(equal).for_each(|(row, force)| multipliers[row - equal] = *force);
        let slacks: Vec<f64> = (0..presses.len()).map(|row| self.product(equal + row, &x) + self.offsets[row]).collect();
        let slack = slacks.iter().zip(&multipliers).map(|(slack, multiplier)| slack.min(*multiplier).abs()).fold(missed, f64::max);
        Some(PressTrial { multipliers, slacks, residual: if slack.is_finite() { slack } else { f64::INFINITY } })
    }

    /// Factors of `[1, R^T; R, -softness]`, with `R` these rows.
    fn factors(&self, rows: &[usize]) -> Option<QDLDLFactorisation<f64>> {
        let unknowns = self.transposed.m;
        let (mut starts, mut places, mut values): (Vec<usize>, Vec<usize>, Vec<f64>) =
            ((0..=unknowns).collect(), (0..unknowns).collect(), vec![1.0; unknowns]);
        for (order, &row) in rows.iter().enumerate() {
            let (own, entries) = self.row(row);
            places.extend(own.iter().copied().chain([unknowns + order]));
            values.extend(entries.iter().copied().chain([-SOFTNESS]));
            starts.push(places.len());
        }
        let size = unknowns + rows.len();
        let signs = (0..size).map(|place| if place < unknowns { 1 } else { -1 }).collect();
        let settings = QDLDLSettings { Dsigns: Some(signs), ..QDLDLSettings::default() };
        QDLDLFactorisation::new(&CscMatrix::new(size, size, starts, places, values), Some(settings)).ok()
    }

    /// `R^T f`.
    fn pushed(&self, rows: &[usize], forces: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.transposed.m];
        for (&row, force) in rows.iter().zip(forces) {
            let (places, values) = self.row(row);
            places.iter().zip(values).for_each(|(&place, value)| x[place] += value * force);
        }
        x
    }

    fn product(&self, row: usize, x: &[f64]) -> f64 {
        let (places, values) = self.row(row);
        places.iter().zip(values).map(|(&place, value)| value * x[place]).sum()
    }

    fn row(&self, row: usize) -> (&[usize], &[f64]) {
        let CscMatrix { colptr, rowval, nzval, .. } = &self.transposed;
        let entries = colptr[row]..colptr[row + 1];
        (&rowval[entries.clone()], &nzval[entries])
    }
}

fn clipped(trial: &PressTrial) -> Vec<f64> {
    trial.multipliers.iter().map(|multiplier| multiplier.max(0.0)).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Two unknowns whose sum is to be 2, and three inequalities of which two say the same: `x_0 >= 3`, `x_0 >= 3`, `x_1 >= -5`.
    #[test]
    fn a_small_program_is_solved_from_any_guess() {
        let root = 0.5_f64.sqrt();
        let transposed = CscMatrix::new(2, 4, vec![0, 2, 3, 4, 5], vec![0, 1, 0, 0, 1], vec![root, root, 1.0, 1.0, 1.0]);
        let program = TiedProgram { transposed, equations: vec![2.0 * root], offsets: vec![-3.0, -3.0, 5.0] };
        for guess in [[false; 3], [true; 3], [true, false, false], [false, false, true]] {
            let multipliers = program.solve(&guess).unwrap();
            // x = (3, -1)
            assert!((multipliers[0] + multipliers[1] - 4.0).abs() < 1e-9 && multipliers[2] == 0.0, "{guess:?}: {multipliers:?}");
        }
        let impossible = TiedProgram { offsets: vec![-3.0, -3.0, 0.5], ..program };
        assert!(impossible.solve(&[false; 3]).is_none());
    }
}
