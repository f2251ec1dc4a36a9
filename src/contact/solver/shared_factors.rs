//! The factors of a program that all ranks share, spread over them by MUMPS. Everything here is collective.

use super::{program::Program, sharing::Sharing};
use crate::{
    error::{Error, Result},
    petsc::{Direct, Matrix, RowBuilder, Vector},
};

/// The factors of a shared program, spread over the ranks by MUMPS.
pub struct SharedFactors<'a> {
    program: &'a Program<'a>,
    sharing: &'a Sharing<'a>,
    /// The constraints of each own body.
    constraints: Vec<Vec<usize>>,
    /// The place of each body that is seen among those of all ranks.
    columns: Vec<f64>,
    /// Once there are factors.
    direct: Option<Direct>,
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
