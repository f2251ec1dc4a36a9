//! What coupled solves tell of the mobility `W` of contacts: a change of forces `d` changed velocities by `w = W d`, as Stokes flow is linear. The network is
//! corrected so that it does the same on all changes that are known, and stays positive definite (the update of Broyden, Fletcher, Goldfarb and Shanno,
//! 1970, for several of them at once): `W_net - V (D^T V)^-1 V^T + U (D^T U)^-1 U^T` with `V = W_net D` and `U = W D`.

use nalgebra::{DMatrix, SymmetricEigen};

/// Part of a change that is left after others, and part of the largest work, below which it says nothing: solves end at a tolerance.
const NEW: f64 = 3e-2;
const WORK: f64 = 1e-6;

/// Most changes that are kept.
const MOST: usize = 12;

/// A part of a mobility: velocities `gain r (r . f)` by forces `f`.
#[derive(Debug, Clone)]
pub struct MobilityMode<const D: usize> {
    /// The factor.
    pub gain: f64,
    /// `r`, in each row block.
    pub rates: Vec<[f64; D]>,
}

/// Forces with their velocities, of all row blocks.
pub type Solved<const D: usize> = (Vec<[f64; D]>, Vec<[f64; D]>);

/// The modes that correct the mobility of a network, which is a function of forces, by what was solved before the last solve, newest last.
pub fn corrections<const D: usize>(
    last: &Solved<D>,
    before: &[Solved<D>],
    network: impl Fn(&[[f64; D]]) -> Vec<[f64; D]>,
) -> Vec<MobilityMode<D>> {
    let mut changes: Vec<Solved<D>> = Vec::new();
    for solved in before.iter().rev().take(MOST) {
        let mut change = (combined(&solved.0, &last.0, -1.0), combined(&solved.1, &last.1, -1.0));
        let whole = dot(&change.0, &change.0);
        for (force, rate) in &changes {
            let part = dot(&change.0, force);
            change = (combined(&change.0, force, -part), combined(&change.1, rate, -part));
        }
        let size = dot(&change.0, &change.0);
        if size > NEW * NEW * whole {
            changes.push((scaled(&change.0, 1.0 / size.sqrt()), scaled(&change.1, 1.0 / size.sqrt())));
        }
    }
    let forces: Vec<Vec<[f64; D]>> = changes.iter().map(|(force, _)| force.clone()).collect();
    let rates: Vec<Vec<[f64; D]>> = changes.iter().map(|(_, rate)| rate.clone()).collect();
    let of_network: Vec<Vec<[f64; D]>> = forces.iter().map(|force| network(force)).collect();
    let (known, there) = (modes(&forces, &of_network), modes(&forces, &rates));
    if known.len() != there.len() {
        return Vec::new();
    }
    known.into_iter().map(|mode| MobilityMode { gain: -mode.gain, ..mode }).chain(there).collect()
}

/// `U (D^T U)^-1 U^T`, as modes; none if forces do too little work in one of them.
fn modes<const D: usize>(forces: &[Vec<[f64; D]>], rates: &[Vec<[f64; D]>]) -> Vec<MobilityMode<D>> {
    let count = forces.len();
    if count == 0 {
        return Vec::new();
    }
    let work = DMatrix::from_fn(count, count, |row, column| 0.5 * (dot(&forces[row], &rates[column]) + dot(&forces[column], &rates[row])));
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(work);
    let most = eigenvalues.iter().copied().fold(0.0, f64::max);
    let mode = |number: usize| {
        let zero = vec![[0.0; D]; rates.first().map_or(0, Vec::len)];
        let turned = (0..count).fold(zero, |sum, place| combined(&sum, &rates[place], eigenvectors[(place, number)]));
        MobilityMode { gain: 1.0 / eigenvalues[number], rates: turned }
    };
    (0..count).filter(|&number| eigenvalues[number] > WORK * most).map(mode).collect()
}

/// The sum of products of components.
pub fn dot<const D: usize>(one: &[[f64; D]], other: &[[f64; D]]) -> f64 {
    one.as_flattened().iter().zip(other.as_flattened()).map(|(one, other)| one * other).sum()
}

/// `one + factor other`.
pub fn combined<const D: usize>(one: &[[f64; D]], other: &[[f64; D]], factor: f64) -> Vec<[f64; D]> {
    one.iter().zip(other).map(|(one, other)| std::array::from_fn(|axis| one[axis] + factor * other[axis])).collect()
}

fn scaled<const D: usize>(vector: &[[f64; D]], factor: f64) -> Vec<[f64; D]> {
    vector.iter().map(|entry| entry.map(|component| factor * component)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_network_answers_as_the_flow_to_all_changes_that_were_tried_and_stays_positive() {
        let count = 6;
        let mobility = |weak: f64| {
            DMatrix::from_fn(
                count,
                count,
                |row, column| if row == column { 1.0 } else { weak * ((row + 2 * column) * (column + 2 * row)) as f64 },
            )
        };
        let (network, flow) = (mobility(0.0), mobility(4e-3));
        let of = |matrix: &DMatrix<f64>, forces: &[[f64; 2]]| -> Vec<[f64; 2]> {
            let rates = matrix * DMatrix::from_column_slice(count, 1, forces.as_flattened());
            rates.as_slice().as_chunks::<2>().0.to_vec()
        };
        let solved = |number: usize| -> Solved<2> {
            let forces: Vec<[f64; 2]> =
                (0..count / 2).map(|place| [1, 2].map(|part| ((number * 7 + place * 3 + part) as f64).sin())).collect();
            let rates = combined(&of(&flow, &forces), &vec![[0.3, -0.2]; count / 2], 1.0);
            (forces, rates)
        };
        let (last, before) = (solved(3), [solved(0), solved(1), solved(2)]);
        let modes = corrections(&last, &before, |forces| of(&network, forces));
        let corrected = |forces: &[[f64; 2]]| {
            modes.iter().fold(of(&network, forces), |sum, mode| combined(&sum, &mode.rates, mode.gain * dot(&mode.rates, forces)))
        };
        for (forces, _) in &before {
            let change = combined(forces, &last.0, -1.0);
            let missed = combined(&corrected(&change), &of(&flow, &change), -1.0);
            assert!(dot(&missed, &missed) < 1e-20, "{missed:?}");
        }
        for number in 10..40 {
            let (forces, _) = solved(number);
            assert!(dot(&forces, &corrected(&forces)) > 0.0);
        }
    }
}
