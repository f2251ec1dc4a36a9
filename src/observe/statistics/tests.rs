//! Synthetic records with known answers.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{blocking::student, *};

/// Noise of variance 1 whose correlation falls by `e` over `memory` samples.
struct Noise {
    random: ChaCha8Rng,
    value: f64,
}

impl Noise {
    fn new(seed: u64) -> Noise {
        let mut noise = Noise { random: ChaCha8Rng::seed_from_u64(seed), value: 0.0 };
        noise.value = noise.normal();
        noise
    }

    fn normal(&mut self) -> f64 {
        let (one, two): (f64, f64) = (self.random.random(), self.random.random());
        (-2.0 * (1.0 - one).ln()).sqrt() * (std::f64::consts::TAU * two).cos()
    }

    /// The next value, so many correlation lengths later.
    fn after(&mut self, distance: f64) -> f64 {
        let kept = (-distance).exp();
        self.value = kept * self.value + (1.0 - kept * kept).sqrt() * self.normal();
        self.value
    }

    fn samples(mut self, count: usize, memory: f64) -> Vec<f64> {
        (0..count).map(|_| self.after(1.0 / memory)).collect()
    }
}

/// Part of many seeds whose interval holds the truth, 0.
fn coverage(found: impl Fn(u64) -> Option<Interval>) -> f64 {
    let seeds = 2000;
    let intervals: Vec<Interval> = (0..seeds).filter_map(found).collect();
    let holding = intervals.iter().filter(|interval| interval.mean.abs() <= interval.half_width).count();
    assert!(intervals.len() > 1800, "{} of {seeds} records have an interval", intervals.len());
    holding as f64 / intervals.len() as f64
}

#[test]
fn quantiles_of_student_are_those_of_tables() {
    for (freedom, quantile) in [(6.0, 2.446912), (7.0, 2.364624), (15.0, 2.131450), (31.0, 2.039513), (1e9, 1.959964)] {
        assert!((student(freedom) - quantile).abs() < 1e-3, "{freedom}: {}", student(freedom));
    }
}

#[test]
fn the_interval_of_correlated_noise_holds_the_mean_in_95_of_100_cases() {
    // 2000 seeds scatter by 0.005
    for (count, memory, least, most) in [(400, 0.01, 0.945, 0.985), (800, 4.0, 0.935, 0.985), (4000, 10.0, 0.945, 0.985)] {
        let part = coverage(|seed| interval(&Noise::new(seed).samples(count, memory)));
        assert!((least..most).contains(&part), "{count} samples with a memory of {memory}: {part}");
    }
}

#[test]
fn taking_correlated_samples_for_independent_ones_is_far_too_sure() {
    let naive = |seed| {
        let samples = Noise::new(seed).samples(800, 4.0);
        let mean = samples.iter().sum::<f64>() / 800.0;
        Some(Interval { mean, half_width: 1.96 / 800_f64.sqrt(), blocks: 800 })
    };
    assert!(coverage(naive) < 0.7);
}

#[test]
fn a_constant_is_known_for_certain() {
    let steady = steady(&(0..100).map(|step| (0.1 * f64::from(step), 2.5)).collect::<Vec<_>>());
    let Steady { from, to, interval } = steady.expect("a constant is steady");
    assert_eq!(from, 0.0);
    // 1e-12: rounding
    assert!((interval.mean - 2.5).abs() < 1e-12 && (to - 9.9).abs() < 1e-12 && interval.half_width < 1e-12, "{interval:?}");
}

/// A curve at unequal steps, ten to a correlation length, that starts eight standard deviations off.
fn settling(seed: u64, length: f64) -> Vec<(f64, f64)> {
    let (mut noise, mut curve, mut at) = (Noise::new(seed), Vec::new(), 0.0);
    while at < length {
        curve.push((at, noise.value + 8.0 * (-at / 3.0_f64).exp()));
        let step = 0.2 * noise.random.random::<f64>();
        noise.after(step);
        at += step;
    }
    curve
}

#[test]
fn a_transient_is_left_out() {
    let whole = coverage(|seed| {
        let curve = settling(seed, 200.0);
        interval(&resampled(&curve, curve.len() - 1))
    });
    let rest = coverage(|seed| Some(steady(&settling(seed, 200.0))?.interval));
    assert!(whole < 0.9, "with the transient: {whole}");
    assert!((0.93..0.98).contains(&rest), "without it: {rest}");
    let begin = steady(&settling(1, 200.0)).expect("the curve becomes steady").from;
    assert!((3.0..60.0).contains(&begin), "{begin}");
}

#[test]
fn what_still_grows_is_not_steady() {
    let curve = |count: i32| (0..count).map(|step| (f64::from(step), f64::from(step) + (0.7 * f64::from(step)).sin())).collect::<Vec<_>>();
    assert_eq!(steady(&curve(200)), None);
    assert_eq!((steady(&curve(20)), steady(&curve(1)), steady(&[])), (None, None, None));
}

#[test]
fn a_record_shorter_than_its_memory_has_no_interval() {
    let wave = |count: usize, period: f64| (0..count).map(|step| (std::f64::consts::TAU * step as f64 / period).sin()).collect::<Vec<_>>();
    assert_eq!(interval(&wave(200, 200.0)), None);
    assert!(interval(&wave(2000, 20.0)).expect("a hundred periods are enough").half_width < 0.2);
    let missing = (0..1000).filter(|&seed| interval(&Noise::new(seed).samples(400, 0.01)).is_none()).count();
    assert!(missing < 40, "{missing} of 1000 records of independent noise");
}

/// A saw whose falling half takes short steps: its mean is 1/2, that of the points is not.
#[test]
fn points_count_by_their_distance() {
    let mut curve = vec![(0.0, 0.0)];
    for tooth in 0..20 {
        let start = f64::from(2 * tooth);
        curve.extend((1..=2).map(|step| (start + 0.5 * f64::from(step), 0.5 * f64::from(step))));
        curve.extend((1..=8).map(|step| (start + 1.0 + 0.125 * f64::from(step), 1.0 - 0.125 * f64::from(step))));
    }
    assert!(resampled(&curve, 20).iter().all(|mean| (mean - 0.5).abs() < 1e-12));
    assert!((mean_from(&curve, 4.0) - 0.5).abs() < 1e-12);
    assert!((mean_from(&curve, 39.5) - 0.25).abs() < 1e-12);
    assert_eq!(mean_from(&curve, 40.0), 0.0);
    let quarters = resampled(&curve, 160);
    assert!((quarters[0] - 0.125).abs() < 1e-12 && (quarters[7] - 0.125).abs() < 1e-12, "{quarters:?}");
}
