//! The shift period of a sheared box: steps are such that images slide by whole cells, between which there is nothing to interpolate.

use crate::{
    error::{Error, Result},
    geometry::{Domain, Protocol},
    grid::Grid,
    linalg::ROUNDING,
    scene::{Scheme, Step, TimeSection},
};

/// The time in which the images of a sheared box slide by one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShiftPeriod {
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

impl ShiftPeriod {
    /// The shift period of a box on a grid; none if its images stay.
    pub fn of<const D: usize>(domain: &Domain<D>, grid: &Grid<D>) -> Option<ShiftPeriod> {
        let (protocol, cell) = (domain.slide()?.protocol, grid.spacing()[0]);
        match protocol {
            Protocol::Steady(speed) => (speed != 0.0).then(|| ShiftPeriod::Steady(cell / speed.abs())),
            _ => Some(ShiftPeriod::Changing { protocol, cell }),
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

    /// The longest time that is not longer, from a time on, in which images slide by a multiple of so many cells; the shortest if that is longer still.
    pub fn within(&self, time: f64, longest: f64, multiple: f64) -> f64 {
        match self {
            ShiftPeriod::Steady(period) => {
                let unit = period * multiple;
                (longest / unit * (1.0 + ROUNDING)).floor().max(1.0) * unit
            }
            ShiftPeriod::Changing { protocol, cell } => protocol.whole(time, longest, cell * multiple),
        }
    }

    /// The shortest time, from a time on, in which images slide by whole cells.
    pub fn shortest(&self, time: f64) -> f64 {
        match self {
            ShiftPeriod::Steady(period) => *period,
            ShiftPeriod::Changing { .. } => self.within(time, 0.0, 1.0),
        }
    }

    /// Rounds a fixed step and the end of a run down to whole periods; a flow that `evolves` has no midpoints.
    ///
    /// # Errors
    /// One of them is shorter than the shortest step.
    pub fn round_down(&self, time: &TimeSection, evolves: bool) -> Result<TimeSection> {
        let multiple = if evolves { 1.0 } else { ShiftPeriod::multiple(time.scheme, 0.0) };
        let step = match (time.step, self) {
            (Step::Fixed(step), ShiftPeriod::Steady(_)) => Step::Fixed(self.rounded("step", step, multiple)?),
            // each step is rounded when it is taken
            (step, _) => step,
        };
        let end = match self {
            ShiftPeriod::Steady(_) => self.rounded("end", time.end, multiple)?,
            // it ends when images have slid by whole cells after that
            ShiftPeriod::Changing { protocol: Protocol::Stress { .. }, .. } => time.end,
            ShiftPeriod::Changing { protocol, cell } => last_whole(protocol, *cell, time.end),
        };
        Ok(TimeSection { step, end, ..time.clone() })
    }

    /// The least number of cells along the flow, from this many on to a quarter more, with which a time is a whole number of multiples of the period; none
    /// where the speed changes.
    pub fn cells_that_fit(&self, cells: usize, time: f64, multiple: f64) -> Option<usize> {
        let ShiftPeriod::Steady(period) = self else { return None };
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
        let kept = ShiftPeriod::Steady(0.25).round_down(&time(Step::Fixed(0.6), 1.8, Scheme::Euler), false).unwrap();
        assert_eq!((kept.step, kept.end), (Step::Fixed(0.5), 1.75));
        let kept = ShiftPeriod::Steady(0.25).round_down(&time(Step::Fixed(0.8), 1.8, Scheme::Midpoint), false).unwrap();
        assert_eq!((kept.step, kept.end), (Step::Fixed(0.5), 1.5));
        // whole already but for rounding
        assert!((ShiftPeriod::Steady(0.1).within(0.0, 0.3, 1.0) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn a_number_of_cells_that_meets_an_end_is_found_nearby() {
        // 61 cells, across which images slide in a time of 1
        let period = ShiftPeriod::Steady(1.0 / 61.0);
        assert_eq!([1.0, 2.0].map(|multiple| period.cells_that_fit(61, 0.5, multiple)), [Some(62), Some(64)]);
        assert_eq!(period.cells_that_fit(61, 1.0, 1.0), Some(61));
        assert_eq!(period.cells_that_fit(61, 0.5_f64.sqrt(), 1.0), None);
    }

    #[test]
    fn what_is_shorter_than_a_period_is_refused_with_the_shortest_that_is_not() {
        let short = |step, end, scheme| ShiftPeriod::Steady(0.25).round_down(&time(step, end, scheme), false).unwrap_err().to_string();
        let message = short(Step::Fixed(0.2), 1.0, Scheme::Euler);
        assert!(message.contains("time.step = 0.2") && message.contains("one cell, which takes 0.25"), "{message}");
        let message = short(Step::Auto, 0.3, Scheme::TwoStep);
        assert!(message.contains("time.end = 0.3") && message.contains("two cells") && message.contains("takes 0.5"), "{message}");
    }
}
