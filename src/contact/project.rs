//! The projection: pairs that would overlap are added until none would.
//!
//! Round by round: look who overlaps on the way, add these pairs and those near the bodies concerned, solve the
//! islands that changed, look again. A step without contact costs one look; a long one costs the pairs that
//! meet, not all that might.

use std::collections::HashSet;

use nalgebra::SVector;

use super::{
    Contact, ContactForce, Identity, KktReport, Memory, Problem, ProblemShare, Projection, ProjectionShare, Solver, Spanning, View,
    distribute::{gathered, own_part},
    failure::{check, check_ways, endless, unkept},
    identity_hash::ByIdentity,
    island::{free_body, solve_island},
    kkt_report::certify,
    paths::{Motions, Path, common_motion, paths},
    share::{IslandSolver, solve_shared},
};
use crate::{
    body::Regions,
    error::Result,
    parallel::{Peers, World},
};

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

/// The velocities next to those wanted, as weighed, that let nothing overlap on the way. Collective: all ranks
/// give the same problem and get the same answer to the last bit.
///
/// Overlaps that exist before the step are gone after it.
///
/// # Errors
/// [`Error::Contact`](crate::error::Error::Contact) if bodies are squeezed with no way out, a velocity is not
/// finite, the step is absurdly long, or the solver fails or finds forces that do not keep bodies apart.
pub fn project<const D: usize>(world: &World, problem: &Problem<D>, spanning: Spanning) -> Result<Projection<D>> {
    let peers = Peers::from(world);
    let regions = Regions::new(problem.domain, peers.count());
    let own = own_part(peers, problem, &regions);
    let share = ProblemShare { problem: own.problem(problem), regions: &regions, spanning };
    let found = project_share(peers, &share, &Memory::default())?;
    Ok(gathered(peers, problem, &own, found))
}

/// A rank's part of the same projection, found sooner if the forces are like those of an earlier step. Collective: each rank gives its own bodies.
///
/// # Errors
/// As [`project`], the same on all ranks.
pub fn project_share<const D: usize>(peers: Peers, share: &ProblemShare<D>, memory: &Memory<D>) -> Result<ProjectionShare<D>> {
    project_by(peers, share, memory, &|problem, contacts, guess| solve_island(problem, contacts, guess))
}

/// The projection, given how to solve islands.
pub(super) fn project_by<const D: usize>(
    peers: Peers,
    share: &ProblemShare<D>,
    memory: &Memory<D>,
    solve: IslandSolver<D>,
) -> Result<ProjectionShare<D>> {
    let mut state = ProjectionState::new(peers, share, memory);
    check(peers, &share.problem)?;
    check_ways(peers, &share.problem, &state.motions())?;
    if peers.any(!share.problem.lower_bounds.is_empty()) {
        let view = state.look(NEARNESS);
        let fresh: Vec<_> = view.lower_bounds.iter().map(|bound| bound.contact).collect();
        state.add(&view, &fresh, solve)?;
    }
    for round in 0..ROUNDS {
        if round > 0 {
            // what a contact parts may be thrown far
            check_ways(peers, &share.problem, &state.motions())?;
        }
        let nearness = LARGEST_NEARNESS.min(NEARNESS * f64::powi(2.0, round as i32));
        let view = state.look(nearness);
        let problem = view.problem(&share.problem);
        let paths = paths(&problem, &Motions { velocities: &view.velocities, common: state.common }, nearness, |body| view.halo.owns(body));
        let Some(violated) = state.violated(&view, &paths, nearness) else {
            return state.finish(view, &paths, round);
        };
        state.add(&view, &violated, solve)?;
    }
    peers.agree(Err(endless(&share.problem, ROUNDS, state.contacts.len())))
}

/// Where the rounds stand on a rank.
struct ProjectionState<'a, const D: usize> {
    peers: Peers<'a>,
    share: &'a ProblemShare<'a, D>,
    memory: &'a Memory<D>,
    /// All contacts of own bodies so far, between bodies by number.
    contacts: Vec<Contact<D>>,
    known: HashSet<Identity<D>, ByIdentity>,
    forces: Vec<f64>,
    /// Velocities of the own bodies.
    velocities: Vec<SVector<f64, D>>,
    /// How all bodies move together with these.
    common: SVector<f64, D>,
    iterations: usize,
    solver: Solver,
    largest_island: usize,
}

impl<'a, const D: usize> ProjectionState<'a, D> {
    fn new(peers: Peers<'a>, share: &'a ProblemShare<'a, D>, memory: &'a Memory<D>) -> Self {
        Self {
            peers,
            share,
            memory,
            contacts: Vec::new(),
            known: HashSet::default(),
            forces: Vec::new(),
            velocities: share.problem.velocities.to_vec(),
            common: common_motion(peers, &share.problem, share.problem.velocities),
            iterations: 0,
            solver: Solver::Formula,
            largest_island: 0,
        }
    }

    /// How the own bodies move so far.
    fn motions(&self) -> Motions<'_, D> {
        Motions { velocities: &self.velocities, common: self.common }
    }

    /// What is seen of bodies with the velocities that they have now.
    fn look(&self, nearness: f64) -> View<D> {
        View::new(self.peers, self.share, &self.motions(), nearness, &self.contacts)
    }

    /// Pairs that overlap on the way, and pairs near the bodies that they hang together with; nothing if none overlap on any rank.
    fn violated(&self, view: &View<D>, paths: &[Path<D>], nearness: f64) -> Option<Vec<Contact<D>>> {
        let problem = view.problem(&self.share.problem);
        let fresh: Vec<&Path<D>> = paths.iter().filter(|path| !self.known.contains(&view.identity(&path.contact))).collect();
        let overlaps = |path: &Path<D>| path.smallest_gap < -TOLERANCE * path.contact.smaller_radius(problem.balls);
        let is_near = |path: &Path<D>| path.contact.gap < nearness * path.contact.smaller_radius(problem.balls);
        if !self.peers.any(fresh.iter().any(|path| overlaps(path))) {
            return None;
        }
        let known: Vec<Contact<D>> = self.contacts.iter().map(|contact| view.placed(contact)).collect();
        let near = fresh.iter().filter(|path| is_near(path) || overlaps(path)).map(|path| &path.contact);
        let mut bodies = view.sets(near.chain(&known));
        let mut concerned = vec![0.0; problem.balls.len()];
        for path in fresh.iter().filter(|path| overlaps(path)) {
            concerned[free_body(&problem, &path.contact)] = -1.0;
        }
        view.spread_least(self.peers, &mut bodies, &mut concerned);
        let joins = |path: &Path<D>| overlaps(path) || is_near(path) && concerned[free_body(&problem, &path.contact)] < 0.0;
        Some(fresh.into_iter().filter(|path| joins(path)).map(|path| path.contact).collect())
    }

    /// Adds contacts of bodies by their places and solves the islands that they change.
    fn add(&mut self, view: &View<D>, fresh: &[Contact<D>], solve: IslandSolver<D>) -> Result<()> {
        let earlier = self.contacts.len();
        for contact in fresh.iter().map(|contact| view.numbered(contact)) {
            self.known.insert(contact.identity());
            self.forces.push(self.memory.force(&contact.identity()));
            self.contacts.push(contact);
        }
        let placed: Vec<Contact<D>> = self.contacts.iter().map(|contact| view.placed(contact)).collect();
        let found = solve_shared(self.peers, view, self.share, &placed, &self.forces, earlier, solve)?;
        self.forces = found.forces;
        (self.iterations, self.solver) = (self.iterations.max(found.iterations), self.solver.max(found.solver));
        self.largest_island = self.largest_island.max(found.largest_island);
        let all = view.problem(&self.share.problem).corrected_velocities(&placed, &self.forces);
        self.velocities = view.halo.own().iter().map(|&place| all[place]).collect();
        self.common = common_motion(self.peers, &self.share.problem, &self.velocities);
        Ok(())
    }

    fn finish(self, view: View<D>, paths: &[Path<D>], rounds: usize) -> Result<ProjectionShare<D>> {
        let placed = self.contacts.iter().zip(&self.forces);
        let mut forces: Vec<_> = placed.map(|(contact, &force)| ContactForce::normal(view.placed(contact), force)).collect();
        forces.sort_unstable_by_key(|force| force.contact.identity());
        let problem = view.problem(&self.share.problem);
        let last = |solver: Solver| Solver::ALL[self.peers.max(solver as usize as f64) as usize];
        let kkt_report = KktReport {
            iterations: self.peers.max(self.iterations as f64) as usize,
            solver: last(self.solver),
            rounds,
            largest_island: self.peers.max(self.largest_island as f64) as usize,
            ..certify(self.peers, &view, &problem, &forces, paths)
        };
        if kkt_report.kkt_residual > LARGEST_RESIDUAL {
            return self.peers.agree(Err(unkept(self.peers, &self.share.problem, &kkt_report)));
        }
        Ok(ProjectionShare { projection: Projection { velocities: self.velocities, forces, kkt_report }, view })
    }
}
