//! A few constraints that hang together, solved on the dense matrix `A A^T`.
//!
//! The same iteration on guesses of the [active set](super::active_set), without what large sparse matrices need.

use super::program::Program;

/// Most constraints that are solved so.
const MOST: usize = 12;
/// Guesses tried.
const GUESSES: usize = 12;
/// The least pivot, as a part of a diagonal entry: equations that repeat each other are left to another method.
const SMALLEST_PIVOT: f64 = 1e-9;

type DenseProducts = [[f64; MOST]; MOST];

/// The multipliers of a program of a few constraints, if it is one and equations of an active set give them.
pub fn solve_dense(program: &Program, guess: &[f64]) -> Option<Vec<f64>> {
    if program.offsets.len() > MOST {
        return None;
    }
    let (matrix, offsets) = (products(program), &program.offsets);
    let mut active: Vec<bool> = guess.iter().map(|guess| *guess > 0.0).collect();
    for _ in 0..GUESSES {
        let multipliers = equal(&matrix, offsets, &active)?;
        let slack = |row: usize| offsets[row] + matrix[row].iter().zip(&multipliers).map(|(entry, z)| entry * z).sum::<f64>();
        let next: Vec<bool> = (0..active.len()).map(|row| if active[row] { multipliers[row] > 0.0 } else { slack(row) < 0.0 }).collect();
        if next == active {
            return Some(multipliers);
        }
        active = next;
    }
    None
}

/// `A A^T`.
fn products(program: &Program) -> DenseProducts {
    let count = program.offsets.len();
    let of = |row: usize, other: usize| -> f64 {
        program.row(row).map(|(place, value)| value * program.row(other).find(|entry| entry.0 == place).map_or(0.0, |entry| entry.1)).sum()
    };
    std::array::from_fn(|row| std::array::from_fn(|other| if row < count && other < count { of(row, other) } else { 0.0 }))
}

/// The multipliers, zero of those that are not active, with which active constraints have no slack; `None` if they repeat each other.
fn equal(matrix: &DenseProducts, offsets: &[f64], active: &[bool]) -> Option<Vec<f64>> {
    let rows: Vec<usize> = (0..offsets.len()).filter(|&row| active[row]).collect();
    let (mut factor, mut known) = ([[0.0; MOST]; MOST], [0.0; MOST]);
    for (place, &row) in rows.iter().enumerate() {
        for (other, &column) in rows[..=place].iter().enumerate() {
            let done: f64 = (0..other).map(|k| factor[place][k] * factor[other][k]).sum();
            let left = matrix[row][column] - done;
            if other < place {
                factor[place][other] = left / factor[other][other];
            } else if left > SMALLEST_PIVOT * matrix[row][row] {
                factor[place][place] = left.sqrt();
            } else {
                return None;
            }
        }
        let done: f64 = (0..place).map(|k| factor[place][k] * known[k]).sum();
        known[place] = (-offsets[row] - done) / factor[place][place];
    }
    let mut multipliers = vec![0.0; offsets.len()];
    for (place, &row) in rows.iter().enumerate().rev() {
        let done: f64 = (place + 1..rows.len()).map(|k| factor[k][place] * multipliers[rows[k]]).sum();
        multipliers[row] = (known[place] - done) / factor[place][place];
    }
    Some(multipliers)
}

#[cfg(test)]
mod tests {
    use clarabel::algebra::CscMatrix;

    use super::*;

    /// Bodies in a row that are pushed together or apart.
    fn row(offsets: &[f64]) -> Program<'static> {
        let places = (0..offsets.len()).flat_map(|body| 2 * body..2 * body + 4).collect();
        let values = (0..offsets.len()).flat_map(|_| [-1.0, 0.0, 1.0, 0.0].map(|value| value * 0.5f64.sqrt())).collect();
        let starts = (0..=offsets.len()).map(|constraint| 4 * constraint).collect();
        let transposed = CscMatrix::new(2 * offsets.len() + 2, offsets.len(), starts, places, values);
        Program { transposed, width: 2, offsets: offsets.to_vec(), sharing: None }
    }

    #[test]
    fn a_row_is_solved_from_any_guess() {
        for seed in 0..200usize {
            let count = 2 + seed % (MOST - 1);
            let number = |place: usize| ((seed * 31 + place * 7919) % 101) as f64 / 50.0 - 1.2;
            let program = row(&(0..count).map(number).collect::<Vec<_>>());
            let guess: Vec<f64> = (0..count).map(|place| ((seed + place * 37) % 3) as f64).collect();
            let found = solve_dense(&program, &guess).unwrap();
            assert!(program.residual(&found) < 1e-13, "{:e} with seed {seed}", program.residual(&found));
        }
    }

    #[test]
    fn equations_that_repeat_each_other_and_many_are_left_to_others() {
        let once = row(&[-1.0]);
        let (places, values) = (once.transposed.rowval.repeat(2), once.transposed.nzval.repeat(2));
        let transposed = CscMatrix::new(4, 2, vec![0, 4, 8], places, values);
        assert_eq!(solve_dense(&Program { transposed, offsets: vec![-1.0, -1.0], ..once }, &[1.0; 2]), None);
        assert_eq!(solve_dense(&row(&[-1.0; MOST + 1]), &[1.0; MOST + 1]), None);
    }
}
