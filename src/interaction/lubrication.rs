//! Lubrication, pair by pair: what the modes of the multipliers miss of the films between near bodies and walls.

use std::fmt;

use super::{Interaction, PairResistance};
use crate::{
    constraint::{
        MultiplierLayout, Neighbourhood,
        lubrication::{FilmTables, LubricationPairs, approach, films, resolved_at_walls},
    },
    contact::Contact,
};

/// LubricationPairs whose resistance is tabulated ([`lubrication`](crate::constraint::lubrication)).
pub struct Lubrication {
    /// Gap, in radii of the smaller body, below which none counts as smaller.
    pub roughness: f64,
    tables: FilmTables,
}

impl Lubrication {
    /// Films between surfaces of this roughness, in radii of the smaller body.
    pub fn new(roughness: f64) -> Lubrication {
        Lubrication { roughness, tables: FilmTables::default() }
    }
}

impl fmt::Debug for Lubrication {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Lubrication").field("roughness", &self.roughness).finish_non_exhaustive()
    }
}

impl<const D: usize> Interaction<D> for Lubrication {
    fn name(&self) -> &'static str {
        "lubrication"
    }

    fn describe(&self) -> String {
        let (roughness, pores) = (self.roughness, if D == 2 { " and the pores between them" } else { "" });
        format!(
            "resistance of lubrication films that modes do not resolve, pair by pair, walls included; no gap below {roughness} radii; \
             one sparse matrix of the bodies' motions{pores} preconditions it"
        )
    }

    fn resistance(&self) -> Option<&dyn PairResistance<D>> {
        Some(self)
    }
}

impl<const D: usize> PairResistance<D> for Lubrication {
    fn rows(&self, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> LubricationPairs<D> {
        films(neighbourhood, layout, &self.tables, self.roughness)
    }

    fn approach(&self, contact: &Contact<D>, of: &dyn Fn(usize) -> (f64, usize)) -> f64 {
        approach::<D>(&self.tables, of(contact.body), contact.other().map(of), contact.gap, self.roughness).unwrap_or(0.0)
    }

    fn resolved_at_walls(&self, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> LubricationPairs<D> {
        resolved_at_walls(neighbourhood, layout, &self.tables)
    }
}
