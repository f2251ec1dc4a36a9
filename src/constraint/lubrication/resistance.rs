//! The resistance of a pair as numbers that are tabulated.

/// What two near bodies, or a body and a wall, resist, for radius 1 of the first body and unit viscosity; linear in the tractions.
///
/// `approach` is force over velocity; `slip`, `roll` and `cross` are the symmetric matrix of force and torque over slip and
/// roll. `stress` has the symmetric traceless first moments of the tractions on each body: for approach its component along
/// `n n`, for slip and roll along `n t`. `pressure` is less the trace of that moment, which approach alone has: `D` times the volume of a body times the pressure
/// inside, as it is rigid and at rest there.
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
    /// Less the trace of the first moment on the first and second body for a unit of approach.
    pub pressure: [f64; 2],
}

/// How many numbers a [`Resistance`] is.
pub(super) const NUMBERS: usize = 12;

impl Resistance {
    /// Whether a number is of approach.
    pub(super) fn of_approach(number: usize) -> bool {
        matches!(number, 0 | 4 | 5 | 10 | 11)
    }

    pub(super) fn numbers(&self) -> [f64; NUMBERS] {
        let ([[a, b], [c, d], [e, f]], [g, h]) = (self.stress, self.pressure);
        [self.approach, self.slip, self.cross, self.roll, a, b, c, d, e, f, g, h]
    }

    pub(super) fn of([approach, slip, cross, roll, a, b, c, d, e, f, g, h]: [f64; NUMBERS]) -> Resistance {
        Resistance { approach, slip, cross, roll, stress: [[a, b], [c, d], [e, f]], pressure: [g, h] }
    }

    /// What `take` makes of each number of two resistances.
    pub(super) fn with(&self, other: &Resistance, take: impl Fn(f64, f64) -> f64) -> Resistance {
        let (one, two) = (self.numbers(), other.numbers());
        Resistance::of(std::array::from_fn(|place| take(one[place], two[place])))
    }
}
