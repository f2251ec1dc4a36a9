//! Scenes resolved in their dimension: bodies placed, what is left open chosen.

use nalgebra::{SMatrix, SVector};

use super::{chains, interactions, modes, protocol, surroundings::opposite_neighbours};
use crate::{
    body::{Body, Motion, Trajectories, Twist, skew},
    error::Result,
    flow::{Drive, InverseMethod},
    geometry::Domain,
    grid::quick_spacing,
    interaction::{Interactions, Lubrication},
    motion::{GranularBody, GranularSetup, WallLoad, longest_granular_step},
    parallel::Peers,
    scene::{self, BodyGroup, ConstraintMethod, ContactModel, FlowModel, Modes, ResolutionSection, Scene, Spacing},
    setup::{
        Inertia, Setup, SuspendedBody,
        placement::{bodies, check_ends, domain, trajectories, vector},
        room::FEWEST_CELLS_PER_RADIUS,
    },
    surface::Shape,
};

impl<const D: usize> GranularSetup<D> {
    /// Resolves a dry scene of dimension `D`.
    ///
    /// # Errors
    /// Bodies overlap or lie outside, or do not fit at the asked fraction.
    pub fn of(scene: &Scene) -> Result<GranularSetup<D>> {
        Self::on(Peers::Alone, scene)
    }

    /// The same by ranks that place many bodies together; collective.
    ///
    /// # Errors
    /// The same.
    pub fn on(peers: Peers, scene: &Scene) -> Result<GranularSetup<D>> {
        let domain = domain(scene);
        let of_group = |(group, body): (usize, crate::body::Body<D>)| {
            let given = &scene.bodies[group];
            let start = start(given);
            let mass = given.density * body.ball.volume();
            let inertia = given.density * body.ball.moment_of_inertia();
            let (center, radius) = (body.ball.center, body.ball.radius);
            match body.motion {
                Motion::Free { force, torque } => {
                    GranularBody { radius, center, twist: start, mass, inertia, acceleration: force / mass, spin_up: torque / inertia }
                }
                Motion::Prescribed(twist) => GranularBody {
                    radius,
                    center,
                    twist,
                    mass: f64::INFINITY,
                    inertia: f64::INFINITY,
                    acceleration: SVector::zeros(),
                    spin_up: SMatrix::zeros(),
                },
            }
        };
        let placed = bodies(peers, scene, &domain)?;
        let trajectories = trajectories(peers, scene, &placed)?;
        let (bonds, welds) = (chains::bonds(scene, &placed), interactions::welds(scene, &placed));
        let groups: Vec<usize> = placed.iter().map(|(group, _)| *group).collect();
        let bodies: Vec<GranularBody<D>> = placed.into_iter().map(of_group).collect();
        let interactions = interactions::of_granular(scene, &domain, &bodies, &groups)?;
        let interactions = if let Some(bonds) = bonds { interactions.with(bonds) } else { interactions };
        let interactions = if let Some(welds) = welds { interactions.with(welds) } else { interactions };
        let load = wall_load(scene, &bodies, &groups);
        Ok(GranularSetup { interactions, domain, bodies, trajectories, load })
    }

    /// The longest step with which contact is stable; infinite if it limits none.
    pub fn longest_step(&self) -> f64 {
        longest_granular_step(&self.interactions, &self.bodies)
    }
}

/// The wall that a load presses on the bodies of a scene, each with its group.
fn wall_load<const D: usize>(scene: &Scene, bodies: &[GranularBody<D>], groups: &[usize]) -> Option<WallLoad> {
    let (axis, scene::NormalLoad { stress, wall_mass }) = (scene.domain.loaded_axis()?, scene.domain.load?);
    let area = scene.domain.size.iter().enumerate().filter(|(other, _)| *other != axis).map(|(_, size)| size).product::<f64>();
    let free = || bodies.iter().filter(|body| body.mass.is_finite());
    let of_layer = || free().map(|body| body.mass).sum::<f64>() / free().map(|body| (2.0 * body.radius).powi(D as i32 - 1)).sum::<f64>();
    let is_fixed = |body: &usize| scene.bodies[groups[*body]].motion == scene::Motion::Wall;
    let fixed = (0..bodies.len()).filter(is_fixed).collect();
    Some(WallLoad { axis, force: stress * area, mass: wall_mass.unwrap_or_else(of_layer) * area, fixed })
}

impl<const D: usize> Setup<D> {
    /// Resolves a scene of dimension `D`: places its bodies and chooses what it leaves open.
    ///
    /// # Errors
    /// Bodies overlap or lie outside, do not fit at the asked fraction, or are too small for the grid or the modes.
    pub fn of(scene: &Scene) -> Result<Setup<D>> {
        Self::on(Peers::Alone, scene)
    }

    /// The same by ranks that place many bodies together; collective.
    ///
    /// # Errors
    /// The same.
    pub fn on(peers: Peers, scene: &Scene) -> Result<Setup<D>> {
        let domain = domain(scene);
        let placed = bodies(peers, scene, &domain)?;
        let groups = || placed.iter().map(|&(group, _)| &scene.bodies[group]);
        let inertia = (scene.flow.model == FlowModel::NavierStokes).then(|| Inertia {
            fluid: scene.flow.density,
            bodies: groups().map(|group| group.density).collect(),
            starts: placed.iter().map(|(group, body)| started(&domain, &scene.bodies[*group], &body.ball.center)).collect(),
        });
        let trajectories = trajectories(peers, scene, &placed)?;
        let (bonds, joints) = (chains::bonds(scene, &placed), chains::joints(scene, &placed));
        let welds = interactions::welds(scene, &placed);
        let groups: Vec<usize> = placed.iter().map(|&(group, _)| group).collect();
        let (spacing, bodies) = suspended_bodies(scene, &domain, placed)?;
        let setup = Setup { inertia, ..Setup::with_bodies(scene, domain, spacing, bodies, trajectories) };
        let setup = match setup.may_be_oblique() {
            true => setup,
            false => Setup { domain: protocol::whole(scene, setup.domain, spacing)?, ..setup },
        };
        let by_expressions = interactions::by_expressions(scene, setup.bodies.iter().map(|suspended| suspended.body.ball.radius))?;
        let more = interactions::friction(scene, &groups).into_iter().chain(by_expressions);
        let setup = Setup { interactions: Interactions::new(setup.interactions.shared().chain(more)), ..setup };
        let setup = match bonds {
            Some(bonds) => setup.with(bonds),
            None => setup,
        };
        let setup = match joints {
            Some(joints) => setup.with(joints),
            None => setup,
        };
        Ok(match welds {
            Some(welds) => setup.with(welds),
            None => setup,
        })
    }

    /// The setup of a scene in which these are the bodies, some of them on trajectories.
    pub(super) fn with_bodies(
        scene: &Scene,
        domain: Domain<D>,
        spacing: f64,
        bodies: Vec<SuspendedBody<D>>,
        trajectories: Trajectories<D>,
    ) -> Setup<D> {
        let inverse = scene.method.inverse.unwrap_or_else(|| InverseMethod::fastest(&domain));
        let setup = Setup {
            domain,
            spacing,
            viscosity: scene.flow.viscosity,
            drive: drive(scene).scaled(scene.flow.drive_factor.rate(0.0)),
            changing_drive: (!scene.flow.drive_factor.steady()).then(|| (drive(scene), scene.flow.drive_factor)),
            bodies,
            inertia: None,
            trajectories,
            constraint: scene.method.constraint,
            interactions: Interactions::default(),
            inverse,
            tolerance: scene.method.tolerance,
        };
        let setup = match scene.lubrication.roughness() {
            Some(roughness) => setup.with(Lubrication::new(roughness)),
            None => setup,
        };
        setup.with_contact(scene.contact.model)
    }

    /// The same with contacts by a model, whose numbers count in the force that drives bodies.
    pub fn with_contact(self, model: ContactModel) -> Setup<D> {
        let contact = interactions::contact_in_flow(model, &self);
        let all: Vec<_> = self.interactions.shared().chain(contact).collect();
        Setup { interactions: Interactions::new(all), ..self }
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

/// How the free bodies of a group move at the start.
fn start<const D: usize>(group: &BodyGroup) -> Twist<D> {
    Twist {
        velocity: group.velocity.as_deref().map_or(SVector::zeros(), vector::<D>),
        spin: group.spin.as_deref().map_or(SMatrix::zeros(), skew::<D>),
    }
}

/// How a free body of a group moves at the start in a fluid with inertia: in a sheared box, relative to the shear.
fn started<const D: usize>(domain: &Domain<D>, group: &BodyGroup, center: &SVector<f64, D>) -> Twist<D> {
    let Twist { velocity, spin } = start(group);
    Twist { velocity: velocity + domain.carried(center), spin: spin + domain.carried_spin() }
}

fn drive<const D: usize>(scene: &Scene) -> Drive<D> {
    match &scene.flow.drive {
        // refused: fluids have no mean gradient
        None | Some(scene::Drive::MeanGradient(_)) => Drive::Rest,
        Some(scene::Drive::MeanVelocity(velocity)) => Drive::MeanVelocity(vector(velocity)),
        Some(scene::Drive::PressureGradient(gradient)) => Drive::PressureGradient(vector(gradient)),
        Some(scene::Drive::BodyForce(force)) => Drive::BodyForce(vector(force)),
        // walls shear what is between them
        Some(scene::Drive::ShearRate(_)) if scene.domain.axes[1] != scene::AxisSection::Periodic => Drive::Rest,
        Some(scene::Drive::ShearRate(protocol) | scene::Drive::ShearedBox(protocol)) => Drive::Shear(protocol.rate(0.0)),
    }
}

/// The spacing of the grid of a scene, and its bodies with the order of their modes for that which it asks for.
///
/// # Errors
/// A body is too small for the grid or the modes.
pub(super) fn suspended_bodies<const D: usize>(
    scene: &Scene,
    domain: &Domain<D>,
    placed: Vec<(usize, Body<D>)>,
) -> Result<(f64, Vec<SuspendedBody<D>>)> {
    let radii = placed.iter().map(|(_, body)| body.ball.radius);
    let spacing = resolution(scene)?.spacing.length(radii.fold(f64::INFINITY, f64::min));
    check_ends(scene, domain, spacing, &placed)?;
    let balls: Vec<_> = placed.iter().map(|(_, body)| body.ball).collect();
    let surrounded = match resolution(scene)?.modes {
        Modes::Count(_) => vec![false; balls.len()],
        Modes::Auto | Modes::Most => opposite_neighbours(domain, &balls),
    };
    let bodies = placed.iter().zip(surrounded).map(|(&(group, body), surrounded)| {
        let bare = surrounded || fixed_in_plane::<D>(&scene.bodies[group]);
        suspended(scene, body, bare, spacing)
    });
    Ok((grid_spacing(scene, domain, spacing), bodies.collect::<Result<_>>()?))
}

/// The spacing of the grid of a scene that asks for one.
pub(super) fn grid_spacing<const D: usize>(scene: &Scene, domain: &Domain<D>, asked: f64) -> f64 {
    let exactly = scene.resolution.as_ref().is_some_and(|resolution| matches!(resolution.spacing, Spacing::Exactly(_)));
    let fitted = scene.method.constraint == ConstraintMethod::Fitted;
    if exactly || fitted { asked } else { quick_spacing(&domain.size, asked) }
}

/// Whether bodies are disks that never move: between two such no film resists, and the flow through a bed of them takes all modes.
pub(super) fn fixed_in_plane<const D: usize>(group: &BodyGroup) -> bool {
    D == 2 && group.motion == scene::Motion::Fixed
}

/// A body with the order of its modes on a grid; films do not stand for the modes of a `bare` one.
///
/// # Errors
/// It is too small for the grid or the modes.
pub(super) fn suspended<const D: usize>(scene: &Scene, body: Body<D>, bare: bool, spacing: f64) -> Result<SuspendedBody<D>> {
    let cells = body.ball.radius / spacing;
    if cells < FEWEST_CELLS_PER_RADIUS * (1.0 - 1e-9) {
        let remedy = format!("leaves {cells:.2} cells per radius {}; at least {FEWEST_CELLS_PER_RADIUS} are needed", body.ball.radius);
        let (key, value) = resolution(scene)?.spacing.key();
        return Err(scene.refuse(key, value, &remedy));
    }
    Ok(SuspendedBody { body, order: modes::order::<D>(scene, resolution(scene)?.modes, cells, bare)? })
}
