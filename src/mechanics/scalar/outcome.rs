//! What is read off the scalar and the multipliers once they are found.

use nalgebra::SVector;

use super::{InclusionState, Inclusions, ScalarSolution, uzawa::Uzawa};
use crate::{error::Result, geometry::Ball, petsc::Vector, scene::ConstraintMethod};

impl<const D: usize> Inclusions<D> {
    /// The solution from what a solver leaves in the work space.
    pub(super) fn solution(&mut self, uzawa: Option<Uzawa>) -> Result<ScalarSolution<D>> {
        let inclusions = self.states()?;
        let field = self.system.field_in.copied()?;
        let mean_flux = self.mean_flux()?;
        let energy = match (self.setup.gradient, mean_flux) {
            (Some(gradient), Some(flux)) => 0.5 * self.setup.domain.volume() * gradient.dot(&flux),
            _ => self.energy(&inclusions, &field)?,
        };
        Ok(ScalarSolution { inclusions, field, on_mesh: None, energy, mean_flux, uzawa })
    }

    /// All inclusions with their values and fluxes, on every rank.
    fn states(&mut self) -> Result<Vec<InclusionState<D>>> {
        let mut values = vec![0.0; self.layout.local_unknowns()];
        self.system.blocks.bodies.interpolate(&self.system.field_in, &mut values)?;
        self.add_outer_values(&mut values)?;
        let (constants, fluxes) = (self.system.blocks.constants(&values), self.fluxes()?);
        let found = self.layout.local_bodies.iter().zip(constants.iter().zip(&fluxes));
        let found: Vec<f64> = found.flat_map(|(&body, (&value, &flux))| [body as f64, value, flux]).collect();
        let all = self.session.world().gather(&found);
        let mut found: Vec<&[f64]> = all.chunks(3).collect();
        found.sort_by(|one, two| one[0].total_cmp(&two[0]));
        let state = |(found, (ball, _)): (&&[f64], &(Ball<D>, usize))| {
            let center = self.setup.domain.wrap(ball.center);
            let background = self.setup.gradient.map_or(0.0, |gradient| gradient.dot(&center));
            InclusionState { center, radius: ball.radius, value: found[1] + background, flux: found[2] }
        };
        Ok(found.iter().zip(&self.setup.inclusions).map(state).collect())
    }

    /// Net fluxes out of this rank's inclusions as the grid has them: of the multipliers, and of what the solver leaves in the rows there.
    fn fluxes(&mut self) -> Result<Vec<f64>> {
        let sums = self.system.blocks.sums(&self.system.field_out)?;
        let fluxes = self.system.blocks.fluxes(&self.system.multipliers.local()?);
        let cell_volume = self.grid.spacing().product();
        Ok(fluxes.iter().zip(sums).map(|(flux, sum)| flux + cell_volume * sum).collect())
    }

    /// The mean gradient, and the mean of what flows within inclusions, where the scalar has no slope: sources times their places.
    fn mean_flux(&self) -> Result<Option<SVector<f64, D>>> {
        let Some(gradient) = self.setup.gradient else { return Ok(None) };
        let multipliers = self.system.multipliers.local()?;
        let mut dipole = self.system.blocks.dipole(&multipliers);
        self.session.world().sum(dipole.as_mut_slice());
        Ok(Some(gradient - dipole / self.setup.domain.volume()))
    }

    /// Where it is least, the functional is minus half the integral of the source times the scalar outside the inclusions.
    ///
    /// The mean over a cell differs from the value at its centre by `h^2/24` times the Laplacian, minus the source outside.
    fn energy(&mut self, inclusions: &[InclusionState<D>], field: &Vector) -> Result<f64> {
        let whole = field.mean()? * self.setup.domain.volume();
        let inside = match self.setup.constraint {
            ConstraintMethod::Sharp => {
                self.setup.inclusions.iter().zip(inclusions).map(|((ball, _), state)| ball.volume() * state.value).sum()
            }
            _ => {
                let mut inside = [self.system.blocks.confined(field)? * self.grid.spacing().product()];
                self.session.world().sum(&mut inside);
                inside[0]
            }
        };
        let outside = self.setup.domain.volume() * (1.0 - self.setup.fraction());
        let bend = self.system.scale / 24.0 * self.setup.source * outside;
        Ok(-0.5 * self.setup.source * (whole - inside - bend))
    }
}
