//! The shift period of a sheared box: steps are such that images slide by whole cells, between which there is nothing to interpolate.

use crate::{
    error::{Error, Result},
    geometry::{Domain, Protocol},
    grid::Grid,
    linalg::ROUNDING,
    scene::{Scheme, Step, TimeSection},
};

/// How steps go with the images of a sheared box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShiftPeriod {
    /// The time in which they slide by one cell.
    period: Period,
    /// Whether every step has to slide them by whole cells. On a grid that [may be oblique](Grid::may_be_oblique) steps do where they are long enough, as stencils
    /// then have fewer nodes, and automatic steps are shortened for the sake of accuracy down to one cell only: where contacts close, velocities jump, and the
    /// estimated error would shorten them again and again. Fixed steps, steps to the end of the run or to a jump of the rate, and those in place of one that led
    /// nowhere are as long as they are to be.
    required: bool,
}

/// The time in which images slide by one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Period {
    /// They slide at one speed.
    Steady(f64),
    /// Their speed changes.
    Changing {
        /// The speed over time.
        protocol: Protocol,
        /// Length of a cell.
        cell: f64,
    },
}

/// Part of a step that is wanted below which none is taken only to bring images to whole cells again.
const LEAST_TO_WHOLE_CELLS: f64 = 0.5;

impl ShiftPeriod {
    /// The shift period of a box on a grid; none if its images stay.
    pub fn of<const D: usize>(domain: &Domain<D>, grid: &Grid<D>) -> Option<ShiftPeriod> {
        let (protocol, cell) = (domain.slide()?.protocol, grid.spacing()[0]);
        let period = match protocol {
            Protocol::Steady(0.0) => return None,
            Protocol::Steady(speed) => Period::Steady(cell / speed.abs()),
            _ => Period::Changing { protocol, cell },
        };
        Some(ShiftPeriod { period, required: !grid.may_be_oblique() })
    }

    /// Of images that slide by a cell in such a time, in every step by whole ones.
    #[cfg(test)]
    pub fn steady(period: f64) -> ShiftPeriod {
        ShiftPeriod { period: Period::Steady(period), required: true }
    }

    /// Of images whose speed changes, which slide by whole cells of this length in every step.
    #[cfg(test)]
    pub fn changing(protocol: Protocol, cell: f64) -> ShiftPeriod {
        ShiftPeriod { period: Period::Changing { protocol, cell }, required: true }
    }

    /// Whether every step has to slide images by whole cells.
    pub fn required(&self) -> bool {
        self.required
    }

    /// The speed over time, where it changes.
    pub fn protocol(&self) -> Option<&Protocol> {
        match &self.period {
            Period::Steady(_) => None,
            Period::Changing { protocol, .. } => Some(protocol),
        }
    }

    /// The number of shift periods that the next step, after a last one (0 if there is none), is a multiple of: its midpoint is an instant too.
    pub fn multiple(scheme: Scheme, last_step: f64) -> f64 {
        match scheme {
            Scheme::Euler => 1.0,
            Scheme::TwoStep if last_step > 0.0 => 1.0,
            Scheme::TwoStep | Scheme::Midpoint => 2.0,
        }
    }

    /// The longest time that is not longer, from a time on, in which images slide by a multiple of so many cells; if that is shorter than all of these, the
    /// shortest of them where steps have to be such, and otherwise that time itself.
    pub fn within(&self, time: f64, longest: f64, multiple: f64) -> f64 {
        match self.required {
            true => self.multiple_within(time, longest, multiple),
            false => self.preferred(time, longest, multiple),
        }
    }

    fn multiple_within(&self, time: f64, longest: f64, multiple: f64) -> f64 {
        match &self.period {
            Period::Steady(period) => {
                let unit = period * multiple;
                (longest / unit * (1.0 + ROUNDING)).floor().max(1.0) * unit
            }
            Period::Changing { protocol, cell } => protocol.whole(time, longest, cell * multiple),
        }
    }

    fn preferred(&self, time: f64, longest: f64, multiple: f64) -> f64 {
        let (passed, rate) = self.cells_passed(time);
        let limit = longest * (1.0 + ROUNDING);
        if is_whole(passed) {
            let whole = self.multiple_within(time, longest, multiple);
            return if whole <= limit { whole } else { longest.min(self.until_turn(time)) };
        }
        let to_whole = match self.protocol() {
            Some(Protocol::Oscillation { .. }) if self.until_turn(time) <= limit => return self.until_turn(time),
            Some(Protocol::Oscillation { .. }) => self.multiple_within(time, longest, 1.0),
            _ if rate == 0.0 => longest,
            _ => {
                let (here, way) = (passed * rate.signum(), rate.abs() * longest);
                (((here + way) * (1.0 + ROUNDING)).floor() - here) / rate.abs()
            }
        };
        if (LEAST_TO_WHOLE_CELLS * longest..=limit).contains(&to_whole) { to_whole } else { longest }
    }

    /// The time from a time on until images have slid to whole cells, so many if they are there; 0 where they rest, or turn back and forth.
    pub fn to_whole(&self, time: f64, multiple: f64) -> f64 {
        let (passed, rate) = self.cells_passed(time);
        if rate == 0.0 || matches!(self.protocol(), Some(Protocol::Oscillation { .. })) {
            return 0.0;
        }
        let along = passed * rate.signum();
        (if is_whole(along) { multiple } else { along.ceil() - along }) / rate.abs()
    }

    /// The time from a time on until images turn back.
    fn until_turn(&self, time: f64) -> f64 {
        self.protocol().map_or(f64::INFINITY, |protocol| protocol.next_turn(time) - time)
    }

    /// The cells by which images have slid until a time, and those by which they slide then in a unit of time.
    fn cells_passed(&self, time: f64) -> (f64, f64) {
        match &self.period {
            Period::Steady(period) => (time / period, 1.0 / period),
            Period::Changing { protocol, cell } => (protocol.passed(time) / cell, protocol.rate(time) / cell),
        }
    }

    /// The time from a time on in which images slide by a cell.
    pub fn one_cell(&self, time: f64) -> f64 {
        match &self.period {
            Period::Steady(period) => *period,
            Period::Changing { .. } => self.multiple_within(time, 0.0, 1.0),
        }
    }

    /// The shortest step from a time; 0 where any is.
    pub fn shortest(&self, time: f64) -> f64 {
        if self.required { self.one_cell(time) } else { 0.0 }
    }

    /// Rounds a fixed step and the end of a run down to whole periods, where steps have to be such; a flow that `evolves` has no midpoints.
    ///
    /// # Errors
    /// One of them is shorter than the shortest step.
    pub fn round_down(&self, time: &TimeSection, evolves: bool) -> Result<TimeSection> {
        if !self.required {
            return Ok(time.clone());
        }
        let multiple = if evolves { 1.0 } else { ShiftPeriod::multiple(time.scheme, 0.0) };
        let step = match (time.step, &self.period) {
            (Step::Fixed(step), Period::Steady(_)) => Step::Fixed(self.rounded("step", step, multiple)?),
            // each step is rounded when it is taken
            (step, _) => step,
        };
        let end = match &self.period {
            Period::Steady(_) => self.rounded("end", time.end, multiple)?,
            // it ends when images have slid by whole cells after that
            Period::Changing { protocol: Protocol::Stress { .. }, .. } => time.end,
            Period::Changing { protocol, cell } => last_whole(protocol, *cell, time.end),
        };
        Ok(TimeSection { step, end, ..time.clone() })
    }

    /// The least number of cells along the flow, from this many on to a quarter more, with which a time is a whole number of multiples of the period; none
    /// where the speed changes.
    pub fn cells_that_fit(&self, cells: usize, time: f64, multiple: f64) -> Option<usize> {
        let Period::Steady(period) = &self.period else { return None };
        let count = |fitting: usize| time / (period * multiple) * fitting as f64 / cells as f64;
        (cells..=cells + cells / 4).find(|&fitting| (count(fitting) - count(fitting).round()).abs() < ROUNDING * count(fitting))
    }

    fn rounded(&self, key: &str, time: f64, multiple: f64) -> Result<f64> {
        let kept = self.within(0.0, time, multiple);
        if kept > time * (1.0 + ROUNDING) {
            let cells = if multiple > 1.0 { "two cells, one for each half of a step" } else { "one cell" };
            return Err(Error::refused(format!(
                "time.{key} = {time}: the images of the sheared box slide by whole cells in a step, at least {cells}, which takes {kept}; \
                 lengthen it or refine [resolution]"
            )));
        }
        Ok(kept)
    }
}

/// Whether a number of cells is whole but for rounding.
fn is_whole(cells: f64) -> bool {
    (cells - cells.round()).abs() <= ROUNDING * (1.0 + cells.abs())
}

/// The last time, up to an end, at which images that start without a shift have slid by whole cells.
fn last_whole(protocol: &Protocol, cell: f64, end: f64) -> f64 {
    let mut time = 0.0;
    while protocol.next_jump(time) < end {
        time = protocol.next_jump(time);
    }
    time + protocol.whole(time, end - time, cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(step: Step, end: f64, scheme: Scheme) -> TimeSection {
        TimeSection { step, end, scheme, travel: 0.1, error: 1e-3, until: None }
    }

    #[test]
    fn steps_and_ends_are_rounded_down_to_whole_periods() {
        let kept = ShiftPeriod::steady(0.25).round_down(&time(Step::Fixed(0.6), 1.8, Scheme::Euler), false).unwrap();
        assert_eq!((kept.step, kept.end), (Step::Fixed(0.5), 1.75));
        let kept = ShiftPeriod::steady(0.25).round_down(&time(Step::Fixed(0.8), 1.8, Scheme::Midpoint), false).unwrap();
        assert_eq!((kept.step, kept.end), (Step::Fixed(0.5), 1.5));
        // whole already but for rounding
        assert!((ShiftPeriod::steady(0.1).within(0.0, 0.3, 1.0) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn steps_that_need_not_be_whole_are_where_they_are_long_enough() {
        let free = |period| ShiftPeriod { required: false, ..period };
        let steady = free(ShiftPeriod::steady(0.25));
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found} for {wanted}");
        for (longest, multiple, step) in [(0.6, 1.0, 0.5), (0.6, 2.0, 0.5), (0.4, 2.0, 0.4), (0.1, 1.0, 0.1)] {
            near(steady.within(0.0, longest, multiple), step);
        }
        // from 1.4 cells on: to the last whole one on the way, unless that is near
        for (longest, step) in [(0.3, 0.15), (0.9, 0.9), (0.1, 0.1), (0.2, 0.15), (0.5, 0.4)] {
            near(steady.within(0.35, longest, 1.0), step);
        }
        let protocol = Protocol::steps(&[(1.0, 1.0), (2.0, -1.0)]);
        let changing = free(ShiftPeriod::changing(protocol, 0.25));
        for (time, longest, step) in [(0.1, 0.9, 0.9), (1.1, 0.2, 0.15), (1.5, 0.3, 0.25)] {
            near(changing.within(time, longest, 1.0), step);
        }
        let asked = time(Step::Fixed(0.1), 1.8, Scheme::TwoStep);
        assert_eq!(steady.round_down(&asked, false).unwrap(), asked);
        assert_eq!(steady.shortest(0.0), 0.0);
    }

    #[test]
    fn accuracy_asks_for_no_step_shorter_than_to_whole_cells() {
        let steady = ShiftPeriod::steady(0.25);
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found} for {wanted}");
        for (time, multiple, to) in [(0.0, 1.0, 0.25), (0.5, 2.0, 0.5), (0.35, 1.0, 0.15), (0.35, 2.0, 0.15)] {
            near(steady.to_whole(time, multiple), to);
        }
        let protocol = Protocol::steps(&[(1.1, 1.0), (1.5, 0.0), (2.0, -1.0)]);
        let changing = ShiftPeriod::changing(protocol, 0.25);
        near(changing.to_whole(1.2, 1.0), 0.0);
        near(changing.to_whole(1.5, 1.0), 0.1);
        near(ShiftPeriod::changing(Protocol::Oscillation { amplitude: 1.0, frequency: 1.0 }, 0.25).to_whole(0.0, 1.0), 0.0);
    }

    #[test]
    fn a_number_of_cells_that_meets_an_end_is_found_nearby() {
        // 61 cells, across which images slide in a time of 1
        let period = ShiftPeriod::steady(1.0 / 61.0);
        assert_eq!([1.0, 2.0].map(|multiple| period.cells_that_fit(61, 0.5, multiple)), [Some(62), Some(64)]);
        assert_eq!(period.cells_that_fit(61, 1.0, 1.0), Some(61));
        assert_eq!(period.cells_that_fit(61, 0.5_f64.sqrt(), 1.0), None);
    }

    #[test]
    fn what_is_shorter_than_a_period_is_refused_with_the_shortest_that_is_not() {
        let short = |step, end, scheme| ShiftPeriod::steady(0.25).round_down(&time(step, end, scheme), false).unwrap_err().to_string();
        let message = short(Step::Fixed(0.2), 1.0, Scheme::Euler);
        assert!(message.contains("time.step = 0.2") && message.contains("one cell, which takes 0.25"), "{message}");
        let message = short(Step::Auto, 0.3, Scheme::TwoStep);
        assert!(message.contains("time.end = 0.3") && message.contains("two cells") && message.contains("takes 0.5"), "{message}");
    }
}
