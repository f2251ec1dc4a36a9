//! Lattice points that a surface passes when its body moves: there a field has to change sides.

use nalgebra::SVector;

use crate::{
    constraint::{index_box::IndexBox, placed::Placed},
    grid::{Grid, Node},
};

/// Jump functions this close to the centre, in radii, are too steep to say anything.
const CORE: f64 = 0.5;

/// A lattice point that a surface passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreshlyCleared<const D: usize> {
    /// Its place in fluid vectors.
    pub place: usize,
    /// The field: a component of the velocity, or `D` for the pressure.
    pub field: usize,
    /// Where it is, not wrapped into the box.
    pub position: SVector<f64, D>,
    /// 1 if it comes to lie outside, -1 if it comes to lie inside.
    pub side: f64,
}

/// The lattice points that change sides when a body moves to `center`.
pub fn freshly_cleared<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, center: &SVector<f64, D>) -> Vec<FreshlyCleared<D>> {
    let moved = Placed { center: *center, surface: placed.surface.clone() };
    let reach = placed.surface.modes.radius() + (center - placed.center).norm();
    let mut found = Vec::new();
    for field in 0..=D {
        for index in IndexBox::around(grid, field, &placed.center, reach).indices() {
            let position = grid.position(field, index);
            let (before, after) = (placed.outside(&position), moved.outside(&position));
            if let (true, Node::Unknown(place)) = (before != after, grid.fluid_node(field, index)) {
                found.push(FreshlyCleared { place, field, position, side: if after { 1.0 } else { -1.0 } });
            }
        }
    }
    found
}

/// The jump, outside minus inside, that the multipliers of a body cause at a point: zero in its core.
pub fn jump<const D: usize>(placed: &Placed<D>, multipliers: &[f64], point: &FreshlyCleared<D>) -> f64 {
    let offset = point.position - placed.center;
    if offset.norm() < CORE * placed.surface.modes.radius() {
        return 0.0;
    }
    let mut modes = vec![0.0; placed.surface.modes.jump_count()];
    placed.surface.modes.jumps(offset.as_slice(), point.field, &mut modes);
    modes.iter().zip(multipliers).map(|(mode, c)| mode * c).sum()
}
