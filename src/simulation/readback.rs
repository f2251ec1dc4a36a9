//! Forces read back from the unknowns of a solve.

use nalgebra::SVector;

use super::{Configuration, assembly::Assembly, bodies::Bodies, fixed_operators::FixedOperators, pair_resistance::belongs};

/// Forces of bodies within a cell of a wall on it.
pub fn forces_on_walls<const D: usize>(
    fixed: &FixedOperators<D>,
    assembly: &Assembly<D>,
    multipliers: &[f64],
) -> [[SVector<f64, D>; 2]; D] {
    let mut walls = assembly.blocks.on_walls(multipliers).map(|pair| pair.map(|force| force * fixed.setup.viscosity));
    walls.iter_mut().flatten().for_each(|force| fixed.session.world().sum(force.as_mut_slice()));
    walls
}

/// Forces of all contacts that are held, from those of this rank.
pub fn contact_forces<const D: usize>(
    fixed: &FixedOperators<D>,
    bodies: &Bodies<D>,
    configuration: &Configuration<D>,
    own: &mut impl Iterator<Item = f64>,
) -> Vec<f64> {
    let of_contact = |pressed| if belongs(&bodies.layout, pressed) { own.next().unwrap_or(0.0) } else { 0.0 };
    let mut forces: Vec<f64> = configuration.pressed.iter().map(of_contact).collect();
    if !forces.is_empty() {
        fixed.session.world().sum(&mut forces);
    }
    forces
}
