//! Near bodies feel each other: a correction, pair by pair, of the inverses of isolated bodies.
//!
//! ```text
//! P = sum over bodies of B_i^{-1}  +  sum over near pairs of ( B_ij^{-1} - B_i^{-1} (+) B_j^{-1} )
//! ```
//!
//! with `B_i` the block of an isolated body in unbounded fluid and `B_ij` that of two. In the frame of the pair the second sum
//! depends on the distance alone, and comes from a table; [`NearPairs`] turns into that frame and back.

mod block;
mod pattern;
mod table;

use std::rc::Rc;

use self::{pattern::Pattern, table::Table};
use super::Layout;
use crate::{
    error::Result,
    geometry::{Ball, Domain, Pair, near_pairs},
    petsc::{Scatter, Vector},
    surface::turn,
};

pub use block::Nature;
pub use table::PairTables;

/// Gap, over the mean radius of the two, below which bodies are a near pair.
pub const REACH: f64 = 1.0;

/// The bodies of all ranks as pairs see them.
pub struct Crowd<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// The bodies, with their centres in the box.
    pub balls: &'a [Ball<D>],
    /// What else decides the block of each.
    pub natures: &'a [Nature],
    /// Who holds which multipliers.
    pub layout: &'a Layout,
}

/// The correction for the near pairs of this rank's bodies.
pub struct NearPairs {
    pairs: Vec<NearPair>,
    tables: Vec<Rc<Table>>,
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

struct NearPair {
    table: usize,
    places: [usize; 2],
    turn: usize,
    values: usize,
}

impl NearPairs {
    /// The near pairs of a crowd, for multipliers shaped like `multipliers`; collective.
    ///
    /// # Errors
    /// PETSc has no memory for the exchange.
    pub fn new<const D: usize>(crowd: &Crowd<D>, tables: &PairTables<D>, multipliers: &Vector) -> Result<NearPairs> {
        let rank = Rank { layout: crowd.layout, natures: crowd.natures };
        let mut near = near_and_mine(crowd);
        let (fetched, places) = rank.places::<D>(&near);
        let local = crowd.layout.local_unknowns();
        let mut pairs = NearPairs {
            pairs: Vec::with_capacity(near.len()),
            tables: Vec::new(),
            turns: Vec::new(),
            values: Vec::new(),
            scatter: Scatter::new(multipliers, &fetched)?,
            wanted: vec![0.0; local + fetched.len()],
            found: vec![0.0; local + fetched.len()],
            local,
        };
        for pair in &mut near {
            pairs.add(crowd, tables, pair, &places);
        }
        Ok(pairs)
    }

    fn add<const D: usize>(&mut self, crowd: &Crowd<D>, tables: &PairTables<D>, pair: &Pair<D>, places: &[usize]) {
        let side = |body: usize| (crowd.natures[body], crowd.balls[body].radius);
        let (mut ends, mut separation) = ([pair.first, pair.second], pair.separation);
        if table::out_of_order(ends.map(side)) {
            ends.reverse();
            separation = -separation;
        }
        let table = tables.of(ends.map(side));
        let known = self.tables.iter().position(|known| Rc::ptr_eq(known, &table));
        let index = known.unwrap_or_else(|| {
            self.tables.push(table.clone());
            self.tables.len() - 1
        });
        let (turn_start, values) = (self.turns.len(), self.values.len());
        let order = ends.map(|body| crowd.natures[body].order).into_iter().max().unwrap_or(1);
        turn(&separation.normalize(), order, &mut self.turns);
        table.append(pair.gap, crowd.balls[ends[0]].radius, &mut self.values);
        self.pairs.push(NearPair { table: index, places: ends.map(|body| places[body]), turn: turn_start, values });
    }

    /// What the pairs add to the inverses of isolated bodies applied to `wanted`: this rank's multipliers; collective.
    ///
    /// # Errors
    /// The exchange fails.
    pub fn correction(&mut self, wanted: &Vector) -> Result<&[f64]> {
        let (own, others) = self.wanted.split_at_mut(self.local);
        own.copy_from_slice(&wanted.local()?);
        others.copy_from_slice(&self.scatter.fetch(wanted)?);
        self.found.fill(0.0);
        let mut frame = [Vec::new(), Vec::new()];
        for pair in &self.pairs {
            let pattern: &Pattern = &self.tables[pair.table].pattern;
            let (turns, values) = (&self.turns[pair.turn..], &self.values[pair.values..]);
            pattern.apply((turns, values), (&self.wanted, pair.places), &mut frame, &mut self.found);
        }
        Ok(&self.found[..self.local])
    }
}

/// The near pairs with a body that this rank holds.
fn near_and_mine<const D: usize>(crowd: &Crowd<D>) -> Vec<Pair<D>> {
    let largest = crowd.balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let radius = |body: usize| crowd.balls[body].radius;
    let mut near = near_pairs(crowd.domain, crowd.balls, REACH * largest);
    near.retain(|pair| {
        let mean = 0.5 * (radius(pair.first) + radius(pair.second));
        pair.gap < REACH * mean && [pair.first, pair.second].iter().any(|&body| crowd.layout.holds(body))
    });
    near
}

struct Rank<'a> {
    layout: &'a Layout,
    natures: &'a [Nature],
}

impl Rank<'_> {
    /// The multipliers to fetch for these pairs, and where each body's stand: this rank's first, then the fetched.
    fn places<const D: usize>(&self, near: &[Pair<D>]) -> (Vec<i32>, Vec<usize>) {
        let mut places = vec![usize::MAX; self.natures.len()];
        self.layout.local_bodies.iter().for_each(|&body| places[body] = self.layout.local(body));
        let mut fetched = Vec::new();
        for body in near.iter().flat_map(|pair| [pair.first, pair.second]) {
            if places[body] == usize::MAX {
                places[body] = self.layout.local_unknowns() + fetched.len();
                let first = self.layout.global(body);
                fetched.extend((first..first + self.natures[body].count::<D>()).map(|unknown| unknown as i32));
            }
        }
        (fetched, places)
    }
}
