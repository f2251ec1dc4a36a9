//! Corrections of pairs, tabulated over the distance.
//!
//! Lengths are in radii of the first body. All blocks are smooth in the distance, also where the surfaces touch: the orders
//! of the modes are finite. Between nodes equally spaced in the inverse distance, cubics interpolate.

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use nalgebra::DMatrix;

use super::{REACH, block::Side, pattern::Pattern};
use crate::constraint::cubic::cubic;

/// Nodes of a table.
const NODES: usize = 16;

/// Ratios of radii are rounded to this fraction of an octave.
const STEPS_PER_OCTAVE: f64 = 16.0;

/// The tables of all combinations of bodies met so far.
#[derive(Default)]
pub struct PairTables<const D: usize> {
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
    /// The table of two bodies of given orders and radii.
    pub fn of(&self, orders: [usize; 2], radii: [f64; 2]) -> Rc<Table> {
        let key = Key { orders, ratio: ((radii[1] / radii[0]).log2() * STEPS_PER_OCTAVE).round() as i32 };
        self.tables.borrow_mut().entry(key).or_insert_with(|| Rc::new(Table::new::<D>(key))).clone()
    }
}

impl Table {
    fn new<const D: usize>(key: Key) -> Table {
        let second = (f64::from(key.ratio) / STEPS_PER_OCTAVE).exp2();
        let sides = [Side::<D>::new(1.0, key.orders[0]), Side::new(second, key.orders[1])];
        let equal = key.ratio == 0 && key.orders[0] == key.orders[1];
        let pattern = Pattern::new(sides.each_ref().map(|side| side.surface.modes.as_ref()), equal);
        let contact = 1.0 + second;
        let last = 1.0 / (contact * (1.0 + 0.5 * REACH));
        let step = (1.0 / contact - last) / (NODES - 1) as f64;
        let nodes = (0..NODES).map(|node| corrections(&sides, &pattern, 1.0 / (last + step * node as f64))).collect();
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
fn corrections<const D: usize>(sides: &[Side<D>; 2], pattern: &Pattern, distance: f64) -> Vec<f32> {
    let [first, second] = sides;
    let isolated = sides.each_ref().map(Side::isolated);
    let on_first = first.velocity_caused_by(second, distance);
    let on_second = if pattern.equal() { DMatrix::zeros(0, 0) } else { second.velocity_caused_by(first, distance) };
    let mut out = Vec::new();
    for [one, two] in pattern.channels() {
        let alone = [(&isolated[0], one), (&isolated[1], two)].map(|(block, modes)| block.select_rows(modes).select_columns(modes));
        let coupling = first.test(&on_first, one, two);
        if pattern.equal() {
            for sign in [1.0, -1.0] {
                let block = (inverse(&alone[0] + &coupling * sign) - inverse(alone[0].clone())) * 0.5;
                out.extend(block.iter().map(|value| *value as f32));
            }
        } else {
            let back = second.test(&on_second, two, one);
            let block = inverse(joined(&alone, Some([&coupling, &back]))) - joined(&alone.map(inverse), None);
            out.extend(block.iter().map(|value| *value as f32));
        }
    }
    out
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
