//! What earlier solves say about the next one: a starting point extrapolated in time.
//!
//! A field on the grid has jumps at the surfaces, which move. Before it is used at new places, the points that a surface
//! passed change sides by the jump function of the body's multipliers ([`passage`]); what is left is smooth in time and
//! is extrapolated linearly.

use nalgebra::SVector;

use super::bodies::Bodies;
use crate::{
    constraint::{Passage, Placed, passage},
    error::Result,
    petsc::{Scatter, Session, Vector},
};

/// Jump functions say little about points further than this from a surface, in cells: after longer moves a solve starts anew.
const LONGEST_MOVE: f64 = 2.0;

/// A solution: the fluid on the grid, the multipliers of all bodies (known to all ranks) and the unknowns of the closure.
pub struct Snapshot {
    /// Disturbance of the flow without bodies.
    pub fluid: Vector,
    /// Multipliers, body by body.
    pub multipliers: Vec<Vec<f64>>,
    /// Unknowns of the closure.
    pub closure: Vec<f64>,
}

/// The last solution and the one before it.
pub struct Past<const D: usize> {
    /// The last solution.
    pub last: Snapshot,
    /// The solution before it, as it would look at the places of the last one, and the time between the two.
    pub earlier: Option<(Snapshot, f64)>,
    /// Where the bodies were at the last solution, in the box.
    pub centers: Vec<SVector<f64, D>>,
}

/// The starting point of a solve.
pub struct Guess {
    /// The extrapolated solution.
    pub extrapolated: Snapshot,
    /// The last solution, as it would look at the new places.
    last: Snapshot,
}

impl Snapshot {
    /// A copy of what was found; fluid and multipliers are this rank's parts. Collective.
    pub fn of<const D: usize>(bodies: &Bodies<D>, session: &Session, found: (&Vector, &[f64], &[f64])) -> Result<Snapshot> {
        let (found, multipliers, closure) = found;
        let mut fluid = found.like()?;
        fluid.copy_from(found)?;
        Ok(Snapshot { fluid, multipliers: bodies.share_multipliers(session, multipliers), closure: closure.to_vec() })
    }

    /// `self + factor (self - earlier)`.
    fn extrapolated(&self, earlier: &Snapshot, factor: f64) -> Result<Snapshot> {
        let mut fluid = self.copy()?.fluid;
        fluid.add(factor, &self.fluid)?;
        fluid.add(-factor, &earlier.fluid)?;
        let line = |(last, earlier): (&f64, &f64)| last + factor * (last - earlier);
        let of_body = |(last, earlier): (&Vec<f64>, &Vec<f64>)| last.iter().zip(earlier).map(line).collect();
        Ok(Snapshot {
            fluid,
            multipliers: self.multipliers.iter().zip(&earlier.multipliers).map(of_body).collect(),
            closure: self.closure.iter().zip(&earlier.closure).map(line).collect(),
        })
    }

    fn copy(&self) -> Result<Snapshot> {
        let mut fluid = self.fluid.like()?;
        fluid.copy_from(&self.fluid)?;
        Ok(Snapshot { fluid, multipliers: self.multipliers.clone(), closure: self.closure.clone() })
    }
}

impl<const D: usize> Past<D> {
    /// A starting point for bodies that have come to new places in the time `elapsed`; none if they moved too far.
    pub fn guess(&self, bodies: &Bodies<D>, elapsed: f64) -> Result<Option<Guess>> {
        if self.longest_move(bodies) > LONGEST_MOVE * bodies.grid().spacing().max() {
            return Ok(None);
        }
        let mut extrapolated = match &self.earlier {
            Some((earlier, interval)) => self.last.extrapolated(earlier, elapsed / interval)?,
            None => self.last.copy()?,
        };
        let mut last = self.last.copy()?;
        self.change_sides(bodies, [&mut extrapolated, &mut last])?;
        Ok(Some(Guess { extrapolated, last }))
    }

    fn longest_move(&self, bodies: &Bodies<D>) -> f64 {
        (0..self.centers.len()).map(|body| self.moved(bodies, body).norm()).fold(0.0, f64::max)
    }

    fn moved(&self, bodies: &Bodies<D>, body: usize) -> SVector<f64, D> {
        bodies.grid().domain().nearest_image(bodies.placed[body].center - self.centers[body])
    }

    fn change_sides(&self, bodies: &Bodies<D>, snapshots: [&mut Snapshot; 2]) -> Result<()> {
        let passages: Vec<(usize, Passage)> = bodies.layout.local_bodies.iter().map(|&body| (body, self.passage(bodies, body))).collect();
        let places: Vec<i32> = passages.iter().flat_map(|(_, passage)| passage.places.iter().copied()).collect();
        let mut scatter = Scatter::new(&self.last.fluid, &places)?;
        for snapshot in snapshots {
            let changes = passages.iter().flat_map(|(body, passage)| passage.of(&snapshot.multipliers[*body]));
            scatter.places()?.iter_mut().zip(changes).for_each(|(place, change)| *place = change);
            scatter.add_back(&mut snapshot.fluid)?;
        }
        Ok(())
    }

    fn passage(&self, bodies: &Bodies<D>, body: usize) -> Passage {
        let placed = Placed { center: self.centers[body], surface: bodies.placed[body].surface.clone() };
        passage(bodies.grid(), &placed, &(placed.center + self.moved(bodies, body)))
    }

    /// The past of the solve after this one: its solution, and the guess it started from.
    pub fn then(past: Option<Past<D>>, last: Snapshot, (guess, elapsed): (Option<Guess>, f64), bodies: &Bodies<D>) -> Past<D> {
        let earlier = match guess {
            // another solve at the same instant takes the place of the last one
            _ if elapsed == 0.0 => past.and_then(|past| past.earlier),
            guess => guess.map(|guess| (guess.last, elapsed)),
        };
        Past { last, earlier, centers: bodies.placed.iter().map(|placed| placed.center).collect() }
    }
}
