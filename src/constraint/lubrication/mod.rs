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
mod table;
mod wall;

pub use film::{
    LubricationPair, LubricationPairs, Opposite, REACH, RelativeMode, RigidFunctional, Wall, approach, films, resolved_at_walls,
};
pub use table::{FilmTable, FilmTables};

/// What two near bodies, or a body and a wall, resist, for radius 1 of the first body and unit viscosity; linear in the tractions.
///
/// `approach` is force over velocity; `slip`, `roll` and `cross` are the symmetric matrix of force and torque over slip and
/// roll. `stress` has the symmetric traceless first moments of the tractions on each body: for approach its component along
/// `n n`, for slip and roll along `n t`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Resistance {
    /// Against approach.
    pub approach: f64,
    /// Against slip.
    pub slip: f64,
    /// Between slip and roll.
    pub cross: f64,
    /// Against roll.
    pub roll: f64,
    /// First moments on the first and second body for a unit of approach, of slip and of roll.
    pub stress: [[f64; 2]; 3],
}

/// How many numbers a [`Resistance`] is.
const NUMBERS: usize = 10;

impl Resistance {
    fn numbers(&self) -> [f64; NUMBERS] {
        let [[a, b], [c, d], [e, f]] = self.stress;
        [self.approach, self.slip, self.cross, self.roll, a, b, c, d, e, f]
    }

    fn of([approach, slip, cross, roll, a, b, c, d, e, f]: [f64; NUMBERS]) -> Resistance {
        Resistance { approach, slip, cross, roll, stress: [[a, b], [c, d], [e, f]] }
    }

    /// What `take` makes of each number of two resistances.
    fn with(&self, other: &Resistance, take: impl Fn(f64, f64) -> f64) -> Resistance {
        let (one, two) = (self.numbers(), other.numbers());
        Resistance::of(std::array::from_fn(|place| take(one[place], two[place])))
    }
}
