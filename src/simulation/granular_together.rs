//! Bonds and contacts of dry bodies solved at once, where held in turn they would take long to agree.
//!
//! Every rank gathers the contacts that are known so far, the chains that they concern and the bodies of both, and solves its part of the islands.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use nalgebra::SVector;

use crate::{
    contact::{Contact, ContactForce, Identity, ProjectionShare, Tie, TiedProblem, bodies_of, pack, packed_length, renamed, unpack},
    geometry::{Ball, Domain},
    parallel::Peers,
};

/// The contacts that projections of a step have found so far.
pub struct Together<const D: usize> {
    /// By bodies' numbers those that this rank answers for, each with the least force that it may bear.
    contacts: BTreeMap<Identity<D>, f64>,
}

/// The own bodies of a rank, which want to move over a step.
pub struct Wanting<'a, const D: usize> {
    pub domain: &'a Domain<D>,
    pub numbers: &'a [usize],
    pub balls: &'a [Ball<D>],
    pub masses: &'a [f64],
    pub velocities: &'a [SVector<f64, D>],
    pub step: f64,
}

/// A body as it travels.
struct Body<const D: usize> {
    ball: Ball<D>,
    mass: f64,
    velocity: SVector<f64, D>,
}

impl<const D: usize> Together<D> {
    pub fn new() -> Self {
        Together { contacts: BTreeMap::new() }
    }

    /// Takes note of the contacts of a projection; of those in `lower_bounds`, which are sorted by identity, some force may be negative.
    pub fn meet(&mut self, found: &ProjectionShare<D>, lower_bounds: &[ContactForce<D>]) {
        let answered = found.projection.forces.iter().filter(|force| found.view.answers(force.contact.identity()));
        for identity in answered.map(|force| found.view.identity(&force.contact)) {
            let bound = lower_bounds.binary_search_by_key(&identity, |bound| bound.contact.identity());
            self.contacts.insert(identity, bound.map_or(0.0, |place| lower_bounds[place].force));
        }
    }

    /// What contacts change velocities by where these rows tie bodies by number too; none where no velocities keep both. Collective.
    pub fn changes(&self, peers: Peers, own: &Wanting<D>, rows: &[Tie<D>]) -> Option<Vec<SVector<f64, D>>> {
        let letters: Vec<f64> = self.contacts.iter().flat_map(|(identity, bound)| pack(*identity, *bound)).collect();
        let contacts: Vec<(Identity<D>, f64)> = peers.gather(&letters).chunks(packed_length::<D>()).map(unpack).collect();
        let touching: BTreeSet<usize> = contacts.iter().flat_map(|(identity, _)| bodies_of(*identity)).collect();
        let ties = gathered_ties(peers, rows, &touching);
        let tied = ties.iter().flat_map(|tie| tie.ends.iter().map(|end| end.0));
        let bodies = own.gathered(peers, &touching.iter().copied().chain(tied).collect());
        let numbers: Vec<usize> = bodies.keys().copied().collect();
        let place_of: HashMap<usize, usize> = numbers.iter().enumerate().map(|(place, &number)| (number, place)).collect();
        let balls: Vec<Ball<D>> = bodies.values().map(|body| body.ball).collect();
        let weights: Vec<f64> = bodies.values().map(|body| body.mass / own.step).collect();
        let velocities: Vec<SVector<f64, D>> = bodies.values().map(|body| body.velocity).collect();
        let placed = |(identity, force): &(Identity<D>, f64)| ContactForce {
            contact: Contact::again(own.domain, &balls, renamed(*identity, |number| place_of[&number])),
            force: *force,
        };
        let contacts: Vec<ContactForce<D>> = contacts.iter().map(placed).collect();
        let ties: Vec<Tie<D>> = ties
            .into_iter()
            .map(|tie| Tie { ends: tie.ends.into_iter().map(|(number, direction)| (place_of[&number], direction)).collect(), ..tie })
            .collect();
        let problem = TiedProblem { weights: &weights, velocities: &velocities, ties: &ties, contacts: &contacts, step: own.step };
        let found = problem.changes(peers.rank(), peers.count());
        if peers.any(found.is_none()) {
            return None;
        }
        let mut changes: Vec<f64> = found?.iter().flat_map(|change| change.iter().copied().collect::<Vec<f64>>()).collect();
        peers.sum(&mut changes);
        let change = |number: &usize| place_of.get(number).map_or(SVector::zeros(), |&place| SVector::from_column_slice(&changes[D * place..D * (place + 1)]));
        Some(own.numbers.iter().map(change).collect())
    }
}

impl<const D: usize> Wanting<'_, D> {
    /// Those bodies of all ranks that are asked for, by their numbers. Collective.
    fn gathered(&self, peers: Peers, asked: &BTreeSet<usize>) -> BTreeMap<usize, Body<D>> {
        let mut letters = Vec::new();
        for (place, number) in self.numbers.iter().enumerate().filter(|(_, number)| asked.contains(number)) {
            letters.extend([*number as f64, self.masses[place], self.balls[place].radius]);
            letters.extend(self.balls[place].center.iter().chain(self.velocities[place].iter()));
        }
        let read = |numbers: &[f64]| {
            let (center, velocity) = numbers[3..].split_at(D);
            let ball = Ball { center: SVector::from_column_slice(center), radius: numbers[2] };
            (numbers[0] as usize, Body { ball, mass: numbers[1], velocity: SVector::from_column_slice(velocity) })
        };
        peers.gather(&letters).chunks(3 + 2 * D).map(read).collect()
    }
}

/// The rows of all ranks that hang together with these bodies, in the order of their first bodies. Collective.
fn gathered_ties<const D: usize>(peers: Peers, rows: &[Tie<D>], touching: &BTreeSet<usize>) -> Vec<Tie<D>> {
    let mut letters = Vec::new();
    for tie in rows {
        letters.extend([tie.ends.len() as f64, tie.rate, tie.compliance]);
        tie.ends.iter().for_each(|(number, direction)| letters.extend(std::iter::once(*number as f64).chain(direction.iter().copied())));
    }
    let letters = peers.gather(&letters);
    let (mut ties, mut rest) = (Vec::new(), &letters[..]);
    while let [count, rate, compliance, numbers @ ..] = rest {
        let (ends, next) = numbers.split_at(*count as usize * (1 + D));
        let end = |end: &[f64]| (end[0] as usize, SVector::from_column_slice(&end[1..]));
        ties.push(Tie { ends: ends.chunks(1 + D).map(end).collect(), rate: *rate, compliance: *compliance });
        rest = next;
    }
    ties
}
