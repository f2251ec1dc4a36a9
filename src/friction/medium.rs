//! What resists motions besides each body itself: films and near neighbours, which make `R = 1 + sum B` of the unit matrix of a program.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector};

use super::row_block::{NONE, RowBlock};
use crate::contact::solver::block_lu::{BlockLu, Blocks};

/// What resists the motions of two bodies, or of one.
#[derive(Debug, Clone)]
pub struct Resisting {
    /// Places of its bodies; the first is there.
    pub ends: [usize; 2],
    /// What each motion makes each body feel, symmetric: blocks (1, 1), (1, 2), (2, 1), (2, 2), or the first alone, each row by row.
    pub blocks: Blocks,
    /// Whether it ties them, however weak a contact of theirs is.
    pub ties: bool,
}

/// The place of a body, and what a row counts of its unknowns.
pub type Entries<const W: usize> = (usize, [f64; W]);

/// What resists between the bodies of a program, factored.
pub struct Medium<const W: usize> {
    resisting: Vec<Resisting>,
    /// Nothing where nothing resists.
    factors: Option<BlockLu>,
}

impl Resisting {
    /// A row that resists its rate, of what the motion of each body counts.
    pub fn of_row<const W: usize>(ends: [usize; 2], rows: &[[f64; W]; 2], resistance: f64) -> Resisting {
        let sides = if ends[1] == NONE { &rows[..1] } else { &rows[..] };
        let pairs = sides.iter().flat_map(|one| sides.iter().map(move |other| (one, other)));
        let entries =
            pairs.flat_map(|(one, other)| one.iter().flat_map(move |row| other.iter().map(move |column| resistance * row * column)));
        Resisting { ends, blocks: entries.collect(), ties: false }
    }

    /// The same of any number of bodies, as what resists between each two of them.
    pub fn of_rows<const W: usize>(entries: &[Entries<W>], resistance: f64) -> Vec<Resisting> {
        if let [(body, row)] = entries {
            return vec![Resisting::of_row([*body, NONE], &[*row, [0.0; W]], resistance)];
        }
        // each body is one of that many pairs
        let share = 1.0 / (entries.len() - 1) as f64;
        let pairs = entries.iter().enumerate().flat_map(|(place, one)| entries[place + 1..].iter().map(move |other| (one, other)));
        let pair = |((one, first), (other, second)): (&Entries<W>, &Entries<W>)| {
            let mut resisting = Resisting::of_row([*one, *other], &[*first, *second], resistance);
            let size = W * W;
            resisting.blocks[..size].iter_mut().for_each(|entry| *entry *= share);
            resisting.blocks[3 * size..].iter_mut().for_each(|entry| *entry *= share);
            Resisting { ties: true, ..resisting }
        };
        pairs.map(pair).collect()
    }

    fn bodies(&self) -> &[usize] {
        if self.ends[1] == NONE { &self.ends[..1] } else { &self.ends }
    }

    fn touches(&self) -> [usize; 2] {
        if self.ends[1] == NONE { [self.ends[0]; 2] } else { self.ends }
    }

    /// Pairs of bodies, each with its block.
    fn each<const W: usize>(&self) -> impl Iterator<Item = ([usize; 2], &[f64])> {
        let pairs = self.bodies().iter().flat_map(|&one| self.bodies().iter().map(move |&other| [one, other]));
        pairs.zip(self.blocks.chunks_exact(W * W))
    }
}

impl<const W: usize> Medium<W> {
    /// Bodies alone.
    pub fn none() -> Medium<W> {
        Medium { resisting: Vec::new(), factors: None }
    }

    /// Bodies and what resists between them; nothing if that has no factors.
    pub fn new(bodies: usize, resisting: Vec<Resisting>) -> Option<Medium<W>> {
        let mut medium = Medium { resisting, factors: None };
        if medium.resisting.is_empty() {
            return Some(medium);
        }
        let mut factors = BlockLu::new(bodies, W, &medium.touches());
        if !factors.factor(|place| medium.resisting[place].blocks.clone()) {
            return None;
        }
        medium.factors = Some(factors);
        Some(medium)
    }

    /// Whether anything resists.
    pub fn resists(&self) -> bool {
        self.factors.is_some()
    }

    /// The two bodies between which each resists; the same twice if there is one.
    pub fn touches(&self) -> Vec<[usize; 2]> {
        self.resisting.iter().map(Resisting::touches).collect()
    }

    /// The blocks of what resists at a place.
    pub fn blocks(&self, place: usize) -> Blocks {
        self.resisting[place].blocks.clone()
    }

    /// `R x`.
    pub fn forces(&self, motion: &[[f64; W]]) -> Vec<[f64; W]> {
        let mut forces = motion.to_vec();
        for ([one, other], block) in self.resisting.iter().flat_map(Resisting::each::<W>) {
            for (force, row) in forces[one].iter_mut().zip(block.chunks_exact(W)) {
                *force += row.iter().zip(&motion[other]).map(|(entry, moved)| entry * moved).sum::<f64>();
            }
        }
        forces
    }

    /// `R^-1 f`.
    pub fn motion(&self, mut forces: Vec<[f64; W]>) -> Vec<[f64; W]> {
        if let Some(factors) = &self.factors {
            factors.solve(forces.as_flattened_mut());
        }
        forces
    }

    /// For each contact what a unit impulse along each of its rows moves it by while all other bodies are at rest, and nothing is tied to them.
    pub fn own_mobilities<const D: usize>(&self, row_blocks: &[RowBlock<D, W>]) -> Vec<[f64; D]> {
        let mut blocks = HashMap::<[usize; 2], DMatrix<f64>>::new();
        for (pair, block) in self.resisting.iter().filter(|resisting| !resisting.ties).flat_map(Resisting::each::<W>) {
            *blocks.entry(pair).or_insert_with(|| DMatrix::zeros(W, W)) += DMatrix::from_row_slice(W, W, block);
        }
        row_blocks.iter().map(|row_block| own_mobility(row_block, &blocks)).collect()
    }
}

fn own_mobility<const D: usize, const W: usize>(row_block: &RowBlock<D, W>, blocks: &HashMap<[usize; 2], DMatrix<f64>>) -> [f64; D] {
    let sides: Vec<(usize, &[[f64; W]; D])> = row_block.sides().collect();
    let mut resistance = DMatrix::identity(W * sides.len(), W * sides.len());
    for (row, (one, _)) in sides.iter().enumerate() {
        for (column, (other, _)) in sides.iter().enumerate() {
            if let Some(block) = blocks.get(&[*one, *other]) {
                let mut place = resistance.view_mut((row * W, column * W), (W, W));
                place += block;
            }
        }
    }
    let factors = resistance.cholesky();
    std::array::from_fn(|axis| {
        let row = DVector::from_iterator(W * sides.len(), sides.iter().flat_map(|(_, rows)| rows[axis]));
        // rows have norm 1
        factors.as_ref().map_or(1.0, |factors| row.dot(&factors.solve(&row)))
    })
}
