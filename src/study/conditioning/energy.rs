//! The error of conjugate gradients in the energy norm after each iteration, without solving twice.
//!
//! With step lengths `alpha_k = (r_k, P r_k) / (p_k, A p_k)`, the error loses `alpha_k (r_k, P r_k)` of its squared energy at step k
//! (Hestenes & Stiefel 1952; Strakos & Tichy 2002 show that rounding leaves this true). The system sees all four vectors pass;
//! the error that is left at the end is the only one to be computed from a known solution.

use std::time::Instant;

use crate::{
    error::Result,
    petsc::{Matrix, System, Vector},
};

/// An approximate inverse, or none.
pub type InverseOperator = Box<dyn Fn(&Vector, &mut Vector) -> Result<()>>;

/// A matrix and its approximate inverse that keep account of energy and time as conjugate gradients use them.
pub struct EnergyMonitor<'a> {
    matrix: &'a Matrix,
    inverse: InverseOperator,
    start: Instant,
    /// Seconds that the account itself took.
    own_seconds: f64,
    /// `(r, P r)` of a step under way.
    pending: Option<f64>,
    steps: Vec<Step>,
}

/// A step of conjugate gradients.
struct Step {
    /// Squared energy that it took from the error.
    gain: f64,
    /// Seconds from the start of the solve to its end.
    seconds: f64,
}

/// Errors and seconds, from before the first step to after the last.
pub struct History {
    /// Energy norms of the error over that of the solution.
    pub errors: Vec<f64>,
    /// Seconds so far.
    pub seconds: Vec<f64>,
}

impl<'a> EnergyMonitor<'a> {
    /// A system at the start of its solve.
    pub fn new(matrix: &'a Matrix, inverse: InverseOperator) -> EnergyMonitor<'a> {
        EnergyMonitor { matrix, inverse, start: Instant::now(), own_seconds: 0.0, pending: None, steps: Vec::new() }
    }

    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64() - self.own_seconds
    }

    /// A scalar product that the account is charged for.
    fn product(&mut self, one: &Vector, other: &Vector) -> Result<f64> {
        let start = Instant::now();
        let product = one.dot(other)?;
        self.own_seconds += start.elapsed().as_secs_f64();
        Ok(product)
    }

    /// What happened, when the error was known to have the squared energy `left` in the end and that of the solution is `whole`.
    pub fn history(self, left: f64, whole: f64) -> History {
        let mut energy = left;
        let mut errors = vec![energy];
        for step in self.steps.iter().rev() {
            energy += step.gain;
            errors.push(energy);
        }
        let errors = errors.into_iter().rev().map(|energy| (energy / whole).sqrt()).collect();
        History { errors, seconds: std::iter::once(0.0).chain(self.steps.iter().map(|step| step.seconds)).collect() }
    }
}

impl System for EnergyMonitor<'_> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.matrix.multiply(input, output)?;
        // the first product is that of the initial guess, before any residual
        if let Some(product) = self.pending.take() {
            let curvature = self.product(input, output)?;
            self.steps.push(Step { gain: product * product / curvature, seconds: 0.0 });
        }
        Ok(())
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let seconds = self.seconds();
        if let Some(step) = self.steps.last_mut() {
            step.seconds = seconds;
        }
        (self.inverse)(input, output)?;
        self.pending = Some(self.product(input, output)?);
        Ok(())
    }
}
