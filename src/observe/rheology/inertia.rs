//! What inertia amounts to: kinetic energy, the stress of fluctuations, and the numbers that compare it with viscosity and steps.

use nalgebra::{SMatrix, SVector};

use crate::{
    body::Body,
    error::Result,
    flow::{Drive, fastest},
    geometry::{Axis, Ball},
    grid::{Grid, operators::signed},
    observe::{
        fields::cells::{CellCenters, visit_inside},
        shear::Shear,
    },
    petsc::Vector,
    setup::{Inertia, Setup, SuspendedBody},
    surface::Shape,
    system::{BodyState, Solution},
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
    /// Those of a solution, which is that of the `start` or not; nothing without inertia. Collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn of<const D: usize>(setup: &Setup<D>, grid: &Grid<D>, solution: &Solution<D>, start: bool) -> Result<Option<InertialNumbers>> {
        let Some(inertia) = &setup.inertia else { return Ok(None) };
        let reynolds = |body: usize| {
            let state = &solution.bodies[body];
            let speed = (state.twist.velocity - setup.domain.carried(&state.center)).norm();
            2.0 * setup.bodies[body].body.ball.radius * speed * inertia.fluid / setup.viscosity
        };
        let free = (0..setup.bodies.len()).filter(|&body| setup.bodies[body].body.free());
        let stokes = free.map(|body| reynolds(body) * inertia.bodies[body] / (STOKES_OVER_REYNOLDS * inertia.fluid));
        Ok(Some(InertialNumbers {
            kinetic_energy: energy_of_movers(setup, grid, solution, start)?
                + energy_of(setup, inertia, solution, |density| density, |body| !body.free()),
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

/// Kinetic energy of the fluid outside bodies and of free bodies; none without inertia. The solution is that of the `start` or not. Collective.
///
/// # Errors
/// PETSc fails.
pub fn energy_of_movers<const D: usize>(setup: &Setup<D>, grid: &Grid<D>, solution: &Solution<D>, start: bool) -> Result<f64> {
    let Some(inertia) = &setup.inertia else { return Ok(0.0) };
    let stream = matches!(setup.drive, Drive::MeanVelocity(_)) || setup.domain.open().is_some();
    if start && !stream {
        // the fluid rests, but for what the grid has of bodies that move
        return Ok(energy_of(setup, inertia, solution, |density| density, Body::free));
    }
    let excess = energy_of(setup, inertia, solution, |density| density - inertia.fluid, Body::free);
    let inside_others = match start {
        true => energy_inside_at_start(setup, inertia, grid, solution)?,
        false => energy_of(setup, inertia, solution, |_| inertia.fluid, |body| !body.free()),
    };
    Ok(energy_of_fluid(inertia, grid, solution)? + excess - inside_others)
}

/// Kinetic energy of the fluid that fills bodies of given motion at the start, when it does not move as they do yet. Collective.
fn energy_inside_at_start<const D: usize>(setup: &Setup<D>, inertia: &Inertia<D>, grid: &Grid<D>, solution: &Solution<D>) -> Result<f64> {
    let given = setup.bodies.iter().zip(&solution.bodies).filter(|(suspended, _)| !suspended.body.free());
    let balls: Vec<Ball<D>> = given.map(|(suspended, state)| Ball { center: state.center, ..suspended.body.ball }).collect();
    if balls.is_empty() {
        return Ok(0.0);
    }
    let velocities = CellCenters::new(grid, &solution.fluid)?.velocity(&solution.fluid)?;
    // of each ball the sum of squares, and the number of cells
    let mut sums = vec![0.0; 2 * balls.len()];
    visit_inside(grid, &balls, |ball, cell| {
        sums[2 * ball] += velocities[cell].norm_squared();
        sums[2 * ball + 1] += 1.0;
    });
    solution.fluid.session().world().sum(&mut sums);
    let of_ball = |(sum, ball): (&[f64], &Ball<D>)| 0.5 * inertia.fluid * ball.volume() * sum[0] / sum[1].max(1.0);
    Ok(sums.chunks(2).zip(&balls).map(of_ball).sum())
}

/// Kinetic energy of the fluid, which fills bodies too.
fn energy_of_fluid<const D: usize>(inertia: &Inertia<D>, grid: &Grid<D>, solution: &Solution<D>) -> Result<f64> {
    Ok(0.5 * inertia.fluid * grid.spacing().product() * square(grid, &solution.fluid)?)
}

/// Kinetic energy of some bodies if they had another density that theirs decides.
fn energy_of<const D: usize>(
    setup: &Setup<D>,
    inertia: &Inertia<D>,
    solution: &Solution<D>,
    density: impl Fn(f64) -> f64,
    counts: impl Fn(&Body<D>) -> bool,
) -> f64 {
    let of_body = |((suspended, own), state): ((&SuspendedBody<D>, &f64), &BodyState<D>)| {
        let ball = suspended.body.ball;
        let (velocity, spin) = (state.twist.velocity - setup.domain.carried(&state.center), state.twist.spin - setup.domain.carried_spin());
        // a skew matrix has each component of the spin twice
        let turning = 0.5 * spin.norm_squared() * ball.moment_of_inertia();
        0.5 * density(*own) * (ball.volume() * velocity.norm_squared() + turning)
    };
    let bodies = setup.bodies.iter().zip(&inertia.bodies).zip(&solution.bodies);
    bodies.filter(|((suspended, _), _)| counts(&suspended.body)).map(of_body).sum()
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
    let axis = &setup.domain.axes[shear.gradient];
    let (at_bottom, of_fluid) = match (axis.walls(), axis) {
        (Some([lower, _]), _) => (lower, 1.0),
        // what is solved for is the disturbance
        (None, Axis::Sheared(_)) => (SVector::zeros(), 0.0),
        _ => return Ok(None),
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
