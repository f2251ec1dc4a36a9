//! Islands shared out among the ranks: each is solved where its bodies are, and one that spans ranks on the rank that owns its first body.
//! Everything here is collective.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use nalgebra::SVector;

use super::{
    Contact, ContactForce, Identity, Problem, ProblemShare, Solver, Spanning,
    failure::failure,
    identity::{pack, packed_length, renamed, unpack},
    island::{free_body, solve_together},
    solver::Outcome,
    view::View,
};
use crate::{error::Result, geometry::Ball, parallel::Peers};

/// What solves an island: the forces at its contacts, from a guess.
pub(super) type IslandSolver<'a, const D: usize> = &'a dyn Fn(&Problem<D>, &[Contact<D>], &[f64]) -> Outcome;

/// The forces of all contacts that a rank sees, and what it took to find them.
pub(super) struct Shared {
    pub forces: Vec<f64>,
    /// Most iterations on an island of this rank.
    pub iterations: usize,
    /// The last in the list of those that solved one of them.
    pub solver: Solver,
    /// Most contacts of one of them.
    pub largest_island: usize,
}

/// An island as the rank that solves it sees it.
struct GatheredContacts<const D: usize> {
    bodies: BTreeMap<usize, Body<D>>,
    /// Contacts with the guess and the least force of each.
    contacts: BTreeMap<Identity<D>, [f64; 2]>,
}

/// A body as it travels.
#[derive(Clone, Copy)]
struct Body<const D: usize> {
    owner: usize,
    ball: Ball<D>,
    weight: f64,
    wanted: SVector<f64, D>,
}

/// Where a rank stands in a problem whose contacts, by their places in a view, are known.
struct Round<'a, const D: usize> {
    peers: Peers<'a>,
    view: &'a View<D>,
    problem: Problem<'a, D>,
    contacts: &'a [Contact<D>],
    /// For the free body of each contact: the number of the first body of its island, times the number of ranks, plus the rank that owns it.
    homes: Vec<u64>,
    /// Whether an island changed, and whether it spans ranks, by the place of a free body.
    changed: Vec<bool>,
    spans: Vec<bool>,
}

/// Forces of contacts by place, of which those from `earlier` on are new: islands without a new contact keep theirs.
pub(super) fn solve_shared<const D: usize>(
    peers: Peers,
    view: &View<D>,
    share: &ProblemShare<D>,
    contacts: &[Contact<D>],
    guess: &[f64],
    earlier: usize,
    solve: IslandSolver<D>,
) -> Result<Shared> {
    if !peers.any(earlier < contacts.len()) {
        return Ok(Shared::of(guess));
    }
    let round = Round::new(peers, view, view.problem(&share.problem), contacts, earlier);
    let mut shared = Shared::of(guess);
    let inside = round.solve_inside(&mut shared, solve);
    peers.agree(inside)?;
    if peers.count() > 1 {
        let together = round.solve_together(&mut shared, share.spanning);
        let spanning = round.solve_spanning(&mut shared, &together, solve)?;
        round.tell_across(&mut shared.forces, spanning);
    }
    Ok(shared)
}

impl Shared {
    /// Forces that nobody has solved for yet.
    fn of(forces: &[f64]) -> Shared {
        Shared { forces: forces.to_vec(), iterations: 0, solver: Solver::Formula, largest_island: 0 }
    }

    /// Takes note of how an island of so many contacts was solved.
    fn take(&mut self, contacts: usize, iterations: usize, solver: Solver) {
        (self.iterations, self.solver) = (self.iterations.max(iterations), self.solver.max(solver));
        self.largest_island = self.largest_island.max(contacts);
    }
}

impl<'a, const D: usize> Round<'a, D> {
    fn new(peers: Peers<'a>, view: &'a View<D>, problem: Problem<'a, D>, contacts: &'a [Contact<D>], earlier: usize) -> Self {
        let count = view.halo.len();
        let free = |contact: &Contact<D>| free_body(&problem, contact);
        let mut sets = view.sets(contacts);
        let name = |body: usize| (view.halo.numbers()[body] * peers.count() + view.halo.owner(body)) as f64;
        let mut homes: Vec<f64> = (0..count).map(name).collect();
        let mut changed = vec![0.0; count];
        contacts[earlier..].iter().for_each(|contact| changed[free(contact)] = -1.0);
        view.spread_least(peers, &mut sets, &mut homes);
        view.spread_least(peers, &mut sets, &mut changed);
        let mut crossing = vec![false; count];
        for contact in contacts.iter().filter(|contact| view.across(contact.identity()).is_some()) {
            if contact.other().is_some_and(|other| problem.gives_way(contact.body) && problem.gives_way(other)) {
                crossing[sets.root(contact.body)] = true;
            }
        }
        Round {
            peers,
            view,
            problem,
            contacts,
            homes: homes.into_iter().map(|home| home as u64).collect(),
            changed: changed.into_iter().map(|changed| changed < 0.0).collect(),
            spans: (0..count).map(|body| crossing[sets.root(body)]).collect(),
        }
    }

    fn free(&self, contact: &Contact<D>) -> usize {
        free_body(&self.problem, contact)
    }

    /// Solves the islands that changed of which all bodies that give way are this rank's.
    fn solve_inside(&self, shared: &mut Shared, solve: IslandSolver<D>) -> Result<()> {
        let mut islands: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for (place, contact) in self.contacts.iter().enumerate() {
            let body = self.free(contact);
            if self.changed[body] && !self.spans[body] && self.view.halo.owns(body) {
                islands.entry(self.homes[body]).or_default().push(place);
            }
        }
        for island in islands.values() {
            let (contacts, guess) = (pick(self.contacts, island), pick(&shared.forces, island));
            match solve(&self.problem, &contacts, &guess) {
                Outcome::Solved { forces, iterations, solver } => {
                    island.iter().zip(forces).for_each(|(&place, force)| shared.forces[place] = force);
                    shared.take(contacts.len(), iterations, solver);
                }
                outcome => return Err(failure(&self.problem, &contacts, &outcome)),
            }
        }
        Ok(())
    }

    /// Whether an island that spans ranks is to be solved to which a contact belongs.
    fn spanning(&self, contact: &Contact<D>) -> bool {
        let body = self.free(contact);
        self.changed[body] && self.spans[body]
    }

    /// Solves the islands of many contacts that span ranks by all of them together; gives those that it has solved.
    fn solve_together(&self, shared: &mut Shared, spanning: Spanning) -> BTreeSet<u64> {
        let Spanning::Together { session, most_gathered } = spanning else { return BTreeSet::new() };
        let solves = |&home: &u64| {
            let own = |body: usize| self.view.halo.owns(body) && self.problem.gives_way(body) && self.homes[body] == home;
            let seen = |contact: &Contact<D>| self.spanning(contact) && (own(contact.body) || contact.other().is_some_and(own));
            let places: Vec<usize> = (0..self.contacts.len()).filter(|&place| seen(&self.contacts[place])).collect();
            let (contacts, guess) = (pick(self.contacts, &places), pick(&shared.forces, &places));
            let Outcome::Solved { forces, iterations, solver } = solve_together(session, self.view, &self.problem, &contacts, &guess)
            else {
                return false;
            };
            places.iter().zip(forces).for_each(|(&place, force)| shared.forces[place] = force);
            shared.take(0, iterations, solver);
            true
        };
        self.large_islands(most_gathered).into_iter().filter(solves).collect()
    }

    /// The islands that span ranks and have more contacts than this, by their homes.
    fn large_islands(&self, most: usize) -> Vec<u64> {
        let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
        for contact in self.contacts.iter().filter(|contact| self.spanning(contact) && self.view.answers(contact.identity())) {
            *counts.entry(self.homes[self.free(contact)]).or_default() += 1;
        }
        // on some rank such an island has more than the mean
        let likely: Vec<u64> = counts.iter().filter(|(_, count)| *count * self.peers.count() > most).map(|(home, _)| *home).collect();
        let homes: Vec<u64> = BTreeSet::from_iter(self.peers.gather(&likely)).into_iter().collect();
        let mut sums: Vec<f64> = homes.iter().map(|home| counts.get(home).map_or(0.0, |&count| count as f64)).collect();
        self.peers.sum(&mut sums);
        homes.into_iter().zip(sums).filter(|(_, sum)| *sum > most as f64).map(|(home, _)| home).collect()
    }

    /// Solves the other islands that span ranks, each on one; gives the forces of their contacts that this rank answers for.
    fn solve_spanning(&self, shared: &mut Shared, together: &BTreeSet<u64>, solve: IslandSolver<D>) -> Result<Vec<(Identity<D>, f64)>> {
        let islands = self.gather_spanning(&shared.forces, together);
        let mut replies = vec![Vec::new(); self.peers.count()];
        let outcome = islands.values().try_for_each(|island| {
            let (iterations, solver) = island.solve(&self.problem, solve, &mut replies)?;
            shared.take(island.contacts.len(), iterations, solver);
            Ok(())
        });
        self.peers.agree(outcome)?;
        Ok(self.peers.deliver(&replies).chunks(packed_length::<D>()).map(unpack).collect())
    }

    /// The islands that span ranks and changed of which this rank owns the first body, without those that are solved `together`.
    fn gather_spanning(&self, guess: &[f64], together: &BTreeSet<u64>) -> BTreeMap<u64, GatheredContacts<D>> {
        let mut letters = vec![Vec::new(); self.peers.count()];
        for (contact, guess) in self.contacts.iter().zip(guess) {
            let home = self.homes[self.free(contact)];
            if !(self.spanning(contact) && self.view.answers(contact.identity())) || together.contains(&home) {
                continue;
            }
            let letter = &mut letters[(home % self.peers.count() as u64) as usize];
            letter.push(home as f64);
            letter.push(self.problem.lower_bound(contact));
            letter.extend(pack(self.view.identity(contact), *guess));
            for body in [contact.body, contact.other().unwrap_or(contact.body)] {
                self.write_body(body, letter);
            }
        }
        let mut islands: BTreeMap<u64, GatheredContacts<D>> = BTreeMap::new();
        let (contact, body) = (2 + packed_length::<D>(), Body::<D>::LENGTH);
        for numbers in self.peers.deliver(&letters).chunks(contact + 2 * body) {
            let island = islands.entry(numbers[0] as u64).or_default();
            let (identity, guess) = unpack(&numbers[2..contact]);
            island.contacts.insert(identity, [guess, numbers[1]]);
            island.bodies.extend(numbers[contact..].chunks(body).map(Body::read));
        }
        islands
    }

    fn write_body(&self, body: usize, numbers: &mut Vec<f64>) {
        let (ball, view) = (&self.view.balls[body], self.view);
        numbers.extend([view.halo.numbers()[body] as f64, view.halo.owner(body) as f64, ball.radius, view.weights[body]]);
        numbers.extend(ball.center.iter());
        numbers.extend(self.problem.velocities[body].iter());
    }

    /// Tells the ranks that own the other bodies of contacts what their forces are, and takes the forces that were found elsewhere.
    fn tell_across(&self, forces: &mut [f64], found: Vec<(Identity<D>, f64)>) {
        let crosses = |contact: &Contact<D>| self.changed[self.free(contact)] && self.view.across(contact.identity()).is_some();
        let concerned = self.contacts.iter().enumerate().filter(|(_, contact)| crosses(contact) || self.spanning(contact));
        let places: HashMap<Identity<D>, usize> = concerned.map(|(place, contact)| (self.view.identity(contact), place)).collect();
        found.into_iter().for_each(|(identity, force)| forces[places[&identity]] = force);
        let mut letters = vec![Vec::new(); self.peers.count()];
        for (contact, force) in
            self.contacts.iter().zip(forces.iter()).filter(|(contact, _)| crosses(contact) && self.view.answers(contact.identity()))
        {
            let rank = self.view.across(contact.identity()).expect("it crosses");
            letters[rank].extend(pack(self.view.identity(contact), *force));
        }
        for (identity, force) in self.peers.deliver(&letters).chunks(packed_length::<D>()).map(unpack) {
            forces[places[&identity]] = force;
        }
    }
}

impl<const D: usize> Default for GatheredContacts<D> {
    fn default() -> Self {
        GatheredContacts { bodies: BTreeMap::new(), contacts: BTreeMap::new() }
    }
}

impl<const D: usize> GatheredContacts<D> {
    /// Solves the island; adds to the replies the force of each contact, for the rank that answers for it.
    fn solve(&self, whole: &Problem<D>, solve: IslandSolver<D>, replies: &mut [Vec<f64>]) -> Result<(usize, Solver)> {
        let numbers: Vec<usize> = self.bodies.keys().copied().collect();
        let (balls, rest): (Vec<Ball<D>>, Vec<(f64, SVector<f64, D>)>) =
            self.bodies.values().map(|body| (body.ball, (body.weight, body.wanted))).unzip();
        let (weights, velocities): (Vec<f64>, Vec<SVector<f64, D>>) = rest.into_iter().unzip();
        let place = |number: usize| numbers.binary_search(&number).expect("both bodies came with a contact");
        let again = |&identity: &Identity<D>| Contact::again(whole.domain, &balls, renamed(identity, place));
        let contacts: Vec<Contact<D>> = self.contacts.keys().map(again).collect();
        let bounds = contacts.iter().zip(self.contacts.values()).filter(|(_, [_, bound])| *bound < 0.0);
        let lower_bounds: Vec<_> = bounds.map(|(&contact, &[_, force])| ContactForce::normal(contact, force)).collect();
        let problem = Problem {
            numbers: Some(&numbers),
            balls: &balls,
            weights: &weights,
            velocities: &velocities,
            lower_bounds: &lower_bounds,
            ..*whole
        };
        let guess: Vec<f64> = self.contacts.values().map(|[guess, _]| *guess).collect();
        let outcome = solve(&problem, &contacts, &guess);
        let Outcome::Solved { forces, iterations, solver } = outcome else { return Err(failure(&problem, &contacts, &outcome)) };
        for ((contact, identity), force) in contacts.iter().zip(self.contacts.keys()).zip(forces) {
            let owner = self.bodies[&numbers[free_body(&problem, contact)]].owner;
            replies[owner].extend(pack(*identity, force));
        }
        Ok((iterations, solver))
    }
}

impl<const D: usize> Body<D> {
    /// How many numbers a body takes, with its own.
    const LENGTH: usize = 4 + 2 * D;

    fn read(numbers: &[f64]) -> (usize, Body<D>) {
        let (center, wanted) = numbers[4..].split_at(D);
        let ball = Ball { center: SVector::from_column_slice(center), radius: numbers[2] };
        let body = Body { owner: numbers[1] as usize, ball, weight: numbers[3], wanted: SVector::from_column_slice(wanted) };
        (numbers[0] as usize, body)
    }
}

/// What belongs to the contacts of an island.
pub(super) fn pick<T: Copy>(of_all: &[T], island: &[usize]) -> Vec<T> {
    island.iter().map(|&place| of_all[place]).collect()
}
