//! The length of the next step.

use nalgebra::SVector;

use super::shift_period::ShiftPeriod;
use crate::{
    geometry::Protocol,
    linalg::ROUNDING,
    mechanics::unsteady::{COURANT, LARGEST_COURANT},
    parallel::Peers,
    scene::{Step, TimeSection},
};

/// Largest growth from one step to the next.
const GROWTH: f64 = 1.25;

/// Part of a fixed step by which a sum of steps misses its multiples.
const OFF_MULTIPLES: f64 = 1e-6;
/// How many times what automatic steps may pass the flow or a body passes in one that stands: the flow then passes the most cells that it may in any.
const TOLERATED: f64 = LARGEST_COURANT / COURANT;

/// Shortest part of a fixed step that is tried where the whole one leads nowhere.
const SHORTEST_PART: f64 = 1.0 / 64.0;

/// How steps are chosen: none moves a body by more than a part of its radius, none is much longer than the one before.
#[derive(Debug, Clone, PartialEq)]
pub struct StepControl {
    /// As the scene says.
    pub time: TimeSection,
    /// What steps and the end are whole numbers of, where images slide.
    pub shift_period: Option<ShiftPeriod>,
    /// When the rate of the shear, or what drives the flow, jumps: steps end there.
    pub protocol: Option<Protocol>,
    /// The longest step with which contact is stable; infinite if it limits none.
    pub longest: f64,
    /// Whether automatic steps change by factors of two only: where another one takes other operators.
    pub by_twos: bool,
}

/// A body's motion as far as steps depend on it.
#[derive(Debug, Clone, Copy)]
pub struct BodyMotion<const D: usize> {
    /// Its radius.
    pub radius: f64,
    /// Velocity.
    pub velocity: SVector<f64, D>,
    /// Acceleration of a body that is not held.
    pub acceleration: SVector<f64, D>,
}

/// Where a step starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepStart {
    /// The time.
    pub time: f64,
    /// Length of the step before it; 0 if it is the first.
    pub last_step: f64,
}

/// What limits a step besides the motions of bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepLimits {
    /// The longest one with which the flow is stable; only automatic steps heed it.
    pub stable: f64,
    /// The longest one that is as exact as is asked for; only automatic steps heed it, and where images slide these are no shorter for it than what takes the
    /// images to whole cells.
    pub accurate: f64,
    /// The longest one to try, as a longer one from the same state led nowhere; infinite at first.
    pub tried: f64,
}

/// The length of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepSize {
    /// Its length; 0 at the end of the run.
    pub length: f64,
    /// Its length if the run did not end.
    pub natural: f64,
}

impl StepSize {
    /// Whether the end of the run cut it short by more than rounding.
    pub fn cut_short(&self) -> bool {
        self.length < self.natural * (1.0 - ROUNDING)
    }
}

impl StepControl {
    /// The next step for bodies that move so, each rank its own, from a start, within limits. Collective.
    pub fn next<const D: usize>(
        &self,
        peers: Peers,
        motions: &[BodyMotion<D>],
        StepStart { time, last_step }: StepStart,
        StepLimits { stable, accurate, tried }: StepLimits,
    ) -> StepSize {
        let left = self.time.end - time;
        let natural = match self.time.step {
            Step::Fixed(step) if self.changing().is_some() && self.slides_whole_cells() => self.whole(time, step.min(tried), last_step),
            // the last step was cut short by the end, and not split
            Step::Fixed(step) if left <= ROUNDING * self.time.end => step.min(tried),
            Step::Fixed(step) => to_multiple(step, time, last_step).min(tried),
            Step::Auto => {
                let longest =
                    self.longest.min(stable).min(tried).min(if last_step > 0.0 { self.grown(time, last_step) } else { f64::INFINITY });
                let limits = motions.iter().map(|motion| reach(motion, self.time.travel * motion.radius));
                let accurate = limits.fold(accurate, f64::min).max(self.to_whole_cells(time, last_step));
                // at rest nothing limits a first one but the end
                let longest = peers.min(accurate.min(longest));
                self.whole(time, if longest.is_finite() { longest } else { self.time.end }, last_step)
            }
        };
        let natural = self.up_to_jump(time, natural);
        // images that slide at a rate that is found come to whole cells when they do
        let free_end = matches!(self.changing(), Some(Protocol::Stress { .. })) && left > ROUNDING * self.time.end;
        StepSize { length: if natural > left * (1.0 - ROUNDING) && !free_end { left } else { natural }, natural }
    }

    /// A step from a start made shorter where it would carry bodies farther than the time `reach` does.
    pub fn shortened(&self, StepStart { time, last_step }: StepStart, step: f64, reach: f64) -> f64 {
        match self.time.step {
            Step::Fixed(_) => step,
            Step::Auto => {
                let limited = step.min(reach.max(self.to_whole_cells(time, last_step)));
                if limited < step || !self.by_twos { step.min(self.whole(time, limited, last_step)) } else { step }
            }
        }
    }

    /// A step from a start half as long as one that led nowhere; none if that is the shortest. Where images have to slide by whole cells, it does.
    pub fn half(&self, StepStart { time, last_step }: StepStart, step: f64) -> Option<f64> {
        let least = if let Step::Fixed(whole) = self.time.step { SHORTEST_PART * whole * (1.0 - ROUNDING) } else { 0.0 };
        let Some(shift_period) = &self.shift_period else { return Some(0.5 * step).filter(|half| *half >= least) };
        let half = shift_period.within(time, 0.5 * step, self.multiple(time, last_step));
        (half < step * (1.0 - ROUNDING) && half >= least).then_some(half)
    }

    /// The length of the step from a time to be taken in place of an automatic one in which the flow or a body passed so many times what it may; nothing if it stands,
    /// or where none is shorter.
    pub fn in_place_of(&self, time: f64, step: f64, passed: f64) -> Option<f64> {
        if self.time.step != Step::Auto || passed <= TOLERATED {
            return None;
        }
        let shortest = self.shortest(time);
        Some((step * (-passed.log2().ceil()).exp2()).max(shortest)).filter(|shorter| *shorter < step * (1.0 - ROUNDING))
    }

    /// The longest step after another.
    fn grown(&self, time: f64, last_step: f64) -> f64 {
        if self.by_twos {
            return 2.0 * last_step;
        }
        // whole shift periods would never grow from one to two
        let one_more = self.shift_period.as_ref().map_or(0.0, |period| period.one_cell(time + last_step));
        if one_more > 0.0 && last_step >= one_more * (1.0 - ROUNDING) || self.shortest(time) > 0.0 {
            return (GROWTH * last_step).max(last_step + one_more);
        }
        GROWTH * last_step
    }

    /// The shortest step from a time, after a last one, that accuracy asks for where the grid may be oblique: to the next whole cells.
    fn to_whole_cells(&self, time: f64, last_step: f64) -> f64 {
        let free = self.shift_period.as_ref().filter(|period| !period.required());
        free.map_or(0.0, |period| period.to_whole(time, self.multiple(time, last_step)))
    }

    /// A step that keeps the shift period, if there is one; never shorter than the shortest that does.
    fn whole(&self, time: f64, step: f64, last_step: f64) -> f64 {
        if self.by_twos {
            let shortest = self.shortest(time);
            let unit = if last_step > 0.0 { last_step } else { shortest };
            return if unit > 0.0 { (unit * (step / unit * (1.0 + ROUNDING)).log2().floor().exp2()).max(shortest) } else { step };
        }
        let Some(shift_period) = &self.shift_period else { return step };
        shift_period.within(time, step, self.multiple(time, last_step))
    }

    /// The number of cells by which images slide in a step from a time after another, at least: the middle of a first one, also after a jump of the rate, is an
    /// instant too, unless the flow evolves or the rate never stands still.
    fn multiple(&self, time: f64, last_step: f64) -> f64 {
        let anew = self.jumped(time, last_step);
        if self.by_twos || self.wanders() { 1.0 } else { ShiftPeriod::multiple(self.time.scheme, if anew { 0.0 } else { last_step }) }
    }

    /// Whether the middle of a step is no instant: images slide at a speed that is to be found, or at one that changes all the time, which slides them by a part
    /// of a cell until then, and they have to slide by whole ones.
    pub fn wanders(&self) -> bool {
        match self.changing() {
            Some(Protocol::Stress { .. }) => true,
            Some(Protocol::Oscillation { .. }) => self.slides_whole_cells(),
            _ => false,
        }
    }

    /// Whether images have to slide by whole cells in every step.
    fn slides_whole_cells(&self) -> bool {
        self.shift_period.as_ref().is_some_and(ShiftPeriod::required)
    }

    /// The speed of images, where it changes.
    fn changing(&self) -> Option<&Protocol> {
        self.shift_period.as_ref().and_then(ShiftPeriod::protocol)
    }

    /// The shortest step from a time that slides images by whole cells; 0 where they stay.
    fn shortest(&self, time: f64) -> f64 {
        self.shift_period.as_ref().map_or(0.0, |shift_period| shift_period.shortest(time))
    }

    /// A step from a time, or what leads to where the rate of the shear jumps.
    fn up_to_jump(&self, time: f64, step: f64) -> f64 {
        let left = self.protocol.as_ref().map_or(f64::INFINITY, |protocol| protocol.next_jump(time) - time);
        if step > left * (1.0 - ROUNDING) { left } else { step }
    }

    /// Whether a step from a time leads to where the rate of the shear, or the stress that decides it, jumps.
    pub fn ends_at_jump(&self, time: f64, step: f64) -> bool {
        self.protocol.as_ref().is_some_and(|protocol| protocol.jumps_between(time, time + step))
    }

    /// Whether the rate of the shear jumped in the last step that led to a time, or at its end.
    pub fn jumped(&self, time: f64, last_step: f64) -> bool {
        self.protocol.as_ref().is_some_and(|protocol| protocol.jumps_between(time - last_step, time))
    }

    /// Whether the run has ended.
    pub fn over(&self, time: f64) -> bool {
        time >= self.time.end * (1.0 - 1e-13)
    }

    /// Whether the next step may reach the end.
    pub fn may_end(&self, time: f64, last_step: f64) -> bool {
        let longest = match self.time.step {
            Step::Fixed(step) => step,
            // nothing is known of a first one, and one after a jump is as long
            Step::Auto if last_step == 0.0 || !self.by_twos && self.jumped(time, last_step) => self.time.end,
            Step::Auto => self.grown(time, last_step),
        };
        let step = longest.max(self.whole(time, longest, last_step));
        time + step * (1.0 + ROUNDING) >= self.time.end
    }
}

/// A fixed step from a time after a last one: the whole one, or, where that was shorter, what leads to a multiple of it, at most twice the last one.
fn to_multiple(step: f64, time: f64, last_step: f64) -> f64 {
    if last_step == 0.0 || last_step >= step * (1.0 - OFF_MULTIPLES) {
        return step;
    }
    let passed = time / step - (time / step + OFF_MULTIPLES).floor();
    if passed < OFF_MULTIPLES { step } else { (1.0 - passed).min(2.0 * last_step / step) * step }
}

/// The time in which a body covers a distance: `v t + a t^2 = distance`.
fn reach<const D: usize>(motion: &BodyMotion<D>, distance: f64) -> f64 {
    let (velocity, acceleration) = (motion.velocity.norm(), motion.acceleration.norm());
    2.0 * distance / (velocity + (velocity * velocity + 4.0 * acceleration * distance).sqrt())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::scene::Scheme;

    fn control(step: Step, shift_period: Option<f64>) -> StepControl {
        let time = TimeSection { step, end: 10.0, scheme: Scheme::TwoStep, travel: 0.1, error: 1e-3, until: None };
        StepControl { time, shift_period: shift_period.map(ShiftPeriod::steady), protocol: None, longest: f64::INFINITY, by_twos: false }
    }

    fn next(control: &StepControl, time: f64, last_step: f64, tried: f64) -> f64 {
        let limits = StepLimits { stable: f64::INFINITY, accurate: f64::INFINITY, tried };
        control.next::<2>(Peers::Alone, &[], StepStart { time, last_step }, limits).length
    }

    #[test]
    fn a_fixed_step_that_was_split_leads_back_to_multiples_of_it() {
        let control = control(Step::Fixed(0.2), None);
        let (mut time, mut last, mut lengths) = (0.6000000000000001, 0.2, Vec::new());
        for tried in [0.05, f64::INFINITY, f64::INFINITY, f64::INFINITY] {
            last = next(&control, time, last, tried);
            lengths.push((last * 1e9).round() / 1e9);
            time += last;
        }
        assert_eq!(lengths, [0.05, 0.1, 0.05, 0.2]);
        assert!((time - 1.0).abs() < 1e-12);
    }

    #[test]
    fn half_a_step_slides_images_by_whole_cells_down_to_one() {
        let control = control(Step::Fixed(0.5), Some(0.1));
        let start = StepStart { time: 0.0, last_step: 0.5 };
        let halves: Vec<f64> = std::iter::successors(Some(0.5), |&step| control.half(start, step)).collect();
        assert_eq!(halves.len(), 3);
        assert!((halves[1] - 0.2).abs() < 1e-12 && (halves[2] - 0.1).abs() < 1e-12);
        assert_eq!(self::control(Step::Auto, None).half(start, 0.5), Some(0.25));
    }

    #[test]
    fn half_a_step_after_a_jump_of_the_rate_has_a_middle() {
        let protocol = Protocol::steps(&[(1.0, 1.0), (2.0, -1.0)]);
        let shift_period = Some(ShiftPeriod::changing(protocol, 0.1));
        let control = StepControl { shift_period, protocol: Some(protocol), ..control(Step::Auto, None) };
        let half = |time: f64| control.half(StepStart { time, last_step: 0.1 }, 0.7).map(|half| (half * 1e9).round() / 1e9);
        let halves = [0.9, 1.0, 1.3].map(half);
        assert_eq!(halves, [Some(0.3), Some(0.2), Some(0.3)]);
    }

    #[test]
    fn the_step_after_a_jump_of_the_rate_may_reach_the_end_as_a_first_one_may() {
        let protocol = Protocol::steps(&[(7.0, 1.0), (20.0, -1.0)]);
        let flowing = StepControl { protocol: Some(protocol), ..control(Step::Auto, None) };
        assert_eq!([(6.9, 0.1), (7.0, 0.1), (7.1, 0.1)].map(|(time, last_step)| flowing.may_end(time, last_step)), [false, true, false]);
        let evolving = StepControl { by_twos: true, ..flowing };
        assert!(!evolving.may_end(7.0, 0.1));
    }

    #[test]
    fn a_step_to_the_next_whole_cells_may_reach_the_end_however_short_the_last_one_was() {
        // images that turn at 2.5 slide slowly there
        let protocol = Protocol::Oscillation { amplitude: 1.0, frequency: 0.1 };
        let mut sheared = StepControl { shift_period: Some(ShiftPeriod::changing(protocol, 0.5)), ..control(Step::Fixed(0.01), None) };
        let start = 5.0 / 6.0;
        let step = next(&sheared, start, 0.01, f64::INFINITY);
        assert!((step - 5.0 / 3.0).abs() < 1e-9, "{step}");
        sheared.time.end = start + step;
        assert!(sheared.may_end(start, 0.01));
    }

    #[test]
    fn an_automatic_step_is_no_longer_than_what_is_left_to_try() {
        assert_eq!(next(&control(Step::Auto, None), 1.0, 0.4, 0.125), 0.125);
        assert_eq!(next(&control(Step::Auto, None), 1.0, 0.4, f64::INFINITY), 0.5);
    }

    #[test]
    fn a_step_in_which_too_much_passed_is_halved_until_it_passes_what_it_may() {
        let auto = control(Step::Auto, None);
        assert_eq!(
            [0.5, 1.3, 1.5, 2.0, 5.0].map(|passed| auto.in_place_of(0.0, 0.8, passed)),
            [None, None, Some(0.4), Some(0.4), Some(0.1)]
        );
        assert_eq!(control(Step::Fixed(0.8), None).in_place_of(0.0, 0.8, 5.0), None);
        let sheared = control(Step::Auto, Some(0.4));
        assert_eq!([sheared.in_place_of(0.0, 0.8, 5.0), sheared.in_place_of(0.0, 0.4, 5.0)], [Some(0.4), None]);
    }
}
