//! Bodies that are tied to each other and touch: contact forces that keep them apart where ties act at the same time.
//!
//! `min 1/2 sum_i w_i |v_i - wanted_i|^2 + 1/2 sum_t c_t f_t^2` subject to `sum d_i . v_i + c_t f_t = rate_t` for each [`Row`], which turns no body, and
//! `gap + dt opening(v) >= 0` for each [`Contact`]: one convex program. A contact that may pull does so with its least force from the start, so that its
//! multiplier is what it bears besides.
//!
//! Balls of a rigid body move by its unknowns `q` alone, which a force on a ball moves by `R^T f` and which move it by `R q` ([`RigidBalls`]).

use std::collections::BTreeMap;

use clarabel::algebra::CscMatrix;
use nalgebra::{SMatrix, SVector};

use super::{Contact, ContactForce, force::pushes, tied_program::TiedProgram, union_find::UnionFind};
use crate::body::Row;

/// Smallest violation, in distances of centres, that the unknowns are scaled by.
const SMALLEST_SCALE: f64 = 1e-7;

/// Most motions of a rigid body.
pub const RIGID: usize = 6;

/// The balls of a rigid body, each with `R`: its velocity for unit unknowns, which are scaled so that their mobility is one.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBalls<const D: usize>(pub Vec<(usize, SMatrix<f64, D, RIGID>)>);

/// A contact of tied bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TiedContact<const D: usize> {
    /// The contact.
    pub contact: Contact<D>,
    /// The least force that it may bear, not positive.
    pub least: f64,
    /// Whether it is likely to bear more.
    pub presses: bool,
}

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
    /// Where they touch or may.
    pub contacts: &'a [TiedContact<D>],
    /// Length of the step.
    pub step: f64,
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

/// A row of the program: entries by unknown, what they are to add up to, and what makes their squares add up to 1.
struct ScaledRow {
    entries: Vec<(usize, f64)>,
    side: f64,
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
        let pushes = pushes(self.velocities.len(), forces);
        Some(pushes.iter().zip(self.weights).map(|(push, weight)| push / *weight).collect())
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

    /// The forces at the contacts of an island; none if it has no solution.
    fn solve(&self, island: &TiedIsland, rigid: &RigidMaps<D>) -> Option<Vec<ContactForce<D>>> {
        let contacts: Vec<TiedContact<D>> = island.contacts.iter().map(|&contact| self.contacts[contact]).collect();
        let pulled = self.pulled(island, rigid, &contacts);
        let velocity = |body: usize| self.velocities[body] + pulled[body];
        let (ties, softs) = self.tie_rows(island, rigid, &velocity);
        let touching: Vec<ScaledRow> =
            contacts.iter().map(|contact| self.contact_row(island, rigid, &velocity, &contact.contact)).collect();
        let unit = ties.iter().map(|row| row.side.abs()).chain(touching.iter().map(|row| -row.side)).fold(0.0, f64::max);
        let least = |(row, contact): (&ScaledRow, &TiedContact<D>)| SMALLEST_SCALE * contact.contact.separation / self.step * row.scale;
        let unit = touching.iter().zip(&contacts).map(least).fold(unit, f64::max);
        let sides = |rows: &[ScaledRow]| -> Vec<f64> { rows.iter().map(|row| row.side / unit).collect() };
        let transposed = columns(island.unknowns + softs, ties.iter().chain(&touching));
        let program = TiedProgram { transposed, equations: sides(&ties), offsets: sides(&touching) };
        let multipliers = program.solve(&contacts.iter().map(|contact| contact.presses).collect::<Vec<bool>>())?;
        let found = contacts.into_iter().zip(&touching).zip(multipliers);
        let force = |((contact, row), multiplier): ((TiedContact<D>, &ScaledRow), f64)| contact.least + multiplier * unit * row.scale;
        Some(found.map(|found| ContactForce::normal(found.0.0.contact, force(found))).collect())
    }

    /// What the least forces of contacts change velocities by.
    fn pulled(&self, island: &TiedIsland, rigid: &RigidMaps<D>, contacts: &[TiedContact<D>]) -> Vec<SVector<f64, D>> {
        let least = contacts.iter().map(|contact| ContactForce::normal(contact.contact, contact.least));
        let pushes = pushes(self.velocities.len(), least);
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

    /// Rows of ties in the unknowns `sqrt(w) (v - wanted)`, and `sqrt(c) f` of the soft ones, of which the number is given too.
    fn tie_rows(&self, island: &TiedIsland, rigid: &RigidMaps<D>, velocity: &impl Fn(usize) -> SVector<f64, D>) -> (Vec<ScaledRow>, usize) {
        let (mut rows, mut softs) = (Vec::new(), 0);
        for tie in island.ties.iter().map(|&tie| &self.ties[tie]) {
            let side = tie.rate - tie.ends.iter().map(|(body, side)| side.direction.dot(&velocity(*body))).sum::<f64>();
            let mut entries = self.entries(island, rigid, tie.ends.iter().map(|(body, side)| (*body, side.direction)));
            if tie.compliance > 0.0 {
                entries.push((island.unknowns + softs, tie.compliance.sqrt()));
                softs += 1;
            }
            rows.push(ScaledRow::new(entries, side));
        }
        (rows, softs)
    }

    fn contact_row(
        &self,
        island: &TiedIsland,
        rigid: &RigidMaps<D>,
        velocity: &impl Fn(usize) -> SVector<f64, D>,
        contact: &Contact<D>,
    ) -> ScaledRow {
        let other = contact.other().map(|other| (other, contact.normal));
        let ends = [Some((contact.body, -contact.normal)), other].into_iter().flatten();
        let moving: f64 = ends.clone().map(|(body, direction)| direction.dot(&velocity(body))).sum();
        let sliding = contact.other().map_or(0.0, |_| contact.normal.dot(&contact.sliding));
        ScaledRow::new(self.entries(island, rigid, ends), contact.gap / self.step + moving + sliding)
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
        let tied: Vec<Vec<usize>> = self.ties.iter().map(|tie| free(tie.ends.iter().map(|(body, _)| *body).collect())).collect();
        let touching =
            |touching: &TiedContact<D>| free([Some(touching.contact.body), touching.contact.other()].into_iter().flatten().collect());
        let touching: Vec<Vec<usize>> = self.contacts.iter().map(touching).collect();
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
    /// The row whose entries are to add up to `side`; those of one unknown are added up. What no unknown changes is no row.
    fn new(mut entries: Vec<(usize, f64)>, side: f64) -> ScaledRow {
        entries.sort_by_key(|entry| entry.0);
        entries.dedup_by(|later, first| {
            let same = later.0 == first.0;
            first.1 += if same { later.1 } else { 0.0 };
            same
        });
        let square = entries.iter().map(|(_, value)| value * value).sum::<f64>();
        let scale = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
        entries.iter_mut().for_each(|(_, value)| *value *= scale);
        ScaledRow { entries, side: side * scale, scale }
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
            let contacts = [0, 2].map(|body| TiedContact { contact: floor(body), least: 0.0, presses });
            let problem = TiedProblem {
                weights: &[1.0, 3.0, 1.0],
                velocities: &[-up; 3],
                ties: std::slice::from_ref(&rod),
                rigid: &[],
                contacts: &contacts,
                step: 0.1,
            };
            let changes = problem.changes(0, 1).unwrap();
            // the force stops both, and pushes the lower one
            assert!((changes[0] - up * 4.0).norm() < 1e-9 && changes[1].norm() + changes[2].norm() == 0.0, "{changes:?}");
            assert!(problem.changes(1, 2).unwrap().iter().all(|change| change.norm() == 0.0));
        }
    }
}
