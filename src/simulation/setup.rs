//! A scene resolved in its dimension: numbers only, nothing left to choose.

use super::placement::{bodies, domain, vector};
use crate::{
    body::Body,
    error::Result,
    flow::{Drive, InverseMethod},
    geometry::Domain,
    scene::{self, Modes, ResolutionSection, Scene, Spacing, StokesSolver, Tolerance},
};

/// Fewest cells per radius: closer to the centre the jump functions are too steep for the grid.
const FEWEST_CELLS_PER_RADIUS: f64 = 3.0;

/// Highest order of modes per cell of radius in 2D and 3D; above it the multipliers see the grid's own noise.
const HIGHEST_ORDER_PER_CELL: [f64; 2] = [1.4, 1.25];

/// A body with the order of its multiplier modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SuspendedBody<const D: usize> {
    /// The body.
    pub body: Body<D>,
    /// Highest order of its modes.
    pub order: usize,
}

/// What to solve.
#[derive(Debug, Clone)]
pub struct Setup<const D: usize> {
    /// The box.
    pub domain: Domain<D>,
    /// Spacing asked for; whole numbers of cells make it differ a little along each axis.
    pub spacing: f64,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// What drives the flow.
    pub drive: Drive<D>,
    /// The bodies.
    pub bodies: Vec<SuspendedBody<D>>,
    /// What inverts the fluid.
    pub inverse: InverseMethod,
    /// When the linear solver ends.
    pub tolerance: Tolerance,
}

impl<const D: usize> Setup<D> {
    /// Resolves a scene of dimension `D`: places its bodies and chooses what it leaves open.
    ///
    /// # Errors
    /// Bodies overlap or lie outside, do not fit at the asked fraction, or are too small for the grid or the modes.
    pub fn of(scene: &Scene) -> Result<Setup<D>> {
        let domain = domain(scene);
        let (spacing, bodies) = suspended_bodies(scene, bodies(scene, &domain)?)?;
        let (viscosity, tolerance) = (scene.flow.viscosity, scene.method.tolerance);
        let inverse = inverse(scene, &domain);
        Ok(Setup { domain, spacing, viscosity, drive: drive(scene), bodies, inverse, tolerance })
    }

    /// Part of the box that bodies fill.
    pub fn fraction(&self) -> f64 {
        self.bodies.iter().map(|suspended| suspended.body.ball.volume()).sum::<f64>() / self.domain.volume()
    }
}

fn resolution(scene: &Scene) -> &ResolutionSection {
    scene.resolution.as_ref().expect("only dry scenes have no resolution")
}

fn drive<const D: usize>(scene: &Scene) -> Drive<D> {
    match &scene.flow.drive {
        // refused: fluids have no mean gradient
        None | Some(scene::Drive::MeanGradient(_)) => Drive::Rest,
        Some(scene::Drive::MeanVelocity(velocity)) => Drive::MeanVelocity(vector(velocity)),
        Some(scene::Drive::PressureGradient(gradient)) => Drive::PressureGradient(vector(gradient)),
        Some(scene::Drive::BodyForce(force)) => Drive::BodyForce(vector(force)),
        Some(scene::Drive::ShearRate(rate)) => Drive::Shear(*rate),
    }
}

fn inverse<const D: usize>(scene: &Scene, domain: &Domain<D>) -> InverseMethod {
    match scene.method.inverse {
        StokesSolver::Hypre => InverseMethod::Hypre,
        StokesSolver::Transform => InverseMethod::Transform,
        StokesSolver::Auto => InverseMethod::fastest(domain),
    }
}

/// The spacing that a scene asks for, and its bodies with the order of their modes.
///
/// # Errors
/// A body is too small for the grid or the modes.
pub(super) fn suspended_bodies<const D: usize>(scene: &Scene, placed: Vec<(usize, Body<D>)>) -> Result<(f64, Vec<SuspendedBody<D>>)> {
    let radii = placed.iter().map(|(_, body)| body.ball.radius);
    let spacing = match resolution(scene).spacing {
        Spacing::Length(spacing) => spacing,
        Spacing::CellsPerRadius(cells) => radii.fold(f64::INFINITY, f64::min) / cells,
    };
    let bodies = placed.iter().map(|&(_, body)| suspended(scene, body, spacing)).collect::<Result<_>>()?;
    Ok((spacing, bodies))
}

fn suspended<const D: usize>(scene: &Scene, body: Body<D>, spacing: f64) -> Result<SuspendedBody<D>> {
    let cells = body.ball.radius / spacing;
    if cells < FEWEST_CELLS_PER_RADIUS * (1.0 - 1e-9) {
        let remedy = format!("leaves {cells:.2} cells per radius {}; at least {FEWEST_CELLS_PER_RADIUS} are needed", body.ball.radius);
        return Err(match resolution(scene).spacing {
            Spacing::Length(spacing) => scene.refuse("resolution.spacing", spacing, &remedy),
            Spacing::CellsPerRadius(cells) => scene.refuse("resolution.cells_per_radius", cells, &remedy),
        });
    }
    Ok(SuspendedBody { body, order: order::<D>(scene, cells)? })
}

/// Order of the modes of a body with so many cells per radius: what is asked for, or what the grid carries well.
fn order<const D: usize>(scene: &Scene, cells: f64) -> Result<usize> {
    let highest = (HIGHEST_ORDER_PER_CELL[D - 2] * cells + 1e-9) as usize;
    match resolution(scene).modes {
        Modes::Auto if D == 2 => Ok((cells.round() as usize).clamp(3, 16).min(highest)),
        Modes::Auto => Ok((cells.round() as usize - 1).clamp(2, 10).min(highest)),
        Modes::Count(modes) if modes > highest => {
            let remedy = format!("is too many for {cells:.2} cells per radius: at most {highest}; lower it or refine the grid");
            Err(scene.refuse("resolution.modes", modes, &remedy))
        }
        Modes::Count(modes) => Ok(modes),
    }
}
