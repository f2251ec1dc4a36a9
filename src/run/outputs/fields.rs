//! The flow on the grid as frames hold it.

use crate::{
    error::Result,
    geometry::{Ball, Domain},
    grid::{Grid, operators::signed},
    observe::{CellCenters, CellVorticity, inside},
    output::FrameFields,
    petsc::Vector,
    run::FlowView,
    scene::Scene,
};

/// What reads velocities, pressure and, if the scene asks for it, vorticity off a flow.
pub struct FlowFields<const D: usize> {
    /// Made anew where images slide.
    centers: CellCenters<D>,
    vorticity: Option<CellVorticity<D>>,
}

impl<const D: usize> FlowFields<D> {
    /// For a scene's flows on a grid, which are like this one. Collective.
    ///
    /// # Errors
    /// PETSc fails, here and below.
    pub fn new(scene: &Scene, grid: &Grid<D>, fluid: &Vector) -> Result<FlowFields<D>> {
        let vorticity = scene.stores_vorticity().then(|| CellVorticity::new(grid, fluid)).transpose()?;
        Ok(FlowFields { centers: CellCenters::new(grid, fluid)?, vorticity })
    }

    /// The fluid of this rank around these bodies. Collective.
    pub fn of<'a>(&mut self, flow: FlowView<'a, D>, domain: &Domain<D>, balls: &[Ball<D>]) -> Result<FrameFields<'a, D>> {
        let (grid, setup, fluid) = (flow.solver.grid(), flow.solver.setup(), &flow.solution.fluid);
        if domain.slide().is_some() {
            self.centers = CellCenters::new(grid, fluid)?;
            if let Some(vorticity) = &mut self.vorticity {
                *vorticity = CellVorticity::new(grid, fluid)?;
            }
        }
        let mut velocity = self.centers.velocity(fluid)?;
        for (index, velocity) in grid.block(D).indices().zip(&mut velocity) {
            *velocity += setup.drive.background(&grid.position(D, signed(index)));
        }
        let pressure = self.centers.pressure(fluid)?.into_iter().map(|pressure| pressure * setup.viscosity).collect();
        let vorticity = self.vorticity.as_mut().map(|vorticity| vorticity.evaluate(grid, fluid, &setup.drive)).transpose()?;
        Ok(FrameFields { grid, velocity, pressure, inside: inside(grid, balls), vorticity })
    }
}
