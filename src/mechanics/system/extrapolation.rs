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
    mechanics::work::SolvedUnknowns,
    petsc::{Scatter, Session, Vector},
};

/// Jump functions say little about points further than this from a surface, in cells: after longer moves a solve starts anew.
const LONGEST_MOVE: f64 = 2.0;

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

    fn without_fluid(&self) -> Option<Snapshot<D>> {
        let (multipliers, centers, mean_flow) = (self.multipliers.clone(), self.centers.clone(), self.mean_flow.clone());
        self.fluid.is_none().then_some(Snapshot { fluid: None, multipliers, centers, mean_flow })
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
    /// A copy, if it holds no fluid.
    pub fn without_fluid(&self) -> Option<ExtrapolationHistory<D>> {
        let earlier = match &self.earlier {
            Some((earlier, interval)) => Some((earlier.without_fluid()?, *interval)),
            None => None,
        };
        Some(ExtrapolationHistory { time: self.time, last: self.last.without_fluid()?, earlier })
    }

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

    /// What is past once a solve at a `time` has found the snapshot `last`, starting from a guess, and what was before it, unless that is of this time too.
    pub fn then(
        past: Option<ExtrapolationHistory<D>>,
        last: Snapshot<D>,
        guess: Option<InitialGuess<D>>,
        time: f64,
    ) -> (ExtrapolationHistory<D>, Option<ExtrapolationHistory<D>>) {
        match past {
            // another solve at the same instant takes the place of the last one
            Some(past) if past.time == time => (ExtrapolationHistory { time, last, earlier: past.earlier }, None),
            past => {
                let interval = past.as_ref().map(|past| time - past.time);
                let earlier = interval.and_then(|interval| guess.map(|guess| (guess.last, interval)));
                (ExtrapolationHistory { time, last, earlier }, past)
            }
        }
    }
}
