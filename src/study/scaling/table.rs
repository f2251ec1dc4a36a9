//! Tables of a scaling study: rows of numbers, measured and predicted.

use serde::Serialize;

use super::{
    arrangement::Shares,
    measurement::Measurement,
    model::{Model, Sample},
};
use crate::{error::Error, output::Series};

/// Heads of the tables for people.
const HEADS: &str =
    "| ranks | seconds | efficiency | iterations | cells max/mean | bodies max/mean | messages | MB sent | collectives | memory MB | |";

/// Rows for rising numbers of ranks.
#[derive(Serialize)]
pub struct Table {
    measured: Vec<Row>,
    model: Vec<Row>,
}

/// A run on so many ranks, measured or predicted; counts are those of the busiest rank.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
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

impl Row {
    /// A measured run, or why there is none.
    pub fn measured(ranks: usize, beyond_cores: bool, sample: std::result::Result<&Sample, &Error>) -> Row {
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
        Row { ranks, beyond_cores, numbers: sample.ok().map(numbers), remark: sample.err().map(Error::to_string) }
    }

    /// A run that the model predicts, with the steps and iterations of one that was measured.
    pub fn predicted(ranks: usize, model: &Model, like: &Measurement, shares: std::result::Result<&Shares, &Error>) -> Row {
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
        Row { ranks, beyond_cores: false, numbers: shares.ok().map(numbers), remark: shares.err().map(Error::to_string) }
    }

    /// Whether there is no such run.
    pub fn absent(&self) -> bool {
        self.numbers.is_none()
    }

    fn markdown(&self, source: &str) -> String {
        let ranks = format!("{}{}", self.ranks, if self.beyond_cores { "*" } else { "" });
        let Some(numbers) = &self.numbers else {
            let remark = self.remark.iter().flat_map(|remark| remark.split([':', ';']).next()).collect::<String>();
            return format!("| {ranks} | - | - | - | - | - | - | - | - | - | {source}: {remark} |");
        };
        let Numbers { seconds, efficiency, iterations, cells_imbalance, bodies_imbalance, messages, bytes, collectives, memory_bytes } =
            numbers;
        let memory = memory_bytes.map_or("-".into(), |bytes| format!("{:.0}", bytes / 1e6));
        format!(
            "| {ranks} | {} | {efficiency:.2} | {iterations:.1} | {cells_imbalance:.2} | {bodies_imbalance:.2} | {messages:.0} \
             | {:.2} | {collectives:.0} | {memory} | {source} |",
            plain(*seconds),
            bytes / 1e6
        )
    }

    /// As a line of `scaling.csv`.
    pub fn csv(&self, kind: &str, source: &str) -> String {
        let numbers = self.numbers.as_ref().map_or(",,,,,,,,".to_owned(), |n| {
            let memory = n.memory_bytes.map_or(String::new(), |memory| memory.to_string());
            let all = [n.seconds, n.efficiency, n.iterations, n.cells_imbalance, n.bodies_imbalance, n.messages, n.bytes, n.collectives];
            all.map(|number| number.to_string()).join(",") + "," + &memory
        });
        let remark = self.remark.as_deref().unwrap_or_default().replace('"', "'");
        format!("{kind},{source},{},{},{numbers},\"{remark}\"\n", self.ranks, self.beyond_cores)
    }
}

/// Seconds with three digits.
fn plain(seconds: f64) -> String {
    if seconds < 0.1 { format!("{seconds:.2e}") } else { format!("{seconds:.3}") }
}

impl Table {
    /// Rows with their efficiencies, each list by its own first row.
    pub fn new(mut measured: Vec<Row>, mut model: Vec<Row>, weak: bool) -> Table {
        rate(&mut measured, weak);
        rate(&mut model, weak);
        Table { measured, model }
    }

    /// All rows with their source.
    pub fn rows(&self) -> impl Iterator<Item = (&'static str, &Row)> {
        self.measured.iter().map(|row| ("measured", row)).chain(self.model.iter().map(|row| ("model", row)))
    }

    /// The table for people.
    pub fn markdown(&self) -> String {
        let rows = self.rows().map(|(source, row)| row.markdown(source)).collect::<Vec<_>>().join("\n");
        format!("{HEADS}\n|-|-|-|-|-|-|-|-|-|-|-|\n{rows}")
    }

    /// Whether it has runs on more ranks than there are cores.
    pub fn beyond_cores(&self) -> bool {
        self.measured.iter().any(|row| row.beyond_cores)
    }

    /// Seconds against ranks.
    pub fn series(&self, kind: &str) -> Vec<Series> {
        let line = |source: &str, rows: &[Row]| Series {
            name: format!("{kind}, {source}"),
            points: rows.iter().filter_map(|row| Some((row.ranks as f64, row.numbers.as_ref()?.seconds))).collect(),
        };
        let lines = [line("measured", &self.measured), line("model", &self.model)];
        lines.into_iter().filter(|line| !line.points.is_empty()).collect()
    }
}

/// Gives rows their efficiency: speed per rank over that of the first row.
fn rate(rows: &mut [Row], weak: bool) {
    let speed = |ranks: usize, seconds: f64| 1.0 / (seconds * if weak { 1.0 } else { ranks as f64 });
    let first = rows.iter().find_map(|row| Some(speed(row.ranks, row.numbers.as_ref()?.seconds)));
    for row in rows {
        if let (Some(first), Some(numbers)) = (first, &mut row.numbers) {
            numbers.efficiency = speed(row.ranks, numbers.seconds) / first;
        }
    }
}
