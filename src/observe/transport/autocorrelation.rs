//! How long bodies keep their velocities besides those of the shear: the velocity autocorrelation function.
//!
//! ```text
//! C_a(lag) = < v_a(t) v_a(t + lag) >,   v = velocity - velocity of the shear at the centre - mean of all bodies at that instant,
//! ```
//!
//! over bodies and over instants `t` (Hansen and McDonald, Theory of Simple Liquids, section 7.2); in a shear the axes are those of flow, gradient and vorticity, each by its
//! name. The velocities of a shear are those of its rate at the instant.

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

/// Lags up to the longest at most, every so many configurations if there are more.
const MOST_LAGS: usize = 100;

/// Velocities of bodies through configurations of a run.
pub struct Autocorrelation<'a, const D: usize> {
    domain: &'a Domain<D>,
    shear: Option<Shear<D>>,
    times: Vec<f64>,
    /// Of each configuration the velocities of bodies less those of the shear and their mean.
    velocities: Vec<Vec<SVector<f64, D>>>,
}

/// Means over bodies and instants for a lag.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlations<const D: usize> {
    /// Mean time between the two configurations.
    pub lag: f64,
    /// Of the velocity along each axis.
    pub values: SVector<f64, D>,
    /// Half the widths of their 95 % intervals, from parts of the run as long as the longest lag, where they are enough.
    pub half_widths: Option<SVector<f64, D>>,
}

/// How long velocities along an axis are kept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CorrelationTime {
    /// Mean square of the velocity.
    pub mean_square: f64,
    /// The integral over the lag of the correlation over its value at zero, up to where it first changes its sign; nothing if it keeps it over all lags.
    pub time: Option<f64>,
}

impl<'a, const D: usize> Autocorrelation<'a, D> {
    /// No configuration yet, of bodies in a box at any time that are carried along by a shear.
    pub fn new(domain: &'a Domain<D>, shear: Option<Shear<D>>) -> Self {
        Autocorrelation { domain, shear, times: Vec::new(), velocities: Vec::new() }
    }

    /// Adds the configuration of a later time: centres, in the box, and velocities of the bodies that are free, always in the same order.
    pub fn add(&mut self, time: f64, bodies: &[(SVector<f64, D>, SVector<f64, D>)]) {
        let carried = self.carried(time);
        let relative = bodies.iter().map(|(center, velocity)| velocity - carried * self.shear.map_or(0.0, |shear| center[shear.gradient]));
        let mut relative: Vec<SVector<f64, D>> = relative.collect();
        let mean = relative.iter().sum::<SVector<f64, D>>() / relative.len().max(1) as f64;
        relative.iter_mut().for_each(|velocity| *velocity -= mean);
        self.velocities.push(relative);
        self.times.push(time);
    }

    /// Growth of the velocity of the shear along its gradient at a time.
    fn carried(&self, time: f64) -> SVector<f64, D> {
        match (&self.shear, self.domain.protocol()) {
            (Some(_), Some(protocol)) => SVector::from_fn(|axis, _| if axis == 0 { protocol.rate(time) } else { 0.0 }),
            (Some(shear), None) => shear.flow * shear.rate,
            (None, _) => SVector::zeros(),
        }
    }

    /// Correlations over lags of no configuration, of one and so on, up to a quarter of the run.
    pub fn correlations(&self) -> Vec<Correlations<D>> {
        let longest = self.times.len().saturating_sub(1) / SHORTEST_PART;
        if longest == 0 || self.velocities.iter().any(Vec::is_empty) {
            return Vec::new();
        }
        (0..=longest).step_by(longest.div_ceil(MOST_LAGS)).map(|lag| self.over(lag, longest)).collect()
    }

    fn over(&self, lag: usize, longest: usize) -> Correlations<D> {
        let products: Vec<SVector<f64, D>> = (lag..self.times.len()).map(|to| self.product(to - lag, to)).collect();
        let count = products.len() as f64;
        let lags = (lag..self.times.len()).map(|to| self.times[to] - self.times[to - lag]).sum::<f64>();
        // what is further apart than the longest lag is taken for independent
        let parts: Vec<&[SVector<f64, D>]> = products.chunks_exact(longest.div_ceil(2)).collect();
        let means: Vec<SVector<f64, D>> = parts.iter().map(|part| part.iter().sum::<SVector<f64, D>>() / part.len() as f64).collect();
        let half_width = |axis: usize| {
            let along: Vec<f64> = means.iter().map(|mean| mean[axis]).collect();
            student(along.len() as f64 - 1.0) * standard_error(&along)
        };
        Correlations {
            lag: lags / count,
            values: products.iter().sum::<SVector<f64, D>>() / count,
            half_widths: (means.len() + 1 >= FEWEST && longest >= FEWEST).then(|| SVector::from_fn(|axis, _| half_width(axis))),
        }
    }

    /// Mean over bodies of the products of their velocities of two configurations.
    fn product(&self, from: usize, to: usize) -> SVector<f64, D> {
        let products = self.velocities[from].iter().zip(&self.velocities[to]).map(|(from, to)| from.component_mul(to));
        products.sum::<SVector<f64, D>>() / self.velocities[from].len() as f64
    }

    /// How long velocities are kept along each axis; nothing where there are too few configurations.
    pub fn correlation_times(&self) -> Option<[CorrelationTime; D]> {
        let all = self.correlations();
        let mean_square = all.first()?.values;
        Some(std::array::from_fn(|axis| CorrelationTime { mean_square: mean_square[axis], time: until_the_sign_changes(&all, axis) }))
    }
}

/// The integral of a correlation over its first value, up to the lag at which it is zero first.
fn until_the_sign_changes<const D: usize>(all: &[Correlations<D>], axis: usize) -> Option<f64> {
    let first = all.first().map(|first| first.values[axis]).filter(|first| *first > 0.0)?;
    let mut sum = 0.0;
    for two in all.windows(2) {
        let [from, to] = [0, 1].map(|end| two[end].values[axis] / first);
        let step = two[1].lag - two[0].lag;
        if to <= 0.0 {
            return Some(sum + 0.5 * from * step * from / (from - to));
        }
        sum += 0.5 * (from + to) * step;
    }
    None
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::geometry::{Axis, LeesEdwards, Protocol};

    fn shear(rate: f64) -> Shear<2> {
        Shear { flow: Vector2::new(rate.signum(), 0.0), gradient: 1, rate: rate.abs(), at_rest: false }
    }

    /// Bodies that a shear alone carries, all of them adrift too, have no velocity of their own, whatever rate it has at the time.
    #[test]
    fn what_the_shear_carries_along_is_no_correlation() {
        let changing = Protocol::Oscillation { amplitude: 2.0, frequency: 0.4 };
        for protocol in [Protocol::Steady(0.7 * 6.0), Protocol::Steady(-0.7 * 6.0), changing] {
            let slide = |time| LeesEdwards { start: 0.0, protocol, time };
            let domain = Domain { size: Vector2::new(8.0, 6.0), axes: [Axis::Periodic, Axis::Sheared(slide(0.0))] };
            let mut found = Autocorrelation::new(&domain, Some(shear(protocol.rate(0.0) / 6.0)));
            for time in (0..40).map(|step| 0.1 * f64::from(step)) {
                let body = |y: f64| (Vector2::new(1.0, y), Vector2::new(protocol.rate(time) / 6.0 * y + 0.3 * time, -0.2));
                found.add(time, &[body(0.5), body(2.5), body(5.5)]);
            }
            assert!(found.correlations().len() == 10 && found.correlations().iter().all(|all| all.values.norm() < 1e-20));
        }
    }

    /// Velocities that turn at one rate with phases all around: a cosine, whose first zero is a quarter of the period.
    #[test]
    fn velocities_that_turn_have_a_cosine() {
        let domain = Domain { size: Vector2::new(8.0, 6.0), axes: [Axis::Periodic; 2] };
        let (mut found, frequency) = (Autocorrelation::new(&domain, None), 0.25);
        for time in (0..401).map(|step| 0.05 * f64::from(step)) {
            let body = |number: u32| {
                let (y, x) = (std::f64::consts::TAU * (frequency * time + f64::from(number) / 16.0)).sin_cos();
                (Vector2::zeros(), 2.0 * Vector2::new(x, y))
            };
            found.add(time, &(0..16).map(body).collect::<Vec<_>>());
        }
        for Correlations { lag, values, .. } in found.correlations() {
            let expected = 2.0 * (std::f64::consts::TAU * frequency * lag).cos();
            assert!(values.iter().all(|value| (value - expected).abs() < 1e-9), "{values} at {lag}, not {expected}");
        }
        for CorrelationTime { mean_square, time } in found.correlation_times().expect("there are lags") {
            let quarter = 1.0 / (std::f64::consts::TAU * frequency);
            assert!((mean_square - 2.0).abs() < 1e-9 && time.is_some_and(|time| (time / quarter - 1.0).abs() < 2e-3), "{time:?}");
        }
    }

    /// Velocities each of which keeps a part of that before: the correlation falls by this part from one to the next, within its interval.
    #[test]
    fn what_is_forgotten_at_a_rate_falls_at_it() {
        let domain = Domain { size: Vector2::new(8.0, 6.0), axes: [Axis::Periodic; 2] };
        let (mut found, mut random, kept) = (Autocorrelation::new(&domain, None), ChaCha8Rng::seed_from_u64(4), 0.8_f64);
        let mut velocities = vec![Vector2::zeros(); 300];
        for step in 0..600 {
            for velocity in &mut velocities {
                *velocity =
                    *velocity * kept + Vector2::from_fn(|_, _| (1.0 - kept * kept).sqrt() * (random.random::<f64>() - 0.5) * 12_f64.sqrt());
            }
            if step >= 200 {
                found.add(0.1 * f64::from(step), &velocities.iter().map(|velocity| (Vector2::zeros(), *velocity)).collect::<Vec<_>>());
            }
        }
        let all = found.correlations();
        for (lag, Correlations { values, half_widths, .. }) in all.iter().enumerate().take(10) {
            let expected = kept.powi(lag as i32);
            assert!(values.iter().all(|value| (value - expected).abs() < 0.03), "{values} at {lag}, not {expected}");
            let widths = half_widths.expect("the run is long enough");
            assert!(
                (values - Vector2::repeat(expected)).iter().zip(&widths).all(|(miss, width)| miss.abs() < 2.5 * width && *width < 0.05)
            );
        }
        assert!(Autocorrelation::new(&domain, None).correlations().is_empty());
    }
}
