//! A program that all ranks share: each has the constraints of its own bodies, and copies of the other bodies in them.
//!
//! A constraint between bodies of two ranks is on both, which compute the same of it to the last bit; in sums one of them counts it.
//! Everything here is collective.

use super::program::Program;
use crate::{
    body::Halo,
    error::{Error, Result},
    parallel::{Peers, Routes},
    petsc::{Direct, Matrix, RowBuilder, Session, Vector},
};

/// Who has what of a program.
pub(super) struct Sharing<'a> {
    session: &'a Session,
    /// Numbers of the bodies that this rank sees, ascending.
    numbers: Vec<usize>,
    /// Places of its own ones, and of copies in the order in which they come.
    own: Vec<usize>,
    copies: Vec<usize>,
    routes: Routes,
    /// Whether this rank counts a constraint.
    counts: Vec<bool>,
    /// Constraints of all ranks.
    count: f64,
}

/// The factors of a shared program, spread over the ranks by MUMPS.
pub(super) struct SharedFactors<'a> {
    program: &'a Program<'a>,
    sharing: &'a Sharing<'a>,
    /// The constraints of each own body.
    constraints: Vec<Vec<usize>>,
    /// The place of each body that is seen among those of all ranks.
    columns: Vec<f64>,
    /// Once there are factors.
    direct: Option<Direct>,
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

impl<'a> SharedFactors<'a> {
    /// Nothing is factored yet.
    pub fn new(program: &'a Program<'a>, sharing: &'a Sharing<'a>) -> Self {
        let (peers, mut constraints) = (sharing.peers(), vec![Vec::new(); sharing.numbers.len()]);
        for constraint in 0..program.offsets.len() {
            let [first, last] = program.bodies(constraint);
            constraints[first].push(constraint);
            if last != first {
                constraints[last].push(constraint);
            }
        }
        let before: usize = peers.gather(&[sharing.own.len() as u64])[..peers.rank()].iter().sum::<u64>() as usize;
        let mut columns = vec![0.0; sharing.numbers.len()];
        sharing.own.iter().enumerate().for_each(|(row, &place)| columns[place] = (before + row) as f64);
        sharing.update(&mut columns, 1);
        Self {
            program,
            sharing,
            constraints: sharing.own.iter().map(|&place| std::mem::take(&mut constraints[place])).collect(),
            columns,
            direct: None,
        }
    }

    /// Factors the matrix of these weights.
    pub fn factor(&mut self, weights: &[f64]) {
        let rows = self.rows(weights);
        let factored = match self.direct.take() {
            Some(direct) => replaced(direct, rows),
            None => self.first(rows),
        };
        self.direct = factored.ok();
    }

    /// Turns a right-hand side into the solution, or into nothing finite if there are no factors: the method then gives up.
    pub fn solve(&mut self, vector: &mut [f64]) {
        if self.try_solve(vector).is_err() {
            vector.fill(f64::NAN);
        }
    }

    fn try_solve(&mut self, vector: &mut [f64]) -> Result<()> {
        let (Sharing { session, own, .. }, width) = (self.sharing, self.program.width);
        let Some(direct) = &mut self.direct else { return Err(Error::Diverged("there are no factors".into())) };
        let mut right = Vector::new(session, own.len() * width)?;
        let blocks = |&place: &usize| place * width..(place + 1) * width;
        right.local_mut()?.chunks_mut(width).zip(own).for_each(|(row, place)| row.copy_from_slice(&vector[blocks(place)]));
        let mut solution = right.like()?;
        direct.solve(&right, &mut solution)?;
        solution.local()?.chunks(width).zip(own).for_each(|(row, place)| vector[blocks(place)].copy_from_slice(row));
        self.sharing.update(vector, width);
        Ok(())
    }

    fn first(&self, rows: RowBuilder) -> Result<Direct> {
        Direct::positive(Matrix::from_rows(self.sharing.session, self.sharing.own.len() * self.program.width, rows)?)
    }

    /// The rows of the own bodies.
    fn rows(&self, weights: &[f64]) -> RowBuilder {
        let (mut rows, width) = (RowBuilder::default(), self.program.width);
        let column = |place: usize| self.columns[place / width] as usize * width + place % width;
        for (&body, constraints) in self.sharing.own.iter().zip(&self.constraints) {
            for place in body * width..(body + 1) * width {
                rows.push(column(place), 1.0);
                for &constraint in constraints {
                    let own = self.program.row(constraint).find(|(entry, _)| *entry == place).map_or(0.0, |(_, value)| value);
                    self.program.row(constraint).for_each(|(other, value)| rows.push(column(other), weights[constraint] * own * value));
                }
                rows.end_row();
            }
        }
        rows
    }
}

fn replaced(mut direct: Direct, rows: RowBuilder) -> Result<Direct> {
    direct.replace(rows)?;
    Ok(direct)
}
