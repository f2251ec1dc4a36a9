//! Corrections of pairs, tabulated over the distance.
//!
//! Lengths are in radii of the first body. All blocks are smooth in the distance, also where the surfaces touch: the orders
//! of the modes are finite. Between nodes equally spaced in the inverse distance, cubics interpolate.

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use nalgebra::DMatrix;

use super::{block::PairSide, pattern::Pattern};
use crate::{constraint::neighbourhood::PAIR_REACH, linalg::cubic};

/// Nodes of a table.
const NODES: usize = 24;

/// Ratios of radii are rounded to this fraction of an octave.
const STEPS_PER_OCTAVE: f64 = 16.0;

/// Part of a unit motion that is rounding.
const ROUNDING: f64 = 1e-9;

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
    tables: RefCell<BTreeMap<Key, Rc<Table>>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    orders: [usize; 2],
    ratio: i32,
}

/// The corrections of one combination of bodies.
pub struct Table {
    /// How the multipliers are arranged.
    pub pattern: Pattern,
    contact: f64,
    /// Smallest inverse distance, and its step from node to node.
    range: [f64; 2],
    nodes: Vec<Vec<f32>>,
}

impl<const D: usize> PairTables<D> {
    /// No tables yet.
    pub fn new(given: Given) -> Self {
        PairTables { given, tables: RefCell::default() }
    }

    /// The table of two bodies of given orders and radii.
    pub fn of(&self, orders: [usize; 2], radii: [f64; 2]) -> Rc<Table> {
        let key = Key { orders, ratio: ((radii[1] / radii[0]).log2() * STEPS_PER_OCTAVE).round() as i32 };
        self.tables.borrow_mut().entry(key).or_insert_with(|| Rc::new(Table::new::<D>(key, self.given))).clone()
    }
}

impl Table {
    fn new<const D: usize>(key: Key, given: Given) -> Table {
        let second = (f64::from(key.ratio) / STEPS_PER_OCTAVE).exp2();
        let sides = [PairSide::<D>::new(1.0, key.orders[0]), PairSide::new(second, key.orders[1])];
        let equal = key.ratio == 0 && key.orders[0] == key.orders[1];
        let pattern = Pattern::new(sides.each_ref().map(|side| side.surface.modes.as_ref()), equal);
        let contact = 1.0 + second;
        let last = 1.0 / (contact * (1.0 + 0.5 * PAIR_REACH));
        let step = (1.0 / contact - last) / (NODES - 1) as f64;
        let nodes = (0..NODES).map(|node| corrections(&sides, given, &pattern, 1.0 / (last + step * node as f64))).collect();
        Table { pattern, contact, range: [last, step], nodes }
    }

    /// Appends the correction for a gap, where the first body has the given radius.
    pub fn append(&self, gap: f64, radius: f64, out: &mut Vec<f32>) {
        let inverse = 1.0 / (self.contact + (gap / radius).max(0.0));
        let (first, weights) = cubic((inverse - self.range[0]) / self.range[1], NODES);
        let weights = weights.map(|weight| (weight / radius) as f32);
        let [a, b, c, d] = [0, 1, 2, 3].map(|node| &self.nodes[first + node]);
        out.extend(
            a.iter().zip(b).zip(c.iter().zip(d)).map(|((a, b), (c, d))| weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d),
        );
    }
}

/// The blocks of the correction at one distance, channel by channel, columns one after the other.
fn corrections<const D: usize>(sides: &[PairSide<D>; 2], given: Given, pattern: &Pattern, distance: f64) -> Vec<f32> {
    let pair = Two::new(sides, pattern.equal(), distance);
    let mut out = Vec::new();
    for modes in pattern.channels() {
        let blocks = match given {
            Given::Forces => pair.given_forces(modes),
            Given::Motions => pair.given_motions(modes),
        };
        out.extend(blocks.iter().flat_map(|block| block.iter().map(|value| *value as f32)));
    }
    out
}

/// Two bodies at a distance.
struct Two<'a, const D: usize> {
    sides: &'a [PairSide<D>; 2],
    distance: f64,
    /// The velocity that each causes on the other; that on the first alone if they are equal.
    caused: Vec<DMatrix<f64>>,
}

impl<'a, const D: usize> Two<'a, D> {
    fn new(sides: &'a [PairSide<D>; 2], equal: bool, distance: f64) -> Self {
        let [first, second] = sides;
        let mut caused = vec![first.velocity_caused_by(second, distance)];
        if !equal {
            caused.push(second.velocity_caused_by(first, distance));
        }
        Two { sides, distance, caused }
    }

    fn equal(&self) -> bool {
        self.caused.len() == 1
    }

    fn rigid(&self) -> usize {
        self.sides[0].surface.modes.rigid_count()
    }

    /// Rows and columns of some modes of a block of each body's own.
    fn own(&self, blocks: [DMatrix<f64>; 2], [one, two]: &[Vec<usize>; 2]) -> [DMatrix<f64>; 2] {
        let [first, second] = blocks;
        [(first, one), (second, two)].map(|(block, modes)| block.select_rows(modes).select_columns(modes))
    }

    /// The blocks by which each acts on the other, tested with all modes.
    fn coupling(&self, [one, two]: &[Vec<usize>; 2]) -> Vec<DMatrix<f64>> {
        let on = |(place, velocity): (usize, &DMatrix<f64>)| {
            let (rows, columns) = if place == 0 { (one, two) } else { (two, one) };
            self.sides[place].test(velocity, rows, columns)
        };
        self.caused.iter().enumerate().map(on).collect()
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
        let own = self.own(self.sides.each_ref().map(PairSide::isolated), modes);
        let mut coupling = self.coupling(modes);
        for (place, block) in coupling.iter_mut().enumerate() {
            let rigid = modes[place].iter().enumerate().filter(|&(_, &mode)| mode < self.rigid());
            rigid.for_each(|(row, _)| block.row_mut(row).fill(0.0));
        }
        let pair = self.combined(&own, &coupling).into_iter().map(inverse);
        let alone = own.map(inverse);
        if self.equal() {
            pair.map(|pair| (pair - &alone[0]) * 0.5).collect()
        } else {
            pair.map(|pair| pair - joined(&alone, None)).collect()
        }
    }

    /// The multipliers for given velocities of all modes, with no net force or torque on the pair, less those of free modes of each alone.
    fn given_motions(&self, modes: &[Vec<usize>; 2]) -> Vec<DMatrix<f64>> {
        let own = self.own(self.sides.each_ref().map(|side| side.isolated_in_motion(self.distance)), modes);
        let coupling = self.coupling(modes);
        let areas = self.sides.each_ref().map(|side| side.surface.area());
        let as_one = [0, 1].map(|side| self.sides[side].motions_as_one(self.distance, side == 1).select_rows(&modes[side]));
        let mut members = modes.each_ref().map(|modes| modes.as_slice());
        let (mut motions, mut factor) = (vec![stacked(&as_one, areas)], 1.0);
        if self.equal() {
            let combined = [1.0, -1.0].map(|sign| &as_one[0] + &as_one[1] * sign);
            motions = combined.into_iter().map(|motions| (motions.clone(), motions)).collect();
            members[1] = &[];
            factor = 0.5;
        }
        let free: Vec<bool> = members.iter().flat_map(|modes| modes.iter().map(|&mode| mode >= self.rigid())).collect();
        let places: Vec<usize> = (0..free.len()).filter(|&place| free[place]).collect();
        let alone = if self.equal() { inverse(part(&own[0], &places)) } else { inverse(part(&joined(&own, None), &places)) };
        let blocks = self.combined(&own, &coupling).into_iter().zip(motions);
        let answer = |(block, (motions, forces)): (DMatrix<f64>, (DMatrix<f64>, DMatrix<f64>))| {
            let mut answer = without_net_force(&block, &motions, &forces);
            for (row, &place) in places.iter().enumerate() {
                places.iter().enumerate().for_each(|(column, &other)| answer[(place, other)] -= alone[(row, column)]);
            }
            answer * factor
        };
        blocks.map(answer).collect()
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
    block.select_rows(places).select_columns(places)
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
