//! Islands with friction shared out among the ranks: each is solved on the rank that owns its first body. Everything here is collective.

use std::collections::BTreeMap;

use nalgebra::SVector;

use super::{ContactWrench, FrictionLaw, FrictionShare, program::FrictionIsland, solver::exact::solve_exactly};
use crate::{
    body::{Twist, components, skew},
    contact::{Contact, Identity, LoadedWall, Problem, ProblemShare, View, island::free_body, pack, packed_length, renamed, unpack},
    geometry::{Ball, Domain},
    parallel::Peers,
};

/// What contacts do to their partners, of bodies by number.
pub type Wrenches<const D: usize> = BTreeMap<Identity<D>, ContactWrench<D>>;

/// The wrench of a contact to start from, and whether it was found for the contacts that were known then.
pub type Guess<const D: usize> = (ContactWrench<D>, bool);

/// What solving the islands of a rank took.
#[derive(Default, Clone, Copy)]
pub struct Cost {
    /// Most sweeps.
    pub sweeps: usize,
    /// Most iterations.
    pub iterations: usize,
}

/// A body as it travels.
#[derive(Clone, Copy)]
struct Traveller<const D: usize> {
    owner: usize,
    ball: Ball<D>,
    mass: [f64; 2],
    twist: Twist<D>,
}

/// An island as the rank that solves it has it.
#[derive(Default)]
struct Gathered<const D: usize> {
    bodies: BTreeMap<usize, Traveller<D>>,
    /// Contacts with a guess of the wrench of each.
    contacts: Wrenches<D>,
    /// Whether a contact is new.
    is_new: bool,
}

/// What a rank sees of bodies and contacts whose friction is solved.
pub struct Shared<'a, const D: usize> {
    /// The ranks.
    pub peers: Peers<'a>,
    /// What is seen.
    pub view: &'a View<D>,
    /// The problem of the own bodies.
    pub share: &'a ProblemShare<'a, D>,
    /// Masses and moments of inertia of the bodies that are seen.
    pub masses: &'a [[f64; 2]],
    /// Their motions wanted.
    pub twists: &'a [Twist<D>],
    /// All contacts of own bodies, of bodies by place, by identity.
    pub contacts: &'a [Contact<D>],
}

impl<const D: usize> Shared<'_, D> {
    /// The wrenches of all contacts of own bodies, from a guess; an island without a new contact keeps its own.
    pub fn solve(&self, friction: &FrictionShare<D>, guess: &dyn Fn(&Identity<D>) -> Guess<D>) -> (Wrenches<D>, Cost) {
        let (domain, step) = (self.share.problem.domain, self.share.problem.step);
        let mut letters = vec![Vec::new(); self.peers.count()];
        let mut cost = Cost::default();
        if let Some(wall) = self.share.problem.wall {
            let wrenches = if D == 2 {
                self.solve_whole::<3>(wall, friction, guess, &mut cost)
            } else {
                self.solve_whole::<6>(wall, friction, guess, &mut cost)
            };
            return (wrenches, cost);
        }
        for island in self.gather(guess).values() {
            let found = if !island.is_new {
                island.contacts.clone()
            } else if D == 2 {
                island.solve::<3>(domain, step, friction, &mut cost)
            } else {
                island.solve::<6>(domain, step, friction, &mut cost)
            };
            for (identity, wrench) in found {
                let mut owners: Vec<usize> = crate::contact::bodies_of(identity).map(|body| island.bodies[&body].owner).collect();
                owners.dedup();
                owners.into_iter().for_each(|owner| write(identity, &wrench, 0.0, &mut letters[owner]));
            }
        }
        let read = |numbers: &[f64]| {
            let (identity, wrench, _) = read(numbers);
            (identity, wrench)
        };
        let wrenches = self.peers.deliver(&letters).chunks(record::<D>()).map(read).collect();
        let most = |count: usize| self.peers.max(count as f64) as usize;
        (wrenches, Cost { sweeps: most(cost.sweeps), iterations: most(cost.iterations) })
    }

    /// The wrenches of all contacts of a problem of all bodies, among them a wall by which most of them hang together.
    fn solve_whole<const W: usize>(
        &self,
        wall: LoadedWall,
        friction: &FrictionShare<D>,
        guess: &dyn Fn(&Identity<D>) -> Guess<D>,
        cost: &mut Cost,
    ) -> Wrenches<D> {
        let laws: Vec<FrictionLaw> = self.contacts.iter().map(|contact| friction.surfaces.of(contact.identity())).collect();
        let (Problem { domain, step, .. }, duration) = (self.share.problem, friction.duration);
        let (balls, masses, twists) = (&self.view.balls, self.masses, self.twists);
        let island =
            FrictionIsland { domain, balls, masses, twists, step, contacts: self.contacts, laws: &laws, duration, wall: Some(wall) };
        let program = island.program::<W>();
        let guess: Vec<ContactWrench<D>> = self.contacts.iter().map(|contact| guess(&contact.identity()).0).collect();
        let found = solve_exactly(&program, island.impulses(&program, &guess), friction.tolerance);
        *cost = Cost { sweeps: found.sweeps, iterations: found.iterations };
        self.contacts.iter().map(Contact::identity).zip(island.wrenches(&program, &found.forces)).collect()
    }

    /// The islands of which this rank owns the first body that gives way.
    fn gather(&self, guess: &dyn Fn(&Identity<D>) -> Guess<D>) -> BTreeMap<u64, Gathered<D>> {
        let homes = self.homes();
        let mut letters = vec![Vec::new(); self.peers.count()];
        for contact in self.contacts.iter().filter(|contact| self.view.answers(contact.identity())) {
            let home = homes[free_body(&self.view.problem(&self.share.problem), contact)];
            let letter = &mut letters[(home % self.peers.count() as u64) as usize];
            let identity = self.view.identity(contact);
            let (wrench, is_old) = guess(&identity);
            write(identity, &wrench, home as f64, letter);
            letter.push(f64::from(is_old));
            [contact.body, contact.other().unwrap_or(contact.body)].into_iter().for_each(|body| self.write_body(body, letter));
        }
        let mut islands: BTreeMap<u64, Gathered<D>> = BTreeMap::new();
        let (contact, body) = (record::<D>(), Traveller::<D>::LENGTH);
        for numbers in self.peers.deliver(&letters).chunks(contact + 1 + 2 * body) {
            let (identity, guess, home) = read(&numbers[..contact]);
            let island = islands.entry(home as u64).or_default();
            island.is_new |= numbers[contact] == 0.0;
            island.contacts.insert(identity, guess);
            island.bodies.extend(numbers[contact + 1..].chunks(body).map(Traveller::read));
        }
        islands
    }

    /// For each body that gives way the number of the first body of its island, times the number of ranks, plus the rank that owns it.
    fn homes(&self) -> Vec<u64> {
        let (view, count) = (self.view, self.peers.count());
        let name = |body: usize| (view.halo.numbers()[body] * count + view.halo.owner(body)) as f64;
        let mut homes: Vec<f64> = (0..view.halo.len()).map(name).collect();
        view.spread_least(self.peers, &mut view.sets(self.contacts), &mut homes);
        homes.into_iter().map(|home| home as u64).collect()
    }

    fn write_body(&self, body: usize, letter: &mut Vec<f64>) {
        let (ball, twist) = (&self.view.balls[body], &self.twists[body]);
        letter.extend([self.view.halo.numbers()[body] as f64, self.view.halo.owner(body) as f64, ball.radius]);
        letter.extend(self.masses[body]);
        letter.extend(ball.center.iter().chain(twist.velocity.iter()));
        letter.extend(components(&twist.spin));
    }
}

/// How many numbers [`write()`] makes.
const fn record<const D: usize>() -> usize {
    packed_length::<D>() + D + D * (D - 1) / 2
}

fn write<const D: usize>(identity: Identity<D>, wrench: &ContactWrench<D>, number: f64, letter: &mut Vec<f64>) {
    letter.extend(pack(identity, number));
    letter.extend(wrench.force.iter());
    letter.extend(components(&wrench.couple));
}

fn read<const D: usize>(numbers: &[f64]) -> (Identity<D>, ContactWrench<D>, f64) {
    let (identity, number) = unpack(&numbers[..packed_length::<D>()]);
    let (force, couple) = numbers[packed_length::<D>()..].split_at(D);
    (identity, ContactWrench { force: SVector::from_column_slice(force), couple: skew(couple) }, number)
}

impl<const D: usize> Traveller<D> {
    /// How many numbers a body takes, with its own.
    const LENGTH: usize = 5 + 2 * D + D * (D - 1) / 2;

    fn read(numbers: &[f64]) -> (usize, Traveller<D>) {
        let (center, motion) = numbers[5..].split_at(D);
        let twist = Twist { velocity: SVector::from_column_slice(&motion[..D]), spin: skew::<D>(&motion[D..]) };
        let ball = Ball { center: SVector::from_column_slice(center), radius: numbers[2] };
        (numbers[0] as usize, Traveller { owner: numbers[1] as usize, ball, mass: [numbers[3], numbers[4]], twist })
    }
}

impl<const D: usize> Gathered<D> {
    fn solve<const W: usize>(&self, domain: &Domain<D>, step: f64, friction: &FrictionShare<D>, cost: &mut Cost) -> Wrenches<D> {
        let numbers: Vec<usize> = self.bodies.keys().copied().collect();
        let balls: Vec<Ball<D>> = self.bodies.values().map(|body| body.ball).collect();
        let masses: Vec<[f64; 2]> = self.bodies.values().map(|body| body.mass).collect();
        let twists: Vec<Twist<D>> = self.bodies.values().map(|body| body.twist).collect();
        let place = |number: usize| numbers.binary_search(&number).expect("both bodies came with a contact");
        let again = |&identity: &Identity<D>| Contact::again(domain, &balls, renamed(identity, place));
        let contacts: Vec<Contact<D>> = self.contacts.keys().map(again).collect();
        let laws: Vec<FrictionLaw> = self.contacts.keys().map(|&identity| friction.surfaces.of(identity)).collect();
        let island = FrictionIsland {
            domain,
            balls: &balls,
            masses: &masses,
            twists: &twists,
            step,
            contacts: &contacts,
            laws: &laws,
            duration: friction.duration,
            wall: None,
        };
        let program = island.program::<W>();
        let guess: Vec<ContactWrench<D>> = self.contacts.values().copied().collect();
        let found = solve_exactly(&program, island.impulses(&program, &guess), friction.tolerance);
        (cost.sweeps, cost.iterations) = (cost.sweeps.max(found.sweeps), cost.iterations.max(found.iterations));
        self.contacts.keys().copied().zip(island.wrenches(&program, &found.forces)).collect()
    }
}
