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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::observe::{Part, Parts};

    const MEAN: f64 = 3.0;

    /// A viscosity that scatters by 0.5 about the mean, and forgets itself over a strain of 1 (AR(1)).
    fn curve(seed: u64, strain: f64) -> Vec<CurvePoint> {
        const STEP: f64 = 0.25;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // a sum of uniform numbers is nearly normal
        let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let (kept, mut value) = ((-STEP).exp(), normal());
        let mut point = |step: usize| {
            value = kept * value + (1.0 - kept * kept).sqrt() * normal();
            CurvePoint {
                strain: STEP * step as f64,
                parts: Parts::of(|part| (part == Part::Hydrodynamic).then_some(MEAN + 0.5 * value)),
                first_normal_difference: 0.0,
                second_normal_difference: None,
                particle_pressure: None,
            }
        };
        (0..(strain / STEP) as usize).map(&mut point).collect()
    }

    fn known(points: &[CurvePoint], viscosity_interval: f64, strain: f64) -> bool {
        ViscosityHistory::new(Some(Until { viscosity_interval, strain }), points.to_vec()).nearly(1.0)
    }

    #[test]
    fn a_run_ends_when_its_mean_was_known_for_a_fifth_of_its_strain() {
        let points = curve(2, 100.0);
        let width = |count: usize| {
            let mean = MeanViscosity::of(&points[..count]).unwrap();
            mean.half_width() / mean.relative
        };
        let [whole, earlier] = [points.len(), points.len() * 4 / 5].map(width);
        assert!(earlier > 1.01 * whole, "choose another seed: {earlier} {whole}");
        assert!(!known(&points, 0.99 * earlier, 20.0), "the whole run knows, its first four fifths did not");
        assert!(known(&points, 1.01 * earlier, 20.0) && !known(&points, 1.01 * earlier, 95.0));
    }

    /// Of 200 runs that end once something is known of their points, those whose interval holds the mean.
    fn holding(known: impl Fn(&[CurvePoint]) -> bool) -> usize {
        let holds = |seed: &u64| {
            let points = curve(*seed, 4000.0);
            let end = (100..points.len()).step_by(8).find(|end| known(&points[..*end])).unwrap();
            let mean = MeanViscosity::of(&points[..end]).unwrap();
            (mean.relative - MEAN).abs() <= mean.half_width()
        };
        (0..200).filter(holds).count()
    }

    #[test]
    #[allow(clippy::print_stderr)]
    fn runs_that_end_when_their_mean_is_known_know_it() {
        for interval in [0.05, 0.1] {
            let once = |points: &[CurvePoint]| {
                let mean = MeanViscosity::of(points);
                mean.is_some_and(|mean| mean.half_width() <= interval * mean.relative && mean.strains[1] - mean.strains[0] >= 20.0)
            };
            let [known, narrow_once] = [holding(|points| known(points, interval, 20.0)), holding(once)];
            // what the manual quotes
            eprintln!("an interval of {interval}: {known} of 200 hold the mean, {narrow_once} that are narrow once");
            assert!((180..=198).contains(&known) && narrow_once <= known, "{interval}: {known}, {narrow_once} of 200");
        }
    }
}
