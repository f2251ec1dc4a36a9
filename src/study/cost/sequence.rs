//! Runs sorted into sequences: settings that differ in the grid alone, from the coarsest to the finest.

use super::{
    record::{CostRecord, Measured},
    setting::CostSetting,
};

/// Grids that a sequence needs for its limit to be trusted.
const ENOUGH: usize = 3;

/// Runs on ever finer grids.
#[derive(Debug, Clone, PartialEq)]
pub struct RefinementSequence<'a> {
    /// Settings and runs.
    pub runs: Vec<(&'a CostSetting, &'a Measured)>,
}

impl<'a> RefinementSequence<'a> {
    /// The sequences of the settings of a method.
    pub fn all(records: &'a [CostRecord], settings: &[CostSetting]) -> Vec<RefinementSequence<'a>> {
        let records = settings.iter().filter_map(|setting| records.iter().find(|record| record.setting == *setting));
        let runs = records.filter_map(|record| Some((&record.setting, record.measured()?)));
        let groups = by_grid(runs, |(setting, _)| setting);
        let mut sequences: Vec<RefinementSequence> = groups.into_iter().map(|runs| RefinementSequence { runs }).collect();
        for sequence in &mut sequences {
            sequence.runs.sort_by(|one, two| two.1.spacing.total_cmp(&one.1.spacing));
            // two nominal resolutions may round to the same cells
            sequence.runs.dedup_by(|next, last| (next.1.spacing / last.1.spacing - 1.0).abs() < 1e-9);
        }
        sequences
    }

    /// The sequence that speaks for a method: of those with enough grids the one with most modes, tightest tolerance and shortest step,
    /// or else the longest.
    pub fn main(sequences: &[RefinementSequence<'a>]) -> Option<RefinementSequence<'a>> {
        let care = |sequence: &RefinementSequence| {
            let setting = sequence.runs[0].0;
            let few = setting.modes.unwrap_or(0) as f64;
            [few, -setting.tolerance.unwrap_or(0.0), -setting.step.map_or(0.0, |step| step.length())]
        };
        let rank = |sequence: &RefinementSequence| (sequence.runs.len().min(ENOUGH), care(sequence));
        let better = |one: &&RefinementSequence, two: &&RefinementSequence| {
            let ((count, care), (other_count, other_care)) = (rank(one), rank(two));
            count.cmp(&other_count).then(care.partial_cmp(&other_care).unwrap_or(std::cmp::Ordering::Equal))
        };
        sequences.iter().max_by(better).cloned()
    }

    /// The run on the finest grid.
    pub fn finest(&self) -> (&'a CostSetting, &'a Measured) {
        self.runs[self.runs.len() - 1]
    }

    /// The runs alone.
    pub fn measured(&self) -> Vec<&'a Measured> {
        self.runs.iter().map(|(_, measured)| *measured).collect()
    }
}

/// Items sorted into groups whose settings differ in the grid alone.
pub fn by_grid<T>(items: impl IntoIterator<Item = T>, setting: impl Fn(&T) -> &CostSetting) -> Vec<Vec<T>> {
    let mut groups: Vec<Vec<T>> = Vec::new();
    for item in items {
        match groups.iter_mut().find(|group| setting(&group[0]).differs_in_grid_alone(setting(&item))) {
            Some(group) => group.push(item),
            None => groups.push(vec![item]),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        experiment::record::RunOutcome,
        study::cost::{
            record::tests::run,
            setting::{Resolution, TimeStep},
        },
    };

    fn record(cells: f64, step: f64) -> CostRecord {
        let step = Some(TimeStep::Step(step));
        let setting = CostSetting { method: "sharp".into(), grid: Resolution::CellsPerRadius(cells), modes: None, tolerance: None, step };
        CostRecord { setting, outcome: RunOutcome::Measured(run(1.0 / cells, cells)) }
    }

    #[test]
    fn the_main_sequence_has_enough_grids_and_then_the_shortest_steps() {
        let places = [(4.0, 0.2), (4.0, 0.1), (4.0, 0.05), (6.0, 0.2), (6.0, 0.1), (6.0, 0.05), (8.0, 0.2), (8.0, 0.1)];
        let mut records: Vec<CostRecord> = places.map(|(cells, step)| record(cells, step)).to_vec();
        let settings: Vec<CostSetting> = records.iter().map(|record| record.setting.clone()).collect();
        records.push(record(16.0, 0.05));
        let sequences = RefinementSequence::all(&records, &settings);
        assert_eq!(
            sequences.iter().map(|sequence| sequence.runs.len()).collect::<Vec<_>>(),
            [3, 3, 2],
            "what was not asked for is left out"
        );
        let main = RefinementSequence::main(&sequences).expect("there are sequences");
        assert_eq!((main.finest().0.step, main.finest().1.spacing), (Some(TimeStep::Step(0.1)), 0.125));
    }
}
