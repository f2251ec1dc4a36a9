//! The flow of a mesh at the points of the staggered grid, where files and pictures look for it.

use nalgebra::Vector2;

use crate::{
    error::Result,
    fitted::{Locator, Spot, StokesFlow, StokesProblem, first_order, second_order},
    grid::{Grid, operators::signed},
    petsc::{Session, Vector},
};

/// A flow, per unit viscosity and without the background, as a fluid vector; rigid motions in disks, where the pressure is that of its mean, zero.
pub fn interpolate<const D: usize>(
    session: &Session,
    grid: &Grid<D>,
    problem: &StokesProblem,
    flow: &StokesFlow,
    mean_pressure: f64,
) -> Result<Vector> {
    let locator = Locator::new(problem.mesh);
    let mut fluid = Vector::new(session, grid.local_fluid_unknowns())?;
    let mut local = fluid.local_mut()?;
    for field in 0..=D {
        let range = grid.local_range(field);
        for (index, value) in grid.block(field).indices().zip(&mut local[range]) {
            let position = grid.position(field, signed(index));
            *value = match locator.spot(&Vector2::new(position[0], position[1]))? {
                Spot::Fluid(triangle, l) if field == D => first_order(triangle, &l, &flow.pressures) - mean_pressure,
                Spot::Fluid(triangle, l) => second_order(triangle, &l, |node| flow.velocities[node][field]),
                Spot::Disk(..) if field == D => 0.0,
                Spot::Disk(disk, arm) => {
                    let background = problem.background * (problem.mesh.disks[disk].center + arm);
                    (flow.motions[disk].at(&arm) - background)[field]
                }
            };
        }
    }
    drop(local);
    Ok(fluid)
}
