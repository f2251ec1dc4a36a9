//! The effects of a scene: what is built for each, and which are off.

use std::borrow::Cow;

use super::{Plan, memory::distinct_laplacians};
use crate::{
    flow::{Drive, InverseMethod},
    geometry::{Domain, Protocol, RateStep},
    grid::Grid,
    interaction::{Interaction, Interactions},
    linalg::ROUNDING,
    motion::ShiftPeriod,
    scene::{FlowModel, MOST_WITH_FORCES, Motion, Scene, Scheme, Step, TimeSection},
    setup::Setup,
};

/// An effect of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Its name.
    pub name: Cow<'static, str>,
    /// What is built for it; nothing if it is off.
    pub built: Option<String>,
}

impl Effect {
    /// One that is built so.
    pub fn on(name: impl Into<Cow<'static, str>>, built: String) -> Effect {
        Effect { name: name.into(), built: Some(built) }
    }

    /// One that is off.
    pub fn off(name: &'static str) -> Effect {
        Effect { name: name.into(), built: None }
    }
}

/// Effects of a flow, but for those of motion.
pub fn flow_effects<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> Vec<Effect> {
    let hierarchies = distinct_laplacians(grid);
    let free = setup.bodies.iter().filter(|suspended| suspended.body.free()).count();
    let spins = (free > 0).then(|| format!("spins of {free} bodies, which follow from the flow"));
    vec![
        Effect::on(
            flow_name(setup),
            match setup.inverse {
                InverseMethod::Hypre => format!("one matrix a component, {hierarchies} multigrid hierarchies (hypre)"),
                method if method.is_exact(&setup.domain) => "no matrices: exact Stokes solver by Fourier transforms".into(),
                InverseMethod::Transform => "one matrix a component, transforms along all axes in the place of multigrid".into(),
            },
        ),
        Effect::on("pressure", "one unknown for each cell".into()),
        Effect { name: "rotation".into(), built: spins },
        Effect::on("drive", shear(&setup.domain).unwrap_or_else(|| changing_drive(setup)) + &sliding(setup, grid)),
        match setup.bodies.len() {
            0 => Effect::off("bodies"),
            count => Effect::on(
                "bodies",
                format!("{count}, {free} of them free, fraction {:.4}; {}", setup.fraction(), setup.method(0.0).description()),
            ),
        },
    ]
}

/// The name of a flow.
pub fn flow_name<const D: usize>(setup: &Setup<D>) -> &'static str {
    if setup.inertia.is_some() { "navier-stokes flow" } else { "stokes flow" }
}

/// Inertia of fluid and bodies.
pub fn inertia<const D: usize>(setup: &Setup<D>) -> Effect {
    let built = setup.inertia.as_ref().map(|inertia| {
        let built = "convection and the flow of two earlier times; one operator for each length of step, all else implicit";
        format!("fluid of density {}: {built}", inertia.fluid)
    });
    Effect { name: "inertia".into(), built }
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

/// What drives a flow, with how it changes.
fn changing_drive<const D: usize>(setup: &Setup<D>) -> String {
    let Some((strongest, factor)) = &setup.changing_drive else { return drive(&setup.drive) };
    let how = match factor {
        Protocol::Oscillation { frequency, .. } => format!("{} cos(2 pi {frequency} time)", factor.fastest()),
        Protocol::Steps { steps, factor } => steps_in_words(steps, *factor),
        Protocol::Steady(factor) | Protocol::Stress { rate: factor, .. } => factor.to_string(),
    };
    format!("{} times {how}", drive(strongest))
}

fn steps_in_words(steps: &[RateStep], factor: f64) -> String {
    let step = |step: &RateStep| {
        let until = if step.until.is_finite() { format!(" until {:.6}", step.until) } else { String::new() };
        format!("{}{until}", factor * step.rate)
    };
    steps.iter().map(step).collect::<Vec<_>>().join(", ")
}

/// How a shear changes its rate, if it does.
fn shear<const D: usize>(domain: &Domain<D>) -> Option<String> {
    Some(match domain.protocol()? {
        Protocol::Steady(rate) => format!("shear at rate {rate}"),
        Protocol::Oscillation { amplitude, frequency } => {
            format!("shear that oscillates by a strain of {amplitude}, {frequency} cycles a time")
        }
        Protocol::Stress { stresses, .. } => format!("shear at the rate at which its stress is {}", steps_in_words(stresses, 1.0)),
        Protocol::Steps { steps, factor } => format!("shear at the rates {}", steps_in_words(steps, factor)),
    })
}

/// How the images of a sheared box go along.
fn sliding<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> String {
    let Some(period) = ShiftPeriod::of(&setup.domain, grid) else { return String::new() };
    match (period.protocol(), period.required()) {
        (None, true) => {
            format!("; images slide along, by a cell in {:.4e}: steps and the end are whole numbers of that", period.one_cell(0.0))
        }
        (None, false) => format!(
            "; images slide along, by a cell in {:.4e}: longer steps are whole numbers of that, in shorter ones the grid is oblique",
            period.one_cell(0.0)
        ),
        (Some(_), true) => "; images slide along by whole cells in every step".into(),
        (Some(_), false) => "; images slide along, in long steps by whole cells, in short ones the grid is oblique".into(),
    }
}

/// Effects of motion, which a fluid and dry bodies share.
pub fn in_time<const D: usize>(plan: &Plan<D>) -> Vec<Effect> {
    let scene = &plan.scene;
    let motion = scene.time.as_ref().map(|time| schedule(time, scene.flow.model));
    let frames = scene.time.as_ref().map(|time| format!("bodies every {}{}", scene.frame_interval(), frames_wait(scene, time)));
    let held = if scene.stores_vorticity() { "velocity, pressure and vorticity" } else { "velocity and pressure" };
    let fields = frames.as_ref().filter(|_| scene.stores_fields()).map(|_| format!("{held} of each cell in every frame"));
    let given = plan.setup().map_or(0, |setup| setup.given_motions().len());
    let forces = (scene.time.is_some() && (1..=MOST_WITH_FORCES).contains(&given)).then(|| {
        let coefficients = if scene.output.reference_velocity.is_some() { ", with coefficients of drag and lift" } else { "" };
        format!("of the fluid on {given} bodies with prescribed motion, after every step{coefficients}")
    });
    let energy = scene.output.energy.then(|| "kinetic energy, work, dissipation and losses in contacts, after every step".to_owned());
    let tied = plan.interactions().is_some_and(|interactions| interactions.group_of().iter().any(Option::is_some));
    let objects = (scene.time.is_some() && tied && scene.writes_objects())
        .then(|| format!("a row of each chain, cell and cluster every {}", scene.frame_interval()));
    let pairs = scene.output.pairs.then(|| "distribution and neighbours, from the frames once the run has ended".to_owned());
    let structure_factor = scene.output.structure_factor.then(|| "along periodic axes, from the frames once the run has ended".to_owned());
    let autocorrelation = scene.output.velocity_autocorrelation.then(|| "from the frames once the run has ended".to_owned());
    let displacements = scene.output.displacements.then(|| "mean squares, from the frames once the run has ended".to_owned());
    let picture = scene.output.picture.then(|| "at the end".to_owned());
    let effect = |(name, built): (&'static str, _)| Effect { name: name.into(), built };
    let of_output = [
        ("frames", frames),
        ("fields output", fields),
        ("forces output", forces),
        ("balance of energy", energy),
        ("tables of objects", objects),
        ("pair distribution", pairs),
        ("structure factor", structure_factor),
        ("displacements", displacements),
        ("velocity autocorrelation", autocorrelation),
        ("picture", picture),
    ];
    let motion = std::iter::once(effect(("motion in time", motion)));
    motion.chain(interactions(plan)).chain(of_output.map(effect)).collect()
}

/// What frames wait for where steps do not meet their times.
fn frames_wait(scene: &Scene, time: &TimeSection) -> &'static str {
    let whole = |ratio: f64| (ratio - ratio.round()).abs() <= ROUNDING * ratio;
    match time.step {
        Step::Fixed(step) if whole(scene.frame_interval() / step) => "",
        _ => ", with the first step at or after each multiple of that",
    }
}

/// To what time, by which rule and in which steps.
fn schedule(time: &TimeSection, model: FlowModel) -> String {
    let step = match time.step {
        Step::Fixed(step) => format!("steps of {step}"),
        Step::Auto if model == FlowModel::Stokes => {
            format!(
                "steps in which no body moves more than {} radii relative to its neighbours, nor errs by more than {:.1e}",
                time.travel, time.error
            )
        }
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
}

/// What bodies do to each other; of the usual effects also those that are off.
fn interactions<const D: usize>(plan: &Plan<D>) -> Vec<Effect> {
    let longest = plan.longest_step();
    let stable = |limits: bool| if limits { format!(", stable with steps up to {longest:.3e}") } else { String::new() };
    let on = |interaction: &dyn Interaction<D>| {
        Effect::on(interaction.name().to_owned(), interaction.describe() + &stable(interaction.steepest(1.0) > 0.0))
    };
    let built: Vec<Effect> = plan.interactions().into_iter().flat_map(Interactions::iter).map(on).collect();
    let absent = |name: &&str| built.iter().all(|effect| effect.name != *name);
    let off: Vec<Effect> = ["lubrication", "contact"].into_iter().filter(absent).map(Effect::off).collect();
    built.into_iter().chain(off).collect()
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
