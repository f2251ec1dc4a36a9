//! A contact as a row block of a program with friction.

/// No body, or one that does not give way.
pub const NONE: usize = usize::MAX;

/// A contact, or what turns one against its friction: two bodies at most, of `W` unknowns each, and `D` rows.
#[derive(Debug, Clone)]
pub struct RowBlock<const D: usize, const W: usize> {
    /// Places of its bodies among those that give way; the first is there.
    pub ends: [usize; 2],
    /// Rows of `A` for each of them.
    pub rows: [[[f64; W]; D]; 2],
    /// `q`.
    pub offset: [f64; D],
    /// The coefficient of friction in these rows.
    pub friction: f64,
    /// How fast a contact opens over how fast it slips: 0 by the exact law, the coefficient by the convex one.
    pub dilation: f64,
    /// What an impulse in these rows is divided by to have the unit of momentum: the norms of the rows before.
    pub norms: [f64; D],
}

impl<const D: usize, const W: usize> RowBlock<D, W> {
    /// The same without tangential rows: no force moves anything along them, and the coefficient does not matter.
    pub fn without_friction(mut self) -> Self {
        self.rows.iter_mut().for_each(|rows| rows[1..].fill([0.0; W]));
        self.offset[1..].fill(0.0);
        RowBlock { friction: 1.0, dilation: 0.0, ..self }
    }

    /// Divides rows by factors, the same for all tangents.
    pub fn scale(&mut self, factors: &[f64; D]) {
        for (axis, factor) in factors.iter().enumerate() {
            self.rows.iter_mut().for_each(|rows| rows[axis].iter_mut().for_each(|entry| *entry /= factor));
            self.offset[axis] /= factor;
            self.norms[axis] *= factor;
        }
        self.friction *= factors[1] / factors[0];
        self.dilation *= factors[1] / factors[0];
    }

    /// The bodies that give way, with their rows.
    pub fn sides(&self) -> impl Iterator<Item = (usize, &[[f64; W]; D])> {
        self.ends.into_iter().zip(&self.rows).filter(|(end, _)| *end != NONE)
    }

    /// `A x` of this contact.
    pub fn rates(&self, motion: &[[f64; W]]) -> [f64; D] {
        let mut rates = [0.0; D];
        for (body, rows) in self.sides() {
            for (rate, row) in rates.iter_mut().zip(rows) {
                *rate += row.iter().zip(&motion[body]).map(|(entry, moved)| entry * moved).sum::<f64>();
            }
        }
        rates
    }

    /// Adds `A^T r` of this contact.
    pub fn push(&self, force: &[f64; D], motion: &mut [[f64; W]]) {
        for (body, rows) in self.sides() {
            for (force, row) in force.iter().zip(rows) {
                motion[body].iter_mut().zip(row).for_each(|(moved, entry)| *moved += force * entry);
            }
        }
    }
}
