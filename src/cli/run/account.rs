//! What all steps of a run together cost and kept; a checkpoint carries it on.

use std::time::Instant;

use crate::{
    contact::{Certificate, Solver},
    error::{Error, Result},
    output::MotionSummary,
    simulation::{Effort, StepReport, View},
};

/// The account of a run, from its start or from that of the run it goes on with.
pub struct Account {
    /// Steps and what they cost, without the time that runs.
    motion: MotionSummary,
    /// Smallest gap of all steps, infinite if no two came near each other.
    smallest_gap: f64,
    kkt_residual: f64,
    last: Option<StepReport>,
    since: Instant,
}

impl Account {
    /// Nothing yet.
    pub fn new() -> Account {
        Account { motion: MotionSummary::default(), smallest_gap: f64::INFINITY, kkt_residual: 0.0, last: None, since: Instant::now() }
    }

    /// Adds a step and the look before it.
    pub fn add<const D: usize>(&mut self, view: &View<D>, report: &StepReport) {
        let (motion, effort) = (&mut self.motion, view.effort + report.effort);
        let [shortest, longest] = motion.steps;
        let before = self.last.map(|last| last.length);
        motion.steps = if before.is_none() { [report.length; 2] } else { [shortest.min(report.length), longest.max(report.length)] };
        motion.grown += usize::from(before.is_some_and(|last| report.length > last * (1.0 + 1e-9)));
        motion.shrunk += usize::from(before.is_some_and(|last| report.length < last * (1.0 - 1e-9)));
        motion.solves += effort.solves;
        motion.iterations += effort.iterations;
        motion.assembly_seconds += effort.assembly;
        motion.solve_seconds += effort.solving;
        motion.contact_seconds += effort.contact;
        if let Some(certificate) = report.certificate {
            self.smallest_gap = self.smallest_gap.min(certificate.smallest_gap);
            self.kkt_residual = self.kkt_residual.max(certificate.kkt_residual);
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

    /// Adds seconds spent on files.
    pub fn add_output(&mut self, seconds: f64) {
        self.motion.output_seconds += seconds;
    }

    /// Pairs of the last step, and smallest gap (if any) and largest residual of all steps.
    pub fn contacts(&self) -> (usize, Option<f64>, f64) {
        let pairs = self.last.and_then(|last| last.certificate).map_or(0, |certificate| certificate.pairs);
        (pairs, Some(self.smallest_gap).filter(|gap| gap.is_finite()), self.kkt_residual)
    }

    /// The numbers from which [`from_numbers`](Account::from_numbers) makes it again.
    pub fn numbers(&self) -> Vec<f64> {
        let MotionSummary {
            steps: [shortest, longest],
            grown,
            shrunk,
            solves,
            iterations,
            seconds,
            assembly_seconds,
            solve_seconds,
            contact_seconds,
            output_seconds,
        } = self.motion();
        let counts = [grown, shrunk, solves, iterations].map(|count| count as f64);
        let costs = [seconds, assembly_seconds, solve_seconds, contact_seconds, output_seconds];
        let kept = [self.smallest_gap, self.kkt_residual];
        let mut numbers = [&[shortest, longest][..], &counts, &costs, &kept].concat();
        if let Some(StepReport { length, certificate, effort }) = self.last {
            let Effort { solves, iterations, assembly, solving, contact } = effort;
            numbers.extend([length, solves as f64, iterations as f64, assembly, solving, contact]);
            if let Some(Certificate { pairs, active, smallest_gap, kkt_residual, total_force, iterations, solver, islands, rounds }) =
                certificate
            {
                numbers.extend([smallest_gap, kkt_residual, total_force]);
                numbers.extend([pairs, active, iterations, solver as usize, islands, rounds].map(|count| count as f64));
            }
        }
        numbers
    }

    /// The account of a run that goes on.
    ///
    /// # Errors
    /// These are not the numbers of an account.
    pub fn from_numbers(numbers: &[f64]) -> Result<Account> {
        let misfit = || Error::Refused("the checkpoint's account is not one; start anew with turbid run".into());
        let (first, rest) = numbers.split_first_chunk::<13>().ok_or_else(misfit)?;
        let [shortest, longest, grown, shrunk, solves, iterations, rest_of_motion @ .., smallest_gap, kkt_residual] = *first;
        let [seconds, assembly_seconds, solve_seconds, contact_seconds, output_seconds] = rest_of_motion;
        let [grown, shrunk, solves, iterations] = [grown, shrunk, solves, iterations].map(|count| count as usize);
        let motion = MotionSummary {
            steps: [shortest, longest],
            grown,
            shrunk,
            solves,
            iterations,
            seconds,
            assembly_seconds,
            solve_seconds,
            contact_seconds,
            output_seconds,
        };
        let last = match rest.split_first_chunk::<6>() {
            None if rest.is_empty() => None,
            None => return Err(misfit()),
            Some((&[length, solves, iterations, assembly, solving, contact], of_contacts)) => {
                let effort = Effort { solves: solves as usize, iterations: iterations as usize, assembly, solving, contact };
                Some(StepReport { length, certificate: certificate(of_contacts).ok_or_else(misfit)?, effort })
            }
        };
        Ok(Account { motion, smallest_gap, kkt_residual, last, since: Instant::now() })
    }
}

/// The certificate of a step, if it had one; nothing if the numbers are not those of one.
fn certificate(numbers: &[f64]) -> Option<Option<Certificate>> {
    match *numbers {
        [] => Some(None),
        [smallest_gap, kkt_residual, total_force, pairs, active, iterations, solver, islands, rounds] => {
            let [pairs, active, iterations, solver, islands, rounds] =
                [pairs, active, iterations, solver, islands, rounds].map(|count| count as usize);
            let solver = *Solver::ALL.get(solver)?;
            Some(Some(Certificate { pairs, active, smallest_gap, kkt_residual, total_force, iterations, solver, islands, rounds }))
        }
        _ => None,
    }
}
