//! The KKT report of a projection: how good it is, measured on the answer itself, and what it cost.

use nalgebra::SVector;

use super::{Contact, ContactForce, Problem, Solver, island::islands, paths::Path};
use crate::geometry::Ball;

/// Forces below this part of the largest are rounding.
const ROUNDING: f64 = 1e-13;

/// How good a projection is, and what it cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KktReport {
    /// Contacts of the problem solved.
    pub pairs: usize,
    /// Contacts with a force that is more than the rounding of the largest.
    pub active: usize,
    /// Smallest gap after the step, in radii of the smaller body, over all pairs that come near each other and
    /// of which one gives way; infinite if there are none.
    pub smallest_gap: f64,
    /// Distance from the optimum, the largest of: change of a body that its forces do not explain; force below
    /// the least that its contact may bear; gap closed; force on an open gap. All in radii: forces by how far they push apart in the step.
    pub kkt_residual: f64,
    /// Sum of all contact forces.
    pub total_force: f64,
    /// Most iterations of a method on one island.
    pub iterations: usize,
    /// The last in the list of [`Solver`]s of those that solved an island.
    pub solver: Solver,
    /// Islands with a force.
    pub islands: usize,
    /// Times that contacts were added.
    pub rounds: usize,
}

impl KktReport {
    /// The KKT report of forces that nobody solved for: how many there are, and the smallest gap where they act.
    pub fn of_forces<const D: usize>(forces: &[ContactForce<D>], balls: &[Ball<D>]) -> KktReport {
        let gap = |force: &ContactForce<D>| force.contact.gap / force.contact.smaller_radius(balls);
        let (count, smallest_gap) = (forces.len(), forces.iter().map(gap).fold(f64::INFINITY, f64::min));
        KktReport {
            pairs: count,
            active: count,
            smallest_gap,
            kkt_residual: 0.0,
            total_force: forces.iter().map(|force| force.force).sum(),
            iterations: 0,
            solver: Solver::Formula,
            islands: 0,
            rounds: 0,
        }
    }
}

/// The KKT report of an answer, without its cost.
pub(super) fn certify<const D: usize>(
    problem: &Problem<D>,
    velocities: &[SVector<f64, D>],
    forces: &[ContactForce<D>],
    paths: &[Path<D>],
) -> KktReport {
    let relative = |path: &Path<D>| path.last_gap / path.contact.smaller_radius(problem.balls);
    let contacts: Vec<Contact<D>> = forces.iter().map(|force| force.contact).collect();
    let rounding = ROUNDING * forces.iter().map(|force| force.force.abs()).fold(0.0, f64::max);
    let bears = |force: &ContactForce<D>| force.force.abs() > rounding;
    let acts = |island: &Vec<usize>| island.iter().any(|&place| bears(&forces[place]));
    KktReport {
        pairs: forces.len(),
        active: forces.iter().filter(|force| bears(force)).count(),
        smallest_gap: paths.iter().map(relative).fold(f64::INFINITY, f64::min),
        kkt_residual: stationarity(problem, velocities, &contacts, forces).max(complementarity(problem, velocities, forces)),
        total_force: forces.iter().map(|force| force.force).sum(),
        iterations: 0,
        solver: Solver::Formula,
        islands: islands(problem, &contacts).iter().filter(|island| acts(island)).count(),
        rounds: 0,
    }
}

/// Largest `|v - (wanted + forces / w)| dt` in radii.
fn stationarity<const D: usize>(
    problem: &Problem<D>,
    velocities: &[SVector<f64, D>],
    contacts: &[Contact<D>],
    forces: &[ContactForce<D>],
) -> f64 {
    let forces: Vec<f64> = forces.iter().map(|force| force.force).collect();
    let explained = problem.corrected_velocities(contacts, &forces);
    let change = |body: usize| (velocities[body] - explained[body]).norm() * problem.step / problem.balls[body].radius;
    (0..velocities.len()).map(change).fold(0.0, f64::max)
}

/// Largest `|min(force - floor, gap)|` in radii, which is nought just if both are non-negative and one is nought.
fn complementarity<const D: usize>(problem: &Problem<D>, velocities: &[SVector<f64, D>], forces: &[ContactForce<D>]) -> f64 {
    let residual = |force: &ContactForce<D>| {
        let push = (force.force - problem.lower_bound(&force.contact)) * problem.mobility(&force.contact) * problem.step;
        push.min(problem.gap_after(&force.contact, velocities)).abs() / force.contact.smaller_radius(problem.balls)
    };
    forces.iter().map(residual).fold(0.0, f64::max)
}
