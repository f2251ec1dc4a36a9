//! Experiment.

mod energy;
mod fit;
mod laplacian;
mod multipliers;

use crate::{error::Result, petsc::Session};
use laplacian::{Method, Problem, exact_eigenvalues};

/// Finest grids of the study, in cells per side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConditioningRange {
    /// In 2D.
    pub finest_2d: usize,
    /// In 3D.
    pub finest_3d: usize,
}

/// X.
pub fn conditioning(session: &Session, range: &ConditioningRange) -> Result<()> {
    for m in Method::ALL {
        for n in [16, 32, 64, 128, 256, 512] { if n <= range.finest_2d { row::<2>(session, n, m)?; } }
        for n in [8, 16, 32, 64, 96] { if n <= range.finest_3d { row::<3>(session, n, m)?; } }
    }
    if session.world().rank()==0 { println!("{:?}", fit::exponent(&[])); }
    for r in multipliers::constrained(session)? { if session.world().rank()==0 { println!("{r:?}"); } }
    Ok(())
}

#[allow(clippy::print_stdout)]
fn row<const D: usize>(session: &Session, n: usize, m: Method) -> Result<()> {
    let p = Problem::<D>::new(session, n)?;
    let s = p.solve(m)?;
    let (a, b) = exact_eigenvalues(D, n);
    if session.world().rank() == 0 {
    println!("{D} {n:4} {:20} its {:5}/{:5} kappa {:10.3} exact {:10.3} l {:.4e} {:.4e} {:.4e} setup {:.4} solve {:.4} MB {:.3} mat {:.3} bound {:.3} first {:.9}", m.name(), s.iterations, s.errors.len()-1, s.condition, b/a, s.smallest, s.largest, b, s.setup_seconds, s.solve_seconds, s.bytes/1e6, s.matrix_bytes/1e6, s.bound_taken, s.errors[0]);
    }
    Ok(())
}
