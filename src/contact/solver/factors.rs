//! The factors of `I + A^T W A` for any weights of the constraints of a program: one rank's, or those that all ranks share.

use super::{cholesky::Cholesky, program::Program, shared_factors::SharedFactors};

/// The factors.
pub enum Factors<'a> {
    /// Of a program that one rank has.
    Alone(Cholesky<'a>),
    /// Of a program that ranks share.
    Shared(SharedFactors<'a>),
}

impl<'a> Factors<'a> {
    /// Analyses a program; nothing is factored yet.
    pub fn new(program: &'a Program<'a>) -> Self {
        match program.sharing {
            None => Factors::Alone(Cholesky::new(program)),
            Some(sharing) => Factors::Shared(SharedFactors::new(program, sharing)),
        }
    }

    /// Factors the matrix of these weights.
    pub fn factor(&mut self, weights: &[f64]) {
        match self {
            Factors::Alone(factors) => factors.factor(weights),
            Factors::Shared(factors) => factors.factor(weights),
        }
    }

    /// Turns a right-hand side into the solution.
    pub fn solve(&mut self, vector: &mut [f64]) {
        match self {
            Factors::Alone(factors) => factors.solve(vector),
            Factors::Shared(factors) => factors.solve(vector),
        }
    }
}
