//! The bodies that a rank sees: its own, and copies of those of other ranks that may be near them.
//!
//! Bodies are listed by their numbers among all of the run, so that any two of them stand in the same order on every rank, and what is
//! computed of a pair is the same to the last bit wherever it is computed.

use nalgebra::{SMatrix, SVector};

use super::{Regions, Twist, components, skew};
use crate::{
    geometry::{Ball, Bounds, Domain},
    parallel::{Peers, Routes},
};

/// A rank's own bodies and its copies of others, in the order of their numbers.
#[derive(Debug, Clone)]
pub struct Halo {
    numbers: Vec<usize>,
    /// The rank that owns each.
    owners: Vec<usize>,
    rank: usize,
    /// Places of the own bodies.
    own: Vec<usize>,
    /// Who has copies of the own bodies, and who of theirs this rank.
    routes: Routes,
    /// Places of the copies, in the order in which they come.
    copies: Vec<usize>,
}

/// The bodies of a rank in space.
pub struct OwnBodies<'a, const D: usize> {
    /// The box at the time at which places hold.
    pub domain: &'a Domain<D>,
    /// Which rank owns what part of it.
    pub regions: &'a Regions<D>,
    /// Numbers among all bodies, ascending.
    pub numbers: &'a [usize],
    /// A ball around each; a copy goes to every rank with a ball that may meet it.
    pub around: &'a [Ball<D>],
}

impl Halo {
    /// The halo of the bodies of this rank, in which those with the numbers that are `required` are seen wherever they are. Collective.
    pub fn new<const D: usize>(peers: Peers, bodies: &OwnBodies<D>, required: impl Iterator<Item = usize>) -> Halo {
        let mut targets: Vec<Vec<usize>> = vec![Vec::new(); peers.count()];
        if peers.count() == 1 {
            return Halo::of_copies(peers, bodies.numbers, &targets);
        }
        let own = bodies.bounds(peers.rank());
        let all = peers.gather(&Bounds::around(&own).numbers());
        for (rank, numbers) in all.chunks(2 * D).enumerate().filter(|&(rank, _)| rank != peers.rank()) {
            let theirs = Bounds::<D>::read(numbers);
            targets[rank] = (0..own.len()).filter(|&body| own[body].meets(&theirs, bodies.domain)).collect();
        }
        Halo::with(peers, bodies.numbers, targets, required)
    }

    /// The halo in which no bodies are seen but the own ones of these numbers and those that are `required`. Collective.
    pub fn of_numbers(peers: Peers, numbers: &[usize], required: impl Iterator<Item = usize>) -> Halo {
        Halo::with(peers, numbers, vec![Vec::new(); peers.count()], required)
    }

    /// The halo in which each rank gets copies of these of the own bodies, and of those that it requires.
    fn with(peers: Peers, numbers: &[usize], mut targets: Vec<Vec<usize>>, required: impl Iterator<Item = usize>) -> Halo {
        let halo = Halo::of_copies(peers, numbers, &targets);
        if peers.count() == 1 {
            return halo;
        }
        let missing = required.filter(|&number| halo.place(number).is_none());
        let missing = peers.gather(&missing.flat_map(|number| [number as u64, peers.rank() as u64]).collect::<Vec<u64>>());
        if missing.is_empty() {
            return halo;
        }
        for request in missing.chunks(2) {
            if let Ok(body) = numbers.binary_search(&(request[0] as usize)) {
                targets[request[1] as usize].push(body);
            }
        }
        targets.iter_mut().for_each(|bodies| {
            bodies.sort_unstable();
            bodies.dedup();
        });
        Halo::of_copies(peers, numbers, &targets)
    }

    /// The halo in which each rank gets copies of these of the own bodies. Collective.
    fn of_copies(peers: Peers, own_numbers: &[usize], targets: &[Vec<usize>]) -> Halo {
        let routes = Routes::new(peers, targets);
        let numbers = routes.copies(peers, |body| [own_numbers[body] as f64]);
        let copies = numbers.iter().zip(routes.sources()).enumerate().map(|(copy, ([number], rank))| (*number as usize, rank, Some(copy)));
        let mine = own_numbers.iter().map(|&number| (number, peers.rank(), None));
        let mut known: Vec<(usize, usize, Option<usize>)> = mine.chain(copies).collect();
        known.sort_unstable();
        let mut places = vec![0; numbers.len()];
        let mut own = Vec::with_capacity(own_numbers.len());
        for (place, &(_, _, copy)) in known.iter().enumerate() {
            match copy {
                Some(copy) => places[copy] = place,
                None => own.push(place),
            }
        }
        Halo {
            numbers: known.iter().map(|&(number, ..)| number).collect(),
            owners: known.iter().map(|&(_, owner, _)| owner).collect(),
            rank: peers.rank(),
            own,
            routes,
            copies: places,
        }
    }

    /// How many bodies this rank sees.
    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Whether it sees none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Numbers of the bodies among all, ascending.
    pub fn numbers(&self) -> &[usize] {
        &self.numbers
    }

    /// Places of the own bodies among those seen, ascending.
    pub fn own(&self) -> &[usize] {
        &self.own
    }

    /// Whether the body at a place is this rank's own.
    pub fn owns(&self, place: usize) -> bool {
        self.owners[place] == self.rank
    }

    /// The rank that owns the body at a place.
    pub fn owner(&self, place: usize) -> usize {
        self.owners[place]
    }

    /// The place of a body, if it is seen.
    pub fn place(&self, number: usize) -> Option<usize> {
        // without other ranks numbers are places
        if self.numbers.get(number) == Some(&number) { Some(number) } else { self.numbers.binary_search(&number).ok() }
    }

    /// Numbers of all bodies that are seen, from those of the own ones. Collective.
    pub fn spread(&self, peers: Peers, own: &[f64]) -> Vec<f64> {
        self.spread_rows(peers, |body| [own[body]]).into_iter().map(|[value]| value).collect()
    }

    /// Vectors of all bodies that are seen, from those of the own ones. Collective.
    pub fn spread_vectors<const D: usize>(&self, peers: Peers, own: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        self.spread_rows::<D>(peers, |body| own[body].into()).into_iter().map(SVector::from).collect()
    }

    /// Motions of all bodies that are seen, from velocities and spins of the own ones. Collective.
    pub fn spread_twists<const D: usize>(
        &self,
        peers: Peers,
        velocities: &[SVector<f64, D>],
        spins: &[SMatrix<f64, D, D>],
    ) -> Vec<Twist<D>> {
        let velocities = self.spread_vectors(peers, velocities);
        let spins = self.spread_rows::<3>(peers, |body| {
            let mut row = [0.0; 3];
            row.iter_mut().zip(components(&spins[body])).for_each(|(entry, component)| *entry = component);
            row
        });
        velocities.into_iter().zip(spins).map(|(velocity, spin)| Twist { velocity, spin: skew(&spin) }).collect()
    }

    /// All bodies that are seen as balls, from the own ones. Collective.
    pub fn spread_balls<const D: usize>(&self, peers: Peers, own: &[Ball<D>]) -> Vec<Ball<D>> {
        let centers: Vec<SVector<f64, D>> = own.iter().map(|ball| ball.center).collect();
        let radii: Vec<f64> = own.iter().map(|ball| ball.radius).collect();
        let spread = self.spread_vectors(peers, &centers).into_iter().zip(self.spread(peers, &radii));
        spread.map(|(center, radius)| Ball { center, radius }).collect()
    }

    fn spread_rows<const W: usize>(&self, peers: Peers, own: impl Fn(usize) -> [f64; W]) -> Vec<[f64; W]> {
        let mut values = vec![[0.0; W]; self.len()];
        self.own.iter().enumerate().for_each(|(body, &place)| values[place] = own(body));
        self.copies.iter().zip(self.routes.copies(peers, own)).for_each(|(&place, value)| values[place] = value);
        values
    }

    /// Gives copies the numbers that their owners have. Collective.
    pub fn update(&self, peers: Peers, values: &mut [f64]) {
        let copies = self.routes.copies(peers, |body| [values[self.own[body]]]);
        self.copies.iter().zip(copies).for_each(|(&place, [value])| values[place] = value);
    }
}

impl<const D: usize> OwnBodies<'_, D> {
    /// Boxes around the own balls, each in the image next to the block of this rank.
    fn bounds(&self, rank: usize) -> Vec<Bounds<D>> {
        let middle = self.regions.middle(rank);
        self.around.iter().map(|ball| Bounds::of(self.domain, ball, &middle)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    #[test]
    fn without_other_ranks_all_that_is_seen_is_own() {
        let domain = Domain { size: SVector::from([10.0, 4.0]), axes: [Axis::Periodic; 2] };
        let regions = Regions::new(&domain, 1);
        let around = [Ball { center: SVector::from([1.0, 1.0]), radius: 0.5 }; 3];
        let halo = Halo::new(
            Peers::Alone,
            &OwnBodies { domain: &domain, regions: &regions, numbers: &[2, 5, 7], around: &around },
            std::iter::empty(),
        );
        assert_eq!((halo.numbers(), halo.own()), (&[2, 5, 7][..], &[0, 1, 2][..]));
        assert_eq!((halo.place(5), halo.place(0)), (Some(1), None));
        assert_eq!(halo.spread(Peers::Alone, &[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
    }
}
