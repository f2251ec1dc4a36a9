//! Lattice points that a surface passes when its body moves: there a field has to change sides.

use nalgebra::SVector;

use super::{Placed, velocity_jump};
use crate::{
    constraint::patch::Patch,
    grid::{Grid, Node},
};

/// Jump functions this close to the centre, in radii, are too steep to say anything.
const CORE: f64 = 0.5;

/// Lattice points that change sides, and by how much each mode changes the field there.
pub struct Passage {
    /// Their places in fluid vectors.
    pub places: Vec<i32>,
    /// One change a mode for each place, modes running fastest.
    pub changes: Vec<f64>,
}

impl Passage {
    /// The change at each place for given multipliers.
    pub fn of<'a>(&'a self, multipliers: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.changes.chunks(multipliers.len()).map(move |modes| modes.iter().zip(multipliers).map(|(mode, c)| mode * c).sum())
    }
}

/// What the move of a body to `center` does to the points that its surface passes.
///
/// A point that comes to lie outside takes the outer extension of the field, `q + D`; one that comes to lie inside, `q - D`.
pub fn passage<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, center: &SVector<f64, D>) -> Passage {
    let moved = Placed { center: *center, surface: placed.surface.clone() };
    let modes = &placed.surface.modes;
    let mut found = Passage { places: Vec::new(), changes: Vec::new() };
    let mut jump = vec![0.0; modes.count()];
    for field in 0..=D {
        let reach = modes.radius() + (center - placed.center).norm();
        for index in Patch::around(grid, field, &placed.center, reach).indices() {
            let position = grid.position(field, index);
            let (inside, offset) = (!placed.outside(&position), position - placed.center);
            if inside != moved.outside(&position) || offset.norm() < CORE * modes.radius() {
                continue;
            }
            let Node::Unknown(place) = grid.fluid_node(field, index) else { continue };
            if field < D {
                velocity_jump(grid, placed, field, &position, &mut jump);
            } else {
                modes.pressure_jump(offset.as_slice(), &mut jump);
            }
            let sign = if inside { 1.0 } else { -1.0 };
            found.places.push(place as i32);
            found.changes.extend(jump.iter().map(|jump| sign * jump));
        }
    }
    found
}
