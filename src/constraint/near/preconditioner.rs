//! The correction of the near pairs of this rank's bodies.

use std::rc::Rc;

use nalgebra::{DMatrix, SMatrix, SVector};

use super::table::{Given, PairTable, PairTables};
use crate::{
    body::skew,
    constraint::{MultiplierLayout, Neighbourhood},
    error::Result,
    geometry::Pair,
    petsc::{Scatter, Vector},
    surface::{area, lever, mode_count, rotations},
};

/// Multipliers of the rigid modes of a body for motions of rigid modes of a body.
pub type RigidBlock = SMatrix<f64, 6, 6>;

/// The correction for the near pairs of this rank's bodies.
pub struct PairPreconditioner {
    given: Given,
    pairs: Vec<NearPair>,
    /// Matrices that turn into the frames of the pairs.
    turns: Vec<f32>,
    /// Blocks of the pairs, one pair after the other.
    values: Vec<f32>,
    scatter: Scatter,
    /// This rank's multipliers, then those fetched.
    wanted: Vec<f64>,
    found: Vec<f64>,
    local: usize,
}

/// The body with the larger order, or else radius, is the second.
struct NearPair {
    table: Rc<PairTable>,
    bodies: [usize; 2],
    /// From the first to the second.
    separation: [f64; 3],
    /// Velocity of a rotation mode at unit spin, and net force of a unit translation multiplier.
    levers: [f64; 2],
    areas: [f64; 2],
    places: [usize; 2],
    /// Where its part of `turns` and of `values` begins.
    starts: (usize, usize),
}

impl PairPreconditioner {
    /// The near pairs of a crowd shared out as `layout` says, for multipliers shaped like `multipliers`; collective.
    ///
    /// # Errors
    /// PETSc has no memory for the exchange.
    pub fn new<const D: usize>(
        neighbourhood: &Neighbourhood<D>,
        layout: &MultiplierLayout,
        tables: &PairTables<D>,
        multipliers: &Vector,
    ) -> Result<PairPreconditioner> {
        let near = near_and_mine(neighbourhood, layout);
        let (fetched, places) = places(neighbourhood, layout, &near);
        let local = layout.local_unknowns();
        let mut pairs = PairPreconditioner {
            given: tables.given,
            pairs: Vec::with_capacity(near.len()),
            turns: Vec::new(),
            values: Vec::new(),
            scatter: Scatter::new(multipliers, &fetched)?,
            wanted: vec![0.0; local + fetched.len()],
            found: vec![0.0; local + fetched.len()],
            local,
        };
        for pair in near {
            pairs.add(neighbourhood, tables, pair, &places);
        }
        pairs.turns.shrink_to_fit();
        pairs.values.shrink_to_fit();
        Ok(pairs)
    }

    fn add<const D: usize>(&mut self, neighbourhood: &Neighbourhood<D>, tables: &PairTables<D>, pair: &Pair<D>, places: &[usize]) {
        let order = |body: usize| neighbourhood.orders[body];
        let radius = |body: usize| neighbourhood.balls[body].radius;
        let (mut ends, mut separation) = ([pair.first, pair.second], pair.separation);
        if (order(pair.second), radius(pair.second)) < (order(pair.first), radius(pair.first)) {
            ends.reverse();
            separation = -separation;
        }
        let table = tables.of(ends.map(order), ends.map(radius));
        let starts = (self.turns.len(), self.values.len());
        rotations(&separation.normalize(), order(ends[1]), &mut self.turns);
        table.append(pair.gap, radius(ends[0]), &mut self.values);
        let mut padded = [0.0; 3];
        padded[..D].copy_from_slice(separation.as_slice());
        self.pairs.push(NearPair {
            table,
            bodies: ends,
            separation: padded,
            levers: ends.map(|body| lever(D, radius(body))),
            areas: ends.map(|body| area(D, radius(body))),
            places: ends.map(|body| places[body]),
            starts,
        });
    }

    /// What is known of the rigid modes.
    pub fn given(&self) -> Given {
        self.given
    }

    /// What the pairs add to the multipliers of isolated bodies: this rank's part; collective.
    ///
    /// `wanted` has the velocity wanted of each mode, but for rigid modes, if forces are given, the multiplier found times the radius.
    ///
    /// # Errors
    /// The exchange fails.
    pub fn correction(&mut self, wanted: &Vector) -> Result<&[f64]> {
        let (own, others) = self.wanted.split_at_mut(self.local);
        own.copy_from_slice(&wanted.local()?);
        others.copy_from_slice(self.scatter.fetch(wanted)?);
        self.found.fill(0.0);
        let mut frame = [Vec::new(), Vec::new()];
        for pair in &self.pairs {
            let (turns, values) = (&self.turns[pair.starts.0..], &self.values[pair.starts.1..]);
            pair.table.pattern.apply(turns, values, &self.wanted, pair.places, &mut frame, &mut self.found);
        }
        Ok(&self.found[..self.local])
    }

    /// What the motions of rigid modes call for, pair by pair: both bodies, and for each the net forces and torques (areas times multipliers)
    /// for motions of both, symmetric and zero where both move as one.
    ///
    /// What is known of rigid modes must be [`Given::Motions`].
    pub fn resistances<const D: usize>(&self) -> impl Iterator<Item = ([usize; 2], [[RigidBlock; 2]; 2])> + '_ {
        let rigid = D * (D + 1) / 2;
        let mut frame = [Vec::new(), Vec::new()];
        self.pairs.iter().map(move |pair| {
            let pattern = &pair.table.pattern;
            let [first, second] = pattern.counts();
            let places = [0, first];
            let (mut wanted, mut found) = (vec![0.0; first + second], vec![0.0; first + second]);
            let (turns, values) = (&self.turns[pair.starts.0..], &self.values[pair.starts.1..]);
            let mut forces = DMatrix::zeros(2 * rigid, 2 * rigid);
            for (column, place) in places.iter().flat_map(|place| *place..place + rigid).enumerate() {
                wanted[place] = 1.0;
                found.fill(0.0);
                pattern.apply(turns, values, &wanted, places, &mut frame, &mut found);
                wanted[place] = 0.0;
                for (body, place) in places.into_iter().enumerate() {
                    (0..rigid).for_each(|row| forces[(body * rigid + row, column)] = pair.areas[body] * found[place + row]);
                }
            }
            let forces = pair.relative::<D>(&forces);
            let block = |one: usize, two: usize| {
                let mut block = RigidBlock::zeros();
                block.view_mut((0, 0), (rigid, rigid)).copy_from(&forces.view((one * rigid, two * rigid), (rigid, rigid)));
                block
            };
            (pair.bodies, [0, 1].map(|one| [0, 1].map(|two| block(one, two))))
        })
    }
}

impl NearPair {
    /// The symmetric part of a matrix of the two bodies' motions that sees their motion relative to each other alone: a table for nearly
    /// these radii takes a motion of both as one for a slightly relative one.
    fn relative<const D: usize>(&self, forces: &DMatrix<f64>) -> DMatrix<f64> {
        let rigid = D * (D + 1) / 2;
        let mut as_one = DMatrix::zeros(2 * rigid, rigid);
        for (body, side) in [(0, -0.5), (1, 0.5)] {
            let from_middle = SVector::<f64, D>::from_column_slice(&self.separation[..D]) * side;
            let mut rows = as_one.rows_mut(body * rigid, rigid);
            (0..D).for_each(|axis| rows[(axis, axis)] = 1.0);
            for plane in 0..rigid - D {
                let unit: Vec<f64> = (0..rigid - D).map(|other| f64::from(other == plane)).collect();
                rows.view_mut((0, D + plane), (D, 1)).copy_from(&(skew::<D>(&unit) * from_middle));
                rows[(D + plane, D + plane)] = self.levers[body];
            }
        }
        let as_one = as_one.qr().q();
        let others = DMatrix::identity(2 * rigid, 2 * rigid) - &as_one * as_one.transpose();
        &others * ((forces + forces.transpose()) * 0.5) * &others
    }
}

/// The near pairs with a body that this rank holds.
fn near_and_mine<'a, const D: usize>(neighbourhood: &'a Neighbourhood<D>, layout: &MultiplierLayout) -> Vec<&'a Pair<D>> {
    neighbourhood.pairs.iter().filter(|pair| neighbourhood.near(pair) && layout.holds_any([pair.first, pair.second])).collect()
}

/// The multipliers to fetch for these pairs, and where each body's stand: this rank's first, then the fetched.
fn places<const D: usize>(neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout, near: &[&Pair<D>]) -> (Vec<usize>, Vec<usize>) {
    let mut places = vec![usize::MAX; neighbourhood.balls.len()];
    layout.local_bodies.iter().for_each(|&body| places[body] = layout.local(body));
    let mut fetched = Vec::new();
    for body in near.iter().flat_map(|pair| [pair.first, pair.second]) {
        if places[body] == usize::MAX {
            places[body] = layout.local_unknowns() + fetched.len();
            let first = layout.global(body);
            fetched.extend(first..first + mode_count(D, neighbourhood.orders[body]));
        }
    }
    (fetched, places)
}
