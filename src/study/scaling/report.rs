//! What a scaling study says: for people, as numbers, as a chart.

use serde::Serialize;

use super::{
    check::{self, Check},
    model::{Network, ScalingModel},
    table::ScalingTable,
};
use crate::{
    experiment::table::csv,
    picture::{Chart, Scale},
};

/// All that the study found.
#[derive(Serialize)]
pub struct ScalingReport {
    /// Title of the scene.
    pub scene: String,
    /// Whether seconds are those of a step, not of an instant.
    pub steps: bool,
    /// How runs were started.
    pub launcher: String,
    /// Runs of each, of which the fastest counts.
    pub repeat: usize,
    /// Cores that the launcher reaches.
    pub cores: usize,
    /// The same scene on more ranks.
    pub strong: ScalingTable,
    /// A scene that grows with the ranks.
    pub weak: Option<ScalingTable>,
    /// Why there is none.
    pub weak_refusal: Option<String>,
    /// Assumed for the model.
    pub network: Network,
    /// The model, if there were runs to fit it to.
    pub model: Option<ScalingModel>,
    /// What it says of each measured run if fitted to the others.
    pub checks: Vec<Check>,
}

impl ScalingReport {
    /// The tables and what is to be said about them.
    pub fn markdown(&self) -> String {
        let mut text = format!("{}\n\nStrong scaling: the same scene.\n\n{}\n\n", self.scene, self.strong.markdown());
        if let Some(weak) = &self.weak {
            text += &format!("Weak scaling: bodies and volume grow with the ranks.\n\n{}\n\n", weak.markdown());
        }
        if let Some(reason) = &self.weak_refusal {
            text += &format!("Weak scaling: none: {reason}.\n\n");
        }
        if !self.checks.is_empty() {
            text += &format!(
                "Each measured row beside what the model says of it if fitted to the others.\n\n{}\n\n",
                check::table(&self.checks)
            );
        }
        text + &self.notes()
    }

    fn notes(&self) -> String {
        let what = if self.steps { "a step" } else { "the instant: set-up, assembly, solve" };
        let (Network { bandwidth, latency }, repeat) = (self.network, self.repeat);
        let mut notes = vec![
            format!("Seconds of {what}; the fastest of {repeat}. Efficiency: speed per rank over that of the first row."),
            "Messages, MB sent, collectives and memory: of the busiest rank, as PETSc counts them, with this program's own collectives; \
             hypre's are not counted."
                .to_owned(),
        ];
        let cores = self.cores;
        if self.strong.beyond_cores() {
            notes.push(format!(
                "* More ranks than the {cores} cores (oversubscribed): they take turns, and the model is not fitted to their seconds, which tell of \
                 the scheduler too, but to their counts."
            ));
        }
        notes.push(match self.model {
            Some(_) => format!(
                "Rows \"model\" are a model, not a measurement: seconds per cell, body, contact and iteration fitted to the measured rows, shares \
                 counted in the partition at that many ranks, iterations and contacts as on the most ranks measured, messages of {:.2} microseconds \
                 and {:.1} GB/s a rank (--latency, --bandwidth), five exchanges on each multigrid level or all values but its own \
                 from each rank in each transpose of a transform, log2 of the ranks messages in a collective, and contacts of the busiest rank: its \
                 share, or the largest island that one rank solves.",
                latency * 1e6,
                bandwidth / 1e9,
            ),
            None => format!("No model: it takes a run on more than one rank, and one on no more than the {cores} cores."),
        });
        notes.join("\n")
    }

    /// Names and contents of the files.
    pub fn files(&self) -> [(&'static str, String); 3] {
        let json = serde_json::to_string_pretty(self).expect("a report is plain numbers and text");
        [("scaling.json", json + "\n"), ("scaling.csv", self.csv()), ("scaling.svg", self.chart().svg())]
    }

    fn tables(&self) -> impl Iterator<Item = (&'static str, &ScalingTable)> {
        [("strong", Some(&self.strong)), ("weak", self.weak.as_ref())].into_iter().filter_map(|(kind, table)| Some((kind, table?)))
    }

    fn csv(&self) -> String {
        csv(&self.tables().flat_map(|(kind, table)| table.rows().map(move |(source, row)| row.csv(kind, source))).collect::<Vec<_>>())
    }

    fn chart(&self) -> Chart {
        let y = if self.steps { "seconds a step" } else { "seconds" };
        let series = self.tables().flat_map(|(kind, table)| table.series(kind)).collect();
        Chart { title: self.scene.clone(), x: "ranks".into(), y: y.into(), scale: Scale::Logarithmic, series }
    }
}
