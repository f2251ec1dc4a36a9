//! One configuration of bodies, whose flow is to be found.

use nalgebra::{SMatrix, SVector};

use super::resolved::Setup;
use crate::{body::Row, interaction::Wrench};

/// Where the bodies of a suspension are, and what is known of that instant.
#[derive(Debug, Clone, Copy)]
pub struct Configuration<'a, const D: usize> {
    /// Centres of all bodies.
    pub centers: &'a [SVector<f64, D>],
    /// How bodies are turned from how they started; none if empty.
    pub rotations: &'a [SMatrix<f64, D, D>],
    /// The time, to which the last solution is extrapolated.
    pub time: f64,
    /// Contacts that are held: their forces are unknowns.
    pub contacts: &'a [Row<D>],
    /// Where the solve starts with the forces of contacts.
    pub contact_guess: &'a [f64],
    /// Springs and welds: their forces are unknowns.
    pub bonds: &'a [Row<D>],
    /// Forces and torques on all bodies besides those of the setup; none if empty.
    pub pushes: &'a [Wrench<D>],
    /// Relative residual at which the solve ends.
    pub tolerance: f64,
}

impl<'a, const D: usize> Configuration<'a, D> {
    /// That in which bodies are at these centres and none touches, in the box of a setup as it is.
    pub fn at_rest(setup: &Setup<D>, centers: &'a [SVector<f64, D>], bonds: &'a [Row<D>]) -> Self {
        Configuration { bonds, ..Configuration::new(centers, setup.domain.time(), setup.tolerance.at_an_instant()) }
    }

    /// Bodies with these centres at a time, unturned, on which nothing acts but what the setup has.
    pub fn new(centers: &'a [SVector<f64, D>], time: f64, tolerance: f64) -> Self {
        Configuration { centers, rotations: &[], time, contacts: &[], contact_guess: &[], bonds: &[], pushes: &[], tolerance }
    }
}
