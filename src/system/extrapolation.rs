//! What earlier solves say about the next one: a starting point extrapolated in time.
//!
//! A field on the grid has jumps at the surfaces, which move. Before it is used at new places, the points that a surface
//! passed change sides: a field that is a sum of solutions with surfaces in different places changes by the same sum of
//! their jump functions. What is left is smooth in time at every point, and is extrapolated linearly. Where the fluid is
//! eliminated from the linear system, multipliers are all there is.

use nalgebra::SVector;

use super::bodies::Bodies;
use crate::{
    constraint::{FreshlyCleared, Placed, freshly_cleared, jump},
    error::Result,
    petsc::{Scatter, Session, Vector},
    system::work::SolvedUnknowns,
};

/// Jump functions say little about points further than this from a surface, in cells: after longer moves a solve starts anew.
const LONGEST_MOVE: f64 = 2.0;

/// Histories that are kept: that before a step, and those of its two solves, now and half a step ahead.
const MOST: usize = 3;

/// The same with fluids, which take room.
const MOST_WITH_FLUID: usize = 2;

/// A solution: the fluid on the grid, the multipliers of all bodies (known to all ranks) and the unknowns of the mean-flow constraint.
pub struct Snapshot<const D: usize> {
    /// Disturbance of the flow without bodies, unless the fluid is eliminated.
    pub fluid: Option<Vector>,
    /// Multipliers, body by body.
    pub multipliers: Vec<Vec<f64>>,
    /// Centres of the bodies when it was found, not wrapped into the box.
    pub centers: Vec<SVector<f64, D>>,
    /// Unknowns of the mean-flow constraint.
    pub mean_flow: Vec<f64>,
}

/// The last solution and the one before it.
pub struct ExtrapolationHistory<const D: usize> {
    /// Time of the last solution.
    pub time: f64,
    /// The last solution.
    pub last: Snapshot<D>,
    /// The solution before it, whose fluid has its surfaces where the last one has them, and the time between the two.
    pub earlier: Option<(Snapshot<D>, f64)>,
}

/// Histories at the last times at which something was solved, the last one first: a run that stops amid the solves of a step goes on from what was before them.
#[derive(Default)]
pub struct RecentHistories<const D: usize>(Vec<ExtrapolationHistory<D>>);

/// The starting point of a solve.
pub struct InitialGuess<const D: usize> {
    /// The extrapolated solution.
    pub extrapolated: Snapshot<D>,
    /// The last solution, its fluid with surfaces in the new places.
    last: Snapshot<D>,
}

impl<const D: usize> Snapshot<D> {
    /// A copy of what was found, without the fluid if it is eliminated. Collective.
    pub fn of(bodies: &Bodies<D>, session: &Session, centers: &[SVector<f64, D>], found: &SolvedUnknowns, condensed: bool) -> Result<Self> {
        let multipliers = bodies.share_multipliers(session, &found.multipliers);
        let fluid = if condensed { None } else { Some(found.fluid.copied()?) };
        Ok(Snapshot { fluid, multipliers, centers: centers.to_vec(), mean_flow: found.global_unknowns.clone() })
    }

    /// `self + factor (self - earlier)`.
    fn extrapolated(&self, earlier: &Snapshot<D>, factor: f64) -> Result<Snapshot<D>> {
        let mut snapshot = self.copy()?;
        if let (Some(fluid), Some(last), Some(earlier)) = (&mut snapshot.fluid, &self.fluid, &earlier.fluid) {
            fluid.add(factor, last)?;
            fluid.add(-factor, earlier)?;
        }
        let line = |(last, earlier): (&mut f64, &f64)| *last += factor * (*last - earlier);
        let bodies = snapshot.multipliers.iter_mut().zip(&earlier.multipliers);
        bodies.for_each(|(last, earlier)| last.iter_mut().zip(earlier).for_each(line));
        snapshot.mean_flow.iter_mut().zip(&earlier.mean_flow).for_each(line);
        Ok(snapshot)
    }

    fn copy(&self) -> Result<Snapshot<D>> {
        let (multipliers, centers, mean_flow) = (self.multipliers.clone(), self.centers.clone(), self.mean_flow.clone());
        Ok(Snapshot { fluid: self.fluid.as_ref().map(Vector::copied).transpose()?, multipliers, centers, mean_flow })
    }

    /// The jump at a point that a body passes, for this solution and a body that is about to be in the image at `center`.
    fn jump(&self, bodies: &Bodies<D>, body: usize, shift: &SVector<f64, D>, point: &FreshlyCleared<D>) -> f64 {
        let placed = Placed { center: self.centers[body] + shift, surface: bodies.placed[body].surface.clone() };
        jump(&placed, &self.multipliers[body], point)
    }
}

impl<const D: usize> ExtrapolationHistory<D> {
    /// A starting point for bodies that have come to new `centers` at a `time`; none if they moved too far.
    pub fn guess(&self, bodies: &Bodies<D>, centers: &[SVector<f64, D>], time: f64) -> Result<Option<InitialGuess<D>>> {
        let longest = centers.iter().zip(&self.last.centers).map(|(center, last)| (center - last).norm()).fold(0.0, f64::max);
        if self.last.fluid.is_some() && longest > LONGEST_MOVE * bodies.grid().spacing().max() {
            return Ok(None);
        }
        let mut last = self.last.copy()?;
        let mut extrapolated = match &self.earlier {
            Some((earlier, interval)) => self.last.extrapolated(earlier, (time - self.time) / interval)?,
            None => self.last.copy()?,
        };
        if let (Some(of_last), Some(of_extrapolated)) = (&mut last.fluid, &mut extrapolated.fluid) {
            self.change_sides(bodies, centers, time, of_last, of_extrapolated)?;
        }
        Ok(Some(InitialGuess { extrapolated, last }))
    }

    /// Changes, at the points that surfaces pass on their way to `centers`, the last fluid and the one extrapolated to `time`.
    fn change_sides(
        &self,
        bodies: &Bodies<D>,
        centers: &[SVector<f64, D>],
        time: f64,
        last: &mut Vector,
        extrapolated: &mut Vector,
    ) -> Result<()> {
        let points: Vec<(usize, SVector<f64, D>, FreshlyCleared<D>)> =
            bodies.layout.local_bodies.iter().flat_map(|&body| self.freshly_cleared(bodies, body, &centers[body])).collect();
        let places: Vec<usize> = points.iter().map(|(_, _, point)| point.place).collect();
        let mut scatter = Scatter::new(last, &places)?;
        let of_last: Vec<f64> =
            points.iter().map(|(body, shift, point)| point.side * self.last.jump(bodies, *body, shift, point)).collect();
        scatter.places().copy_from_slice(&of_last);
        scatter.add_back(last)?;
        scatter.places().iter_mut().zip(&of_last).zip(&points).for_each(|((place, of_last), (body, shift, point))| {
            *place = *of_last;
            if let Some((earlier, interval)) = &self.earlier {
                let of_earlier = point.side * earlier.jump(bodies, *body, shift, point);
                *place += (time - self.time) / interval * (of_last - of_earlier);
            }
        });
        scatter.add_back(extrapolated)
    }

    /// The points that a body passes on its way to `center`, each with the body and the shift of its centres into the box.
    fn freshly_cleared(
        &self,
        bodies: &Bodies<D>,
        body: usize,
        center: &SVector<f64, D>,
    ) -> Vec<(usize, SVector<f64, D>, FreshlyCleared<D>)> {
        let shift = bodies.placed[body].center - center;
        let placed = Placed { center: self.last.centers[body] + shift, surface: bodies.placed[body].surface.clone() };
        freshly_cleared(bodies.grid(), &placed, &bodies.placed[body].center).into_iter().map(|point| (body, shift, point)).collect()
    }
}

impl<const D: usize> RecentHistories<D> {
    /// What the next solve starts from.
    pub fn last(&self) -> Option<&ExtrapolationHistory<D>> {
        self.0.first()
    }

    /// What the first solve at a time started from, or starts from.
    pub fn before(&self, time: f64) -> Option<&ExtrapolationHistory<D>> {
        self.0.iter().find(|history| history.time < time)
    }

    /// Adds what a solve at a time has found that started from a guess; another solve at the same instant takes the place of the last one.
    pub fn add(&mut self, last: Snapshot<D>, guess: Option<InitialGuess<D>>, time: f64) {
        if let Some(same) = self.0.first_mut().filter(|history| history.time == time) {
            same.last = last;
            return;
        }
        let interval = self.0.first().map(|history| time - history.time);
        let earlier = interval.and_then(|interval| guess.map(|guess| (guess.last, interval)));
        let most = if last.fluid.is_some() { MOST_WITH_FLUID } else { MOST };
        self.0.insert(0, ExtrapolationHistory { time, last, earlier });
        self.0.truncate(most);
    }

    /// Forgets what was found from a time on.
    pub fn forget_from(&mut self, time: f64) {
        self.0.retain(|history| history.time < time);
    }
}

impl<const D: usize> From<Option<ExtrapolationHistory<D>>> for RecentHistories<D> {
    fn from(last: Option<ExtrapolationHistory<D>>) -> Self {
        RecentHistories(last.into_iter().collect())
    }
}
