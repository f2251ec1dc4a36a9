//! Tables of a scaling study: for people, as numbers, as a chart.

use std::fmt::Write;

use serde::Serialize;

use super::{
    arrangement::Shares,
    measurement::Measurement,
    model::{Model, Network, Sample},
};
use crate::{
    error::Error,
    output::{Chart, Scale, Series},
};

/// Names of the numbers of a row in `scaling.csv`.
const COLUMNS: &str = "kind,source,ranks,beyond_cores,seconds,efficiency,iterations,cells_imbalance,bodies_imbalance,messages,bytes,collectives,memory_bytes,remark";

/// Heads of the tables for people.
const HEADS: &str = "| ranks | seconds | efficiency | iterations | cells | bodies | messages | MB | collectives | memory | |";

/// All that the study found.
#[derive(Serialize)]
pub struct Report {
    /// Title of the scene.
    pub scene: String,
    /// Whether seconds are those of a step, not of an instant.
    pub steps: bool,
    /// How runs were started.
    pub launcher: String,
    /// Runs of each, of which the fastest counts.
    pub repeat: usize,
    /// Cores of this machine.
    pub cores: usize,
    /// The same scene on more ranks.
    pub strong: Table,
    /// A scene that grows with the ranks, or why there is none.
    pub weak: std::result::Result<Table, String>,
    /// Assumed for the model.
    pub network: Network,
    /// The model, if there were runs to fit it to.
    pub model: Option<Model>,
}

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
    /// More ranks than this machine has cores.
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

    fn markdown(&self, source: &str) -> String {
        let ranks = format!("{}{}", self.ranks, if self.beyond_cores { "*" } else { "" });
        let Some(numbers) = &self.numbers else {
            return format!("| {ranks} | - | - | - | - | - | - | - | - | - | {source}: {} |", self.remark.as_deref().unwrap_or_default());
        };
        let Numbers { seconds, efficiency, iterations, cells_imbalance, bodies_imbalance, messages, bytes, collectives, memory_bytes } =
            numbers;
        let memory = memory_bytes.map_or("-".into(), |bytes| format!("{:.0}", bytes / 1e6));
        format!(
            "| {ranks} | {seconds:.3e} | {efficiency:.2} | {iterations:.1} | {cells_imbalance:.2} | {bodies_imbalance:.2} | {messages:.0} \
             | {:.2} | {collectives:.0} | {memory} | {source} |",
            bytes / 1e6
        )
    }

    fn csv(&self, kind: &str, source: &str) -> String {
        let numbers = self.numbers.as_ref().map_or(",,,,,,,,".to_owned(), |n| {
            let memory = n.memory_bytes.map_or(String::new(), |memory| memory.to_string());
            let all = [n.seconds, n.efficiency, n.iterations, n.cells_imbalance, n.bodies_imbalance, n.messages, n.bytes, n.collectives];
            all.map(|number| number.to_string()).join(",") + "," + &memory
        });
        let remark = self.remark.as_deref().unwrap_or_default().replace('"', "'");
        format!("{kind},{source},{},{},{numbers},\"{remark}\"\n", self.ranks, self.beyond_cores)
    }
}

impl Table {
    /// Rows with their efficiencies, each list by its own first row.
    pub fn new(mut measured: Vec<Row>, mut model: Vec<Row>, weak: bool) -> Table {
        rate(&mut measured, weak);
        rate(&mut model, weak);
        Table { measured, model }
    }

    fn rows(&self) -> impl Iterator<Item = (&'static str, &Row)> {
        self.measured.iter().map(|row| ("measured", row)).chain(self.model.iter().map(|row| ("model", row)))
    }

    fn markdown(&self) -> String {
        let rows = self.rows().map(|(source, row)| row.markdown(source)).collect::<Vec<_>>().join("\n");
        format!("{HEADS}\n|-|-|-|-|-|-|-|-|-|-|-|\n{rows}")
    }

    fn series(&self, kind: &str) -> Vec<Series> {
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

impl Report {
    /// The tables and what is to be said about them.
    pub fn markdown(&self) -> String {
        let mut text = format!("{}\n\nStrong scaling: the same scene.\n\n{}\n\n", self.scene, self.strong.markdown());
        let _ = match &self.weak {
            Ok(weak) => write!(text, "Weak scaling: bodies and volume grow with the ranks.\n\n{}\n\n", weak.markdown()),
            Err(reason) => write!(text, "Weak scaling: none: {reason}.\n\n"),
        };
        text + &self.notes()
    }

    fn notes(&self) -> String {
        let what = if self.steps { "a step" } else { "the instant: set-up, jump assembly, solve" };
        let Network { bandwidth, latency } = self.network;
        let mut notes = vec![
            format!("Seconds of {what}; the fastest of {}. Cells and bodies: largest share of a rank over the mean.", self.repeat),
            "Messages, MB, collectives and memory (MB): of the busiest rank, as PETSc counts them and this program's own collectives; hypre's are not counted."
                .to_owned(),
        ];
        let cores = self.cores;
        if self.strong.measured.iter().any(|row| row.beyond_cores) {
            notes.push(format!("* More ranks than the {cores} cores of this machine: they take turns; the model leaves such rows out."));
        }
        notes.push(match self.model {
            Some(_) => format!(
                "Rows \"model\" are a model, not a measurement: seconds per cell, body and iteration fitted to the measured rows, shares counted in the \
                 partition at that many ranks, iterations as on the most ranks measured, messages of {:.2} microseconds and {:.1} GB/s a rank \
                 (--latency, --bandwidth), and five exchanges on each multigrid level.",
                latency * 1e6,
                bandwidth / 1e9
            ),
            None => format!("No model: it takes a run on more than one rank and on no more than the {cores} cores of this machine."),
        });
        notes.join("\n")
    }

    /// Names and contents of the files.
    pub fn files(&self) -> [(&'static str, String); 3] {
        let json = serde_json::to_string_pretty(self).expect("a report is plain numbers and text");
        [("scaling.json", json + "\n"), ("scaling.csv", self.csv()), ("scaling.svg", self.chart().svg())]
    }

    fn tables(&self) -> impl Iterator<Item = (&'static str, &Table)> {
        [("strong", Some(&self.strong)), ("weak", self.weak.as_ref().ok())].into_iter().filter_map(|(kind, table)| Some((kind, table?)))
    }

    fn csv(&self) -> String {
        let rows = self.tables().flat_map(|(kind, table)| table.rows().map(move |(source, row)| row.csv(kind, source)));
        format!("{COLUMNS}\n{}", rows.collect::<String>())
    }

    fn chart(&self) -> Chart {
        let y = if self.steps { "seconds a step" } else { "seconds" };
        let series = self.tables().flat_map(|(kind, table)| table.series(kind)).collect();
        Chart { title: self.scene.clone(), x: "ranks".into(), y: y.into(), scale: Scale::Logarithmic, series }
    }
}
