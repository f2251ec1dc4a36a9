//! The effects of a scene: what is built for each, and which are off.

use super::memory::distinct_laplacians;
use crate::{
    flow::{Drive, InverseMethod},
    grid::Grid,
    scene::{ContactModel, Motion, Scene, Scheme, Step},
    simulation::{Setup, beat::Beat},
};

/// An effect of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Its name.
    pub name: &'static str,
    /// What is built for it; nothing if it is off.
    pub built: Option<String>,
}

impl Effect {
    /// One that is built so.
    pub fn on(name: &'static str, built: String) -> Effect {
        Effect { name, built: Some(built) }
    }

    /// One that is off.
    pub fn off(name: &'static str) -> Effect {
        Effect { name, built: None }
    }
}

/// Effects of a flow, but for those of motion.
pub fn flow_effects<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> Vec<Effect> {
    let hierarchies = distinct_laplacians(grid);
    let free = setup.bodies.iter().filter(|suspended| suspended.body.free()).count();
    let spins = (free > 0).then(|| format!("spins of {free} bodies, which follow from the flow"));
    vec![
        Effect::on(
            "stokes flow",
            match setup.inverse {
                InverseMethod::Hypre => format!("one matrix a component, {hierarchies} multigrid hierarchies (hypre)"),
                InverseMethod::Transform => "no matrices: exact inverse by Fourier transforms".into(),
            },
        ),
        Effect::on("pressure", "one unknown for each cell".into()),
        Effect { name: "rotation", built: spins },
        Effect::on("drive", drive(&setup.drive) + &sliding(setup, grid)),
        match setup.bodies.len() {
            0 => Effect::off("bodies"),
            count => Effect::on("bodies", format!("{count}, {free} of them free; {}", setup.method().description())),
        },
    ]
}

/// What drives a flow.
pub fn drive<const D: usize>(drive: &Drive<D>) -> String {
    match drive {
        Drive::Rest => "walls and forces only".into(),
        Drive::MeanVelocity(velocity) => format!("mean velocity {:?}", velocity.as_slice()),
        Drive::PressureGradient(gradient) => format!("pressure gradient {:?}", gradient.as_slice()),
        Drive::BodyForce(force) => format!("body force {:?}", force.as_slice()),
        Drive::Shear(rate) => format!("background shear at rate {rate}"),
    }
}

/// How the images of a sheared box go along.
fn sliding<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> String {
    let beat = Beat::of(&setup.domain, grid);
    beat.map_or(String::new(), |beat| {
        format!("; images slide along, by a cell in {:.4e}: steps and the end are whole numbers of that", beat.0)
    })
}

/// Effects of motion, which a fluid and dry bodies share.
///
/// `longest` is the longest step with which contact is stable.
pub fn in_time(scene: &Scene, longest: f64) -> Vec<Effect> {
    let motion = scene.time.as_ref().map(|time| {
        let step = match time.step {
            Step::Fixed(step) => format!("steps of {step}"),
            Step::Auto => format!("steps in which no body moves more than {} radii", time.travel),
        };
        let scheme = match time.scheme {
            Scheme::TwoStep => "two-step",
            Scheme::Midpoint => "midpoint",
            Scheme::Euler => "Euler",
        };
        let until = time.until.map_or(String::new(), |until| {
            let (percent, strain) = (100.0 * until.viscosity_interval, until.strain);
            format!(", or until 95 % confidence leaves the mean viscosity +- {percent} % over a strain of at least {strain}")
        });
        format!("to time {} by the {scheme} rule, {step}{until}", time.end)
    });
    let contact = match scene.contact.model {
        ContactModel::None => None,
        ContactModel::Inelastic => Some("inelastic, one quadratic program a step, split into islands".to_owned()),
        ContactModel::Gluey { gamma_min } => {
            let least = gamma_min.map_or("without limit".to_owned(), |least| format!("down to {least}"));
            Some(format!("gluey, one quadratic program a step, split into islands, and a memory for each contact that sticks, {least}"))
        }
        ContactModel::Repulsion { stiffness, range } => {
            Some(format!("repulsion of stiffness {stiffness} within {range} radii, stable with steps up to {longest:.3e}"))
        }
    };
    let frames = scene.time.as_ref().map(|_| format!("bodies every {}", scene.frame_interval()));
    let fields = frames.as_ref().filter(|_| scene.output.fields).map(|_| "velocity and pressure of each cell in every frame".to_owned());
    let pairs = scene.output.pairs.then(|| "distribution and neighbours, from the frames once the run has ended".to_owned());
    let picture = scene.output.picture.then(|| "at the end".to_owned());
    let effect = |(name, built)| Effect { name, built };
    let of_motion = [("motion in time", motion), ("lubrication", lubrication(scene)), ("contact", contact)];
    of_motion
        .into_iter()
        .chain([("frames", frames), ("fields output", fields), ("pair distribution", pairs), ("picture", picture)])
        .map(effect)
        .collect()
}

fn lubrication(scene: &Scene) -> Option<String> {
    let roughness = scene.lubrication.roughness()?;
    let pores = if scene.dimension() == 2 { " and the pores between them" } else { "" };
    Some(format!(
        "what modes miss of films between near bodies and walls, pair by pair; no gap below {roughness} radii; \
         one sparse matrix of the bodies' motions{pores} preconditions it"
    ))
}

/// The weight of free bodies that differ from the fluid in density.
pub fn gravity(scene: &Scene) -> Effect {
    let density = if scene.dry() { 0.0 } else { scene.flow.density };
    let heavy = scene.bodies.iter().any(|bodies| bodies.motion == Motion::Free && bodies.density != density);
    match &scene.gravity {
        Some(gravity) if heavy && gravity.iter().any(|&component| component != 0.0) => {
            let less = if density > 0.0 { " less buoyancy" } else { "" };
            Effect::on("gravity", format!("{gravity:?}, weight{less} of free bodies"))
        }
        _ => Effect::off("gravity"),
    }
}
