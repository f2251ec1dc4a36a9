//! The viscosity of a run over time, and whether it is known as well as the scene asks for.

use crate::{
    output::{CurvePoint, MeanViscosity},
    parallel::World,
    scene::Until,
};

/// Part of a run whose mean must be known as well as the whole one's for the run to end: an interval that is narrow once is so by chance.
const EARLIER: f64 = 0.8;

/// The viscosity of a run so far; its points and their mean are known to the first rank only.
#[derive(Default)]
pub struct ViscosityHistory {
    until: Option<Until>,
    points: Vec<CurvePoint>,
    mean: Option<MeanViscosity>,
    satisfied: bool,
}

impl ViscosityHistory {
    /// Of a run that has these points behind it.
    pub fn new(until: Option<Until>, points: Vec<CurvePoint>) -> ViscosityHistory {
        ViscosityHistory { until, mean: MeanViscosity::of(&points), points, satisfied: false }
    }

    /// Adds a point. Collective.
    ///
    /// Only a step that started from a checkpoint may be the last, since the run can then be resumed: such steps begin once the mean
    /// is [`nearly`](ViscosityHistory::nearly) known but for `about`.
    pub fn add(&mut self, world: &World, point: Option<CurvePoint>, about: f64) {
        let near = self.nearly(about);
        if world.rank() == 0 {
            self.points.extend(point);
            self.mean = MeanViscosity::of(&self.points);
        }
        if self.until.is_some() {
            self.satisfied = world.max(f64::from(near && self.nearly(1.0))) > 0.0;
        }
    }

    /// Whether the mean is known but for a factor, and was so over the first four fifths of the strain; on the first rank.
    pub fn nearly(&self, factor: f64) -> bool {
        let (Some(until), Some(mean)) = (self.until, &self.mean) else { return false };
        let narrow = |mean: &MeanViscosity| mean.half_width() <= factor * until.viscosity_interval * mean.relative.abs();
        let [from, to] = mean.strains;
        factor * (to - from) >= until.strain && narrow(mean) && self.earlier().is_some_and(|mean| narrow(&mean))
    }

    /// The mean over the first part of the strain.
    fn earlier(&self) -> Option<MeanViscosity> {
        let last = self.points.last()?.strain;
        let count = self.points.partition_point(|point| point.strain.abs() <= EARLIER * last.abs());
        MeanViscosity::of(&self.points[..count])
    }

    /// The points so far; on the first rank.
    pub fn points(&self) -> &[CurvePoint] {
        &self.points
    }

    /// The mean over the steady part, once there is one; on the first rank.
    pub fn mean(&self) -> Option<&MeanViscosity> {
        self.mean.as_ref()
    }

    /// Whether the mean is known as well as the scene asks for, and the run may end; on all ranks.
    pub fn satisfied(&self) -> bool {
        self.satisfied
    }
}
