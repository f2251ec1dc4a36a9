//! Islands shared out among the ranks, and their forces gathered again. Everything here is collective.

use super::{Contact, Problem, Solver, island::solve_island, solver::Outcome};
use crate::parallel::World;

/// Work to solve an island grows with its contacts to this power.
const WORK_POWER: f64 = 1.5;

/// Solves each island on one rank; all ranks get all outcomes, in order.
pub(super) fn solve_shared<const D: usize>(
    world: &World,
    problem: &Problem<D>,
    contacts: &[Contact<D>],
    guess: &[f64],
    islands: &[Vec<usize>],
) -> Vec<Outcome> {
    let owners = partition(islands, world.size());
    let mut numbers = Vec::new();
    for (island, _) in islands.iter().zip(&owners).filter(|&(_, &owner)| owner == world.rank()) {
        write(&solve_island(problem, &pick(contacts, island), &pick(guess, island)), island.len(), &mut numbers);
    }
    let all = world.gather(&numbers);
    let mut outcomes = vec![Outcome::NotConverged; islands.len()];
    let mut rest = &all[..];
    for rank in 0..world.size() {
        for place in (0..islands.len()).filter(|&place| owners[place] == rank) {
            let record;
            (record, rest) = rest.split_at(islands[place].len() + 2);
            outcomes[place] = read(record);
        }
    }
    outcomes
}

/// What belongs to the contacts of an island.
pub(super) fn pick<T: Copy>(of_all: &[T], island: &[usize]) -> Vec<T> {
    island.iter().map(|&place| of_all[place]).collect()
}

/// The rank that solves each island: the largest first, each to the rank with the least work so far.
fn partition(islands: &[Vec<usize>], ranks: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..islands.len()).collect();
    order.sort_by_key(|&place| std::cmp::Reverse(islands[place].len()));
    let mut work = vec![0.0; ranks];
    let mut owners = vec![0; islands.len()];
    for place in order {
        let idlest = (0..ranks).min_by(|&one, &two| f64::total_cmp(&work[one], &work[two])).unwrap_or(0);
        work[idlest] += (islands[place].len() as f64).powf(WORK_POWER);
        owners[place] = idlest;
    }
    owners
}

/// Appends the iterations, or what failed as a negative number, the method, and the forces.
fn write(outcome: &Outcome, contacts: usize, numbers: &mut Vec<f64>) {
    match outcome {
        Outcome::Solved { forces, iterations, solver } => {
            numbers.extend([*iterations as f64, f64::from(*solver as u8)]);
            numbers.extend(forces);
        }
        Outcome::Infeasible | Outcome::NotConverged => {
            numbers.push(if *outcome == Outcome::Infeasible { -1.0 } else { -2.0 });
            numbers.resize(numbers.len() + contacts + 1, 0.0);
        }
    }
}

fn read(record: &[f64]) -> Outcome {
    match record[0] {
        -1.0 => Outcome::Infeasible,
        -2.0 => Outcome::NotConverged,
        iterations => {
            let solver = Solver::ALL[record[1] as usize];
            Outcome::Solved { forces: record[2..].to_vec(), iterations: iterations as usize, solver }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_island_has_a_rank_to_itself() {
        let islands: Vec<Vec<usize>> = [1, 30, 2, 2, 1].map(|count| (0..count).collect()).to_vec();
        assert_eq!(partition(&islands, 2), [1, 0, 1, 1, 1]);
        assert_eq!(partition(&islands, 1), [0; 5]);
    }

    #[test]
    fn outcomes_survive_as_numbers() {
        let solved = Outcome::Solved { forces: vec![0.5, 0.0], iterations: 7, solver: Solver::Sparse };
        for outcome in [solved, Outcome::Infeasible, Outcome::NotConverged] {
            let mut numbers = Vec::new();
            write(&outcome, 2, &mut numbers);
            assert_eq!((numbers.len(), read(&numbers)), (4, outcome));
        }
    }
}
