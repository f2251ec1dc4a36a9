//! Corrections of pairs, tabulated over the distance.
//!
//! Lengths are in radii of the first body. All blocks are smooth in the distance, also where the surfaces touch: the orders
//! of the modes are finite. Between nodes equally spaced in the inverse distance, which are made when a pair asks for them, cubics interpolate.

use std::{
    cell::{OnceCell, RefCell},
    collections::BTreeMap,
    rc::Rc,
};

use nalgebra::DMatrix;

use super::{block::PairSide, pattern::Pattern};
use crate::{
    constraint::neighbourhood::PAIR_REACH,
    linalg::{ROUNDING, cubic},
};

/// Nodes of a table.
const NODES: usize = 24;

/// Ratios of radii are rounded to this fraction of an octave.
const STEPS_PER_OCTAVE: f64 = 16.0;

/// What is known of the rigid modes of bodies, of which the correction tells the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Given {
    /// Net forces and torques.
    Forces,
    /// Velocities and spins.
    Motions,
}

/// The tables of all combinations of bodies met so far.
pub struct PairTables<const D: usize> {
    /// What the corrections are for.
    pub given: Given,
    tables: RefCell<BTreeMap<TableKey, Rc<PairTable>>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct TableKey {
    orders: [usize; 2],
    ratio: i32,
}

/// The corrections of one combination of bodies.
pub struct PairTable {
    /// How the multipliers are arranged.
    pub pattern: Rc<Pattern>,
    contact: f64,
    /// Smallest inverse distance, and its step from node to node.
    range: [f64; 2],
    nodes: [OnceCell<Vec<f32>>; NODES],
    /// The corrections at a distance.
    correct: Box<dyn Fn(f64) -> Vec<f32>>,
}

impl<const D: usize> PairTables<D> {
    /// No tables yet.
    pub fn new(given: Given) -> Self {
        PairTables { given, tables: RefCell::default() }
    }

    /// The table of two bodies of given orders and radii.
    pub fn of(&self, orders: [usize; 2], radii: [f64; 2]) -> Rc<PairTable> {
        let key = TableKey { orders, ratio: ((radii[1] / radii[0]).log2() * STEPS_PER_OCTAVE).round() as i32 };
        self.tables.borrow_mut().entry(key).or_insert_with(|| Rc::new(PairTable::new::<D>(key, self.given))).clone()
    }
}

impl PairTable {
    fn new<const D: usize>(key: TableKey, given: Given) -> PairTable {
        let second = (f64::from(key.ratio) / STEPS_PER_OCTAVE).exp2();
        let sides = [PairSide::<D>::new(1.0, key.orders[0]), PairSide::new(second, key.orders[1])];
        let equal = key.ratio == 0 && key.orders[0] == key.orders[1];
        let pattern = Rc::new(Pattern::new(sides.each_ref().map(|side| side.modes.as_ref()), equal));
        let contact = 1.0 + second;
        let last = 1.0 / (contact * (1.0 + 0.5 * PAIR_REACH));
        let range = [last, (1.0 / contact - last) / (NODES - 1) as f64];
        let arrangement = pattern.clone();
        let correct = Box::new(move |distance| corrections(&sides, given, &arrangement, distance));
        PairTable { pattern, contact, range, nodes: [const { OnceCell::new() }; NODES], correct }
    }

    /// Appends the correction for a gap, where the first body has the given radius.
    pub fn append(&self, gap: f64, radius: f64, out: &mut Vec<f32>) {
        let inverse = 1.0 / (self.contact + (gap / radius).max(0.0));
        let (first, weights) = cubic((inverse - self.range[0]) / self.range[1], NODES);
        let weights = weights.map(|weight| (weight / radius) as f32);
        let distance = |node: usize| 1.0 / (self.range[0] + self.range[1] * node as f64);
        let [a, b, c, d] = [0, 1, 2, 3].map(|node| self.nodes[first + node].get_or_init(|| (self.correct)(distance(first + node))));
        out.extend(
            a.iter().zip(b).zip(c.iter().zip(d)).map(|((a, b), (c, d))| weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d),
        );
    }
}

/// The blocks of the correction at one distance, channel by channel, columns one after the other.
fn corrections<const D: usize>(sides: &[PairSide<D>; 2], given: Given, pattern: &Pattern, distance: f64) -> Vec<f32> {
    let pair = Two::new(sides, given, pattern.equal(), distance);
    let mut out = Vec::new();
    for modes in pattern.channels() {
        let blocks = match given {
            Given::Forces => pair.given_forces(modes),
            Given::Motions => pair.given_motions(modes),
        };
        blocks.iter().for_each(|block| out.extend(block.iter().map(|value| *value as f32)));
    }
    out
}

/// Two bodies at a distance.
struct Two<'a, const D: usize> {
    sides: &'a [PairSide<D>; 2],
    distance: f64,
    equal: bool,
    /// The block of each when it is alone.
    alone: [DMatrix<f64>; 2],
    /// The motions of both as one, seen from each; none where forces are given.
    as_one: [DMatrix<f64>; 2],
}

impl<'a, const D: usize> Two<'a, D> {
    fn new(sides: &'a [PairSide<D>; 2], given: Given, equal: bool, distance: f64) -> Self {
        let (alone, as_one) = match given {
            Given::Forces => (sides.each_ref().map(PairSide::isolated), [0, 1].map(|_| DMatrix::zeros(0, 0))),
            Given::Motions => (
                sides.each_ref().map(|side| side.isolated_in_motion(distance)),
                [0, 1].map(|side| sides[side].motions_as_one(distance, side == 1)),
            ),
        };
        Two { sides, distance, equal, alone, as_one }
    }

    fn rigid(&self) -> usize {
        self.sides[0].modes.rigid_count()
    }

    /// Some modes of the block of each body when it is alone.
    fn own(&self, modes: &[Vec<usize>; 2]) -> [DMatrix<f64>; 2] {
        [0, 1].map(|side| part(&self.alone[side], &modes[side]))
    }

    /// The blocks by which each acts on the other; that on the first alone if they are equal.
    fn coupling(&self, [one, two]: &[Vec<usize>; 2]) -> Vec<DMatrix<f64>> {
        let [first, second] = self.sides;
        let on_first = first.coupling(second, self.distance, [one, two]);
        if self.equal {
            return vec![on_first];
        }
        // reciprocity
        let on_second = on_first.transpose() * (first.modes.force_factor() / second.modes.force_factor());
        vec![on_first, on_second]
    }

    /// Sums and differences of a block and what couples it, or the two bodies in one.
    fn combined(&self, own: &[DMatrix<f64>; 2], coupling: &[DMatrix<f64>]) -> Vec<DMatrix<f64>> {
        match coupling {
            [coupling] => [1.0, -1.0].iter().map(|&sign| &own[0] + coupling * sign).collect(),
            _ => vec![joined(own, Some([&coupling[0], &coupling[1]]))],
        }
    }

    /// `B_ij^{-1} - B_i^{-1} (+) B_j^{-1}`.
    fn given_forces(&self, modes: &[Vec<usize>; 2]) -> Vec<DMatrix<f64>> {
        let own = self.own(modes);
        let mut coupling = self.coupling(modes);
        for (place, block) in coupling.iter_mut().enumerate() {
            let rigid = modes[place].iter().enumerate().filter(|&(_, &mode)| mode < self.rigid());
            rigid.for_each(|(row, _)| block.row_mut(row).fill(0.0));
        }
        let pair = self.combined(&own, &coupling).into_iter().map(inverse);
        let alone = own.map(inverse);
        if self.equal {
            pair.map(|pair| (pair - &alone[0]) * 0.5).collect()
        } else {
            pair.map(|pair| pair - joined(&alone, None)).collect()
        }
    }

    /// The multipliers for given velocities of all modes, with no net force or torque on the pair, less those of free modes of each alone.
    fn given_motions(&self, modes: &[Vec<usize>; 2]) -> Vec<DMatrix<f64>> {
        let own = self.own(modes);
        let coupling = self.coupling(modes);
        let areas = self.sides.each_ref().map(|side| side.modes.force_factor());
        let as_one = [0, 1].map(|side| self.as_one[side].select_rows(&modes[side]));
        let alone = [0, 1].map(|side| self.inverse_of_free(&own[side], &modes[side]));
        let blocks = self.combined(&own, &coupling).into_iter();
        if self.equal {
            let combined = [1.0, -1.0].map(|sign| &as_one[0] + &as_one[1] * sign);
            return blocks.zip(&combined).map(|(block, motions)| (without_net_force(&block, motions, motions) - &alone[0]) * 0.5).collect();
        }
        let (alone, (motions, forces)) = (joined(&alone, None), stacked(&as_one, areas));
        blocks.map(|block| without_net_force(&block, &motions, &forces) - &alone).collect()
    }

    /// The inverse of the part of free modes of a block, zero elsewhere.
    fn inverse_of_free(&self, block: &DMatrix<f64>, modes: &[usize]) -> DMatrix<f64> {
        let free: Vec<usize> = (0..modes.len()).filter(|&place| modes[place] >= self.rigid()).collect();
        let small = inverse(part(block, &free));
        let mut whole = DMatrix::zeros(modes.len(), modes.len());
        for (row, &place) in free.iter().enumerate() {
            free.iter().enumerate().for_each(|(column, &other)| whole[(place, other)] = small[(row, column)]);
        }
        whole
    }
}

/// The motions of both, one below the other, and the same weighed by the areas, which takes the net force.
fn stacked([first, second]: &[DMatrix<f64>; 2], areas: [f64; 2]) -> (DMatrix<f64>, DMatrix<f64>) {
    let size = first.nrows() + second.nrows();
    let mut motions = DMatrix::zeros(size, first.ncols());
    motions.rows_mut(0, first.nrows()).copy_from(first);
    motions.rows_mut(first.nrows(), second.nrows()).copy_from(second);
    let mut forces = motions.clone();
    forces.rows_mut(first.nrows(), second.nrows()).scale_mut(areas[1] / areas[0]);
    (motions, forces)
}

fn part(block: &DMatrix<f64>, places: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(places.len(), places.len(), |row, column| block[(places[row], places[column])])
}

/// The inverse of a block on what has no part along some `forces`, up to the `motions` that go with them.
fn without_net_force(block: &DMatrix<f64>, motions: &DMatrix<f64>, forces: &DMatrix<f64>) -> DMatrix<f64> {
    let some: Vec<usize> = (0..motions.ncols()).filter(|&column| motions.column(column).norm() > ROUNDING).collect();
    let (size, count) = (block.nrows(), some.len());
    let mut whole = DMatrix::zeros(size + count, size + count);
    whole.view_mut((0, 0), (size, size)).copy_from(block);
    whole.view_mut((0, size), (size, count)).copy_from(&motions.select_columns(&some));
    whole.view_mut((size, 0), (count, size)).copy_from(&forces.select_columns(&some).transpose());
    inverse(whole).view((0, 0), (size, size)).into_owned()
}

fn joined(diagonal: &[DMatrix<f64>; 2], others: Option<[&DMatrix<f64>; 2]>) -> DMatrix<f64> {
    let [first, second] = diagonal.each_ref().map(DMatrix::nrows);
    let mut block = DMatrix::zeros(first + second, first + second);
    block.view_mut((0, 0), (first, first)).copy_from(&diagonal[0]);
    block.view_mut((first, first), (second, second)).copy_from(&diagonal[1]);
    if let Some([above, below]) = others {
        block.view_mut((0, first), (first, second)).copy_from(above);
        block.view_mut((first, 0), (second, first)).copy_from(below);
    }
    block
}

fn inverse(block: DMatrix<f64>) -> DMatrix<f64> {
    block.try_inverse().expect("the block of two bodies has an inverse")
}
