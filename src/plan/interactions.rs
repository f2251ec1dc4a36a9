//! The interactions that a scene calls for, in the units of its run, and the longest step with which they are stable.
//!
//! The stiffness of a repulsion counts in the force that drives bodies. In a flow that is the largest of: the force on a free
//! body, `mu rate a^(D-1)` of walls or background in shear, `mu U a^(D-2)` of a mean velocity or of bodies whose motion is given,
//! and `|G| L a^(D-1) / 2` of a pressure gradient between walls `L` apart (of a periodic box: `L = a`), with the largest
//! radius `a`. In a dry run it is the energy of the hardest impact to be expected, `m U^2 + |f| L`, over `a`, with the largest
//! mass, speed at the start and force and the longest edge `L` of the box.

use std::rc::Rc;

use crate::{
    body::{Body, Motion, Twist},
    error::Result,
    flow::Drive,
    friction::SurfaceFriction,
    geometry::{Axis, Ball, Domain},
    interaction::{Cluster, Friction, Gluey, Inelastic, Interaction, Interactions, Repulsion, UnequalFriction, Welds},
    motion::GranularBody,
    scene::{ContactModel, ForceLaw, Scene, Step},
    setup::Setup,
};

/// The interactions of dry bodies.
///
/// # Errors
/// A force that is given by an expression is not finite between bodies of their radii.
pub fn of_granular<const D: usize>(
    scene: &Scene,
    domain: &Domain<D>,
    bodies: &[GranularBody<D>],
    groups: &[usize],
) -> Result<Interactions<D>> {
    let contact = contact(scene.contact.model, || {
        let largest =
            |number: fn(&GranularBody<D>) -> f64| bodies.iter().map(number).filter(|number| number.is_finite()).fold(0.0, f64::max);
        let (mass, speed) = (largest(|body| body.mass), largest(|body| body.twist.velocity.norm()));
        let force = largest(|body| if body.mass.is_finite() { body.mass * body.acceleration.norm() } else { 0.0 });
        (mass * speed * speed + force * domain.size.max()) / largest(|body| body.radius)
    });
    let by_expressions = by_expressions(scene, bodies.iter().map(|body| body.radius))?;
    Ok(Interactions::new(contact.into_iter().chain(friction(scene, groups)).chain(by_expressions)))
}

/// The forces of a scene that are given by expressions, on bodies of these radii.
///
/// # Errors
/// One is not finite between such bodies.
pub fn by_expressions<const D: usize>(scene: &Scene, radii: impl Iterator<Item = f64> + Clone) -> Result<Vec<Rc<dyn Interaction<D>>>> {
    let radii = [radii.clone().fold(f64::INFINITY, f64::min), radii.fold(0.0, f64::max)];
    let shared = |law| -> Rc<dyn Interaction<D>> {
        match law {
            ForceLaw::Pair(law) => Rc::new(law),
            ForceLaw::Body(law) => Rc::new(law),
        }
    };
    Ok(scene.force_laws(radii)?.into_iter().map(shared).collect())
}

/// Friction and roughness of the surfaces of a scene, whose bodies are of these groups, if there are any.
pub fn friction<const D: usize>(scene: &Scene, groups: &[usize]) -> Option<Rc<dyn Interaction<D>>> {
    let law = scene.contact.friction;
    let (coefficient, tolerance) = (law.coefficient, scene.contact.tolerance);
    let of_films = scene.lubrication.roughness().filter(|_| coefficient > 0.0);
    let roughness = scene.contact.roughness.or(of_films).unwrap_or(0.0);
    if scene.frictions_differ() || !law.is_plain() {
        let bodies = groups.iter().map(|&group| scene.bodies[group].friction.unwrap_or(law)).collect();
        let surfaces = SurfaceFriction::new(bodies, scene.contact.wall_friction.unwrap_or(law));
        let friction = Friction { coefficient: surfaces.largest().coefficient, roughness, tolerance };
        return Some(Rc::new(UnequalFriction { friction, surfaces }));
    }
    (coefficient > 0.0 || roughness > 0.0).then(|| -> Rc<dyn Interaction<D>> { Rc::new(Friction { coefficient, roughness, tolerance }) })
}

/// The welds of the rigid clusters of a scene, whose bodies are these, each with its group; none without clusters.
pub fn welds<const D: usize>(scene: &Scene, bodies: &[(usize, Body<D>)]) -> Option<Welds<D>> {
    let (mut clusters, mut first) = (Vec::new(), 0);
    for group in bodies.chunk_by(|one, next| one.0 == next.0) {
        if let Some(cluster) = &scene.bodies[group[0].0].cluster {
            for (number, balls) in group.chunks(cluster.balls()).enumerate() {
                let balls: Vec<Ball<D>> = balls.iter().map(|(_, body)| body.ball).collect();
                clusters.push(Cluster::new(first + number * cluster.balls(), &balls));
            }
        }
        first += group.len();
    }
    (!clusters.is_empty()).then(|| Welds::new(clusters, bodies.len()))
}

/// The interaction of a contact model between bodies in a flow.
pub fn contact_in_flow<const D: usize>(model: ContactModel, setup: &Setup<D>) -> Option<Rc<dyn Interaction<D>>> {
    contact(model, || {
        let radius = setup.bodies.iter().map(|suspended| suspended.body.ball.radius).fold(0.0, f64::max);
        let (surface, viscosity) = (radius.powi(D as i32 - 1), setup.viscosity);
        let of_body = |motion: Motion<D>| match motion {
            Motion::Free { force, torque } => force.norm() + torque.norm() / radius,
            Motion::Prescribed(Twist { velocity, spin }) => viscosity * (velocity.norm() / radius + spin.norm()) * surface,
        };
        let bodies = setup.fastest_motions().into_iter().map(of_body).fold(0.0, f64::max);
        bodies.max(surface * walls(setup)).max(surface * drive(setup, radius))
    })
}

/// The interaction of a contact model whose forces are in a unit.
fn contact<const D: usize>(model: ContactModel, unit: impl FnOnce() -> f64) -> Option<Rc<dyn Interaction<D>>> {
    match model {
        ContactModel::None => None,
        ContactModel::Inelastic => Some(Rc::new(Inelastic)),
        ContactModel::Gluey { gamma_min } => Some(Rc::new(Gluey { least: gamma_min.unwrap_or(f64::NEG_INFINITY) })),
        ContactModel::Repulsion { stiffness, range } => Some(Rc::new(Repulsion { touch: stiffness * unit(), range })),
    }
}

/// Shear stress that walls cause.
fn walls<const D: usize>(setup: &Setup<D>) -> f64 {
    let rate = |axis: usize| match &setup.domain.axes[axis] {
        Axis::Periodic | Axis::Sheared(_) => 0.0,
        Axis::Walls { lower, upper } => (upper - lower).norm() / setup.domain.size[axis],
        Axis::MovingWalls { upper, .. } => 2.0 * upper.fastest() / setup.domain.size[axis],
        Axis::Open(inflow) => inflow.speed.abs() / setup.domain.size.min(),
    };
    setup.viscosity * (0..D).map(rate).fold(0.0, f64::max)
}

/// Stress that the drive causes on bodies of a radius.
fn drive<const D: usize>(setup: &Setup<D>, radius: f64) -> f64 {
    let between_walls = (0..D).filter(|&axis| !setup.domain.periodic(axis)).map(|axis| setup.domain.size[axis]);
    let width = between_walls.fold(radius, f64::max);
    match setup.strongest_drive() {
        Drive::Rest => 0.0,
        Drive::MeanVelocity(velocity) => setup.viscosity * velocity.norm() / radius,
        Drive::PressureGradient(force) | Drive::BodyForce(force) => 0.5 * force.norm() * width,
        Drive::Shear(rate) => setup.viscosity * rate.abs(),
    }
}

/// Refuses a repulsion without a unit, and a fixed step that is too long for the interactions.
pub fn check<const D: usize>(scene: &Scene, interactions: &Interactions<D>, longest: f64) -> Result<()> {
    let repulsion = matches!(scene.contact.model, ContactModel::Repulsion { .. });
    let steep: Vec<_> = interactions.iter().filter(|interaction| interaction.steepest(1.0) > 0.0).collect();
    let touches = |interaction: &&dyn Interaction<D>| interaction.contact().touch.is_some();
    match scene.time.as_ref().map(|time| time.step) {
        _ if repulsion && !steep.iter().any(touches) => {
            let remedy = "has no force to be measured by: nothing drives the bodies; give them gravity, a force, a velocity or a flow";
            Err(scene.refuse("contact.model", "\"repulsion\"", remedy))
        }
        Some(Step::Fixed(step)) if step > longest => {
            let (what, remedy) = if repulsion && steep.iter().all(touches) {
                ("contact.model = \"repulsion\", which is".into(), "shorten it, set it to \"auto\", or lower contact.stiffness")
            } else {
                let names = steep.iter().map(|interaction| interaction.name()).collect::<Vec<_>>().join(", ");
                (format!("the interactions ({names}), which are"), "shorten it or set it to \"auto\"")
            };
            Err(scene.refuse("time.step", step, &format!("is too long for {what} stable up to {longest:.3e}; {remedy}")))
        }
        _ => Ok(()),
    }
}
