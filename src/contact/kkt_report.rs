//! The KKT report of a projection: how good it is, measured on the answer itself, and what it cost.

use nalgebra::SVector;

use super::{Contact, ContactForce, Problem, Solver, View, friction_report::FrictionReport, island::free_body, paths::Path};
use crate::{geometry::Ball, linalg::CANCELLATION, parallel::Peers};

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
    /// Most contacts of an island that one rank solved.
    pub largest_island: usize,
    /// How well friction was kept, where there is any.
    pub friction: Option<FrictionReport>,
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
            largest_island: 0,
            friction: None,
        }
    }

    /// The same of the forces of all ranks, each of which one rank tells. Collective.
    pub fn over(&self, peers: Peers) -> KktReport {
        let mut sums = [self.pairs as f64, self.active as f64, self.total_force];
        peers.sum(&mut sums);
        KktReport {
            pairs: sums[0] as usize,
            active: sums[1] as usize,
            smallest_gap: peers.min(self.smallest_gap),
            total_force: sums[2],
            ..*self
        }
    }
}

/// The KKT report of an answer of all ranks, without its cost. Collective.
pub(crate) fn certify<const D: usize>(
    peers: Peers,
    view: &View<D>,
    problem: &Problem<D>,
    forces: &[ContactForce<D>],
    paths: &[Path<D>],
) -> KktReport {
    let relative = |path: &Path<D>| path.last_gap / path.contact.smaller_radius(problem.balls);
    let contacts: Vec<Contact<D>> = forces.iter().map(|force| force.contact).collect();
    let rounding = CANCELLATION * peers.max(forces.iter().map(|force| force.force.abs()).fold(0.0, f64::max));
    let bears = |force: &&ContactForce<D>| force.force.abs() > rounding;
    let answered = || forces.iter().filter(|force| view.answers(force.contact.identity()));
    let mut acts = vec![0.0; problem.balls.len()];
    forces.iter().filter(bears).for_each(|force| acts[free_body(problem, &force.contact)] = -1.0);
    let islands = acting_islands(peers, view, &contacts, acts);
    let mut sums =
        [answered().count() as f64, answered().filter(bears).count() as f64, answered().map(|force| force.force).sum(), islands as f64];
    peers.sum(&mut sums);
    KktReport {
        pairs: sums[0] as usize,
        active: sums[1] as usize,
        smallest_gap: peers.min(paths.iter().map(relative).fold(f64::INFINITY, f64::min)),
        kkt_residual: peers.max(stationarity(view, problem, &contacts, forces).max(complementarity(problem, &view.velocities, forces))),
        total_force: sums[2],
        iterations: 0,
        solver: Solver::Formula,
        islands: sums[3] as usize,
        rounds: 0,
        largest_island: 0,
        friction: None,
    }
}

/// How many islands with a body that acts have their first body on this rank.
fn acting_islands<const D: usize>(peers: Peers, view: &View<D>, contacts: &[Contact<D>], mut acts: Vec<f64>) -> usize {
    if !peers.any(acts.contains(&-1.0)) {
        return 0;
    }
    let numbers = view.halo.numbers();
    let (mut sets, mut firsts) = (view.sets(contacts), numbers.iter().map(|&number| number as f64).collect::<Vec<_>>());
    view.spread_least(peers, &mut sets, &mut firsts);
    view.spread_least(peers, &mut sets, &mut acts);
    view.halo.own().iter().filter(|&&body| acts[body] < 0.0 && firsts[body] as usize == numbers[body]).count()
}

/// Largest `|v - (wanted + forces / w)| dt` in radii, over the own bodies.
fn stationarity<const D: usize>(view: &View<D>, problem: &Problem<D>, contacts: &[Contact<D>], forces: &[ContactForce<D>]) -> f64 {
    let forces: Vec<f64> = forces.iter().map(|force| force.force).collect();
    let explained = problem.corrected_velocities(contacts, &forces);
    let change = |&body: &usize| (view.velocities[body] - explained[body]).norm() * problem.step / problem.balls[body].radius;
    view.halo.own().iter().map(change).fold(0.0, f64::max)
}

/// Largest `|min(force - floor, gap)|` in radii, which is nought just if both are non-negative and one is nought.
fn complementarity<const D: usize>(problem: &Problem<D>, velocities: &[SVector<f64, D>], forces: &[ContactForce<D>]) -> f64 {
    let residual = |force: &ContactForce<D>| {
        let push = (force.force - problem.lower_bound(&force.contact)) * problem.mobility(&force.contact) * problem.step;
        push.min(problem.gap_after(&force.contact, velocities)).abs() / force.contact.smaller_radius(problem.balls)
    };
    forces.iter().map(residual).fold(0.0, f64::max)
}
