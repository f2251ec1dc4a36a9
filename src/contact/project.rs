//! The projection: pairs that would overlap are added until none would.
//!
//! Round by round: look who overlaps on the way, add these pairs and those near the bodies concerned, solve the
//! islands that changed, look again. A step without contact costs one look; a long one costs the pairs that
//! meet, not all that might.

use std::collections::HashSet;

use nalgebra::SVector;

use super::{
    Contact, ContactForce, KktReport, Memory, Partner, Problem, Solver,
    failure::{check, endless, failure, unkept},
    island::{free_body, islands},
    kkt_report::certify,
    paths::{Path, paths},
    share::solve_shared,
    solver::Outcome,
    union_find::UnionFind,
};
use crate::{error::Result, parallel::World};

/// Overlaps on the way below this many radii are rounding.
const TOLERANCE: f64 = 1e-11;
/// Gap, in radii, up to which pairs join the problem of their neighbours in the first round; it doubles in each round.
const NEARNESS: f64 = 0.2;
/// Where it stops doubling.
const LARGEST_NEARNESS: f64 = 4.0;
/// Distance from the optimum, in radii, beyond which an answer is none; answers have 1e-7 and less.
const LARGEST_RESIDUAL: f64 = 1e-4;
/// Rounds before giving up.
const ROUNDS: usize = 100;

/// Velocities that let nothing overlap.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection<const D: usize> {
    /// Velocities of the bodies.
    pub velocities: Vec<SVector<f64, D>>,
    /// All contacts of the problem solved, with their forces, of which many may be zero; sorted by
    /// [`Contact::identity`]. The sum of its contact forces on a body is `w (v - wanted)`, for bodies that give way.
    pub forces: Vec<ContactForce<D>>,
    /// How good the answer is, and what it cost.
    pub kkt_report: KktReport,
}

/// The velocities next to those wanted, as weighed, that let nothing overlap on the way. Collective: all ranks
/// give the same problem and get the same answer to the last bit.
///
/// Overlaps that exist before the step are gone after it.
///
/// # Errors
/// [`Error::Contact`](crate::error::Error::Contact) if bodies are squeezed with no way out, a velocity is not
/// finite, the step is absurdly long, or the solver fails or finds forces that do not keep bodies apart.
pub fn project<const D: usize>(world: &World, problem: &Problem<D>) -> Result<Projection<D>> {
    project_from(world, problem, &Memory::default())
}

/// The same projection, found sooner if the forces are like those of an earlier step.
///
/// # Errors
/// As [`project`].
pub fn project_from<const D: usize>(world: &World, problem: &Problem<D>, memory: &Memory<D>) -> Result<Projection<D>> {
    project_by(problem, memory, |contacts, guess, islands| solve_shared(world, problem, contacts, guess, islands))
}

/// The projection, given how to solve islands.
pub(super) fn project_by<const D: usize>(
    problem: &Problem<D>,
    memory: &Memory<D>,
    solve: impl Fn(&[Contact<D>], &[f64], &[Vec<usize>]) -> Vec<Outcome>,
) -> Result<Projection<D>> {
    check(problem)?;
    let mut state = ProjectionState::new(problem, memory);
    if !problem.lower_bounds.is_empty() {
        let changed = state.add(problem.lower_bounds.iter().map(|floor| floor.contact).collect());
        let outcomes = solve(&state.contacts, &state.forces, &changed);
        state.take(&changed, outcomes)?;
    }
    for round in 0..ROUNDS {
        let nearness = LARGEST_NEARNESS.min(NEARNESS * f64::powi(2.0, round as i32));
        let paths = paths(problem, &state.velocities, nearness);
        let violated = state.violated(&paths, nearness);
        if violated.is_empty() {
            let found = state.finish(&paths, round);
            return if found.kkt_report.kkt_residual <= LARGEST_RESIDUAL { Ok(found) } else { Err(unkept(problem, &found.kkt_report)) };
        }
        let changed = state.add(violated);
        let outcomes = solve(&state.contacts, &state.forces, &changed);
        state.take(&changed, outcomes)?;
    }
    Err(endless(problem, ROUNDS, state.contacts.len()))
}

/// Where the rounds stand.
struct ProjectionState<'a, const D: usize> {
    problem: &'a Problem<'a, D>,
    memory: &'a Memory<D>,
    contacts: Vec<Contact<D>>,
    known: HashSet<(usize, Partner, [i32; D])>,
    forces: Vec<f64>,
    velocities: Vec<SVector<f64, D>>,
    iterations: usize,
    solver: Solver,
}

impl<'a, const D: usize> ProjectionState<'a, D> {
    fn new(problem: &'a Problem<'a, D>, memory: &'a Memory<D>) -> Self {
        let velocities = problem.velocities.to_vec();
        Self {
            problem,
            memory,
            contacts: Vec::new(),
            known: HashSet::new(),
            forces: Vec::new(),
            velocities,
            iterations: 0,
            solver: Solver::Formula,
        }
    }

    /// Pairs that overlap on the way, and pairs near the bodies that they hang together with; empty if none overlap.
    fn violated(&self, paths: &[Path<D>], nearness: f64) -> Vec<Contact<D>> {
        let problem = self.problem;
        let fresh: Vec<&Path<D>> = paths.iter().filter(|path| !self.known.contains(&path.contact.identity())).collect();
        let overlaps = |path: &Path<D>| path.smallest_gap < -TOLERANCE * path.contact.smaller_radius(problem.balls);
        let is_near = |path: &Path<D>| path.contact.gap < nearness * path.contact.smaller_radius(problem.balls);
        if !fresh.iter().any(|path| overlaps(path)) {
            return Vec::new();
        }
        let mut bodies = UnionFind::new(problem.balls.len());
        let near = fresh.iter().filter(|path| is_near(path) || overlaps(path)).map(|path| &path.contact);
        for contact in near.chain(&self.contacts) {
            if let Some(other) = contact.other().filter(|&other| problem.gives_way(contact.body) && problem.gives_way(other)) {
                bodies.join(contact.body, other);
            }
        }
        let mut concerned = vec![false; problem.balls.len()];
        for path in fresh.iter().filter(|path| overlaps(path)) {
            concerned[bodies.root(free_body(problem, &path.contact))] = true;
        }
        let mut joins = |path: &Path<D>| overlaps(path) || is_near(path) && concerned[bodies.root(free_body(problem, &path.contact))];
        fresh.into_iter().filter(|path| joins(path)).map(|path| path.contact).collect()
    }

    /// Adds contacts; returns the islands that they change.
    fn add(&mut self, fresh: Vec<Contact<D>>) -> Vec<Vec<usize>> {
        let earlier = self.contacts.len();
        self.known.extend(fresh.iter().map(Contact::identity));
        self.forces.extend(fresh.iter().map(|contact| self.memory.force(contact)));
        self.contacts.extend(fresh);
        let mut changed = islands(self.problem, &self.contacts);
        changed.retain(|island| island.iter().any(|&place| place >= earlier));
        changed
    }

    fn take(&mut self, islands: &[Vec<usize>], outcomes: Vec<Outcome>) -> Result<()> {
        for (island, outcome) in islands.iter().zip(outcomes) {
            let Outcome::Solved { forces, iterations, solver } = outcome else {
                let contacts: Vec<_> = island.iter().map(|&place| self.contacts[place]).collect();
                return Err(failure(self.problem, &contacts, &outcome));
            };
            island.iter().zip(forces).for_each(|(&place, force)| self.forces[place] = force);
            (self.iterations, self.solver) = (self.iterations.max(iterations), self.solver.max(solver));
        }
        self.velocities = self.problem.corrected_velocities(&self.contacts, &self.forces);
        Ok(())
    }

    fn finish(self, paths: &[Path<D>], rounds: usize) -> Projection<D> {
        let pairs = self.contacts.into_iter().zip(self.forces);
        let mut forces: Vec<_> = pairs.map(|(contact, force)| ContactForce { contact, force }).collect();
        forces.sort_unstable_by_key(|force| force.contact.identity());
        let kkt_report = KktReport {
            iterations: self.iterations,
            solver: self.solver,
            rounds,
            ..certify(self.problem, &self.velocities, &forces, paths)
        };
        Projection { velocities: self.velocities, forces, kkt_report }
    }
}
