//! The missing resistance, tabulated over the gap for each combination of bodies.

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use super::{
    Resistance,
    axisymmetric::AxisymmetricBody,
    exact::Exact,
    pair::{self, Lift},
    ratios::{self, RatioNode},
    resolved::ExactTables,
    wall,
};
use crate::linalg::cubic;

/// Least number of nodes of the truncated resistance, and nodes for each order of the modes: high ones tell small gaps from smaller ones. The
/// inverse distance of the centres falls with the square of their number, for the resistance changes fast where the gap closes.
const NODES: (usize, usize) = (24, 5);

/// One less the inverse of one more than the gap, at the last of them.
const FARTHEST: f64 = 1.0 - 1.0 / (1.0 + FARTHEST_REACH);

/// Largest gap at which nothing may be missing, in radii of the smaller body, and that from which a table may begin to fade out.
const FARTHEST_REACH: f64 = (1.0 + FADING) * REACH;

/// Largest gap that a table may reach, in radii of the smaller body.
const REACH: f64 = 1.0;

/// Part of the resistance against approach below which nothing counts as missing.
const NEGLIGIBLE: f64 = 1e-3;

/// Part of its reach over which a table fades out.
const FADING: f64 = 0.25;

/// The missing resistance of one combination of bodies. Lengths in radii of the first body, which is the smaller.
#[derive(Clone)]
pub struct FilmTable {
    exact: Exact,
    truncated: Vec<Resistance>,
    /// What is missing where nothing should be.
    excess: Resistance,
    reach: f64,
}

/// The tables of all combinations met so far.
#[derive(Default)]
pub struct FilmTables {
    exact: ExactTables,
    tables: RefCell<BTreeMap<FilmKey, Rc<FilmTable>>>,
}

/// Orders of the smaller and the larger body, and their ratio; no second body is a wall.
type FilmKey = (usize, Option<(usize, RatioNode)>);

impl FilmTables {
    /// The table of a body with modes up to an order and a second one, of another order and so many times as large (at least once), or a wall.
    pub fn of<const D: usize>(&self, order: usize, second: Option<(usize, f64)>) -> FilmTable {
        let Some((other, ratio)) = second else { return FilmTable::clone(&self.at_node::<D>((order, None))) };
        let table = |(node, weight)| (weight, self.at_node::<D>((order, Some((other, node)))));
        let tables: Vec<(f64, Rc<FilmTable>)> = ratios::nodes(ratio).into_iter().map(table).collect();
        let lift = ratios::lift(ratio);
        let mut mean = FilmTable::new(self.exact.of::<D>(Some((ratio, lift))), Vec::new());
        let sum = |of: &dyn Fn(&FilmTable) -> Resistance| {
            tables.iter().fold(Resistance::default(), |sum, (weight, table)| sum.with(&of(table), |sum, value| sum + weight * value))
        };
        mean.truncated = (0..tables[0].1.truncated.len()).map(|node| sum(&|table| table.truncated[node])).collect();
        if lift == Lift::First {
            mean.excess = mean.missing_at_reach();
        }
        mean.reach = tables.iter().map(|(weight, table)| weight * table.reach).sum::<f64>().min(FARTHEST_REACH);
        mean
    }

    fn at_node<const D: usize>(&self, key: FilmKey) -> Rc<FilmTable> {
        let anew = || {
            let (order, second) = key;
            let exact = self.exact.of::<D>(second.map(|(_, node)| (node.ratio(), node.lift)));
            Rc::new(FilmTable::of_node::<D>(exact, order, second))
        };
        self.tables.borrow_mut().entry(key).or_insert_with(anew).clone()
    }
}

impl FilmTable {
    fn new(exact: Exact, truncated: Vec<Resistance>) -> FilmTable {
        FilmTable { exact, truncated, excess: Resistance::default(), reach: REACH }
    }

    /// The table of a body of radius 1 and order `order`, and a second one of another order and radius, or a wall.
    fn of_node<const D: usize>(exact: Exact, order: usize, second: Option<(usize, RatioNode)>) -> FilmTable {
        let first = AxisymmetricBody::<D>::new(1.0, order);
        let other = second.map(|(order, node)| (AxisymmetricBody::<D>::new(node.ratio(), order), node.lift));
        let at = |gap: f64| match &other {
            Some((other, lift)) => pair::resistance([&first, other], gap, *lift),
            None => wall::resistance(&first, gap),
        };
        let nodes = NODES.0.max(NODES.1 * order.max(second.map_or(0, |(order, _)| order)));
        let mut table = FilmTable::new(exact, (0..nodes).map(|node| at(gap_at(node as f64 / (nodes - 1) as f64))).collect());
        let one_moves = second.is_some_and(|(_, node)| node.lift == Lift::First);
        if one_moves {
            table.excess = table.missing_at_reach();
        }
        let reach = table.find_reach();
        // beyond, what is missing relative to there means nothing
        table.reach = if one_moves { reach.min(REACH) } else { reach };
        table
    }

    /// Gap at which nothing is missing any more.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The whole resistance at a gap above zero.
    pub fn exact(&self, gap: f64) -> Resistance {
        self.exact.at(gap)
    }

    /// The resistance that the modes see.
    pub fn truncated(&self, gap: f64) -> Resistance {
        let (first, weights) = cubic(place_of(gap) * (self.truncated.len() - 1) as f64, self.truncated.len());
        (0..4).fold(Resistance::default(), |sum, node| sum.with(&self.truncated[first + node], |sum, value| sum + weights[node] * value))
    }

    /// What is missing at a gap above zero; nothing from the [`reach`](Self::reach) on.
    pub fn missing(&self, gap: f64) -> Resistance {
        let fade = smooth((self.reach - gap) / (FADING * self.reach));
        let missing = self.exact(gap).with(&self.truncated(gap), |exact, truncated| exact - truncated);
        missing.with(&self.excess, |missing, excess| fade * (missing - excess))
    }

    /// What modes do not see where nothing should be missing.
    fn missing_at_reach(&self) -> Resistance {
        self.exact(REACH).with(&self.truncated(REACH), |exact, truncated| exact - truncated)
    }

    /// The smallest gap from which on next to nothing is missing.
    fn find_reach(&self) -> f64 {
        let gaps = (1..=100).map(|step| REACH * f64::from(step) / 100.0);
        let missing = |gap: f64| self.exact(gap).approach - self.truncated(gap).approach - self.excess.approach;
        let enough = |gap: &f64| missing(*gap).abs() < NEGLIGIBLE * self.exact(*gap).approach;
        gaps.clone().rev().take_while(enough).last().unwrap_or(REACH) * (1.0 + FADING)
    }
}

/// Between 0 and 1, with flat ends.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Nodes lie from gap 0, at place 0, to beyond the largest reach, at place 1.
fn gap_at(place: f64) -> f64 {
    1.0 / (1.0 - FARTHEST * place.powi(2)) - 1.0
}

fn place_of(gap: f64) -> f64 {
    ((1.0 - 1.0 / (1.0 + gap)) / FARTHEST).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const GAPS: [f64; 9] = [1e-6, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.3, 0.6, 1.0];

    fn close(found: f64, exact: f64, tolerance: f64, what: &str) {
        assert!((found / exact - 1.0).abs() < tolerance, "{what}: {found} {exact} {:e}", found / exact - 1.0);
    }

    #[test]
    fn disks_have_the_closed_forms_at_any_gap() {
        let (pair, wall) = (FilmTables::default().of::<2>(6, Some((6, 1.0))), FilmTables::default().of::<2>(6, None));
        for gap in GAPS {
            let what = format!("gap {gap}");
            let alpha = (1.0 + 0.5 * gap).acosh();
            // alpha^3 is lost to rounding where the closed form cancels
            if gap > 1e-5 {
                close(pair.exact(gap).approach, 4.0 * PI / (2.0 * alpha - (2.0 * alpha).tanh()), 1e-4, &what);
            }
            let (alpha, lever, found) = ((1.0 + gap).acosh(), 1.0 + 0.5 * gap, wall.exact(gap));
            if gap > 1e-5 {
                close(found.approach, 4.0 * PI / (alpha - alpha.tanh()), 1e-4, &what);
            }
            close(found.slip, 4.0 * PI / alpha, 1e-4, &what);
            close(found.cross, -lever * 4.0 * PI / alpha, 1e-4, &what);
            close(found.roll, lever * lever * 4.0 * PI / alpha + 4.0 * PI / alpha.tanh(), 1e-4, &what);
        }
        // translating by +-U across, per 2 U, at h/a = 1.05
        close(pair.exact(0.1).slip, 23.64578088 / 2.0, 1e-5, "slip");
    }

    /// Brenner's and Maude's series; for slip `3 pi (Y11 - Y12)` by Jeffrey and Onishi's asymptotic law.
    #[test]
    fn spheres_have_the_series_at_any_gap() {
        let (pair, wall) = (FilmTables::default().of::<3>(4, Some((4, 1.0))), FilmTables::default().of::<3>(4, None));
        for (height, of_wall, of_pair) in [
            (1.001, 1002.3533268807, 254.14320360806),
            (1.01, 101.89617232461, 28.114022193234),
            (1.1, 11.459157203410, 4.6255431402510),
            (1.5, 3.2053903153526, 2.0386546439229),
        ] {
            close(wall.exact(height - 1.0).approach, 6.0 * PI * of_wall, 1e-3, "wall");
            close(pair.exact(2.0 * height - 2.0).approach, 3.0 * PI * of_pair, 1e-3, "pair");
        }
        for gap in [1e-4, 1e-3] {
            close(pair.exact(gap).slip, 3.0 * PI * ((1.0 / gap).ln() / 3.0 + 1.272), 1e-3, "slip");
        }
    }

    #[test]
    fn what_is_missing_is_positive_and_ends_smoothly() {
        let tables = [
            FilmTables::default().of::<2>(4, Some((4, 1.0))),
            FilmTables::default().of::<2>(6, Some((9, 1.5))),
            FilmTables::default().of::<2>(6, Some((32, 20.0))),
            FilmTables::default().of::<2>(6, None),
            FilmTables::default().of::<3>(4, Some((4, 1.0))),
            FilmTables::default().of::<3>(3, None),
        ];
        for (number, table) in tables.iter().enumerate() {
            assert_eq!(table.missing(table.reach()), Resistance::default(), "{number}");
            let mut last = f64::INFINITY;
            for step in 0..200 {
                let gap = 1e-5 * (table.reach() / 1e-5).powf(f64::from(step) / 200.0);
                let missing = table.missing(gap);
                assert!(missing.approach < last, "{number}: approach {gap} {missing:?}");
                assert!(missing.approach > -1e-3 * table.exact(gap).approach, "{number} {gap} {missing:?}");
                let determinant = missing.slip * missing.roll - missing.cross.powi(2);
                let small = 2e-3 * (table.exact(gap).slip + table.exact(gap).roll);
                assert!(missing.slip > -small && missing.roll > -small, "{number} {gap} {missing:?}");
                assert!(gap > 0.01 || determinant > 0.0, "{number} {gap} {missing:?}");
                last = missing.approach;
            }
        }
    }

    /// Largest difference of two resistances, each number over the exact one of its kind, and of the larger body over its radius.
    fn difference(found: &Resistance, direct: &Resistance, exact: &Resistance, radius: f64) -> f64 {
        let across = exact.slip.max(exact.roll);
        let scales = [
            exact.approach,
            across,
            across,
            across,
            exact.approach,
            exact.approach * radius,
            across,
            across * radius,
            across,
            across * radius,
            exact.approach,
            exact.approach * radius,
        ];
        let differences = found.with(direct, |one, other| (one - other).abs()).numbers();
        differences.iter().zip(scales).map(|(difference, scale)| difference / scale).fold(0.0, f64::max)
    }

    /// Ratios up to 4 and gaps from 1e-4 on, without a pattern.
    fn agrees_with_direct_computation<const D: usize>(orders: usize) {
        let tables = FilmTables::default();
        let part = |sample: usize, step: f64| (sample as f64 * step).fract();
        for sample in 1..=16 {
            let first = 2 + (part(sample, 0.618_034) * (orders - 1) as f64) as usize;
            let second = first + (part(sample, 0.414_214) * (orders + 1 - first) as f64) as usize;
            let ratio = if sample % 4 == 0 { 1.0 } else { (2.0 * part(sample, 0.732_051)).exp2() };
            let table = tables.of::<D>(first, Some((second, ratio)));
            let sides = [AxisymmetricBody::<D>::new(1.0, first), AxisymmetricBody::new(ratio, second)];
            for step in 0..8 {
                let gap = 1e-4 * (table.reach() / 1e-4).powf((f64::from(step) + part(sample, 0.236_068)) / 8.0);
                let direct = pair::resistance([&sides[0], &sides[1]], gap, ratios::lift(ratio));
                let difference = difference(&table.truncated(gap), &direct, &table.exact(gap), ratio);
                assert!(difference < 1e-4, "{D}D orders {first}, {second}, ratio {ratio}, gap {gap}: {difference:e}");
            }
        }
    }

    #[test]
    fn tables_of_any_bodies_agree_with_direct_computation() {
        agrees_with_direct_computation::<2>(16);
        agrees_with_direct_computation::<3>(10);
    }
}
