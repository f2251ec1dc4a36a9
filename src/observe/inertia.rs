//! What inertia amounts to: kinetic energy, the stress of fluctuations, and the numbers that compare it with viscosity and steps.

use nalgebra::{SMatrix, SVector};

use super::{cells::CellCenters, shear::Shear};
use crate::{
    error::Result,
    flow::fastest,
    geometry::{Axis, Ball},
    grid::{Grid, operators::signed},
    petsc::Vector,
    simulation::{Inertia, Setup, Solution},
    surface::Shape,
};

/// The time in which a sphere follows the fluid, `(2/9) density radius^2 / viscosity`, over that in which it moves by its radius, is the ninth part of its
/// Reynolds number by the diameter times the ratio of the densities. Disks have the same number.
const STOKES_OVER_REYNOLDS: f64 = 9.0;

/// Inertia at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InertialNumbers {
    /// Kinetic energy of fluid and bodies; in a sheared box that relative to the shear.
    pub kinetic_energy: f64,
    /// Largest Reynolds number of a body, by its speed (in a sheared box relative to the shear), its diameter and the fluid.
    pub reynolds: f64,
    /// Largest Stokes number of a free body, a ninth of its Reynolds number times its density over that of the fluid; 0 without free bodies.
    pub stokes: f64,
    /// Largest speed of the flow along an axis.
    pub fastest: f64,
}

impl InertialNumbers {
    /// Those of a solution; nothing without inertia. Collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn of<const D: usize>(setup: &Setup<D>, grid: &Grid<D>, solution: &Solution<D>) -> Result<Option<InertialNumbers>> {
        let Some(inertia) = &setup.inertia else { return Ok(None) };
        let volume = grid.spacing().product();
        let reynolds = |body: usize| {
            let state = &solution.bodies[body];
            let speed = (state.twist.velocity - setup.domain.carried(&state.center)).norm();
            2.0 * setup.bodies[body].body.ball.radius * speed * inertia.fluid / setup.viscosity
        };
        let free = (0..setup.bodies.len()).filter(|&body| setup.bodies[body].body.free());
        let stokes = free.map(|body| reynolds(body) * inertia.bodies[body] / (STOKES_OVER_REYNOLDS * inertia.fluid));
        Ok(Some(InertialNumbers {
            kinetic_energy: 0.5 * inertia.fluid * volume * square(grid, &solution.fluid)? + excess_energy(setup, inertia, solution),
            reynolds: (0..setup.bodies.len()).map(reynolds).fold(0.0, f64::max),
            stokes: stokes.fold(0.0, f64::max),
            fastest: fastest(grid, &solution.fluid)?,
        }))
    }

    /// Cells that the flow passes along an axis in a step, at most.
    pub fn courant<const D: usize>(&self, grid: &Grid<D>, step: f64) -> f64 {
        self.fastest * step / grid.spacing().min()
    }
}

/// Sum of the squares of all velocities of the grid.
fn square<const D: usize>(grid: &Grid<D>, fluid: &Vector) -> Result<f64> {
    let values = fluid.local()?;
    let mut sum = [(0..D).flat_map(|axis| &values[grid.local_range(axis)]).map(|value| value * value).sum()];
    fluid.session().world().sum(&mut sum);
    Ok(sum[0])
}

/// What bodies have beyond the fluid that moves in their places.
fn excess_energy<const D: usize>(setup: &Setup<D>, inertia: &Inertia<D>, solution: &Solution<D>) -> f64 {
    let of_body = |(body, state): (usize, &crate::simulation::BodyState<D>)| {
        let (ball, excess): (Ball<D>, f64) = (setup.bodies[body].body.ball, inertia.bodies[body] - inertia.fluid);
        // a skew matrix has each component of the spin twice
        let turning = 0.5 * state.twist.spin.norm_squared() * ball.moment_of_inertia();
        let velocity = state.twist.velocity - setup.domain.carried(&state.center);
        0.5 * excess * (ball.volume() * velocity.norm_squared() + turning)
    };
    solution.bodies.iter().enumerate().map(of_body).sum()
}

/// The stress of Reynolds times volume, `-integral of rho v v` with the velocity `v` relative to the shear; nothing without inertia.
/// Collective.
///
/// Of a suspension in a statistically steady state, it and the other parts of the stress add up to that of the walls.
///
/// # Errors
/// PETSc fails.
pub fn reynolds_stress<const D: usize>(
    setup: &Setup<D>,
    grid: &Grid<D>,
    solution: &Solution<D>,
    shear: &Shear<D>,
) -> Result<Option<SMatrix<f64, D, D>>> {
    let Some(inertia) = &setup.inertia else { return Ok(None) };
    let (at_bottom, of_fluid) = match setup.domain.axes[shear.gradient] {
        Axis::Walls { lower, .. } => (lower, 1.0),
        // what is solved for is the disturbance
        Axis::Sheared(_) => (SVector::zeros(), 0.0),
        Axis::Periodic | Axis::Open(_) => return Ok(None),
    };
    let background = |point: &SVector<f64, D>| at_bottom + shear.flow * (shear.rate * point[shear.gradient]);
    let velocities = CellCenters::new(grid, &solution.fluid)?.velocity(&solution.fluid)?;
    let cells =
        grid.block(D).indices().zip(velocities).map(|(cell, velocity)| velocity - background(&grid.position(D, signed(cell))) * of_fluid);
    let mut fluid: SMatrix<f64, D, D> = cells.map(|relative| relative * relative.transpose()).sum();
    solution.fluid.session().world().sum(fluid.as_mut_slice());
    let excess = solution.bodies.iter().enumerate().map(|(body, state)| {
        let relative = state.twist.velocity - background(&state.center);
        relative * relative.transpose() * ((inertia.bodies[body] - inertia.fluid) * setup.bodies[body].body.ball.volume())
    });
    let excess: SMatrix<f64, D, D> = excess.sum();
    Ok(Some(-(fluid * (inertia.fluid * grid.spacing().product()) + excess)))
}
