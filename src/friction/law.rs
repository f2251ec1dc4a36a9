//! How surfaces rub on each other.

/// How a contact turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// About tangents: in two dimensions about the one axis that there is.
    Rolling,
    /// About the normal, in three dimensions.
    Twisting,
}

/// Friction of a surface, or of a contact: what bounds forces across the normal and couples, by the normal force `r_N` above a critical load `c`.
///
/// `|r_T| <= mu (r_N - c)`, and with the reduced radius `a` (of two bodies `a_1 a_2 / (a_1 + a_2)`, at a wall that of the body) `|M_T| <= a k (r_N - c)` for the
/// couple against rolling, `|M_N| <= a k_n (r_N - c)` for that against twisting; all of them zero below the critical load (Mari, Seto, Morris and Denn 2014,
/// doi:10.1122/1.4890747). Rates of rolling are those of Luding 2008, doi:10.1007/s10035-008-0099-x: `a` times the relative spin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionLaw {
    /// `mu`, a ratio.
    pub coefficient: f64,
    /// `k`, a ratio: a ball at rest on a slope of this tangent does not roll.
    pub rolling: f64,
    /// `k_n`, a ratio, in three dimensions: against spin about the normal.
    pub twisting: f64,
    /// `c`, a force.
    pub critical_load: f64,
    /// Whether a contact that slips opens by `mu |u_T|`, as the convex law has it (Anitescu and Tasora 2010, doi:10.1007/s10589-008-9223-4); by the exact one it
    /// does not.
    pub convex: bool,
}

impl FrictionLaw {
    /// Coulomb's law of a coefficient alone.
    pub fn plain(coefficient: f64) -> FrictionLaw {
        FrictionLaw { coefficient, ..FrictionLaw::default() }
    }

    /// Whether it is Coulomb's law of a coefficient alone.
    pub fn is_plain(&self) -> bool {
        *self == FrictionLaw::plain(self.coefficient)
    }

    /// Whether more than a coefficient and a normal force bounds what a contact bears.
    pub(super) fn has_bounds(&self) -> bool {
        self.turns() || self.critical_load > 0.0
    }

    /// Whether couples resist.
    pub fn turns(&self) -> bool {
        self.rolling > 0.0 || self.twisting > 0.0
    }

    /// The ratio that bounds the couple against a turn.
    pub(super) fn of_turn(&self, turn: Turn) -> f64 {
        match turn {
            Turn::Rolling => self.rolling,
            Turn::Twisting => self.twisting,
        }
    }

    /// That of a contact of two surfaces: of each number the smaller one, and the convex law if one of them has it.
    pub fn with(&self, other: &FrictionLaw) -> FrictionLaw {
        FrictionLaw {
            coefficient: self.coefficient.min(other.coefficient),
            rolling: self.rolling.min(other.rolling),
            twisting: self.twisting.min(other.twisting),
            critical_load: self.critical_load.min(other.critical_load),
            convex: self.convex || other.convex,
        }
    }

    /// That of the larger one of each number.
    pub fn beyond(&self, other: &FrictionLaw) -> FrictionLaw {
        FrictionLaw {
            coefficient: self.coefficient.max(other.coefficient),
            rolling: self.rolling.max(other.rolling),
            twisting: self.twisting.max(other.twisting),
            critical_load: self.critical_load.max(other.critical_load),
            convex: self.convex || other.convex,
        }
    }
}
