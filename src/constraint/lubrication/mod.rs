//! Lubrication: the resistance of thin films that a finite number of modes does not see.
//!
//! The resistance of two near bodies computed with modes up to some order depends on the order and not on the grid, and levels off
//! as the gap closes. What is missing, `dR(gap) = R(gap) - R_K(gap)`, is tabulated for two bodies (or a body and a wall) in
//! unbounded fluid, and acts on their motions relative to each other: the idea of Stokesian dynamics (Brady and Bossis 1988,
//! doi:10.1146/annurev.fl.20.010188.000551) with modes instead of moments, on a resolved flow. Truncation takes test velocities away,
//! so `dR` is positive semidefinite.
//!
//! Relative motions of a pair, with `n` from the first to the second, levers `l_i = a_i + gap/2` to the middle of the gap, and
//! a direction `t` across, `b = n x t`:
//!
//! ```text
//! approach  (v_1 - v_2) . n        slip  (v_1 - v_2) . t + (l_1 w_1 + l_2 w_2) . b        roll  (w_1 - w_2) . b
//! ```
//!
//! None of them changes when both move as one rigid body, so that forces are opposite and have no net torque. Spin about `n` is left out:
//! its resistance stays finite.

mod axisymmetric;
mod exact;
mod film;
mod pair;
mod ratios;
mod resistance;
mod resolved;
mod table;
mod wall;

pub use film::{LubricationPair, LubricationPairs, Opposite, RelativeMode, Wall, approach, films, resolved_at_walls};
use resistance::NUMBERS;
pub use resistance::Resistance;
pub use table::{FilmTable, FilmTables};
