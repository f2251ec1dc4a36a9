//! What the errors of a method say: their order, and its cheapest setting for a wanted error.

use serde::Serialize;

use super::{
    sequence::RefinementSequence,
    setting::{CostSetting, Resolution},
};
use crate::study::fit::Power;

/// Finest grids of a sequence whose seconds are fitted.
const TIMED: usize = 3;

/// How much finer than the finest measured grid a predicted one may be.
const FARTHEST: f64 = 20.0;

/// The setting of a method that reaches the wanted error in the least time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cheapest {
    /// The setting; a predicted one stands between or beyond those measured.
    pub setting: CostSetting,
    /// Its relative error without sign: measured, or the wanted one if it is predicted.
    pub error: f64,
    /// Seconds of the whole scene.
    pub seconds: f64,
    /// Spacing of its grid.
    pub spacing: f64,
    /// Its unknowns.
    pub unknowns: f64,
    /// Whether it was measured.
    pub measured: bool,
}

/// By what settings are judged.
#[derive(Debug, Clone, Copy)]
pub struct ErrorCriterion<F> {
    /// Relative error of a run's values, with or without sign.
    pub error: F,
    /// Uncertainty of the reference.
    pub uncertainty: f64,
    /// Wanted error.
    pub wanted: f64,
    /// Length of the scene over that of a run.
    pub times: f64,
}

impl<F: Fn(&[f64]) -> f64> ErrorCriterion<F> {
    /// Powers of the spacing that errors and, on the finest grids, seconds follow on a sequence; errors within the uncertainty do not count.
    pub fn growth(&self, sequence: &RefinementSequence) -> [Option<Power>; 2] {
        let errors = sequence.runs.iter().map(|(_, run)| (run.spacing, (self.error)(&run.values).abs()));
        let errors: Vec<(f64, f64)> = errors.filter(|(_, error)| *error > self.uncertainty).collect();
        // on coarse grids, seconds are those of whatever has no grid
        let finest = &sequence.runs[sequence.runs.len().saturating_sub(TIMED)..];
        let seconds: Vec<(f64, f64)> = finest.iter().map(|(_, run)| (run.spacing, run.whole_seconds(self.times))).collect();
        [Power::fit(&errors), Power::fit(&seconds)]
    }

    /// The cheapest setting that was measured, of all sequences. It counts only if all finer grids of its sequence reach the error as well:
    /// where an error changes its sign, a coarse grid may be right by chance.
    pub fn cheapest(&self, sequences: &[RefinementSequence]) -> Option<Cheapest> {
        let reaches = |values: &[f64]| (self.error)(values).abs() + self.uncertainty <= self.wanted;
        let safe = |sequence: &RefinementSequence| sequence.runs.iter().rev().take_while(|(_, run)| reaches(&run.values)).count();
        let candidates = sequences.iter().flat_map(|sequence| sequence.runs[sequence.runs.len() - safe(sequence)..].iter());
        let cheapest = candidates.min_by(|one, two| one.1.whole_seconds(self.times).total_cmp(&two.1.whole_seconds(self.times)));
        cheapest.map(|(setting, run)| Cheapest {
            setting: (*setting).clone(),
            error: (self.error)(&run.values).abs(),
            seconds: run.whole_seconds(self.times),
            spacing: run.spacing,
            unknowns: run.unknowns,
            measured: true,
        })
    }

    /// The setting beyond a sequence that its fits predict to reach the error; nothing if errors do not fall, or so slowly that fits tell nothing.
    pub fn predicted(&self, sequence: &RefinementSequence, radius: f64) -> Option<Cheapest> {
        let [errors, seconds] = self.growth(sequence);
        let (errors, seconds) = (errors.filter(|power| power.exponent > 0.0)?, seconds?);
        let finest = sequence.finest().1.spacing;
        let spacing = errors.reaches(self.wanted).filter(|spacing| *spacing > finest / FARTHEST)?.min(finest);
        let grid = match sequence.finest().0.grid {
            Resolution::CellsPerRadius(_) => Resolution::CellsPerRadius((radius / spacing * (1.0 - 1e-9)).ceil()),
            Resolution::Spacing(_) => Resolution::Spacing(spacing),
            Resolution::Exactly(_) => Resolution::Exactly(spacing),
        };
        let setting = CostSetting { grid, ..sequence.finest().0.clone() };
        let spacing = grid.spacing(radius);
        let unknowns = Power::fit(&sequence.runs.iter().map(|(_, run)| (run.spacing, run.unknowns)).collect::<Vec<_>>())?.at(spacing);
        Some(Cheapest { setting, error: self.wanted, seconds: seconds.at(spacing), spacing, unknowns, measured: false })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        experiment::record::RunOutcome,
        study::cost::record::{CostRecord, Measured, tests::run},
    };

    fn records(errors: &[(f64, f64)]) -> Vec<CostRecord> {
        let record = |&(cells, error): &(f64, f64)| CostRecord {
            setting: CostSetting {
                method: "sharp".into(),
                grid: Resolution::CellsPerRadius(cells),
                modes: None,
                tolerance: None,
                step: None,
            },
            outcome: RunOutcome::Measured(Measured { values: vec![1.0 + error], ..run(1.0 / cells, 0.0) }),
        };
        errors.iter().map(record).collect()
    }

    fn judged<T>(
        errors: &[(f64, f64)],
        uncertainty: f64,
        ask: impl Fn(&ErrorCriterion<fn(&[f64]) -> f64>, &[RefinementSequence]) -> T,
    ) -> T {
        let records = records(errors);
        let settings: Vec<CostSetting> = records.iter().map(|record| record.setting.clone()).collect();
        let error: fn(&[f64]) -> f64 = |values| values[0] - 1.0;
        ask(&ErrorCriterion { error, uncertainty, wanted: 1e-2, times: 1.0 }, &RefinementSequence::all(&records, &settings))
    }

    #[test]
    fn a_lucky_error_is_not_chosen() {
        let chosen =
            judged(&[(4.0, 1e-4), (6.0, -0.02), (8.0, 5e-3), (12.0, 1e-3)], 0.0, |criterion, sequences| criterion.cheapest(sequences));
        let chosen = chosen.expect("8 cells do");
        assert_eq!((chosen.setting.grid, chosen.measured), (Resolution::CellsPerRadius(8.0), true));
        assert!((chosen.error - 5e-3).abs() < 1e-12 && chosen.seconds == 64.0);
    }

    #[test]
    fn an_uncertain_reference_lets_fewer_settings_pass() {
        let errors = [(4.0, 0.02), (6.0, 8e-3), (8.0, 5e-3)];
        let with = |uncertainty| {
            judged(&errors, uncertainty, |criterion, sequences| criterion.cheapest(sequences)).map(|chosen| chosen.setting.grid)
        };
        assert_eq!(with(0.0), Some(Resolution::CellsPerRadius(6.0)));
        assert_eq!(with(4e-3), Some(Resolution::CellsPerRadius(8.0)));
        assert_eq!(with(2e-2), None);
    }

    #[test]
    fn a_fit_predicts_what_was_not_measured() {
        let errors: Vec<(f64, f64)> = [4.0, 6.0, 8.0].map(|cells| (cells, 0.8 / cells)).to_vec();
        let slow: Vec<(f64, f64)> = [4.0, 6.0, 8.0].map(|cells: f64| (cells, 0.8 / cells.sqrt())).to_vec();
        assert_eq!(judged(&slow, 0.0, |criterion, sequences| criterion.predicted(&sequences[0], 1.0)), None);
        let predicted =
            judged(&errors, 0.0, |criterion, sequences| (criterion.cheapest(sequences), criterion.predicted(&sequences[0], 1.0)));
        let (None, Some(predicted)) = predicted else { panic!("{predicted:?}") };
        assert_eq!((predicted.setting.grid, predicted.measured), (Resolution::CellsPerRadius(80.0), false));
        assert!((predicted.seconds / 6400.0 - 1.0).abs() < 1e-9);
        let growing = [(4.0, 0.02), (8.0, 0.04)];
        assert_eq!(judged(&growing, 0.0, |criterion, sequences| criterion.predicted(&sequences[0], 1.0)), None);
    }

    #[test]
    fn errors_within_the_uncertainty_are_left_out_of_fits() {
        let errors = [(4.0, 0.16), (8.0, 0.04), (16.0, 1e-9)];
        let [order, seconds] = judged(&errors, 1e-3, |criterion, sequences| criterion.growth(&sequences[0]));
        assert!((order.expect("two are left").exponent - 2.0).abs() < 1e-9);
        assert!((seconds.expect("three").exponent + 2.0).abs() < 1e-9);
    }
}
