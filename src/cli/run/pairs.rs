//! The pair distribution of a run: over its frames once it has ended, or of an instant.

use std::path::Path;

use crate::{
    error::Result,
    geometry::{Ball, Domain},
    observe::{PairCounts, PairDistribution, Shear},
    output::{MeanViscosity, PairSummary, pair_files, read_frames},
    parallel::World,
};

/// Part of a run without a steady viscosity that is left out.
const START_UP: f64 = 0.5;

/// What was found of the pairs, and the files that hold it.
pub struct Pairs {
    /// For the summary.
    pub summary: PairSummary,
    /// Files by name.
    pub files: Vec<(&'static str, Vec<u8>)>,
}

/// The bodies that are looked at.
pub struct Crowd<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// Radii of the bodies.
    pub radii: &'a [f64],
    /// The shear, if there is one.
    pub shear: Option<Shear<D>>,
}

/// Of one configuration; nothing if there are fewer than two bodies.
pub fn at_an_instant<const D: usize>(crowd: Crowd<D>, balls: &[Ball<D>]) -> Option<Pairs> {
    let mut counts = PairCounts::new(crowd.domain, crowd.radii, crowd.shear);
    counts.add(crowd.domain.slide().map_or(0.0, |slide| slide.time), balls);
    counts.distribution().map(|distribution| Pairs::of(&distribution, 0.0))
}

/// Over the frames of a run until a time: those of the steady part of its viscosity, or else of its second half. Collective; on the first rank.
///
/// # Errors
/// Frames cannot be read.
pub fn of_a_run<const D: usize>(
    world: &World,
    folder: &Path,
    crowd: Crowd<D>,
    (end, mean): (f64, Option<&MeanViscosity>),
) -> Result<Option<Pairs>> {
    let begin = match (&crowd.shear, mean) {
        (Some(shear), Some(mean)) => mean.strains[0] / shear.rate.abs(),
        _ => START_UP * end,
    };
    let measure = || {
        let mut counts = PairCounts::new(crowd.domain, crowd.radii, crowd.shear);
        let mut first = None;
        for frame in read_frames::<D>(folder)?.into_iter().filter(|frame| frame.time >= begin) {
            let ball = |(body, &radius): (&crate::observe::FrameBody<D>, &f64)| Ball { center: body.center, radius };
            counts.add(frame.time, &frame.bodies.iter().zip(crowd.radii).map(ball).collect::<Vec<_>>());
            first.get_or_insert(frame.time);
        }
        Ok(counts.distribution().zip(first).map(|(distribution, first)| Pairs::of(&distribution, first)))
    };
    world.agree(if world.rank() == 0 { measure() } else { Ok(None) })
}

impl Pairs {
    fn of(distribution: &PairDistribution, from_time: f64) -> Pairs {
        let PairDistribution { configurations, coordination, .. } = *distribution;
        Pairs { summary: PairSummary { coordination, configurations, from_time }, files: pair_files(distribution).to_vec() }
    }
}
