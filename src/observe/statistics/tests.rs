//! Synthetic records and windows of runs with known means.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{blocks::student, *};

/// Random numbers, and noise of variance 1 whose correlation falls by `e` over a distance of 1.
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
}

/// The record of a seed.
type Record = fn(u64) -> Vec<f64>;

const COUNT: usize = 1000;
const SERIES: u64 = 200;

/// Noise of variance 1 over so many correlation times (AR(1)).
fn fading(seed: u64, times: f64) -> Vec<f64> {
    let mut noise = Noise::new(seed);
    (0..COUNT).map(|_| noise.after(times / COUNT as f64)).collect()
}

fn sum(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(one, other)| one + other).collect()
}

/// Half the variance fades twenty times as fast as the other half.
fn two_scales(seed: u64) -> Vec<f64> {
    sum(&fading(seed, 30.0), &fading(seed + 1_000_000, 600.0))
}

/// A start-up of three standard deviations that fades over a twentieth of the record.
fn starting(seed: u64) -> Vec<f64> {
    let start: Vec<f64> = (0..COUNT).map(|step| 3.0 * (-20.0 * step as f64 / COUNT as f64).exp()).collect();
    sum(&fading(seed, 60.0), &start)
}

/// Noise of six scales from a tenth of the record down, whose correlation falls like a power of the distance between them.
fn long_memory(seed: u64) -> Vec<f64> {
    let scales = (0..6).map(|scale| fading(seed + 1_000_000 * scale, 10.0 * 2.5_f64.powi(scale as i32)));
    scales.fold(vec![0.0; COUNT], |total, scale| sum(&total, &scale))
}

/// Parts of series that have an interval, and of these that hold the mean, 0.
fn coverage(record: impl Fn(u64) -> Vec<f64>, found: impl Fn(&[f64]) -> Option<Interval>) -> [f64; 2] {
    let intervals: Vec<Interval> = (0..SERIES).filter_map(|seed| found(&record(seed))).collect();
    let holding = intervals.iter().filter(|interval| interval.mean.abs() <= interval.half_width).count();
    [intervals.len() as f64 / SERIES as f64, holding as f64 / intervals.len() as f64]
}

fn over_places(samples: &[f64]) -> Vec<(f64, f64)> {
    (0..).map(f64::from).zip(samples.iter().copied()).collect()
}

fn of_record(samples: &[f64]) -> Option<Interval> {
    steady(&over_places(samples), 0.0).ok().map(|steady| steady.interval)
}

/// What the manual quotes: `cargo test --lib statistics -- --nocapture`.
#[allow(clippy::print_stderr)]
fn tell(what: &str, numbers: &[f64]) {
    eprintln!("{what}: {numbers:?}");
}

#[test]
fn intervals_hold_the_mean_of_series_of_four_kinds() {
    let records: [(&str, Record); 5] = [
        ("AR(1), 20 times", |seed| fading(seed, 20.0)),
        ("AR(1), 100 times", |seed| fading(seed, 100.0)),
        ("two scales", two_scales),
        ("drift at the start", starting),
        ("long memory", long_memory),
    ];
    for (name, record) in records {
        let [found, holding] = coverage(record, of_record);
        tell(name, &[found, holding]);
        assert!(found > 0.9 && (0.9..=0.99).contains(&holding), "{name}: {found} have an interval, {holding} of these hold the mean");
    }
}

#[test]
fn intervals_of_independent_samples_are_not_wider_than_few_blocks_need() {
    let white = |seed| fading(seed, 1e6);
    let [found, holding] = coverage(white, of_record);
    tell("independent", &[found, holding]);
    assert!(found > 0.98 && (0.94..=0.99).contains(&holding), "{found} {holding}");
    let mut widths: Vec<f64> = (0..SERIES).filter_map(|seed| Some(of_record(&white(seed))?.half_width)).collect();
    widths.sort_by(f64::total_cmp);
    // twice what is known to who knows the variance
    let known = 1.96 / (0.9 * COUNT as f64).sqrt();
    assert!((1.6..2.3).contains(&(widths[widths.len() / 2] / known)), "{}", widths[widths.len() / 2] / known);
}

#[test]
fn taking_correlated_samples_for_independent_ones_is_far_too_sure() {
    let naive = |samples: &[f64]| {
        let (mean, count) = (samples.iter().sum::<f64>() / COUNT as f64, COUNT as f64);
        Some(Interval { mean, half_width: 1.96 / count.sqrt(), blocks: COUNT })
    };
    assert!(coverage(|seed| fading(seed, 100.0), naive)[1] < 0.6);
}

#[test]
fn quantiles_of_student_are_those_of_tables() {
    for (freedom, quantile) in [(3.0, 3.182446), (6.0, 2.446912), (7.0, 2.364624), (15.0, 2.131450), (31.0, 2.039513), (1e9, 1.959964)] {
        assert!((student(freedom) - quantile).abs() < 1e-3, "{freedom}: {}", student(freedom));
    }
}

#[test]
fn a_constant_is_known_for_certain() {
    let steady = steady(&(0..100).map(|step| (0.1 * f64::from(step), 2.5)).collect::<Vec<_>>(), 0.0);
    let Steady { from, to, interval } = steady.expect("a constant is steady");
    // 19 batches of five samples, of which a tenth, two, are left out
    assert!((from - 1.0).abs() < 1e-12, "{from}");
    // 1e-12: rounding
    assert!((interval.mean - 2.5).abs() < 1e-12 && (to - 9.9).abs() < 1e-12 && interval.half_width < 1e-12, "{interval:?}");
}

/// A curve at unequal steps, ten to a correlation length, that starts twenty standard deviations off.
fn settling(seed: u64, length: f64) -> Vec<(f64, f64)> {
    let (mut noise, mut curve, mut at) = (Noise::new(seed), Vec::new(), 0.0);
    while at < length {
        curve.push((at, noise.value + 20.0 * (-at / 20.0_f64).exp()));
        let step = 0.2 * noise.random.random::<f64>();
        noise.after(step);
        at += step;
    }
    curve
}

/// Without more than the first tenth, a start-up of twenty standard deviations over 20 of 200 lengths leaves 0.8, eight standard deviations of the mean.
#[test]
fn a_start_up_that_stands_out_is_left_out() {
    let begin = |seed: u64| steady(&settling(seed, 200.0), 0.0).expect("the curve becomes steady");
    let steadies: Vec<Steady> = (0..SERIES).map(begin).collect();
    let holding = steadies.iter().filter(|steady| steady.interval.mean.abs() <= steady.interval.half_width).count();
    assert!((0.9..=0.99).contains(&(holding as f64 / SERIES as f64)), "{holding}");
    let later = steadies.iter().filter(|steady| steady.from > 22.0).count();
    assert!(later as f64 > 0.9 * SERIES as f64, "{later}");
}

#[test]
fn what_still_grows_is_not_steady() {
    let curve = |count: i32| (0..count).map(|step| (f64::from(step), f64::from(step) + (0.7 * f64::from(step)).sin())).collect::<Vec<_>>();
    assert!(matches!(steady(&curve(200), 0.0), Err(Shortage::Drift(_))));
    assert!([curve(20), curve(1), Vec::new()].iter().all(|curve| matches!(steady(curve, 0.0), Err(Shortage::FewSamples(_)))));
}

#[test]
fn a_record_shorter_than_its_memory_has_no_interval() {
    let wave = |count: usize, period: f64| (0..count).map(|step| (std::f64::consts::TAU * step as f64 / period).cos()).collect::<Vec<_>>();
    assert!(matches!(steady(&over_places(&wave(400, 300.0)), 0.0), Err(Shortage::Memory(_))));
    assert!(of_record(&wave(2000, 20.0)).expect("a hundred periods are enough").half_width < 0.2);
}

/// A row of `windows.csv`: a part of a curve, the mean of the whole run, and what comes out.
struct Window {
    curve: Vec<(f64, f64)>,
    long: f64,
    /// Mean, half width and start, and the number of blocks; nothing where there is no interval.
    expected: Option<([f64; 3], usize)>,
}

/// Windows of real runs, with the means of the whole runs (`tests/data/viscosity/make.py`).
fn windows() -> Vec<Window> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/viscosity");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect("the curves lie in the repository");
    let numbers = |text: &str| text.lines().map(|line| line.parse().expect("a number")).collect::<Vec<f64>>();
    let window = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |cell: usize| cells[cell].parse::<f64>().expect("a number");
        let (from, to) = (number(1) as usize, number(2) as usize);
        let values = numbers(&read(&format!("{}.txt", cells[0])));
        let curve = (from..to).map(|place| 0.1 * place as f64).zip(values[from..to].iter().copied()).collect();
        let expected = (!cells[5].is_empty()).then(|| ([number(5), number(6), number(7)], number(8) as usize));
        Window { curve, long: number(3), expected }
    };
    read("windows.csv").lines().skip(1).map(window).collect()
}

#[test]
fn intervals_of_windows_of_runs_hold_the_mean_of_the_whole_run() {
    let windows = windows();
    let intervals: Vec<(f64, Interval)> =
        windows.iter().filter_map(|window| Some((window.long, steady(&window.curve, 20.0).ok()?.interval))).collect();
    let holding = intervals.iter().filter(|(long, interval)| (interval.mean - long).abs() <= interval.half_width).count();
    let part = holding as f64 / intervals.len() as f64;
    tell("windows of runs", &[windows.len() as f64, intervals.len() as f64, holding as f64]);
    assert!(windows.len() >= 60 && intervals.len() as f64 > 0.9 * windows.len() as f64, "{} of {}", intervals.len(), windows.len());
    assert!((0.9..=0.99).contains(&part), "{holding} of {}", intervals.len());
}

/// The tests of the Python package read the same file.
#[test]
fn intervals_of_windows_are_those_that_are_written_down() {
    for (number, window) in windows().iter().enumerate() {
        let found = steady(&window.curve, 20.0)
            .ok()
            .map(|Steady { from, interval, .. }| ([interval.mean, interval.half_width, from], interval.blocks));
        assert_eq!(found.map(|(_, blocks)| blocks), window.expected.map(|(_, blocks)| blocks), "row {number}");
        let numbers = found.iter().zip(&window.expected).flat_map(|((ours, _), (theirs, _))| ours.iter().zip(theirs));
        // the order of sums differs
        numbers.for_each(|(ours, theirs)| assert!((ours - theirs).abs() <= 1e-12 * theirs.abs(), "row {number}: {ours} {theirs}"));
    }
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
