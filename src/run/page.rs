//! What the page of a run shows: gathered from its summary and the files of its folder.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Instant, SystemTime},
};

use super::command::command;
use crate::{
    output::{
        Answer, Breakdown, Facts, Image, KNOWN_FILES, LOG, MeanViscosity, Page, Standing, Summary, Table, answers, bodies_table, date,
        duration, lengths_of_steps, number, plain,
    },
    parallel::Machine,
    scene::Scene,
};

/// Tables that are drawn.
const TABLES: [&str; 3] = ["series.csv", "forces.csv", "pairs.csv"];
/// Images that are shown.
const IMAGES: [&str; 3] = ["picture.svg", "picture.png", "profiles.svg"];
/// Lines of the log that are shown.
const LINES: usize = 25;
/// Largest image that is shown, in bytes; others are named.
const LARGEST: usize = 8 << 20;

/// What is known of a run from its start on; on the first rank.
pub struct PageOfRun {
    title: String,
    scene: String,
    folder: PathBuf,
    ranks: usize,
    machine: Machine,
    command: String,
    begun: (SystemTime, Instant),
}

impl PageOfRun {
    /// Of a scene's run in a folder.
    pub fn new(scene: &Scene, folder: &Path, ranks: usize) -> PageOfRun {
        PageOfRun {
            title: scene.shown_title().to_owned(),
            scene: scene.text.clone(),
            folder: folder.to_owned(),
            ranks,
            machine: Machine::local(),
            command: command(),
            begun: (SystemTime::now(), Instant::now()),
        }
    }

    /// The page of a run that has not ended.
    pub fn unfinished(&self, standing: Standing, written: String, answers: Vec<Answer>, mean: Option<MeanViscosity>) -> Page {
        Page {
            title: self.title.clone(),
            standing,
            written,
            answers,
            tables: TABLES.iter().filter_map(|name| Table::read(&self.folder.join(name)).ok().flatten()).collect(),
            mean,
            images: Vec::new(),
            parts: Vec::new(),
            bodies: None,
            facts: self.facts(None),
            scene: self.scene_text(),
            log: self.log(),
            files: self.files(),
        }
    }

    /// The page of a run that has ended.
    pub fn ended(&self, summary: &Summary, mean: Option<MeanViscosity>) -> Page {
        let written = match summary.motion {
            Some(_) => format!("at time {} after {} steps, {}", plain(summary.time), summary.steps, date(SystemTime::now())),
            None => date(SystemTime::now()),
        };
        let image = |&name: &&'static str| {
            let bytes = fs::read(self.folder.join(name)).ok()?;
            Some(Image { name, bytes: if bytes.len() > LARGEST { Vec::new() } else { bytes } })
        };
        Page {
            images: IMAGES.iter().filter_map(image).collect(),
            parts: parts(summary, mean.as_ref()),
            bodies: bodies_table(summary),
            facts: self.facts(Some(summary)),
            // the summary is written last
            files: [KNOWN_FILES[0]].into_iter().map(|(name, what)| (name.to_owned(), what)).chain(self.files()).collect(),
            ..self.unfinished(Standing::Ended, written, answers(summary), mean)
        }
    }

    /// The scene as the folder has it, or as it was read.
    fn scene_text(&self) -> String {
        fs::read_to_string(self.folder.join("scene.toml")).unwrap_or_else(|_| self.scene.clone())
    }

    fn log(&self) -> String {
        let text = fs::read_to_string(self.folder.join(LOG)).unwrap_or_default();
        let lines: Vec<&str> = text.lines().collect();
        let left_out = lines.len().saturating_sub(LINES);
        let more = if left_out > 0 { format!("({left_out} lines before these are in {LOG})\n") } else { String::new() };
        more + &lines[left_out..].join("\n")
    }

    fn files(&self) -> Vec<(String, &'static str)> {
        let there = |name: &str| self.folder.join(name).exists();
        KNOWN_FILES.iter().filter(|(name, _)| there(name)).map(|&(name, what)| (name.to_owned(), what)).collect()
    }

    /// Contacts, solver and run.
    fn facts(&self, summary: Option<&Summary>) -> Vec<Facts> {
        let mut all = summary.map_or(Vec::new(), |summary| vec![scene_facts(summary)]);
        all.extend(summary.and_then(contact_facts));
        all.extend(summary.and_then(solver_facts));
        let (began, since) = self.begun;
        let seconds = summary.and_then(|summary| summary.motion.as_ref()).map_or(since.elapsed().as_secs_f64(), |motion| motion.seconds);
        let machine = &self.machine;
        let memory = machine.memory.map_or(String::new(), |bytes| format!(", {:.1} GB of memory", bytes / 1e9));
        let processor = machine.processor.as_ref().map_or(String::new(), |name| format!(", {name}"));
        let run = vec![
            ("command", self.command.clone()),
            ("version", format!("turbid {}", env!("CARGO_PKG_VERSION"))),
            ("started", date(began)),
            ("wall time", format!("{}, resumptions included", duration(seconds))),
            ("ranks", self.ranks.to_string()),
            ("machine", format!("{}: {} cores{processor}{memory} (first rank)", machine.name, machine.cores)),
        ];
        all.push(Facts { title: "Run", facts: run });
        all
    }
}

fn scene_facts(summary: &Summary) -> Facts {
    let mut facts =
        vec![("bodies", summary.body_count().max(summary.scalar.as_ref().map_or(0, |scalar| scalar.inclusions.len())).to_string())];
    facts.push(("fraction of the box", format!("{:.4}", summary.fraction)));
    if let Some(motion) = &summary.motion {
        facts.push(("time", plain(summary.time).to_string()));
        facts.push(("steps", format!("{} of {}", summary.steps, lengths_of_steps(motion.steps))));
    }
    if let Some(accuracy) = &summary.accuracy {
        facts.push(("accuracy asked for", accuracy.asked.to_string()));
        facts.push(("cells per radius", accuracy.cells_per_radius.to_string()));
    }
    facts.extend(summary.lubrication.as_ref().map(|lubrication| ("lubrication films", lubrication.text())));
    facts.extend(summary.inertia.as_ref().map(|inertia| ("inertia", inertia.text())));
    facts.extend(summary.energy.as_ref().map(|energy| ("energy", energy.text())));
    facts.extend(summary.pairs.map(|pairs| ("coordination", format!("{:.3} neighbours of a body", pairs.coordination))));
    Facts { title: "Suspension", facts }
}

fn contact_facts(summary: &Summary) -> Option<Facts> {
    let contact = summary.contact.as_ref()?;
    let mut facts = vec![
        ("model", contact.model.to_owned()),
        ("contacts that bear a force", contact.active.to_string()),
        ("sum of their forces", number(contact.total_force, 5)),
        ("pairs looked at", contact.pairs.to_string()),
    ];
    facts.extend(contact.smallest_gap.map(|gap| ("smallest gap of all steps", format!("{gap:.2e} radii"))));
    facts.extend(contact.kkt_residual.map(|residual| ("largest residual of all steps", format!("{residual:.1e}"))));
    facts.extend(contact.glue.as_ref().map(|glue| ("contacts that stick", glue.stuck.to_string())));
    Some(Facts { title: "Contacts", facts })
}

fn solver_facts(summary: &Summary) -> Option<Facts> {
    let solver = summary.solver.as_ref()?;
    let mut facts = vec![("unknowns", format!("{} on the grid, {} multipliers", solver.grid_unknowns, solver.multiplier_unknowns))];
    facts.push(("Stokes solver", solver.inverse.to_owned()));
    match &summary.motion {
        Some(motion) if motion.solves > 0 => {
            let mean = motion.iterations as f64 / motion.solves as f64;
            facts.push(("solves", format!("{}, of {mean:.1} iterations on average", motion.solves)));
        }
        _ => facts.push(("iterations", format!("{} to a residual of {:.1e}", solver.iterations, solver.residual))),
    }
    facts.extend(solver.faster.map(|faster| ("faster", format!("method.inverse = \"{faster}\" suits this box"))));
    facts.push(("peak memory", format!("{:.0} MB of all ranks", solver.peak_memory_bytes / 1e6)));
    Some(Facts { title: "Solver", facts })
}

/// The viscosity, and the seconds of the run, as sums.
fn parts(summary: &Summary, mean: Option<&MeanViscosity>) -> Vec<Breakdown> {
    let viscosity = summary.viscosity.as_ref().map(|viscosity| match mean {
        Some(mean) => Breakdown { title: "What the mean viscosity is made up of", parts: mean.parts.in_words(), decimals: 4 },
        None => Breakdown { title: "What the viscosity is made up of", parts: viscosity.parts.in_words(), decimals: 4 },
    });
    let seconds = match (&summary.motion, &summary.solver) {
        (Some(motion), _) => {
            let named = [motion.assembly_seconds, motion.solve_seconds, motion.contact_seconds, motion.output_seconds];
            let rest = (motion.seconds - named.iter().sum::<f64>()).max(0.0);
            ["assembly", "flow", "contacts", "files", "rest"].into_iter().zip(named.into_iter().chain([rest])).collect()
        }
        (None, Some(solver)) => vec![
            ("set-up", solver.setup_seconds),
            ("assembly", solver.assembly_seconds),
            ("Stokes solver", solver.inverse_seconds),
            ("matrices", solver.matrix_seconds),
            ("surfaces", solver.body_seconds),
            ("Krylov", solver.krylov_seconds),
        ],
        (None, None) => Vec::new(),
    };
    let seconds = Breakdown { title: "Seconds of wall time", parts: seconds, decimals: 2 };
    viscosity.into_iter().chain([seconds]).filter(|parts| parts.parts.iter().any(|(_, value)| *value != 0.0)).collect()
}
