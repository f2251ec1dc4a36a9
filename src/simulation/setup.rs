//! A scene resolved in its dimension: numbers only, nothing left to choose.

use std::rc::Rc;

use super::{
    placement::{bodies, domain, vector},
    surroundings::opposite_neighbours,
};
use crate::{
    body::Body,
    constraint::{FlowMethod, flow_method},
    error::Result,
    flow::{Drive, InverseMethod},
    geometry::Domain,
    scene::{self, ConstraintMethod, Modes, MultiplierSolver, ResolutionSection, Scene, Spacing, StokesSolver, Tolerance},
    surface::{highest_order, modes},
};

/// Fewest cells per radius: closer to the centre the jump functions are too steep for the grid.
const FEWEST_CELLS_PER_RADIUS: f64 = 3.0;

/// Highest order of modes per cell of radius in 2D and 3D; above it the multipliers see the grid's own noise.
const HIGHEST_ORDER_PER_CELL: [f64; 2] = [1.4, 1.25];

/// Tolerance of the fluid alone over that of the whole.
const INNER: f64 = 0.01;

/// Order of `modes = "most"` per cell of radius in 2D and 3D, a margin below the highest, and its limit.
const MOST_ORDER_PER_CELL: [f64; 2] = [1.25, 1.0];
const MOST_ORDER: [usize; 2] = [24, 12];

/// Order of the modes per cell of radius where lubrication knows what they miss, and the least order in 2D and 3D.
///
/// Higher modes bend within a cell: a disk 0.1 radii from a wall then resists approach by 6 % too little at five cells a radius, and by
/// 2.4 % at this order; two disks scatter by 4 % with their places on the grid at one mode a cell. Crowds have their viscosity with
/// three modes (`examples/crowd.toml`).
///
/// Where neighbours are in opposite places the sum over films is wrong, and modes up to the plain order bear what there is, in 3D one more:
/// flows along an axis have no modes of even order, and a body-centred cubic array at 0.3 lacks 2 % of its drag without the fifth.
const LUBRICATED_ORDER_PER_CELL: f64 = 0.6;
const LUBRICATED_ORDER: [usize; 2] = [3, 2];

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
    /// What makes bodies rigid.
    pub constraint: ConstraintMethod,
    /// With lubrication, the gap in radii below which none counts as smaller; nothing without it.
    pub lubrication: Option<f64>,
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
        let (spacing, bodies) = suspended_bodies(scene, &domain, bodies(scene, &domain)?)?;
        Ok(Setup::with_bodies(scene, domain, spacing, bodies))
    }

    /// The setup of a scene in which these are the bodies.
    pub(super) fn with_bodies(scene: &Scene, domain: Domain<D>, spacing: f64, bodies: Vec<SuspendedBody<D>>) -> Setup<D> {
        let inverse = inverse(scene, &domain);
        Setup {
            domain,
            spacing,
            viscosity: scene.flow.viscosity,
            drive: drive(scene),
            bodies,
            constraint: scene.method.constraint,
            lubrication: scene.lubrication.roughness(),
            inverse,
            tolerance: scene.method.tolerance,
        }
    }

    /// What fills the blocks of the bodies.
    ///
    /// # Panics
    /// For a fitted mesh, which has no such blocks.
    pub fn method(&self) -> Rc<FlowMethod<D>> {
        flow_method(self.constraint.word(), self.constraint.epsilon()).expect("a fitted mesh has no blocks on a grid")
    }

    /// Tolerance of the fluid alone, where a method needs each solve of it to be exact and the inverse is not.
    ///
    /// Extra stresses are told apart by what the exact flow makes of them, and Uzawa's iteration is one on the multipliers.
    pub fn inner_tolerance(&self) -> Option<f64> {
        let exact = matches!(self.constraint, ConstraintMethod::Penalty(_) | ConstraintMethod::MeanValue(MultiplierSolver::Uzawa(_)));
        exact.then(|| INNER * self.tolerance.at_an_instant())
    }

    /// Half the distance between bodies: in 2D others cut the logarithm of a body's mobility there.
    pub fn reach(&self) -> f64 {
        0.5 * (self.domain.volume() / self.bodies.len() as f64).powf(1.0 / D as f64)
    }

    /// Force that gives a body of this radius a unit velocity in unbounded fluid.
    pub fn resistance(&self, radius: f64) -> f64 {
        let modes = modes(D, radius, 1);
        self.viscosity * modes.force_factor() / modes.isolated_mobility(self.reach())[(0, 0)]
    }

    /// Part of the box that bodies fill.
    pub fn fraction(&self) -> f64 {
        self.bodies.iter().map(|suspended| suspended.body.ball.volume()).sum::<f64>() / self.domain.volume()
    }
}

/// The resolution of a scene that is not dry.
///
/// # Errors
/// It is yet to be chosen.
fn resolution(scene: &Scene) -> Result<&ResolutionSection> {
    let accuracy = scene.accuracy.unwrap_or_default();
    let open = || scene.refuse("accuracy", accuracy, "chooses the resolution in turbid run only; give [resolution] instead");
    scene.resolution.as_ref().ok_or_else(open)
}

fn drive<const D: usize>(scene: &Scene) -> Drive<D> {
    match &scene.flow.drive {
        // refused: fluids have no mean gradient
        None | Some(scene::Drive::MeanGradient(_)) => Drive::Rest,
        Some(scene::Drive::MeanVelocity(velocity)) => Drive::MeanVelocity(vector(velocity)),
        Some(scene::Drive::PressureGradient(gradient)) => Drive::PressureGradient(vector(gradient)),
        Some(scene::Drive::BodyForce(force)) => Drive::BodyForce(vector(force)),
        Some(scene::Drive::ShearRate(rate) | scene::Drive::ShearedBox(rate)) => Drive::Shear(*rate),
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
pub(super) fn suspended_bodies<const D: usize>(
    scene: &Scene,
    domain: &Domain<D>,
    placed: Vec<(usize, Body<D>)>,
) -> Result<(f64, Vec<SuspendedBody<D>>)> {
    let radii = placed.iter().map(|(_, body)| body.ball.radius);
    let spacing = match resolution(scene)?.spacing {
        Spacing::Length(spacing) => spacing,
        Spacing::CellsPerRadius(cells) => radii.fold(f64::INFINITY, f64::min) / cells,
    };
    let balls: Vec<_> = placed.iter().map(|(_, body)| body.ball).collect();
    let surrounded = match resolution(scene)?.modes {
        Modes::Count(_) => vec![false; balls.len()],
        Modes::Auto | Modes::Most => opposite_neighbours(domain, &balls),
    };
    let bodies = placed.iter().zip(surrounded).map(|(&(_, body), surrounded)| suspended(scene, (body, surrounded), spacing));
    Ok((spacing, bodies.collect::<Result<_>>()?))
}

/// A body, with neighbours in opposite places or not, with the order of its modes on a grid.
///
/// # Errors
/// It is too small for the grid or the modes.
pub(super) fn suspended<const D: usize>(scene: &Scene, (body, surrounded): (Body<D>, bool), spacing: f64) -> Result<SuspendedBody<D>> {
    let cells = body.ball.radius / spacing;
    if cells < FEWEST_CELLS_PER_RADIUS * (1.0 - 1e-9) {
        let remedy = format!("leaves {cells:.2} cells per radius {}; at least {FEWEST_CELLS_PER_RADIUS} are needed", body.ball.radius);
        return Err(match resolution(scene)?.spacing {
            Spacing::Length(spacing) => scene.refuse("resolution.spacing", spacing, &remedy),
            Spacing::CellsPerRadius(cells) => scene.refuse("resolution.cells_per_radius", cells, &remedy),
        });
    }
    Ok(SuspendedBody { body, order: order::<D>(scene, cells, surrounded)? })
}

/// Order of the modes of a body with so many cells per radius, `surrounded` by neighbours in opposite places or not: what is asked for, or what the
/// grid carries well.
fn order<const D: usize>(scene: &Scene, cells: f64, surrounded: bool) -> Result<usize> {
    let highest = ((HIGHEST_ORDER_PER_CELL[D - 2] * cells + 1e-9) as usize).min(highest_order(D));
    let lubricated = scene.lubrication.roughness().is_some();
    match resolution(scene)?.modes {
        Modes::Auto => {
            let plain = if D == 2 { (cells.round() as usize).clamp(3, 16) } else { (cells.round() as usize - 1).clamp(2, 10) };
            let by_films = ((LUBRICATED_ORDER_PER_CELL * cells + 1e-9) as usize).max(LUBRICATED_ORDER[D - 2]);
            let auto = match (surrounded, lubricated) {
                (true, _) => plain + (D - 2),
                (false, true) => plain.min(by_films),
                (false, false) => plain,
            };
            Ok(auto.min(highest))
        }
        Modes::Most if lubricated && !surrounded => {
            let by_films = (LUBRICATED_ORDER_PER_CELL * cells - 1e-9).ceil() as usize;
            Ok(by_films.clamp(LUBRICATED_ORDER[D - 2], MOST_ORDER[D - 2]).min(highest))
        }
        Modes::Most => Ok(((MOST_ORDER_PER_CELL[D - 2] * cells + 1e-9) as usize).clamp(2, MOST_ORDER[D - 2]).min(highest)),
        Modes::Count(modes) if modes > highest => {
            let remedy = format!("is too many for {cells:.2} cells per radius: at most {highest}; lower it or refine the grid");
            Err(scene.refuse("resolution.modes", modes, &remedy))
        }
        Modes::Count(modes) => Ok(modes),
    }
}
