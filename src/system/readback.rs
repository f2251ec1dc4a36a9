//! What is read back from the unknowns of a solve.

use nalgebra::SVector;

use super::{
    assembly::Assembly, bodies::Bodies, film_forces::add_films, fixed_operators::FixedOperators, pair_constraints::PairConstraints,
    pair_resistance::belongs,
};
use crate::{
    body::Row,
    constraint::MultiplierLayout,
    error::Result,
    setup::Configuration,
    system::{Cost, Solution, WallForces, work::SolvedUnknowns},
};

/// The solution, with the unknowns of this rank's contacts and films. Collective.
pub fn solution<const D: usize>(
    fixed: &FixedOperators<D>,
    bodies: &Bodies<D>,
    assembly: &Assembly<D>,
    pair_constraints: &PairConstraints,
    unknowns: &[f64],
    found: SolvedUnknowns,
    configuration: &Configuration<D>,
) -> Result<Solution<D>> {
    let mut states = bodies.states(&fixed.session, &assembly.blocks, &found.velocities, &found.multipliers);
    let mut walls = forces_on_walls(fixed, assembly, &found.multipliers);
    let unit = pair_constraints.scale * fixed.setup.viscosity;
    let mut forces = unknowns[..pair_constraints.count()].iter().map(|unknown| unknown * unit);
    let contact_forces = shared(fixed, &bodies.layout, configuration.contacts, &mut forces);
    let bond_forces = shared(fixed, &bodies.layout, configuration.bonds, &mut forces);
    let film_forces: Vec<f64> = forces.collect();
    let (world, layout, viscosity) = (fixed.session.world(), &bodies.layout, fixed.setup.viscosity);
    let films = || add_films(world, layout, &assembly.films, &film_forces, viscosity, &mut states, &mut walls);
    let lubrication = fixed.setup.interactions.resist().then(films);
    Ok(Solution {
        on_mesh: None,
        lubrication,
        cost: Cost::default(),
        bond_stress: Row::total_stress(configuration.bonds, &bond_forces, configuration.centers),
        bond_forces,
        walls: WallForces { forces: walls, complete: false },
        ..fixed.solution(states, found.fluid, &found.global_unknowns, contact_forces)?
    })
}

/// Forces of bodies within a cell of a wall on it.
fn forces_on_walls<const D: usize>(fixed: &FixedOperators<D>, assembly: &Assembly<D>, multipliers: &[f64]) -> [[SVector<f64, D>; 2]; D] {
    let mut walls = assembly.blocks.on_walls(multipliers).map(|pair| pair.map(|force| force * fixed.setup.viscosity));
    walls.iter_mut().flatten().for_each(|force| fixed.session.world().sum(force.as_mut_slice()));
    walls
}

/// Forces of all rows, from those of this rank's own.
fn shared<const D: usize>(
    fixed: &FixedOperators<D>,
    layout: &MultiplierLayout,
    rows: &[Row<D>],
    own: &mut impl Iterator<Item = f64>,
) -> Vec<f64> {
    let mut forces: Vec<f64> = rows.iter().map(|row| if belongs(layout, row) { own.next().unwrap_or(0.0) } else { 0.0 }).collect();
    if !forces.is_empty() {
        fixed.session.world().sum(&mut forces);
    }
    forces
}
