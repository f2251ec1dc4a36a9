//! The force on the fluid inside a body that spins up.
//!
//! What rotates rigidly ever faster needs the force `rho w' x r` inside, which no pressure bears. The torque on a free body says how fast it spins up,
//! `I w' = -(torque on the fluid)`: so the force goes with its rotation modes.

use nalgebra::SVector;

use super::{
    blocks::rotations,
    body::InteriorBlocks,
    places::{EntriesMut, Places},
};
use crate::{body::planes, linalg::dot, surface::unit_rotation};

/// The force inside one body: unknowns, each with the force of unit spin-ups there.
pub struct InteriorForce {
    unknowns: Vec<usize>,
    places: Vec<u32>,
    /// One a plane for each unknown.
    forces: Vec<f64>,
    /// Spin-up of a unit multiplier of rotation.
    factor: f64,
}

impl InteriorForce {
    /// None yet, for a body with this spin-up `rho w' / mu` of a unit multiplier of rotation.
    pub fn new(factor: f64) -> InteriorForce {
        InteriorForce { unknowns: Vec::new(), places: Vec::new(), forces: Vec::new(), factor }
    }

    /// The spin-up of a unit multiplier of rotation.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Adds an unknown, a component of the velocity at an offset from the centre, of whose cell a part is inside.
    pub fn push<const D: usize>(&mut self, unknown: usize, component: usize, offset: &SVector<f64, D>, part: f64) {
        self.unknowns.push(unknown);
        self.forces.extend((0..planes::<D>().len()).map(|plane| part * unit_rotation(plane, offset.as_slice(), component)));
    }

    /// Finds the places of the unknowns.
    pub fn plan(&mut self, places: &mut Places) {
        self.places = places.each(&self.unknowns);
    }

    /// `rows += factor *` the force of known spin-ups, one for each plane.
    pub fn add(&self, factor: f64, spin_up: &[f64], rows: &mut EntriesMut) {
        if spin_up.iter().all(|spin_up| *spin_up == 0.0) {
            return;
        }
        for (place, force) in self.places.iter().zip(self.forces.chunks_exact(spin_up.len())) {
            *rows.at(*place) += factor * dot(force, spin_up);
        }
    }

    /// `rows += factor *` the force that goes with the rotation modes among the multipliers of the body.
    pub fn add_of_rotations<const D: usize>(&self, factor: f64, c: &[f64], rows: &mut EntriesMut) {
        self.add(factor * self.factor, &c[rotations::<D>()], rows);
    }
}

impl InteriorBlocks for InteriorForce {
    fn spin_up_of_rotation(&self) -> f64 {
        self.factor()
    }

    fn spread_spin_up(&self, factor: f64, spin_up: &[f64], rows: &mut EntriesMut) {
        self.add(factor, spin_up, rows);
    }
}
