//! Tables of a scaling study: rows of numbers, measured and predicted.

use serde::Serialize;

use super::{
    measurement::Measurement,
    model::{Prediction, Sample, ScalingModel, Work},
    workload::RankShares,
};
use crate::{
    error::Error,
    experiment::table::{TableRow, markdown, number, quoted},
    output::{ParallelSummary, Spread},
    picture::Series,
};

/// Rows for rising numbers of ranks.
#[derive(Serialize)]
pub struct ScalingTable {
    measured: Vec<RunRow>,
    model: Vec<RunRow>,
}

/// A run on so many ranks, measured or predicted; counts are those of the busiest rank.
#[derive(Debug, Clone, Serialize)]
pub struct RunRow {
    ranks: usize,
    /// More ranks than there are cores.
    beyond_cores: bool,
    numbers: Option<Numbers>,
    /// Why there are none.
    remark: Option<String>,
}

#[derive(Debug, Clone, Serialize)]
struct Numbers {
    seconds: f64,
    efficiency: f64,
    iterations: f64,
    /// Largest share over the mean.
    cells_imbalance: f64,
    bodies_imbalance: f64,
    messages: f64,
    bytes: f64,
    collectives: f64,
    memory_bytes: Option<f64>,
}

impl Numbers {
    /// Of a step of a run, from those of all steps; efficiencies are told later.
    fn of(run: &Measurement, total: &Prediction, cells: &Spread, bodies: &Spread) -> Numbers {
        let steps = run.steps as f64;
        Numbers {
            seconds: total.seconds / steps,
            efficiency: 1.0,
            iterations: run.iterations as f64 / steps,
            cells_imbalance: cells.imbalance(),
            bodies_imbalance: bodies.imbalance(),
            messages: total.messages / steps,
            bytes: total.bytes / steps,
            collectives: total.collectives / steps,
            memory_bytes: total.memory,
        }
    }
}

impl RunRow {
    /// A measured run, or why there is none.
    pub fn measured(ranks: usize, beyond_cores: bool, sample: std::result::Result<&Sample, &Error>) -> RunRow {
        let numbers = |Sample { measured, .. }: &Sample| {
            let ParallelSummary { cells, bodies, messages, bytes, collectives, memory_bytes, .. } = measured.parallel;
            let [messages, bytes, collectives] = [messages, bytes, collectives].map(|spread| spread.most);
            let (seconds, memory) = (measured.all_seconds(), Some(memory_bytes.most));
            let total = Prediction { seconds, messages, bytes, collectives, memory };
            Numbers::of(measured, &total, &cells, &bodies)
        };
        RunRow { ranks, beyond_cores, numbers: sample.ok().map(numbers), remark: sample.err().map(Error::to_string) }
    }

    /// A run that the model predicts, with the steps, iterations and contacts of one that was measured.
    pub fn predicted(ranks: usize, model: &ScalingModel, like: &Sample, shares: std::result::Result<&RankShares, &Error>) -> RunRow {
        let total = |shares: &RankShares| model.predict(shares, &Work::like(like, shares), 1.0);
        let numbers = |shares: &RankShares| Numbers::of(&like.measured, &total(shares), &shares.cells, &shares.bodies);
        RunRow { ranks, beyond_cores: false, numbers: shares.ok().map(numbers), remark: shares.err().map(Error::to_string) }
    }

    /// Whether there is no such run.
    pub fn absent(&self) -> bool {
        self.numbers.is_none()
    }

    fn cells(&self, source: &str) -> TableRow<'static> {
        let remark = self.remark.iter().flat_map(|remark| remark.split([':', ';']).next()).collect::<String>();
        let of = |cell: &dyn Fn(&Numbers) -> String| self.numbers.as_ref().map_or("-".into(), cell);
        vec![
            ("ranks", format!("{}{}", self.ranks, if self.beyond_cores { "*" } else { "" })),
            ("seconds", of(&|run| plain(run.seconds))),
            ("efficiency", of(&|run| format!("{:.2}", run.efficiency))),
            ("iterations", of(&|run| format!("{:.1}", run.iterations))),
            ("cells max/mean", of(&|run| format!("{:.2}", run.cells_imbalance))),
            ("bodies max/mean", of(&|run| format!("{:.2}", run.bodies_imbalance))),
            ("messages", of(&|run| format!("{:.0}", run.messages))),
            ("MB sent", of(&|run| format!("{:.2}", run.bytes / 1e6))),
            ("collectives", of(&|run| format!("{:.0}", run.collectives))),
            ("memory MB", of(&|run| run.memory_bytes.map_or("-".into(), |bytes| format!("{:.0}", bytes / 1e6)))),
            ("", if self.absent() { format!("{source}: {remark}") } else { source.to_owned() }),
        ]
    }

    /// Its cells in `scaling.csv`.
    pub fn csv(&self, kind: &str, source: &str) -> TableRow<'static> {
        let of = |cell: fn(&Numbers) -> Option<f64>| number(self.numbers.as_ref().and_then(cell));
        vec![
            ("kind", kind.to_owned()),
            ("source", source.to_owned()),
            ("ranks", self.ranks.to_string()),
            ("beyond_cores", self.beyond_cores.to_string()),
            ("seconds", of(|run| Some(run.seconds))),
            ("efficiency", of(|run| Some(run.efficiency))),
            ("iterations", of(|run| Some(run.iterations))),
            ("cells_imbalance", of(|run| Some(run.cells_imbalance))),
            ("bodies_imbalance", of(|run| Some(run.bodies_imbalance))),
            ("messages", of(|run| Some(run.messages))),
            ("bytes", of(|run| Some(run.bytes))),
            ("collectives", of(|run| Some(run.collectives))),
            ("memory_bytes", of(|run| run.memory_bytes)),
            ("remark", quoted(self.remark.as_deref().unwrap_or_default())),
        ]
    }
}

/// Seconds with three digits.
fn plain(seconds: f64) -> String {
    if seconds < 0.1 { format!("{seconds:.2e}") } else { format!("{seconds:.3}") }
}

impl ScalingTable {
    /// Rows with their efficiencies, each list by its own first row.
    pub fn new(mut measured: Vec<RunRow>, mut model: Vec<RunRow>, weak: bool) -> ScalingTable {
        rate(&mut measured, weak);
        rate(&mut model, weak);
        ScalingTable { measured, model }
    }

    /// All rows with their source.
    pub fn rows(&self) -> impl Iterator<Item = (&'static str, &RunRow)> {
        self.measured.iter().map(|row| ("measured", row)).chain(self.model.iter().map(|row| ("model", row)))
    }

    /// The table for people.
    pub fn markdown(&self) -> String {
        markdown(&self.rows().map(|(source, row)| row.cells(source)).collect::<Vec<_>>())
    }

    /// Whether it has runs on more ranks than there are cores.
    pub fn beyond_cores(&self) -> bool {
        self.measured.iter().any(|row| row.beyond_cores)
    }

    /// Seconds against ranks.
    pub fn series(&self, kind: &str) -> Vec<Series> {
        let line = |source: &str, rows: &[RunRow]| Series {
            name: format!("{kind}, {source}"),
            points: rows.iter().filter_map(|row| Some((row.ranks as f64, row.numbers.as_ref()?.seconds))).collect(),
        };
        let lines = [line("measured", &self.measured), line("model", &self.model)];
        lines.into_iter().filter(|line| !line.points.is_empty()).collect()
    }
}

/// Gives rows their efficiency: speed per rank over that of the first row.
fn rate(rows: &mut [RunRow], weak: bool) {
    let speed = |ranks: usize, seconds: f64| 1.0 / (seconds * if weak { 1.0 } else { ranks as f64 });
    let first = rows.iter().find_map(|row| Some(speed(row.ranks, row.numbers.as_ref()?.seconds)));
    for row in rows {
        if let (Some(first), Some(numbers)) = (first, &mut row.numbers) {
            numbers.efficiency = speed(row.ranks, numbers.seconds) / first;
        }
    }
}
