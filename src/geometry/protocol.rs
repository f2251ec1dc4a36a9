//! How a rate changes with time: what moves walls, and the images of a sheared box.

use std::f64::consts::TAU;

/// Part of a time, or of an amplitude, that is rounding.
const SAME: f64 = 1e-12;

/// A rate over time, and its integral from time 0. Steps, of which a scene has a few, are kept for as long as the program runs, so that it is copied as numbers
/// are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Protocol {
    /// One rate for ever.
    Steady(f64),
    /// The integral is `amplitude sin(2 pi frequency time)`.
    Oscillation {
        /// Of the integral.
        amplitude: f64,
        /// Cycles a time, positive.
        frequency: f64,
    },
    /// A rate that a shear stress decides on the way: of what it has been the integral is known.
    Stress {
        /// One shear stress after the other, from time 0 on.
        stresses: &'static [RateStep],
        /// When the rate was found.
        since: f64,
        /// The integral up to then.
        passed: f64,
        /// The rate.
        rate: f64,
    },
    /// One rate after the other, from time 0 on.
    Steps {
        /// The steps.
        steps: &'static [RateStep],
        /// What rates are multiplied by.
        factor: f64,
    },
}

/// A rate, or a stress that decides one, until a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateStep {
    /// When it ends; infinite for the last one.
    pub until: f64,
    /// The rate, or the stress.
    pub rate: f64,
    /// When it begins.
    start: f64,
    /// The integral up to there.
    passed: f64,
}

impl RateStep {
    /// How long it lasts.
    pub fn length(&self) -> f64 {
        self.until - self.start
    }
}

impl Protocol {
    /// One rate after the other, each until a time; the last one goes on.
    ///
    /// # Panics
    /// Without any.
    pub fn steps(rates: &[(f64, f64)]) -> Protocol {
        Protocol::Steps { steps: kept(rates), factor: 1.0 }
    }

    /// The rates that one stress after the other decides, each until a time; the last one goes on. At the start they are those of a fluid of this viscosity.
    ///
    /// # Panics
    /// Without any.
    pub fn of_stresses(stresses: &[(f64, f64)], viscosity: f64) -> Protocol {
        let stresses = kept(stresses);
        Protocol::Stress { stresses, since: 0.0, passed: 0.0, rate: stresses[0].rate / viscosity }
    }

    /// The rate at a time; where it jumps, that of what follows.
    pub fn rate(&self, time: f64) -> f64 {
        match self {
            Protocol::Steady(rate) | Protocol::Stress { rate, .. } => *rate,
            Protocol::Oscillation { amplitude, frequency } => TAU * frequency * amplitude * (TAU * frequency * time).cos(),
            Protocol::Steps { steps, factor } => factor * step_at(steps, time).rate,
        }
    }

    /// The integral of the rate up to a time.
    pub fn passed(&self, time: f64) -> f64 {
        match self {
            Protocol::Steady(rate) => rate * time,
            Protocol::Stress { since, passed, rate, .. } => passed + rate * (time - since),
            Protocol::Oscillation { amplitude, frequency } => amplitude * (TAU * frequency * time).sin(),
            Protocol::Steps { steps, factor } => {
                let step = step_at(steps, time);
                factor * (step.passed + step.rate * (time - step.start))
            }
        }
    }

    /// The mean rate from a time on.
    pub fn mean_rate(&self, time: f64, interval: f64) -> f64 {
        match self {
            Protocol::Steady(rate) | Protocol::Stress { rate, .. } => *rate,
            _ if interval == 0.0 => self.rate(time),
            _ => (self.passed(time + interval) - self.passed(time)) / interval,
        }
    }

    /// The same with all rates times a factor.
    pub fn scaled(&self, factor: f64) -> Protocol {
        match self {
            Protocol::Steady(rate) => Protocol::Steady(rate * factor),
            Protocol::Stress { stresses, since, passed, rate } => {
                Protocol::Stress { stresses, since: *since, passed: passed * factor, rate: rate * factor }
            }
            Protocol::Oscillation { amplitude, frequency } => {
                Protocol::Oscillation { amplitude: amplitude * factor, frequency: *frequency }
            }
            Protocol::Steps { steps, factor: before } => Protocol::Steps { steps, factor: before * factor },
        }
    }

    /// The largest rate of all times, in size.
    pub fn fastest(&self) -> f64 {
        match self {
            Protocol::Steady(rate) | Protocol::Stress { rate, .. } => rate.abs(),
            Protocol::Oscillation { amplitude, frequency } => (TAU * frequency * amplitude).abs(),
            Protocol::Steps { steps, factor } => factor.abs() * steps.iter().map(|step| step.rate.abs()).fold(0.0, f64::max),
        }
    }

    /// The most by which the integral changes in an interval in which the rate does not jump, wherever it begins.
    pub fn most_in(&self, interval: f64) -> f64 {
        let most = self.fastest() * interval;
        match self {
            Protocol::Steady(_) | Protocol::Stress { .. } => most,
            Protocol::Oscillation { amplitude, .. } => most.min(2.0 * amplitude.abs()),
            Protocol::Steps { steps, factor } => {
                steps.iter().map(|step| (factor * step.rate).abs() * interval.min(step.length())).fold(0.0, f64::max)
            }
        }
    }

    /// The shear stresses that decide it, one after the other, if it is they.
    pub fn stresses(&self) -> Option<&'static [RateStep]> {
        if let Protocol::Stress { stresses, .. } = self { Some(stresses) } else { None }
    }

    /// The shear stress that decides it at a time, if one does; where it jumps, that of what follows.
    pub fn stress(&self, time: f64) -> Option<f64> {
        self.stresses().map(|stresses| step_at(stresses, time).rate)
    }

    /// One that a shear stress decides, which at a time has come to an integral and goes on at a rate; any other as it is.
    pub fn found(&self, time: f64, passed: f64, rate: f64) -> Protocol {
        match *self {
            Protocol::Stress { stresses, .. } => Protocol::Stress { stresses, since: time, passed, rate },
            other => other,
        }
    }

    /// Whether the rate is the same at all times.
    pub fn steady(&self) -> bool {
        matches!(self, Protocol::Steady(_))
    }

    /// The first time after a time at which the rate jumps, or the stress that decides it; infinite if it never does again.
    pub fn next_jump(&self, time: f64) -> f64 {
        match self {
            Protocol::Steps { steps, .. } | Protocol::Stress { stresses: steps, .. } => step_at(steps, time).until,
            _ => f64::INFINITY,
        }
    }

    /// The first time after a time at which an oscillation turns; infinite for other protocols.
    pub fn next_turn(&self, time: f64) -> f64 {
        match self {
            Protocol::Oscillation { frequency, .. } => {
                let half_cycles = 2.0 * time * frequency - 0.5;
                (0.5 + (half_cycles + SAME * (1.0 + half_cycles.abs())).floor() + 1.0) / (2.0 * frequency)
            }
            _ => f64::INFINITY,
        }
    }

    /// Whether the rate jumps after a time, up to another.
    pub fn jumps_between(&self, after: f64, time: f64) -> bool {
        self.next_jump(after) <= time * (1.0 + SAME)
    }

    /// The longest interval after a time, no longer than `longest`, over which the integral changes by a multiple of `unit`, of which it is one at the time;
    /// the shortest of all if that is longer still.
    pub fn whole(&self, time: f64, longest: f64, unit: f64) -> f64 {
        match self {
            Protocol::Oscillation { amplitude, frequency } => {
                Oscillation { amplitude: amplitude.abs(), frequency: *frequency }.whole(time, longest, unit)
            }
            _ => {
                let rate = self.rate(time).abs();
                if rate == 0.0 {
                    return longest;
                }
                let period = unit / rate;
                (longest / period * (1.0 + SAME)).floor().max(1.0) * period
            }
        }
    }

    /// The same with the times at which the rate jumps moved such that the integral is a multiple of `unit` at each of them, but not to less than one.
    pub fn rounded(&self, unit: f64) -> Protocol {
        let Protocol::Steps { steps, factor } = self else { return *self };
        let mut start = 0.0;
        let unit = unit / factor.abs();
        let rounded = steps.iter().map(|step| {
            let length = step.length();
            let whole = if step.rate == 0.0 { length } else { (step.rate * length / unit).abs().round().max(1.0) * unit / step.rate.abs() };
            start += whole;
            (start, step.rate)
        });
        Protocol::steps(&rounded.collect::<Vec<_>>()).scaled(*factor)
    }
}

/// `amplitude sin(2 pi frequency time)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// The largest value.
    pub amplitude: f64,
    /// Cycles a time, positive.
    pub frequency: f64,
}

/// Steps, kept for as long as the program runs.
fn kept(rates: &[(f64, f64)]) -> &'static [RateStep] {
    let (mut start, mut passed, mut steps) = (0.0, 0.0, Vec::new());
    for &(until, rate) in rates {
        steps.push(RateStep { until, rate, start, passed });
        (start, passed) = (until, passed + rate * (until - start));
    }
    steps.last_mut().expect("a protocol has a step").until = f64::INFINITY;
    steps.leak()
}

fn step_at(steps: &[RateStep], time: f64) -> &RateStep {
    let over = |step: &RateStep| time >= step.until * (1.0 - SAME);
    &steps[steps.partition_point(over).min(steps.len() - 1)]
}

impl Oscillation {
    /// As [`Protocol::whole`].
    fn whole(self, time: f64, longest: f64, unit: f64) -> f64 {
        let Oscillation { amplitude, frequency } = self;
        let passed = |time: f64| amplitude * (TAU * frequency * time).sin();
        let soon = SAME / frequency * (1.0 + time * frequency) * 1e3;
        let least = time + soon;
        // times at which the integral is so many units: two in each cycle
        let times = |units: f64| {
            let ratio = (units * unit / amplitude).clamp(-1.0, 1.0);
            let reached = (units * unit).abs() <= amplitude * (1.0 + SAME);
            let rising = ratio.asin() / TAU;
            reached.then(|| [rising, 0.5 - rising].map(|phase| phase / frequency)).into_iter().flatten()
        };
        let last_up_to = |phase: f64, end: f64| phase + ((end - phase) * frequency).floor() / frequency;
        let first_from = |phase: f64| phase + ((least - phase) * frequency).ceil() / frequency;
        let (end, units) = (time + longest, passed(time + longest) / unit);
        let until =
            [units.floor(), units.ceil()].into_iter().flat_map(times).map(|phase| last_up_to(phase, end + soon)).fold(time, f64::max);
        if until > least {
            return until - time;
        }
        let now = (passed(time) / unit).round();
        [now - 1.0, now, now + 1.0].into_iter().flat_map(times).map(first_from).fold(f64::INFINITY, f64::min) - time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn protocols() -> [Protocol; 3] {
        [
            Protocol::Steady(2.0),
            Protocol::Oscillation { amplitude: 0.35, frequency: 1.7 },
            Protocol::steps(&[(0.5, 1.0), (0.75, 0.0), (2.0, -2.0), (3.0, 0.5)]),
        ]
    }

    #[test]
    fn the_rate_is_the_slope_of_the_integral() {
        for protocol in protocols() {
            for time in (1..60).map(|step| 0.0501 * f64::from(step)).filter(|time| !protocol.jumps_between(time - 1e-3, time + 1e-3)) {
                let slope = (protocol.passed(time + 1e-5) - protocol.passed(time - 1e-5)) / 2e-5;
                assert!((slope - protocol.rate(time)).abs() < 1e-6, "{protocol:?} at {time}");
                assert!((protocol.mean_rate(time, 1e-4) - protocol.rate(time)).abs() < 1e-2);
                assert!(protocol.rate(time).abs() <= protocol.fastest());
                assert!((protocol.scaled(3.0).passed(time) - 3.0 * protocol.passed(time)).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn an_oscillation_turns_twice_a_cycle() {
        let turns = Protocol::Oscillation { amplitude: 0.35, frequency: 2.0 };
        for (time, turn) in [(0.0, 0.125), (0.125, 0.375), (0.3, 0.375), (0.4, 0.625)] {
            assert!((turns.next_turn(time) - turn).abs() < 1e-12, "{time}");
        }
        assert_eq!(Protocol::Steady(1.0).next_turn(0.0), f64::INFINITY);
    }

    #[test]
    fn an_interval_strains_by_no_more_than_an_oscillation_or_a_step_does() {
        let oscillation = Protocol::Oscillation { amplitude: -0.5, frequency: 0.25 };
        assert_eq!([0.1, 100.0].map(|interval| oscillation.most_in(interval)), [0.1 * 0.25 * std::f64::consts::PI, 1.0]);
        let steps = Protocol::steps(&[(1.0, 3.0), (2.0, -1.0)]).scaled(2.0);
        assert_eq!([0.5, 2.0, 10.0].map(|interval| steps.most_in(interval)), [3.0, 6.0, 20.0]);
        assert_eq!(Protocol::Steady(-2.0).most_in(3.0), 6.0);
    }

    #[test]
    fn a_jump_belongs_to_what_follows() {
        let [.., steps] = protocols();
        assert_eq!([0.5, 0.5 * (1.0 - 1e-15), 0.499].map(|time| steps.rate(time)), [0.0, 0.0, 1.0]);
        assert_eq!([0.0, 0.5, 0.6, 2.5].map(|time| steps.next_jump(time)), [0.5, 0.75, 0.75, f64::INFINITY]);
        assert!(steps.jumps_between(0.4, 0.5) && !steps.jumps_between(0.5, 0.6));
    }

    #[test]
    fn whole_intervals_end_at_multiples_of_the_unit_and_reach_as_far_as_they_may() {
        let unit = 0.03;
        for protocol in protocols() {
            let (mut time, mut steps) = (0.0, 0);
            while time < 2.9 {
                let longest = (0.01 + 0.05 * f64::from(steps % 7)).min(protocol.rounded(unit).next_jump(time) - time);
                let interval = protocol.rounded(unit).whole(time, longest, unit);
                assert!(interval > 0.0 && interval.is_finite(), "{protocol:?} at {time}");
                time += interval;
                let units = protocol.rounded(unit).passed(time) / unit;
                assert!((units - units.round()).abs() < 1e-6, "{protocol:?} at {time}: {units}");
                // nothing longer would have done
                let later = (1..400).map(|part| time + (longest - interval) * f64::from(part) / 400.0).filter(|_| interval < longest);
                let mut signs = later.map(|later| (protocol.rounded(unit).passed(later) / unit - units.round()).floor());
                let first = signs.next();
                assert!(signs.all(|sign| Some(sign) == first) || interval < 1e-2, "{protocol:?} at {time}");
                steps += 1;
            }
        }
    }
}
