//! What all steps of a run together cost and kept; a checkpoint carries it on.

use std::{collections::BTreeMap, time::Instant};

use crate::{
    contact::{FrictionReport, KktReport, Solver},
    error::{Offer, Refusal, Result},
    motion::{Effort, Observation, StepReport},
    output::MotionSummary,
};

/// The statistics of a run, from its start or from those of the run it goes on with.
#[derive(Clone)]
pub struct RunStatistics {
    /// Steps and what they cost, without the time that runs.
    motion: MotionSummary,
    /// Smallest gap of all steps, infinite if no two came near each other.
    smallest_gap: f64,
    kkt_residual: f64,
    /// Largest residual of friction of all steps, and the number of those in which it was not found to the tolerance.
    friction_residual: f64,
    friction_missed: usize,
    last: Option<StepReport>,
    since: Instant,
}

/// How contacts were kept in a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeptContacts {
    /// Pairs that the contact model looked at in the last step.
    pub pairs: usize,
    /// Smallest gap of all steps; nothing if no two came near each other.
    pub smallest_gap: Option<f64>,
    /// Largest residual of the optimality conditions of all steps.
    pub kkt_residual: f64,
    /// Largest residual of the law of friction of all steps, and the number of steps above the tolerance.
    pub friction: (f64, usize),
}

/// Numbers that checkpoints of older versions lack; they are zero there.
const LATER: [&str; 7] =
    ["contacts", "island_contacts", "halved", "friction_residual", "friction_missed", "last.largest_island", "last.halvings"];

/// A number of the statistics, to read or to write.
enum Number<'a> {
    Count(&'a mut usize),
    Real(&'a mut f64),
    Solver(&'a mut Solver),
}
use Number::{Count, Real};

impl RunStatistics {
    /// Nothing yet.
    pub fn new() -> RunStatistics {
        let motion = MotionSummary::default();
        let (friction_residual, friction_missed) = (0.0, 0);
        let (last, since) = (None, Instant::now());
        RunStatistics { motion, smallest_gap: f64::INFINITY, kkt_residual: 0.0, friction_residual, friction_missed, last, since }
    }

    /// Adds a step and the look before it.
    pub fn add<const D: usize>(&mut self, observation: &Observation<D>, report: &StepReport) {
        let (motion, effort) = (&mut self.motion, observation.effort + report.effort);
        let [shortest, longest] = motion.steps;
        let before = self.last.map(|last| last.length);
        motion.steps = if before.is_none() { [report.length; 2] } else { [shortest.min(report.length), longest.max(report.length)] };
        motion.grown += usize::from(before.is_some_and(|last| report.length > last * (1.0 + 1e-9)));
        motion.shrunk += usize::from(before.is_some_and(|last| report.length < last * (1.0 - 1e-9)));
        motion.halved += report.halvings;
        add_effort(motion, &effort);
        if let Some(kkt_report) = report.kkt_report {
            self.smallest_gap = self.smallest_gap.min(kkt_report.smallest_gap);
            self.kkt_residual = self.kkt_residual.max(kkt_report.kkt_residual);
            motion.contacts += kkt_report.pairs;
            motion.island_contacts += kkt_report.largest_island;
            let friction = kkt_report.friction.unwrap_or_default();
            self.friction_residual = self.friction_residual.max(friction.residual);
            self.friction_missed += usize::from(friction.residual > friction.tolerance);
        }
        self.last = Some(*report);
    }

    /// The last step.
    pub fn last(&self) -> Option<&StepReport> {
        self.last.as_ref()
    }

    /// Steps and costs, with the seconds until now.
    pub fn motion(&self) -> MotionSummary {
        MotionSummary { seconds: self.motion.seconds + self.since.elapsed().as_secs_f64(), ..self.motion.clone() }
    }

    /// Steps and costs of a run that ends with a last look.
    pub fn motion_to<const D: usize>(&self, last: &Observation<D>) -> MotionSummary {
        let mut motion = self.motion();
        add_effort(&mut motion, &last.effort);
        motion
    }

    /// Adds seconds spent on files.
    pub fn add_output(&mut self, seconds: f64) {
        self.motion.output_seconds += seconds;
    }

    /// How contacts were kept.
    pub fn contacts(&self) -> KeptContacts {
        KeptContacts {
            pairs: self.last.and_then(|last| last.kkt_report).map_or(0, |kkt_report| kkt_report.pairs),
            smallest_gap: Some(self.smallest_gap).filter(|gap| gap.is_finite()),
            kkt_residual: self.kkt_residual,
            friction: (self.friction_residual, self.friction_missed),
        }
    }

    /// A line `name = number` for each number until now, from which [`read`](RunStatistics::read) makes them again to the last digit.
    pub fn text(&self) -> String {
        let line = |(name, number)| match number {
            Count(count) => format!("{name} = {count}\n"),
            Real(real) => format!("{name} = {real:?}\n"),
            Number::Solver(solver) => format!("{name} = {}\n", *solver as usize),
        };
        RunStatistics { motion: self.motion(), ..self.clone() }.numbers().into_iter().map(line).collect()
    }

    /// The statistics of a run that goes on.
    ///
    /// # Errors
    /// The text holds none.
    pub fn read(text: &str) -> Result<RunStatistics> {
        let lines: BTreeMap<&str, &str> = text.lines().filter_map(|line| line.split_once(" = ")).collect();
        let mut statistics = RunStatistics::new();
        statistics.last = lines.contains_key("last.length").then(|| StepReport {
            length: 0.0,
            kkt_report: lines.contains_key("last.pairs").then(|| KktReport {
                friction: lines.contains_key("last.friction_residual").then(FrictionReport::default),
                ..KktReport::of_forces::<2>(&[], &[])
            }),
            effort: Effort::default(),
            halvings: 0,
        });
        let read = |(name, number): (&str, Number)| {
            let Some(text) = lines.get(name) else { return LATER.contains(&name).then_some(()) };
            match number {
                Count(count) => *count = text.parse().ok()?,
                Real(real) => *real = text.parse().ok()?,
                Number::Solver(solver) => *solver = *Solver::ALL.get(text.parse::<usize>().ok()?)?,
            }
            Some(())
        };
        let whole = statistics.numbers().into_iter().try_for_each(read);
        let misfit =
            || Refusal::from("the checkpoint's statistics are none; resume from another checkpoint".to_owned()).offering(Offer::Anew);
        whole.map(|()| statistics).ok_or_else(misfit)
    }

    /// Every number by its name.
    fn numbers(&mut self) -> Vec<(&'static str, Number<'_>)> {
        let [shortest, longest] = &mut self.motion.steps;
        let mut numbers = vec![
            ("shortest_step", Real(shortest)),
            ("longest_step", Real(longest)),
            ("grown", Count(&mut self.motion.grown)),
            ("shrunk", Count(&mut self.motion.shrunk)),
            ("halved", Count(&mut self.motion.halved)),
            ("solves", Count(&mut self.motion.solves)),
            ("iterations", Count(&mut self.motion.iterations)),
            ("seconds", Real(&mut self.motion.seconds)),
            ("assembly_seconds", Real(&mut self.motion.assembly_seconds)),
            ("solve_seconds", Real(&mut self.motion.solve_seconds)),
            ("contact_seconds", Real(&mut self.motion.contact_seconds)),
            ("output_seconds", Real(&mut self.motion.output_seconds)),
            ("contacts", Count(&mut self.motion.contacts)),
            ("island_contacts", Count(&mut self.motion.island_contacts)),
            ("smallest_gap", Real(&mut self.smallest_gap)),
            ("kkt_residual", Real(&mut self.kkt_residual)),
            ("friction_residual", Real(&mut self.friction_residual)),
            ("friction_missed", Count(&mut self.friction_missed)),
        ];
        let Some(StepReport { length, kkt_report, effort, halvings }) = &mut self.last else { return numbers };
        numbers.extend([
            ("last.length", Real(length)),
            ("last.halvings", Count(halvings)),
            ("last.solves", Count(&mut effort.solves)),
            ("last.iterations", Count(&mut effort.iterations)),
            ("last.assembly", Real(&mut effort.assembly)),
            ("last.solving", Real(&mut effort.solving)),
            ("last.contact", Real(&mut effort.contact)),
        ]);
        numbers.extend(kkt_report.as_mut().map_or(Vec::new(), of_contacts));
        numbers
    }
}

fn add_effort(motion: &mut MotionSummary, effort: &Effort) {
    motion.solves += effort.solves;
    motion.iterations += effort.iterations;
    motion.assembly_seconds += effort.assembly;
    motion.solve_seconds += effort.solving;
    motion.contact_seconds += effort.contact;
}

fn of_contacts(kept: &mut KktReport) -> Vec<(&'static str, Number<'_>)> {
    let mut numbers = vec![
        ("last.pairs", Count(&mut kept.pairs)),
        ("last.active", Count(&mut kept.active)),
        ("last.smallest_gap", Real(&mut kept.smallest_gap)),
        ("last.kkt_residual", Real(&mut kept.kkt_residual)),
        ("last.total_force", Real(&mut kept.total_force)),
        ("last.contact_iterations", Count(&mut kept.iterations)),
        ("last.contact_solver", Number::Solver(&mut kept.solver)),
        ("last.islands", Count(&mut kept.islands)),
        ("last.rounds", Count(&mut kept.rounds)),
        ("last.largest_island", Count(&mut kept.largest_island)),
    ];
    numbers.extend(kept.friction.as_mut().map_or(Vec::new(), of_friction));
    numbers
}

fn of_friction(friction: &mut FrictionReport) -> Vec<(&'static str, Number<'_>)> {
    vec![
        ("last.friction_residual", Real(&mut friction.residual)),
        ("last.sticking", Count(&mut friction.sticking)),
        ("last.slipping", Count(&mut friction.slipping)),
        ("last.contact_work", Real(&mut friction.work)),
        ("last.sweeps", Count(&mut friction.sweeps)),
        ("last.friction_iterations", Count(&mut friction.iterations)),
    ]
}

impl Default for RunStatistics {
    fn default() -> RunStatistics {
        RunStatistics::new()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::error::Error;

    #[test]
    fn statistics_are_read_back_to_the_last_digit() {
        let mut kkt_report = KktReport::of_forces::<2>(&[], &[]);
        (kkt_report.kkt_residual, kkt_report.solver) = (0.1 + 0.2, Solver::ALL[1]);
        let friction = Some(FrictionReport { residual: 1.0 / 7.0, sticking: 3, ..FrictionReport::default() });
        for kkt_report in [None, Some(kkt_report), Some(KktReport { friction, ..kkt_report })] {
            let last = Some(StepReport { length: 1.0 / 3.0, kkt_report, effort: Effort { solves: 2, ..Effort::default() }, halvings: 1 });
            let statistics = RunStatistics { last, ..RunStatistics::new() };
            let again = RunStatistics::read(&statistics.text()).unwrap();
            assert_eq!((again.last, again.smallest_gap), (statistics.last, f64::INFINITY));
        }
        for text in ["", "grown = 1\n"] {
            assert!(matches!(RunStatistics::read(text), Err(Error::Refused(_))));
        }
    }
}
