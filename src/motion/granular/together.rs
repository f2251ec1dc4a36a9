//! Bonds, rigid clusters and contacts of dry bodies solved at once, where held in turn they would take long to agree.
//!
//! Every rank gathers the contacts that are known so far, the chains that they concern and the bodies of both, and solves its part of the islands.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{SMatrix, SVector};

use super::{chains::GranularStep, ties::Ties};
use crate::{
    body::{RigidFunctional, Row},
    contact::{
        Contact, ContactForce, Identity, ProjectionShare, RIGID, RigidBalls, TiedProblem, bodies_of, pack, packed_length, renamed, unpack,
    },
    friction::RigidTwists,
    geometry::{Ball, Domain},
    parallel::Peers,
};

/// Smallest violation, in distances of centres, that unknowns are scaled by.
const SMALLEST_SCALE: f64 = 1e-7;

/// The contacts that projections of a step have found so far.
#[derive(Default)]
pub struct Together<const D: usize> {
    /// By bodies' numbers those that this rank answers for, each with the least force that it may bear, and whether it bore more last.
    contacts: BTreeMap<Identity<D>, (f64, bool)>,
}

/// The own bodies of a rank, which want to move over a step.
pub struct Wanting<'a, const D: usize> {
    pub domain: &'a Domain<D>,
    pub numbers: &'a [usize],
    pub balls: &'a [Ball<D>],
    pub masses: &'a [f64],
    pub velocities: &'a [SVector<f64, D>],
    pub step: GranularStep,
}

/// Bodies of all ranks, in the order of their numbers.
struct Gathered<const D: usize> {
    numbers: Vec<usize>,
    balls: Vec<Ball<D>>,
    weights: Vec<f64>,
    velocities: Vec<SVector<f64, D>>,
}

impl<const D: usize> Together<D> {
    /// Takes note of the contacts of a projection; those that may pull are in `lower_bounds`, sorted by identity.
    pub fn meet(&mut self, found: &ProjectionShare<D>, lower_bounds: &[ContactForce<D>]) {
        for met in found.projection.forces.iter().filter(|met| found.view.answers(met.contact.identity())) {
            let identity = found.view.identity(&met.contact);
            let bound = lower_bounds.binary_search_by_key(&identity, |bound| bound.contact.identity());
            let least = bound.map_or(0.0, |place| lower_bounds[place].force);
            self.contacts.insert(identity, (least, met.force > least));
        }
    }

    /// What contacts change velocities by where bonds and these clusters of the rank act too; nothing where no velocities keep both. Collective.
    pub fn changes(&self, peers: Peers, own: &Wanting<D>, ties: &Ties<D>, clusters: &[RigidBalls<D>]) -> Option<Vec<SVector<f64, D>>> {
        let contacts = self.gathered(peers);
        let touching: BTreeSet<usize> = contacts.iter().flat_map(|(identity, ..)| bodies_of(*identity)).collect();
        let ties = gathered_ties(peers, &ties.rows(&touching));
        let clusters =
            gathered_clusters(peers, clusters.iter().filter(|RigidBalls(balls)| balls.iter().any(|ball| touching.contains(&ball.0))));
        let tied = ties.iter().flat_map(|tie| tie.ends.iter().map(|end| end.0));
        let of_clusters = clusters.iter().flat_map(|RigidBalls(balls)| balls.iter().map(|ball| ball.0));
        let bodies = own.gathered(peers, &touching.iter().copied().chain(tied).chain(of_clusters).collect());
        let contact = |identity: &Identity<D>| Contact::again(own.domain, &bodies.balls, renamed(*identity, |number| bodies.place(number)));
        let farthest = contacts.iter().map(|(identity, ..)| contact(identity).separation).fold(0.0, f64::max);
        let row = |(identity, least, _): &(Identity<D>, f64, bool)| Row { least: *least, ..contact(identity).row(own.step.length) };
        let rows: Vec<Row<D>> = contacts.iter().map(row).collect();
        let presses: Vec<bool> = contacts.iter().map(|(.., presses)| *presses).collect();
        let tie = |tie: Row<D>| Row { ends: tie.ends.into_iter().map(|(number, side)| (bodies.place(number), side)).collect(), ..tie };
        let ties: Vec<Row<D>> = ties.into_iter().map(tie).collect();
        let rigid =
            |RigidBalls(balls): RigidBalls<D>| RigidBalls(balls.into_iter().map(|(number, moved)| (bodies.place(number), moved)).collect());
        let rigid: Vec<RigidBalls<D>> = clusters.into_iter().map(rigid).collect();
        let Gathered { weights, velocities, .. } = &bodies;
        let smallest = SMALLEST_SCALE * farthest / own.step.length;
        let problem = TiedProblem { weights, velocities, ties: &ties, rigid: &rigid, contacts: &rows, presses: &presses, smallest };
        let found = problem.changes(peers.rank(), peers.count());
        if peers.any(found.is_none()) {
            return None;
        }
        let mut changes: Vec<f64> = found?.iter().flat_map(|change| <[f64; D]>::from(*change)).collect();
        peers.sum(&mut changes);
        let of_body = |number: &usize| {
            let place = bodies.numbers.binary_search(number).ok();
            place.map_or(SVector::zeros(), |place| SVector::from_column_slice(&changes[D * place..D * (place + 1)]))
        };
        Some(own.numbers.iter().map(of_body).collect())
    }

    /// The contacts of all ranks. Collective.
    fn gathered(&self, peers: Peers) -> Vec<(Identity<D>, f64, bool)> {
        let letter =
            |(identity, (least, presses)): (&Identity<D>, &(f64, bool))| [pack(*identity, *least), vec![f64::from(*presses)]].concat();
        let letters: Vec<f64> = self.contacts.iter().flat_map(letter).collect();
        let read = |letter: &[f64]| {
            let (identity, least) = unpack(letter);
            (identity, least, letter[packed_length::<D>()] > 0.0)
        };
        let mut contacts: Vec<(Identity<D>, f64, bool)> = peers.gather(&letters).chunks(packed_length::<D>() + 1).map(read).collect();
        contacts.sort_by_key(|contact| contact.0);
        contacts
    }
}

impl<const D: usize> Wanting<'_, D> {
    /// Those bodies of all ranks that are asked for. Collective.
    fn gathered(&self, peers: Peers, asked: &BTreeSet<usize>) -> Gathered<D> {
        let mut letters = Vec::new();
        for (place, number) in self.numbers.iter().enumerate().filter(|(_, number)| asked.contains(number)) {
            letters.extend([*number as f64, self.masses[place], self.balls[place].radius]);
            letters.extend(self.balls[place].center.iter().chain(self.velocities[place].iter()));
        }
        let letters = peers.gather(&letters);
        let mut bodies: Vec<&[f64]> = letters.chunks(3 + 2 * D).collect();
        bodies.sort_by_key(|body| body[0] as usize);
        let vector = |numbers: &[f64]| SVector::from_column_slice(&numbers[..D]);
        Gathered {
            numbers: bodies.iter().map(|body| body[0] as usize).collect(),
            balls: bodies.iter().map(|body| Ball { center: vector(&body[3..]), radius: body[2] }).collect(),
            weights: bodies.iter().map(|body| body[1] / self.step.push).collect(),
            velocities: bodies.iter().map(|body| vector(&body[3 + D..])).collect(),
        }
    }
}

impl<const D: usize> Gathered<D> {
    fn place(&self, number: usize) -> usize {
        self.numbers.binary_search(&number).expect("bodies of contacts and bonds are gathered")
    }
}

/// The ties of all ranks, which turn no body, in the order of their bodies. Collective.
pub(super) fn gathered_ties<const D: usize>(peers: Peers, own: &[Row<D>]) -> Vec<Row<D>> {
    let mut letters = Vec::new();
    for tie in own {
        letters.extend([tie.ends.len() as f64, tie.rate, tie.compliance]);
        tie.ends.iter().for_each(|(number, side)| letters.extend([*number as f64].iter().chain(side.direction.iter())));
    }
    let letters = peers.gather(&letters);
    let (mut ties, mut rest) = (Vec::new(), &letters[..]);
    while let [count, rate, compliance, numbers @ ..] = rest {
        let (ends, next) = numbers.split_at(*count as usize * (1 + D));
        let side = |direction: &[f64]| RigidFunctional { direction: SVector::from_column_slice(direction), turn: SMatrix::zeros() };
        let end = |end: &[f64]| (end[0] as usize, side(&end[1..]));
        ties.push(Row::new(ends.chunks(1 + D).map(end).collect(), *rate, *compliance));
        rest = next;
    }
    // stable: rows of a chain come from one rank and keep their order
    ties.sort_by_key(|tie| tie.ends.iter().map(|end| end.0).max());
    ties
}

/// How the clusters of all ranks move, in the order of their balls. Collective.
pub(super) fn gathered_rigid_twists<const D: usize>(peers: Peers, own: &[RigidTwists<D>]) -> Vec<RigidTwists<D>> {
    let mut letters = Vec::new();
    for RigidTwists { balls, spin } in own {
        letters.push(balls.len() as f64);
        letters.extend(spin.iter());
        balls.iter().for_each(|(number, moved)| letters.extend([*number as f64].iter().chain(moved.iter())));
    }
    let letters = peers.gather(&letters);
    let (mut clusters, mut rest) = (Vec::new(), &letters[..]);
    while let [count, numbers @ ..] = rest {
        let (spin, numbers) = numbers.split_at(3 * RIGID);
        let (balls, next) = numbers.split_at(*count as usize * (1 + D * RIGID));
        let ball = |ball: &[f64]| (ball[0] as usize, SMatrix::from_column_slice(&ball[1..]));
        let balls = balls.chunks(1 + D * RIGID).map(ball).collect();
        clusters.push(RigidTwists { balls, spin: SMatrix::from_column_slice(spin) });
        rest = next;
    }
    clusters.sort_by_key(|cluster: &RigidTwists<D>| cluster.balls[0].0);
    clusters
}

/// The clusters of all ranks, in the order of their balls. Collective.
fn gathered_clusters<'a, const D: usize>(peers: Peers, own: impl Iterator<Item = &'a RigidBalls<D>>) -> Vec<RigidBalls<D>> {
    let mut letters = Vec::new();
    for RigidBalls(balls) in own {
        letters.push(balls.len() as f64);
        balls.iter().for_each(|(number, moved)| letters.extend([*number as f64].iter().chain(moved.iter())));
    }
    let letters = peers.gather(&letters);
    let (mut clusters, mut rest) = (Vec::new(), &letters[..]);
    while let [count, numbers @ ..] = rest {
        let (balls, next) = numbers.split_at(*count as usize * (1 + D * RIGID));
        let ball = |ball: &[f64]| (ball[0] as usize, SMatrix::from_column_slice(&ball[1..]));
        clusters.push(RigidBalls(balls.chunks(1 + D * RIGID).map(ball).collect()));
        rest = next;
    }
    clusters.sort_by_key(|RigidBalls(balls): &RigidBalls<D>| balls[0].0);
    clusters
}
