//! What one body adds to the linear system, whatever the method.

use std::rc::Rc;

use nalgebra::{SMatrix, SVector};

use super::{
    layout::MultiplierLayout,
    places::{Entries, EntriesMut, Places},
};
use crate::surface::SurfaceTable;

/// The blocks C, J and E of one body. Places are those of the last [`plan`](Self::plan).
pub trait BodyBlocks<const D: usize> {
    /// Number of its multipliers.
    fn count(&self) -> usize;

    /// Finds the places of all that is touched.
    fn plan(&mut self, layout: &MultiplierLayout, plans: &mut Plans);

    /// `rows += factor * C c`; `scratch` may hold anything.
    fn spread(&self, factor: f64, c: &[f64], scratch: &mut Vec<f64>, rows: &mut EntriesMut);

    /// Writes `J u`, before it is projected on the modes of a surface; `scratch` may hold anything.
    fn read(&self, u: Entries, walls: Walls, scratch: &mut Vec<f64>, out: &mut [f64]);

    /// What its rows are.
    fn rows(&self) -> BodyRows<'_, D>;

    /// Adds to what is read the part of `E c` that is to be projected on the modes with it, with the multipliers of all as this rank sees them.
    fn add_at_points(&self, _all: Entries, _out: &mut [f64]) {}

    /// `out += E c` but for that part, with the multipliers of this body and those of all as this rank sees them.
    fn add_local(&self, _own: &[f64], _all: Entries, _out: &mut [f64]) {}

    /// What moves inside it, with inertia.
    fn interior(&self) -> Option<&dyn InteriorBlocks> {
        None
    }

    /// What the rows make of a velocity, or of a scalar in the place of its first component, known at each offset from the centre.
    fn coefficients(&self, known: &dyn Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64>;

    /// First moment `integral of F_i r_j` of what multipliers do.
    fn first_moment(&self, c: &[f64]) -> SMatrix<f64, D, D>;

    /// Adds what multipliers exert directly on the lower and the upper wall across each axis.
    fn add_on_walls(&self, _c: &[f64], _forces: &mut WallForces<D>) {}

    /// Memory that the assembly of another body can use again.
    fn into_memory(self: Box<Self>) -> Vec<Vec<f32>> {
        Vec::new()
    }
}

/// What the rows of a body are.
pub enum BodyRows<'a, const D: usize> {
    /// Velocities at the points of a surface, which have to be projected on its modes.
    Surface(&'a Rc<SurfaceTable<D>>),
    /// Equations of their own, with an approximate inverse of the diagonal block in those that are not rigid, if there is one.
    Own(Option<&'a Rc<dyn FreeInverse>>),
}

impl<'a, const D: usize> BodyRows<'a, D> {
    /// The surface on whose modes what is read has to be projected.
    pub fn surface(&self) -> Option<&'a Rc<SurfaceTable<D>>> {
        match self {
            BodyRows::Surface(surface) => Some(surface),
            BodyRows::Own(_) => None,
        }
    }
}

/// What a body with inertia adds by what moves inside it.
pub trait InteriorBlocks {
    /// Spin-up `rho w' / mu` that a unit multiplier of rotation gives the body; 0 for motion that is given.
    fn spin_up_of_rotation(&self) -> f64;

    /// `rows += factor *` what the spin-up of this body, one number a plane, adds to them.
    fn spread_spin_up(&self, factor: f64, spin_up: &[f64], rows: &mut EntriesMut);

    /// `out +=` what spin-ups of bodies, in the places of multipliers of rotations, add to the velocities on the surface.
    fn add_spin_up(&self, _spin_ups: Entries, _out: &mut [f64]) {}

    /// Replaces in `out` the rows whose velocities are not those of the surface, if there are such.
    fn read_inside(&self, _u: Entries, _out: &mut [f64]) {}
}

/// Forces on the lower and the upper wall across each axis.
pub type WallForces<const D: usize> = [[SVector<f64, D>; 2]; D];

/// What a velocity that is read is on walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Walls {
    /// Zero.
    Still,
    /// That of the walls.
    Moving,
}

/// What is collected while places are planned.
pub struct Plans {
    /// Entries that are read.
    pub read: Places,
    /// Entries that are added to.
    pub spread: Places,
    /// Multipliers.
    pub multipliers: Places,
}

/// An approximate inverse of the diagonal block of a body in the rows that are not rigid.
pub trait FreeInverse {
    /// `output = ` what multipliers give the rows `input`.
    fn apply(&self, input: &[f64], output: &mut [f64]);
}
