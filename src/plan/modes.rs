//! How many modes each body has.

use crate::{
    error::Result,
    scene::{FlowModel, Modes, Scene},
    surface::highest_order,
};

/// Highest order of modes per cell of radius in 2D and 3D; above it the multipliers see the grid's own noise.
const HIGHEST_ORDER_PER_CELL: [f64; 2] = [1.4, 1.25];

/// Order of `modes = "most"` per cell of radius in 2D and 3D, a margin below the highest, and its limit.
const MOST_ORDER_PER_CELL: [f64; 2] = [1.25, 1.0];
const MOST_ORDER: [usize; 2] = [24, 12];

/// Order of the modes per cell of radius where lubrication knows what they miss, and the least order, in 2D and 3D.
///
/// In 2D higher modes bend within a cell: a disk 0.1 radii from a wall then resists approach by 6 % too little at five cells a radius, and by
/// 2.4 % at this order; two disks scatter by 4 % with their places on the grid at one mode a cell. Where neighbours are in opposite places the sum
/// over films is wrong, and modes up to the plain order bear what there is.
///
/// In 3D films stand for relative motions of pairs only: what all neighbours do to a fixed or settling body is not among them, and takes one mode a cell
/// and at least four, where the grid carries them (`turbid validation --beds`).
const LUBRICATED_ORDER_PER_CELL: [f64; 2] = [0.6, 1.0];
const LUBRICATED_ORDER: [usize; 2] = [3, 4];

/// Highest order where lubrication knows what they miss, in 2D and 3D. By a wall the image of a mode is sharper than the mode: 0.01 radii from it a sphere resists approach by
/// 8 % too much with twelve modes at twelve cells a radius, and by 0.2 % with eight.
const LUBRICATED_MOST_ORDER: [usize; 2] = [8, 8];

/// Order of the modes of a body with so many cells per radius, for whose modes films stand or not (`bare`): what is asked for, or what the grid
/// carries well.
///
/// # Errors
/// More are asked for than the grid carries.
pub fn order<const D: usize>(scene: &Scene, modes: Modes, cells: f64, bare: bool) -> Result<usize> {
    let highest = ((HIGHEST_ORDER_PER_CELL[D - 2] * cells + 1e-9) as usize).min(highest_order(D));
    // boundary layers of a flow with inertia need modes that films do not stand for
    let lubricated = scene.lubrication.roughness().is_some() && scene.flow.model == FlowModel::Stokes;
    let by_films = (lubricated && (D == 3 || !bare)).then_some(LUBRICATED_ORDER_PER_CELL[D - 2] * cells);
    let [least, most] = [LUBRICATED_ORDER[D - 2], LUBRICATED_MOST_ORDER[D - 2]];
    match modes {
        Modes::Auto => {
            let plain = if D == 2 { (cells.round() as usize).clamp(3, 16) } else { (cells.round() as usize - 1).clamp(2, 10) };
            let auto = match by_films {
                Some(order) if D == 2 => plain.min(((order + 1e-9) as usize).max(least)),
                Some(order) => (order.round() as usize).clamp(least, most),
                None if bare => plain + (D - 2),
                None => plain,
            };
            Ok(auto.min(highest))
        }
        Modes::Most => {
            let wanted = match by_films {
                Some(order) if D == 2 => ((order - 1e-9).ceil() as usize).clamp(least, most),
                Some(order) => (order.round() as usize).clamp(least, most),
                None => ((MOST_ORDER_PER_CELL[D - 2] * cells + 1e-9) as usize).clamp(2, MOST_ORDER[D - 2]),
            };
            Ok(wanted.min(highest))
        }
        Modes::Count(modes) if modes > highest => {
            let remedy = format!("is too many for {cells:.2} cells per radius: at most {highest}; lower it or refine the grid");
            Err(scene.refuse("resolution.modes", modes, &remedy))
        }
        Modes::Count(modes) => Ok(modes),
    }
}
