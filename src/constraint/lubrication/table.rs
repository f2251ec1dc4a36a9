//! The missing resistance, tabulated over the gap for each combination of bodies.

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use super::{
    Resistance,
    axisymmetric::AxisymmetricBody,
    exact::Exact,
    pair::{self, Lift},
    wall,
};
use crate::{linalg::cubic, surface::highest_order};

/// Nodes of the truncated resistance: the inverse distance of the centres falls with their square, for it changes fast where the gap closes.
const NODES: usize = 24;

/// One less the inverse of one more than the gap, at the last of them.
const FARTHEST: f64 = 1.0 - 1.0 / (1.0 + (1.0 + FADING) * REACH);

/// Samples of the exact one.
const SAMPLES: usize = 20;

/// Largest gap that a table may reach, in radii of the smaller body.
const REACH: f64 = 1.0;

/// Part of the resistance against approach below which nothing counts as missing.
const NEGLIGIBLE: f64 = 1e-3;

/// Part of its reach over which a table fades out.
const FADING: f64 = 0.25;

/// Ratios of radii are rounded to this fraction of an octave.
const STEPS_PER_OCTAVE: f64 = 16.0;

/// Largest ratio of radii for which the exact resistance is computed; beyond, it lies between that and a wall, and what is missing is taken
/// relative to what would be missing at the largest gap.
const LARGEST_RATIO: f64 = 2.0;

/// The missing resistance of one combination of bodies. Lengths in radii of the first body, which is the smaller.
pub struct FilmTable {
    /// Radius of the second body, none for a wall.
    second: Option<f64>,
    exact: Exact,
    truncated: Vec<Resistance>,
    /// What is missing where nothing should be.
    excess: Resistance,
    reach: f64,
}

/// The tables of all combinations met so far.
#[derive(Default)]
pub struct FilmTables {
    tables: RefCell<BTreeMap<Key, Rc<FilmTable>>>,
}

/// Orders of the smaller and the larger body, and their ratio; no second body is a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    order: usize,
    second: Option<(usize, i32)>,
}

impl FilmTables {
    /// The table of a body with modes up to an order and a second one, of another order and so many times as large (at least once), or a wall.
    pub fn of<const D: usize>(&self, order: usize, second: Option<(usize, f64)>) -> Rc<FilmTable> {
        let second = second.map(|(order, ratio)| (order, (ratio.log2() * STEPS_PER_OCTAVE).round() as i32));
        let key = Key { order, second };
        let ratio = |steps: i32| (f64::from(steps) / STEPS_PER_OCTAVE).exp2();
        let anew = || Rc::new(FilmTable::new::<D>(order, second.map(|(order, steps)| (order, ratio(steps)))));
        self.tables.borrow_mut().entry(key).or_insert_with(anew).clone()
    }
}

impl FilmTable {
    /// The table of a body of radius 1 and order `order`, and a second one of another order and radius, or a wall.
    pub fn new<const D: usize>(order: usize, second: Option<(usize, f64)>) -> FilmTable {
        let exact = exact::<D>(second.map(|(_, radius)| radius));
        let first = AxisymmetricBody::<D>::new(1.0, order);
        let other = second.map(|(order, radius)| AxisymmetricBody::<D>::new(radius, order));
        let lift = lift(second.map(|(_, radius)| radius));
        let at = |gap: f64| match &other {
            Some(other) => pair::resistance([&first, other], gap, lift),
            None => wall::resistance(&first, gap),
        };
        let truncated: Vec<Resistance> = (0..NODES).map(|node| at(gap_of_node(node as f64))).collect();
        let second = second.map(|(_, radius)| radius);
        let mut table = FilmTable { second, exact, truncated, excess: Resistance::default(), reach: REACH };
        if lift == Lift::First {
            table.excess = table.exact(REACH).with(&table.truncated(REACH), |exact, truncated| exact - truncated);
        }
        table.reach = table.find_reach();
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
        let (first, weights) = cubic(node_of_gap(gap), NODES);
        (0..4).fold(Resistance::default(), |sum, node| sum.with(&self.truncated[first + node], |sum, value| sum + weights[node] * value))
    }

    /// What is missing at a gap above zero; nothing from the [`reach`](Self::reach) on.
    pub fn missing(&self, gap: f64) -> Resistance {
        let fade = smooth((self.reach - gap) / (FADING * self.reach));
        let missing = self.exact(gap).with(&self.truncated(gap), |exact, truncated| exact - truncated);
        missing.with(&self.excess, |missing, excess| fade * (missing - excess))
    }

    /// The smallest gap from which on next to nothing is missing.
    fn find_reach(&self) -> f64 {
        let gaps = (1..=100).map(|step| REACH * f64::from(step) / 100.0);
        let missing = |gap: f64| self.exact(gap).approach - self.truncated(gap).approach - self.excess.approach;
        let enough = |gap: &f64| missing(*gap).abs() < NEGLIGIBLE * self.exact(*gap).approach;
        let found = gaps.clone().rev().take_while(enough).last().unwrap_or(REACH) * (1.0 + FADING);
        // beyond, what is missing relative to there means nothing
        if lift(self.second) == Lift::First { found.min(REACH) } else { found }
    }
}

/// Between 0 and 1, with flat ends.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Nodes lie from gap 0 to beyond the largest reach.
fn gap_of_node(node: f64) -> f64 {
    1.0 / (1.0 - FARTHEST * (node / (NODES - 1) as f64).powi(2)) - 1.0
}

fn node_of_gap(gap: f64) -> f64 {
    ((1.0 - 1.0 / (1.0 + gap)) / FARTHEST).sqrt() * (NODES - 1) as f64
}

/// How relative motions of a pair are lifted to motions of both.
fn lift(second: Option<f64>) -> Lift {
    if second.is_some_and(|radius| radius > LARGEST_RATIO) { Lift::First } else { Lift::Balanced }
}

/// The resistance with all modes.
fn exact<const D: usize>(second: Option<f64>) -> Exact {
    match second.filter(|_| lift(second) == Lift::First) {
        None => resolved::<D>(second, Lift::Balanced),
        Some(radius) => Exact::between(resolved::<D>(Some(LARGEST_RATIO), Lift::First), &resolved::<D>(None, Lift::First), radius),
    }
}

/// From gaps that the highest order resolves.
fn resolved<const D: usize>(second: Option<f64>, lift: Lift) -> Exact {
    let order = highest_order(D);
    let first = AxisymmetricBody::<D>::new(1.0, order);
    let other = second.map(|radius| AxisymmetricBody::<D>::new(radius, order));
    let least = least_resolved(order, second);
    let sample = |number: usize| {
        // denser where the gap is small
        let gap = least + 1.4 * REACH * (number as f64 / (SAMPLES - 1) as f64).powi(2);
        let found = match &other {
            Some(other) => pair::resistance([&first, other], gap, lift),
            None => wall::resistance(&first, gap),
        };
        (gap, found)
    };
    let samples: Vec<(f64, Resistance)> = (0..SAMPLES).map(sample).collect();
    Exact::fit(D, second, &samples)
}

/// The gap at which modes up to an order err by some 1e-5: fields fall by `e^{-alpha}` from one mode to the next,
/// `a_2 sinh(alpha) = sqrt(2 r e)` with `r` the reduced radius and the larger body's radius `a_2`.
fn least_resolved(order: usize, second: Option<f64>) -> f64 {
    let sinh = (8.0 / order as f64).sinh();
    match second {
        Some(radius) => (radius * sinh).powi(2) * (1.0 + radius) / (2.0 * radius),
        None => 0.5 * sinh.powi(2),
    }
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
        let (pair, wall) = (FilmTable::new::<2>(6, Some((6, 1.0))), FilmTable::new::<2>(6, None));
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
        let (pair, wall) = (FilmTable::new::<3>(4, Some((4, 1.0))), FilmTable::new::<3>(4, None));
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
            FilmTable::new::<2>(4, Some((4, 1.0))),
            FilmTable::new::<2>(6, Some((9, 1.5))),
            FilmTable::new::<2>(6, Some((32, 20.0))),
            FilmTable::new::<2>(6, None),
            FilmTable::new::<3>(4, Some((4, 1.0))),
            FilmTable::new::<3>(3, None),
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
}
