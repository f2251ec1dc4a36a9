//! How far bodies go besides what carries all of them along: mean-square displacements, and the diffusivities that follow.
//!
//! From one configuration to the next a body goes from `x` to `x'`; the shear carries it by the strain in between times its mean distance along the gradient, and all free bodies
//! together drift by their mean. What is left,
//!
//! ```text
//! d = x' - x - strain (y + y') / 2 e_x - mean,
//! ```
//!
//! is added up over the run (Sierou and Brady, doi:10.1017/S0022112004008651), so that neither where the shear has its origin nor across which side of the box a body goes matters. The image of `x'` that counts is
//! the one nearest to where the shear alone would have carried the body: configurations must follow each other before bodies go half a box.

use nalgebra::SVector;
use serde::Serialize;

use crate::{
    geometry::Domain,
    observe::{
        Shear,
        statistics::{FEWEST, standard_error, student},
    },
};

/// Longest lag over the time between the first and the last configuration, one over it.
const SHORTEST_PART: usize = 4;

/// Parts of the run, one after the other, of each of which diffusivities are measured.
const PARTS: usize = 8;

/// Paths of bodies through configurations of a run.
pub struct Displacements<'a, const D: usize> {
    domain: &'a Domain<D>,
    shear: Option<Shear<D>>,
    times: Vec<f64>,
    last: Vec<SVector<f64, D>>,
    /// Of each configuration how far each body has gone since the first one.
    paths: Vec<Vec<SVector<f64, D>>>,
}

/// Mean squares over bodies and over parts of the run that follow each other.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanSquares<const D: usize> {
    /// Mean time between the two configurations.
    pub lag: f64,
    /// Strain in that time, in a shear.
    pub strain: Option<f64>,
    /// Of the displacement along each axis.
    pub squares: SVector<f64, D>,
    /// Half the widths of their 95 % intervals, where the lag fits into the run often enough.
    pub half_widths: Option<SVector<f64, D>>,
}

/// A diffusivity along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Diffusivity {
    /// Its value.
    pub value: f64,
    /// Half the width of its 95 % interval.
    pub half_width: f64,
}

impl<'a, const D: usize> Displacements<'a, D> {
    /// No configuration yet, of bodies in a box at any time that are carried along by a shear.
    pub fn new(domain: &'a Domain<D>, shear: Option<Shear<D>>) -> Self {
        Displacements { domain, shear, times: Vec::new(), last: Vec::new(), paths: Vec::new() }
    }

    /// Adds the configuration of a later time: centres of the bodies that are free, always in the same order.
    pub fn add(&mut self, time: f64, centers: &[SVector<f64, D>]) {
        let path = match (self.times.last(), self.paths.last()) {
            (Some(&before), Some(path)) => {
                let mut steps: Vec<SVector<f64, D>> =
                    self.last.iter().zip(centers).map(|(from, to)| self.displacement(before, from, time, to)).collect();
                let mean = steps.iter().sum::<SVector<f64, D>>() / steps.len().max(1) as f64;
                steps.iter_mut().zip(path).for_each(|(step, path)| *step += path - mean);
                steps
            }
            _ => vec![SVector::zeros(); centers.len()],
        };
        self.paths.push(path);
        self.times.push(time);
        self.last = centers.to_vec();
    }

    /// What a body goes besides what the shear carries it.
    fn displacement(&self, before: f64, from: &SVector<f64, D>, time: f64, to: &SVector<f64, D>) -> SVector<f64, D> {
        let domain = self.domain.clone().at(time);
        let Some(shear) = &self.shear else { return domain.nearest_image(to - from) };
        let strain = self.strain(time) - self.strain(before);
        let alone = domain.nearest_image(to - from - shear.flow * (strain * from[shear.gradient]));
        alone - shear.flow * (0.5 * strain * alone[shear.gradient])
    }

    /// The strain until a time, of the flow along its direction now.
    fn strain(&self, time: f64) -> f64 {
        self.shear.as_ref().map_or(0.0, |shear| shear.sign() * shear.strain(self.domain, time))
    }

    /// Mean squares over lags of one configuration, two, four and so on, up to a quarter of the run.
    pub fn mean_squares(&self) -> Vec<MeanSquares<D>> {
        let steps = self.times.len().saturating_sub(1);
        let lags = std::iter::successors(Some(1_usize), |lag| Some(2 * lag)).take_while(|lag| SHORTEST_PART * lag <= steps);
        lags.map(|lag| self.over(lag)).collect()
    }

    fn over(&self, lag: usize) -> MeanSquares<D> {
        let parts: Vec<[usize; 2]> =
            (0..).map(|part| [part * lag, (part + 1) * lag]).take_while(|[_, to]| *to < self.times.len()).collect();
        let squares: Vec<SVector<f64, D>> = parts.iter().map(|&[from, to]| self.squares(from, to)).collect();
        let between = |of: &dyn Fn(f64) -> f64| {
            parts.iter().map(|&[from, to]| of(self.times[to]) - of(self.times[from])).sum::<f64>() / parts.len() as f64
        };
        let half_width = |axis: usize| half_width(&squares.iter().map(|square| square[axis]).collect::<Vec<_>>());
        MeanSquares {
            lag: between(&|time| time),
            strain: self.shear.map(|_| between(&|time| self.strain(time))),
            squares: squares.iter().sum::<SVector<f64, D>>() / squares.len() as f64,
            half_widths: (squares.len() >= FEWEST).then(|| SVector::from_fn(|axis, _| half_width(axis))),
        }
    }

    /// Mean squares over bodies of what they go between two configurations.
    fn squares(&self, from: usize, to: usize) -> SVector<f64, D> {
        let displacements = self.paths[from].iter().zip(&self.paths[to]).map(|(from, to)| to - from);
        displacements.map(|displacement| displacement.component_mul(&displacement)).sum::<SVector<f64, D>>() / self.paths[from].len() as f64
    }

    /// Half the growth of mean squares over time along each axis, from a sixteenth of the run to an eighth; nothing where there are too few configurations.
    pub fn diffusivities(&self) -> Option<[Diffusivity; D]> {
        let half = self.times.len().saturating_sub(1) / (2 * PARTS);
        if half == 0 || self.last.is_empty() {
            return None;
        }
        let of_part = |part: usize| {
            let [from, middle, to] = [0, 1, 2].map(|halves| (2 * part + halves) * half);
            let halves = (self.squares(from, middle) + self.squares(middle, to)) * 0.5;
            (self.squares(from, to) - halves) / (self.times[to] - self.times[from])
        };
        let parts: Vec<SVector<f64, D>> = (0..PARTS).map(of_part).collect();
        Some(std::array::from_fn(|axis| {
            let along: Vec<f64> = parts.iter().map(|part| part[axis]).collect();
            Diffusivity { value: along.iter().sum::<f64>() / PARTS as f64, half_width: half_width(&along) }
        }))
    }
}

fn half_width(independent: &[f64]) -> f64 {
    student(independent.len() as f64 - 1.0) * standard_error(independent)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::geometry::{Axis, LeesEdwards};

    fn sheared(size: [f64; 2], rate: f64) -> Domain<2> {
        let slide = LeesEdwards::steady(0.0, rate * size[1], 0.0);
        Domain { size: Vector2::from(size), axes: [Axis::Periodic, Axis::Sheared(slide)] }
    }

    fn shear(rate: f64) -> Shear<2> {
        Shear { flow: Vector2::new(rate.signum(), 0.0), gradient: 1, rate: rate.abs(), at_rest: false }
    }

    /// Bodies that the shear alone carries go nowhere, in whatever image they are and however the box drifts.
    #[test]
    fn what_the_shear_carries_along_does_not_count() {
        for rate in [0.7, -0.7] {
            let (domain, starts) = (sheared([8.0, 6.0], rate), [[1.0, 0.5], [3.0, 5.5], [7.5, 3.0]].map(Vector2::from));
            let mut found = Displacements::new(&domain, Some(shear(rate)));
            for step in 0..40 {
                let time = 0.2 * f64::from(step);
                // all rise too, across the seam
                let at = |start: &Vector2<f64>| {
                    let height = start[1] + 0.3 * time;
                    domain.clone().at(time).wrap(Vector2::new(start[0] + rate * (start[1] * time + 0.15 * time * time), height))
                };
                found.add(time, &starts.iter().map(at).collect::<Vec<_>>());
            }
            for MeanSquares { squares, strain, lag, .. } in found.mean_squares() {
                assert!(squares.norm() < 1e-20, "{squares}");
                assert!((strain.unwrap() - 0.7 * lag).abs() < 1e-12);
            }
        }
    }

    /// A walk whose steps are independent has the diffusivity of its steps; in the shear the axis of the flow has no other one.
    #[test]
    fn a_random_walk_has_the_diffusivity_of_its_steps() {
        let (domain, mut random, step) = (sheared([20.0, 20.0], 0.5), ChaCha8Rng::seed_from_u64(3), 0.1);
        let mut places: Vec<Vector2<f64>> = (0..200).map(|body| Vector2::new(f64::from(body % 20), f64::from(body / 10))).collect();
        let mut found = Displacements::new(&domain, Some(shear(0.5)));
        for number in 0..400 {
            let time = step * f64::from(number);
            found.add(time, &places.iter().map(|place| domain.clone().at(time).wrap(*place)).collect::<Vec<_>>());
            for place in &mut places {
                let [x, y] = [0, 1].map(|_| 0.2 * (random.random::<f64>() - 0.5));
                *place += Vector2::new(0.5 * step * (place[1] + 0.5 * y) + x, y);
            }
        }
        // the variance of a step is .2^2 / 12
        let exact = 0.04 / 12.0 / (2.0 * step);
        for Diffusivity { value, half_width } in found.diffusivities().unwrap() {
            assert!((value - exact).abs() < 2.0 * half_width && half_width < 0.2 * exact, "{value} +- {half_width}, not {exact}");
        }
        for MeanSquares { lag, squares, half_widths, .. } in found.mean_squares() {
            assert!((squares / (2.0 * exact * lag)).iter().all(|part| (part - 1.0).abs() < 0.2), "{lag}: {squares}");
            assert!(half_widths.is_none_or(|widths| widths.iter().all(|width| *width > 0.0)));
        }
    }

    #[test]
    fn few_configurations_have_no_diffusivity() {
        let domain = Domain { size: Vector2::new(4.0, 4.0), axes: [Axis::Periodic; 2] };
        let mut found = Displacements::new(&domain, None);
        assert_eq!((found.mean_squares().len(), found.diffusivities()), (0, None));
        (0..5)
            .for_each(|time| found.add(f64::from(time), &[Vector2::new(3.9, 1.0), Vector2::new(1.0, (1.0 + 0.5 * f64::from(time)) % 4.0)]));
        let [one] = &found.mean_squares()[..] else { panic!("a lag of one in five configurations") };
        // half of what one body goes is the drift of both
        assert!((one.squares - Vector2::new(0.0, 0.0625)).norm() < 1e-12 && one.strain.is_none() && found.diffusivities().is_none());
    }
}
