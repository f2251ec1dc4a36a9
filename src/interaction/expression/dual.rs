//! A value with its derivative in one direction.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value, and its derivative in the direction in which variables change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its derivative.
    pub slope: f64,
}

impl Dual {
    /// A number that does not change.
    pub fn fixed(value: f64) -> Dual {
        Dual { value, slope: 0.0 }
    }

    /// The variable with respect to which derivatives are taken.
    pub fn varying(value: f64) -> Dual {
        Dual { value, slope: 1.0 }
    }

    /// Whether value and derivative are finite.
    pub fn is_finite(&self) -> bool {
        self.value.is_finite() && self.slope.is_finite()
    }

    /// A function of it, of this value and this derivative.
    pub(super) fn chain(self, value: f64, derivative: f64) -> Dual {
        // an infinite derivative does not matter to what does not change
        Dual { value, slope: if self.slope == 0.0 { 0.0 } else { derivative * self.slope } }
    }

    /// It to a power.
    pub(super) fn power(self, exponent: Dual) -> Dual {
        let (base, value) = (self.value, self.value.powf(exponent.value));
        let by_base = self.chain(value, exponent.value * base.powf(exponent.value - 1.0));
        let by_exponent = exponent.chain(value, value * base.ln());
        Dual { value, slope: by_base.slope + by_exponent.slope }
    }
}

impl Neg for Dual {
    type Output = Dual;

    fn neg(self) -> Dual {
        Dual { value: -self.value, slope: -self.slope }
    }
}

impl Add for Dual {
    type Output = Dual;

    fn add(self, other: Dual) -> Dual {
        Dual { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Sub for Dual {
    type Output = Dual;

    fn sub(self, other: Dual) -> Dual {
        self + -other
    }
}

impl Mul for Dual {
    type Output = Dual;

    fn mul(self, other: Dual) -> Dual {
        Dual { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }
}

impl Div for Dual {
    type Output = Dual;

    fn div(self, other: Dual) -> Dual {
        let value = self.value / other.value;
        Dual { value, slope: (self.slope - value * other.slope) / other.value }
    }
}
