//! A scene resolved in its dimension: numbers only, nothing left to choose.

use nalgebra::{SMatrix, SVector};

use crate::{
    body::{Body, Motion, Twist, pack, read_centers, skew},
    error::{Error, Result},
    flow::Drive,
    geometry::{Axis, Ball, Domain, Fault, first_fault},
    scene::{self, AxisSection, BodyGroup, Modes, Placement, ResolutionSection, Scene, Spacing},
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
    /// Relative residual of the linear solver.
    pub tolerance: f64,
}

impl<const D: usize> Setup<D> {
    /// Resolves a scene of dimension `D`: places its bodies and chooses what it leaves open.
    ///
    /// # Errors
    /// Bodies overlap or lie outside, do not fit at the asked fraction, or are too small for the grid or the modes.
    pub fn of(scene: &Scene) -> Result<Setup<D>> {
        let domain = domain(scene);
        let balls = place(scene, &domain)?;
        check_places(scene, &domain, &balls)?;
        let resolution = resolution(scene)?;
        let radii = balls.iter().map(|&(_, ball)| ball.radius);
        let spacing = match resolution.spacing {
            Spacing::Length(spacing) => spacing,
            Spacing::CellsPerRadius(cells) => radii.fold(f64::INFINITY, f64::min) / cells,
        };
        let bodies = balls.iter().map(|&(group, ball)| suspended(scene, group, ball, spacing)).collect::<Result<_>>()?;
        let (viscosity, tolerance) = (scene.flow.viscosity, scene.method.tolerance);
        Ok(Setup { domain, spacing, viscosity, drive: drive(scene), bodies, tolerance })
    }

    /// Part of the box that bodies fill.
    pub fn fraction(&self) -> f64 {
        self.bodies.iter().map(|suspended| suspended.body.ball.volume()).sum::<f64>() / self.domain.volume()
    }
}

fn resolution(scene: &Scene) -> Result<&ResolutionSection> {
    scene.resolution.as_ref().ok_or_else(|| scene.refuse("flow.model", "\"none\"", "is not available yet; must be \"stokes\""))
}

fn vector<const D: usize>(numbers: &[f64]) -> SVector<f64, D> {
    SVector::from_column_slice(numbers)
}

fn domain<const D: usize>(scene: &Scene) -> Domain<D> {
    let axis = |axis: usize| match &scene.domain.axes[axis] {
        AxisSection::Periodic => Axis::Periodic,
        AxisSection::Walls { lower, upper } => Axis::Walls { lower: vector(lower), upper: vector(upper) },
    };
    Domain { size: vector(&scene.domain.size), axes: std::array::from_fn(axis) }
}

fn drive<const D: usize>(scene: &Scene) -> Drive<D> {
    match &scene.flow.drive {
        None => Drive::Rest,
        Some(scene::Drive::MeanVelocity(velocity)) => Drive::MeanVelocity(vector(velocity)),
        Some(scene::Drive::PressureGradient(gradient)) => Drive::PressureGradient(vector(gradient)),
        Some(scene::Drive::BodyForce(force)) => Drive::BodyForce(vector(force)),
        Some(scene::Drive::ShearRate(rate)) => Drive::Shear(*rate),
    }
}

/// The balls of all groups with their groups: given centers first, then random ones, which avoid them.
fn place<const D: usize>(scene: &Scene, domain: &Domain<D>) -> Result<Vec<(usize, Ball<D>)>> {
    let mut balls = Vec::new();
    for (group, bodies) in scene.bodies.iter().enumerate() {
        balls.extend(given_balls(bodies)?.into_iter().map(|ball| (group, ball)));
    }
    check_places(scene, domain, &balls)?;
    let obstacles: Vec<Ball<D>> = balls.iter().map(|&(_, ball)| ball).collect();
    let (mut random, mut gap) = (Vec::new(), 0.0_f64);
    for (group, bodies) in scene.bodies.iter().enumerate() {
        let count = random_count(scene, group, bodies, domain)?;
        random.extend(std::iter::repeat_n((group, bodies.radius), count));
        gap = if count > 0 { gap.max(bodies.gap) } else { gap };
    }
    let radii: Vec<f64> = random.iter().map(|&(_, radius)| radius).collect();
    let centers =
        pack(domain, &obstacles, &radii, gap, scene.seed).map_err(|error| refuse_crowd(scene, random[0].0, &error.to_string()))?;
    balls.extend(random.into_iter().zip(centers).map(|((group, radius), center)| (group, Ball { center, radius })));
    Ok(balls)
}

/// The refusal of a random group that does not fit.
fn refuse_crowd(scene: &Scene, group: usize, remedy: &str) -> Error {
    match scene.bodies[group].placement {
        Placement::Fraction(fraction) => scene.refuse(&format!("bodies[{group}].fraction"), fraction, remedy),
        Placement::Count(count) => scene.refuse(&format!("bodies[{group}].count"), count, remedy),
        _ => unreachable!("only random groups are packed"),
    }
}

fn given_balls<const D: usize>(group: &BodyGroup) -> Result<Vec<Ball<D>>> {
    match &group.placement {
        Placement::Centers(centers) => Ok(centers.iter().map(|center| Ball { center: vector(center), radius: group.radius }).collect()),
        Placement::File(path) => {
            let centers = read_centers::<D>(path)?;
            Ok(centers.into_iter().map(|(center, radius)| Ball { center, radius: radius.unwrap_or(group.radius) }).collect())
        }
        _ => Ok(Vec::new()),
    }
}

fn random_count<const D: usize>(scene: &Scene, group: usize, bodies: &BodyGroup, domain: &Domain<D>) -> Result<usize> {
    match bodies.placement {
        Placement::Count(count) => Ok(count),
        Placement::Fraction(fraction) => {
            let one = Ball { center: SVector::<f64, D>::zeros(), radius: bodies.radius }.volume();
            let count = (fraction * domain.volume() / one).round() as usize;
            let remedy = "is less than half a body; enlarge domain.size or lower the radius";
            if count == 0 { Err(scene.refuse(&format!("bodies[{group}].fraction"), fraction, remedy)) } else { Ok(count) }
        }
        _ => Ok(0),
    }
}

fn check_places<const D: usize>(scene: &Scene, domain: &Domain<D>, balls: &[(usize, Ball<D>)]) -> Result<()> {
    let only: Vec<Ball<D>> = balls.iter().map(|&(_, ball)| ball).collect();
    let Some(fault) = first_fault(domain, &only) else { return Ok(()) };
    let at = |body: usize| format!("{:?}", only[body].center.as_slice());
    let (body, remedy) = match fault {
        Fault::Overlap { first, second, gap } => {
            (second, format!("overlaps body {first} at {} by {:.3e}; move one of them or lower the radius", at(first), -gap))
        }
        Fault::OwnImage { body, gap } => (body, format!("overlaps its own periodic image by {:.3e}; enlarge domain.size", -gap)),
        Fault::Outside { body, axis } => {
            let (size, name) = (domain.size[axis], ["x", "y", "z"][axis]);
            (body, format!("body {body} lies outside the box along {name}, which goes from 0 to {size}; move it inside"))
        }
    };
    let group = balls[body].0;
    let key = match scene.bodies[group].placement {
        Placement::File(_) => format!("bodies[{group}].file"),
        _ => format!("bodies[{group}].centers"),
    };
    Err(scene.refuse(&key, at(body), &remedy))
}

fn suspended<const D: usize>(scene: &Scene, group: usize, ball: Ball<D>, spacing: f64) -> Result<SuspendedBody<D>> {
    let cells = ball.radius / spacing;
    if cells < FEWEST_CELLS_PER_RADIUS * (1.0 - 1e-9) {
        let remedy = format!("leaves {cells:.2} cells per radius {}; at least {FEWEST_CELLS_PER_RADIUS} are needed", ball.radius);
        return Err(match resolution(scene)?.spacing {
            Spacing::Length(spacing) => scene.refuse("resolution.spacing", spacing, &remedy),
            Spacing::CellsPerRadius(cells) => scene.refuse("resolution.cells_per_radius", cells, &remedy),
        });
    }
    Ok(SuspendedBody { body: Body { ball, motion: motion(scene, group, &ball) }, order: order::<D>(scene, cells)? })
}

fn motion<const D: usize>(scene: &Scene, group: usize, ball: &Ball<D>) -> Motion<D> {
    let bodies = &scene.bodies[group];
    match &bodies.motion {
        scene::Motion::Fixed => Motion::Prescribed(Twist::zero()),
        scene::Motion::Prescribed { velocity, spin } => Motion::Prescribed(Twist { velocity: vector(velocity), spin: skew(spin) }),
        scene::Motion::Free => {
            let weight =
                scene.gravity.as_deref().map_or(SVector::zeros(), vector::<D>) * (bodies.density - scene.flow.density) * ball.volume();
            let force = bodies.force.as_deref().map_or(SVector::zeros(), vector::<D>);
            let torque = bodies.torque.as_deref().map_or(SMatrix::zeros(), skew::<D>);
            Motion::Free { force: force + weight, torque }
        }
    }
}

/// Order of the modes of a body with so many cells per radius: what is asked for, or what the grid carries well.
fn order<const D: usize>(scene: &Scene, cells: f64) -> Result<usize> {
    let highest = (HIGHEST_ORDER_PER_CELL[D - 2] * cells + 1e-9) as usize;
    match resolution(scene)?.modes {
        Modes::Auto if D == 2 => Ok((cells.round() as usize).clamp(3, 16).min(highest)),
        Modes::Auto => Ok((cells.round() as usize - 1).clamp(2, 10).min(highest)),
        Modes::Count(modes) if modes > highest => {
            let remedy = format!("is too many for {cells:.2} cells per radius: at most {highest}; lower it or refine the grid");
            Err(scene.refuse("resolution.modes", modes, &remedy))
        }
        Modes::Count(modes) => Ok(modes),
    }
}
