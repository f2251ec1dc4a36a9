//! Bodies that are tied to each other and touch: contact forces that keep them apart where ties act at the same time.
//!
//! `min 1/2 sum_i w_i |v_i - wanted_i|^2 + 1/2 sum_t c_t f_t^2` subject to `sum d_i . v_i + c_t f_t = rate_t` for each [`Row`] of a tie, and
//! `sum d_i . v_i >= rate_c` for that of each contact: one convex program. None of them turns a body. A contact that may pull does so with its least force
//! from the start, so that its multiplier is what it bears besides.
//!
//! Balls of a rigid body move by its unknowns `q` alone, which a force on a ball moves by `R^T f` and which move it by `R q` ([`RigidBalls`]).

use std::collections::BTreeMap;

use clarabel::algebra::CscMatrix;
use nalgebra::{SMatrix, SVector};

use super::{tied_program::TiedProgram, union_find::UnionFind};
use crate::body::Row;

/// Most motions of a rigid body.
pub const RIGID: usize = 6;

/// The balls of a rigid body, each with `R`: its velocity for unit unknowns, which are scaled so that their mobility is one.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBalls<const D: usize>(pub Vec<(usize, SMatrix<f64, D, RIGID>)>);

/// Bodies with ties and contacts that want to move for one step.
#[derive(Debug, Clone, Copy)]
pub struct TiedProblem<'a, const D: usize> {
    /// Force per unit of velocity that a body is turned aside by; infinite for a body whose velocity is given.
    pub weights: &'a [f64],
    /// Velocities wanted.
    pub velocities: &'a [SVector<f64, D>],
    /// What ties them.
    pub ties: &'a [Row<D>],
    /// Which of them are balls of rigid bodies.
    pub rigid: &'a [RigidBalls<D>],
    /// Where they touch or may: rows of which each bears its least force or more.
    pub contacts: &'a [Row<D>],
    /// Which of these are likely to bear more.
    pub presses: &'a [bool],
    /// A rate of contacts that is small: unknowns are scaled by no smaller violation.
    pub smallest: f64,
}

/// Bodies that hang together by ties, rigid bodies and contacts, with the places of these.
#[derive(Default)]
struct TiedIsland {
    bodies: Vec<usize>,
    ties: Vec<usize>,
    contacts: Vec<usize>,
    /// Where the unknowns of each body begin, and how many there are.
    starts: Vec<usize>,
    unknowns: usize,
}

/// For each body the rigid body that it is a ball of, and how that moves it.
type RigidMaps<const D: usize> = Vec<Option<(usize, SMatrix<f64, D, RIGID>)>>;

/// A row of the program: entries by unknown, what they miss of the rate wanted, and what makes their squares add up to 1.
struct ScaledRow {
    entries: Vec<(usize, f64)>,
    missing: f64,
    scale: f64,
}

impl<const D: usize> TiedProblem<'_, D> {
    /// What contacts change velocities by in this rank's share of the islands that have ties too; zero for bodies of others. None if one of these islands
    /// has no solution.
    pub fn changes(&self, rank: usize, ranks: usize) -> Option<Vec<SVector<f64, D>>> {
        let (mut forces, rigid) = (Vec::new(), self.rigid());
        for island in self.islands(&rigid).into_iter().skip(rank).step_by(ranks) {
            forces.extend(self.solve(&island, &rigid)?);
        }
        let pushes = self.pushes(forces.into_iter());
        Some(pushes.iter().zip(self.weights).map(|(push, weight)| push / *weight).collect())
    }

    /// The force on each body by forces of contacts, which are named by their places.
    fn pushes(&self, forces: impl Iterator<Item = (usize, f64)>) -> Vec<SVector<f64, D>> {
        let mut pushes = vec![SVector::zeros(); self.weights.len()];
        for (contact, force) in forces {
            self.contacts[contact].wrenches(force).for_each(|(body, push)| pushes[body] += push.direction);
        }
        pushes
    }

    fn gives_way(&self, body: usize) -> bool {
        self.weights[body].is_finite()
    }

    fn rigid(&self) -> RigidMaps<D> {
        let mut rigid = vec![None; self.weights.len()];
        for (number, RigidBalls(balls)) in self.rigid.iter().enumerate() {
            balls.iter().for_each(|(ball, moved)| rigid[*ball] = Some((number, *moved)));
        }
        rigid
    }

    /// The forces at the contacts of an island, which are named by their places; none if it has no solution. Unknowns are `sqrt(w) (v - wanted)`, and
    /// `sqrt(c) f` of soft rows.
    fn solve(&self, island: &TiedIsland, rigid: &RigidMaps<D>) -> Option<Vec<(usize, f64)>> {
        let pulled = self.pulled(island, rigid);
        let mut unknowns = island.unknowns;
        let mut scaled = |row: &Row<D>| {
            let directions = || row.ends.iter().map(|(body, side)| (*body, side.direction));
            let moving: f64 = directions().map(|(body, direction)| direction.dot(&(self.velocities[body] + pulled[body]))).sum();
            let mut entries = self.entries(island, rigid, directions());
            if row.compliance > 0.0 {
                entries.push((unknowns, row.compliance.sqrt()));
                unknowns += 1;
            }
            ScaledRow::new(entries, row.rate - moving)
        };
        let contacts = || island.contacts.iter().map(|&contact| &self.contacts[contact]);
        let ties: Vec<ScaledRow> = island.ties.iter().map(|&tie| scaled(&self.ties[tie])).collect();
        let touching: Vec<ScaledRow> = contacts().map(scaled).collect();
        let unit = ties.iter().map(|row| row.missing.abs()).chain(touching.iter().map(|row| row.missing)).fold(0.0, f64::max);
        let unit = touching.iter().map(|row| self.smallest * row.scale).fold(unit, f64::max);
        let transposed = columns(unknowns, ties.iter().chain(&touching));
        let equations = ties.iter().map(|row| row.missing / unit).collect();
        let program = TiedProgram { transposed, equations, offsets: touching.iter().map(|row| -row.missing / unit).collect() };
        let multipliers = program.solve(&island.contacts.iter().map(|&contact| self.presses[contact]).collect::<Vec<bool>>())?;
        let force = |((contact, row), multiplier): ((&Row<D>, &ScaledRow), f64)| contact.least + multiplier * unit * row.scale;
        Some(island.contacts.iter().copied().zip(contacts().zip(&touching).zip(multipliers).map(force)).collect())
    }

    /// What the least forces of contacts change velocities by.
    fn pulled(&self, island: &TiedIsland, rigid: &RigidMaps<D>) -> Vec<SVector<f64, D>> {
        let pushes = self.pushes(island.contacts.iter().map(|&contact| (contact, self.contacts[contact].least)));
        let mut unknowns = vec![SVector::<f64, RIGID>::zeros(); self.rigid.len()];
        for &body in &island.bodies {
            rigid[body].iter().for_each(|(number, moved)| unknowns[*number] += moved.transpose() * pushes[body]);
        }
        let change = |(body, push): (usize, &SVector<f64, D>)| match &rigid[body] {
            Some((number, moved)) => moved * unknowns[*number],
            None => push / self.weights[body],
        };
        pushes.iter().enumerate().map(change).collect()
    }

    fn entries(
        &self,
        island: &TiedIsland,
        rigid: &RigidMaps<D>,
        ends: impl Iterator<Item = (usize, SVector<f64, D>)>,
    ) -> Vec<(usize, f64)> {
        let of_end = |(body, direction): (usize, SVector<f64, D>)| -> Vec<(usize, f64)> {
            let Ok(place) = island.bodies.binary_search(&body) else { return Vec::new() };
            let entries: Vec<f64> = match &rigid[body] {
                Some((_, moved)) => (moved.transpose() * direction).iter().copied().collect(),
                None => (direction / self.weights[body].sqrt()).iter().copied().collect(),
            };
            (island.starts[place]..).zip(entries).collect()
        };
        ends.flat_map(of_end).collect()
    }

    /// Those with contacts, and with ties or rigid bodies.
    fn islands(&self, rigid: &RigidMaps<D>) -> Vec<TiedIsland> {
        let mut sets = UnionFind::new(self.weights.len());
        let free = |bodies: Vec<usize>| -> Vec<usize> { bodies.into_iter().filter(|&body| self.gives_way(body)).collect() };
        let of_rows =
            |rows: &[Row<D>]| -> Vec<Vec<usize>> { rows.iter().map(|row| free(row.ends.iter().map(|end| end.0).collect())).collect() };
        let (tied, touching) = (of_rows(self.ties), of_rows(self.contacts));
        let balls: Vec<Vec<usize>> = self.rigid.iter().map(|RigidBalls(balls)| balls.iter().map(|(ball, _)| *ball).collect()).collect();
        tied.iter().chain(&touching).chain(&balls).for_each(|bodies| bodies.windows(2).for_each(|pair| sets.join(pair[0], pair[1])));
        let mut islands: BTreeMap<usize, TiedIsland> = BTreeMap::new();
        for body in free((0..self.weights.len()).collect()) {
            islands.entry(sets.root(body)).or_default().bodies.push(body);
        }
        let mut place = |bodies: &[usize]| bodies.first().map(|&body| sets.root(body));
        for (tie, bodies) in tied.iter().enumerate() {
            place(bodies).and_then(|root| islands.get_mut(&root)).into_iter().for_each(|island| island.ties.push(tie));
        }
        for (contact, bodies) in touching.iter().enumerate() {
            place(bodies).and_then(|root| islands.get_mut(&root)).into_iter().for_each(|island| island.contacts.push(contact));
        }
        let held = |island: &TiedIsland| !island.ties.is_empty() || island.bodies.iter().any(|&body| rigid[body].is_some());
        let mut islands: Vec<TiedIsland> = islands.into_values().filter(|island| !island.contacts.is_empty() && held(island)).collect();
        islands.iter_mut().for_each(|island| island.number(rigid));
        islands
    }
}

impl TiedIsland {
    /// Gives each body its unknowns, the balls of a rigid body the same ones.
    fn number<const D: usize>(&mut self, rigid: &RigidMaps<D>) {
        let mut of_rigid = BTreeMap::new();
        for &body in &self.bodies {
            let next = self.unknowns;
            let start = rigid[body].map_or(next, |(number, _)| *of_rigid.entry(number).or_insert(next));
            if start == next {
                self.unknowns += if rigid[body].is_some() { RIGID } else { D };
            }
            self.starts.push(start);
        }
    }
}

impl ScaledRow {
    /// The row of entries that miss so much; those of one unknown are added up. What no unknown changes is no row.
    fn new(mut entries: Vec<(usize, f64)>, missing: f64) -> ScaledRow {
        entries.sort_by_key(|entry| entry.0);
        entries.dedup_by(|later, first| {
            let same = later.0 == first.0;
            first.1 += if same { later.1 } else { 0.0 };
            same
        });
        let square = entries.iter().map(|(_, value)| value * value).sum::<f64>();
        let scale = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
        entries.iter_mut().for_each(|(_, value)| *value *= scale);
        ScaledRow { entries, missing: missing * scale, scale }
    }
}

/// A matrix with a column for each row.
fn columns<'a>(height: usize, rows: impl Iterator<Item = &'a ScaledRow>) -> CscMatrix<f64> {
    let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
    for row in rows {
        places.extend(row.entries.iter().map(|entry| entry.0));
        values.extend(row.entries.iter().map(|entry| entry.1));
        starts.push(places.len());
    }
    CscMatrix::new(height, starts.len() - 1, starts, places, values)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::body::RigidFunctional;
    use crate::contact::Contact;
    use crate::geometry::{Axis, Ball, Domain};

    /// Two disks above each other on a rod, the lower one on the floor, and one that falls freely.
    #[test]
    fn the_floor_stops_a_rod_by_its_lower_end() {
        let walls = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
        let domain = Domain { size: Vector2::new(9.0, 9.0), axes: [Axis::Periodic, walls] };
        let balls = [[3.0, 0.5], [3.0, 1.6], [6.0, 4.0]].map(|center| Ball { center: center.into(), radius: 0.5 });
        let up = Vector2::new(0.0, 1.0);
        let side = |direction| RigidFunctional { direction, turn: SMatrix::zeros() };
        let rod = Row::new(vec![(0, side(-up)), (1, side(up))], 0.0, 0.0);
        let floor = |body: usize| Contact::of_wall(&domain, &balls, body, 1, false);
        for presses in [true, false] {
            let contacts = [0, 2].map(|body| floor(body).row(0.1));
            let problem = TiedProblem {
                weights: &[1.0, 3.0, 1.0],
                velocities: &[-up; 3],
                ties: std::slice::from_ref(&rod),
                rigid: &[],
                contacts: &contacts,
                presses: &[presses; 2],
                smallest: 1e-7,
            };
            let changes = problem.changes(0, 1).unwrap();
            // the force stops both, and pushes the lower one
            assert!((changes[0] - up * 4.0).norm() < 1e-9 && changes[1].norm() + changes[2].norm() == 0.0, "{changes:?}");
            assert!(problem.changes(1, 2).unwrap().iter().all(|change| change.norm() == 0.0));
        }
    }
}
