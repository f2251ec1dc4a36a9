//! A program that all ranks share: each has the constraints of its own bodies, and copies of the other bodies in them.
//!
//! A constraint between bodies of two ranks is on both, which compute the same of it to the last bit; in sums one of them counts it.
//! Everything here is collective.

use crate::{
    body::Halo,
    parallel::{Peers, Routes},
    petsc::Session,
};

/// Who has what of a program.
pub struct Sharing<'a> {
    pub session: &'a Session,
    /// Numbers of the bodies that this rank sees, ascending.
    pub numbers: Vec<usize>,
    /// Places of its own ones, and of copies in the order in which they come.
    pub own: Vec<usize>,
    copies: Vec<usize>,
    routes: Routes,
    /// Whether this rank counts a constraint.
    counts: Vec<bool>,
    /// Constraints of all ranks.
    count: f64,
}

impl<'a> Sharing<'a> {
    /// Of bodies by their places in a halo, ascending, and constraints of which this rank counts some.
    pub fn new(session: &'a Session, halo: &Halo, bodies: &[usize], counts: Vec<bool>) -> Sharing<'a> {
        let peers = Peers::from(session.world());
        let (mut wanted, mut copies) = (vec![Vec::new(); peers.count()], vec![Vec::new(); peers.count()]);
        for (place, &body) in bodies.iter().enumerate().filter(|&(_, &body)| !halo.owns(body)) {
            wanted[halo.owner(body)].push(halo.numbers()[body]);
            copies[halo.owner(body)].push(place);
        }
        let mut count = [counts.iter().filter(|&&counts| counts).count() as f64];
        peers.sum(&mut count);
        Sharing {
            session,
            numbers: bodies.iter().map(|&body| halo.numbers()[body]).collect(),
            own: (0..bodies.len()).filter(|&place| halo.owns(bodies[place])).collect(),
            copies: copies.concat(),
            routes: Routes::asking(peers, &wanted),
            counts,
            count: count[0],
        }
    }

    /// The ranks.
    pub fn peers(&self) -> Peers<'a> {
        self.session.world().into()
    }

    /// How many constraints there are.
    pub fn count(&self) -> f64 {
        self.count
    }

    /// The sum of numbers, one for each constraint.
    pub fn sum(&self, numbers: impl Iterator<Item = f64>) -> f64 {
        let mut sum = [numbers.zip(&self.counts).filter(|(_, counts)| **counts).map(|(number, _)| number).sum()];
        self.peers().sum(&mut sum);
        sum[0]
    }

    /// Gives copies of bodies the values that their owners have, so many of each body.
    pub fn update(&self, values: &mut [f64], width: usize) {
        match width {
            1 => self.update_blocks::<1>(values),
            2 => self.update_blocks::<2>(values),
            3 => self.update_blocks::<3>(values),
            width => panic!("bodies move along 2 or 3 axes, not {width}"),
        }
    }

    fn update_blocks<const W: usize>(&self, values: &mut [f64]) {
        let blocks = values.as_chunks_mut::<W>().0;
        let sent = |number: usize| blocks[self.numbers.binary_search(&number).expect("a body is asked of its owner")];
        let copies = self.routes.copies(self.peers(), sent);
        self.copies.iter().zip(copies).for_each(|(&place, copy)| blocks[place] = copy);
    }
}
