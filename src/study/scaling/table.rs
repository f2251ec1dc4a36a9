//! Tables of a scaling study: rows of numbers, measured and predicted.

use serde::Serialize;

use super::{
    arrangement::Shares,
    measurement::Measurement,
    model::{Model, Sample},
};
use crate::{
    error::Error,
    output::Series,
    study::table::{Row, markdown, number, quoted},
};

/// Rows for rising numbers of ranks.
#[derive(Serialize)]
pub struct Table {
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

impl RunRow {
    /// A measured run, or why there is none.
    pub fn measured(ranks: usize, beyond_cores: bool, sample: std::result::Result<&Sample, &Error>) -> RunRow {
        let numbers = |sample: &Sample| {
            let (measured, parallel) = (&sample.measured, &sample.measured.parallel);
            let steps = measured.steps as f64;
            Numbers {
                seconds: measured.seconds(),
                efficiency: 1.0,
                iterations: measured.iterations as f64 / steps,
                cells_imbalance: parallel.cells.imbalance(),
                bodies_imbalance: parallel.bodies.imbalance(),
                messages: parallel.messages.most / steps,
                bytes: parallel.bytes.most / steps,
                collectives: parallel.collectives.most / steps,
                memory_bytes: Some(parallel.memory_bytes.most),
            }
        };
        RunRow { ranks, beyond_cores, numbers: sample.ok().map(numbers), remark: sample.err().map(Error::to_string) }
    }

    /// A run that the model predicts, with the steps and iterations of one that was measured.
    pub fn predicted(ranks: usize, model: &Model, like: &Measurement, shares: std::result::Result<&Shares, &Error>) -> RunRow {
        let numbers = |shares: &Shares| {
            let (steps, iterations) = (like.steps as f64, like.iterations as f64);
            let predicted = model.predict(shares, iterations);
            Numbers {
                seconds: predicted.seconds / steps,
                efficiency: 1.0,
                iterations: iterations / steps,
                cells_imbalance: shares.cells.imbalance(),
                bodies_imbalance: shares.bodies.imbalance(),
                messages: predicted.messages / steps,
                bytes: predicted.bytes / steps,
                collectives: predicted.collectives / steps,
                memory_bytes: predicted.memory,
            }
        };
        RunRow { ranks, beyond_cores: false, numbers: shares.ok().map(numbers), remark: shares.err().map(Error::to_string) }
    }

    /// Whether there is no such run.
    pub fn absent(&self) -> bool {
        self.numbers.is_none()
    }

    fn cells(&self, source: &str) -> Row<'static> {
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
    pub fn csv(&self, kind: &str, source: &str) -> Row<'static> {
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

impl Table {
    /// Rows with their efficiencies, each list by its own first row.
    pub fn new(mut measured: Vec<RunRow>, mut model: Vec<RunRow>, weak: bool) -> Table {
        rate(&mut measured, weak);
        rate(&mut model, weak);
        Table { measured, model }
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
