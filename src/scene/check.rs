//! What sections of a scene demand of each other.

use crate::error::Result;
use crate::flow::InverseMethod;
use crate::friction::FrictionLaw;
use crate::geometry::Protocol;
use crate::scene::demand::{expect, name, walled};
use crate::scene::{
    AffineFlow, AxisSection, BodyGroup, Colour, ConstraintMethod, ContactModel, ContactSection, Drive, FlowModel, Joint, LubricationModel,
    Modes, Motion, MultiplierSolver, Scene, Scheme, Spacing, accuracy, energy, force_laws, load, protocol, regions,
};

/// Least order of multipliers that bear a strain.
const FEWEST_IN_A_FLUID: usize = 2;

pub(super) fn check(scene: &Scene) -> Result<()> {
    check_open(scene)?;
    check_chains(scene)?;
    check_clusters(scene)?;
    check_colour(scene)?;
    check_objects(scene)?;
    check_plane(scene)?;
    check_spacing(scene)?;
    check_modes(scene)?;
    check_contact(scene)?;
    check_constraint(scene)?;
    check_lubrication(scene)?;
    accuracy::check(scene)?;
    check_until(scene)?;
    check_reference(scene)?;
    check_structure_factor(scene)?;
    check_followed(scene)?;
    regions::check(scene)?;
    energy::check(scene)?;
    force_laws::check(scene)?;
    load::check(scene)?;
    if scene.dry() {
        return check_dry(scene);
    }
    if scene.scalar() {
        return check_scalar(scene);
    }
    check_inverse(scene)?;
    if scene.flow.model == FlowModel::NavierStokes {
        check_inertia(scene)?;
    }
    protocol::check_factor(scene)?;
    check_drive(scene)
}

/// Refuses what a drive cannot be together with.
fn check_drive(scene: &Scene) -> Result<()> {
    match &scene.flow.drive {
        Some(Drive::ShearRate(protocol)) => protocol::check_shear(scene, protocol),
        Some(Drive::ShearedBox(protocol)) => protocol::check_sheared_box(scene, protocol),
        Some(Drive::MeanVelocity(vector)) => check_walls(scene, "flow.drive.mean_velocity", vector),
        Some(Drive::PressureGradient(vector)) => check_walls(scene, "flow.drive.pressure_gradient", vector),
        Some(Drive::MeanGradient(gradient)) => {
            let remedy = "is for a scalar (flow.model = \"scalar\") only; a fluid has pressure_gradient";
            Err(scene.refuse("flow.drive.mean_gradient", format!("{gradient:?}"), remedy))
        }
        Some(Drive::BodyForce(_)) | None => Ok(()),
    }
}

/// Refuses a plane of pictures through which images slide, or beside the box.
fn check_plane(scene: &Scene) -> Result<()> {
    let (plane, drive) = (scene.output.plane, &scene.flow.drive);
    let slides = plane == Some([1, 2]) && matches!(drive, Some(Drive::ShearedBox(_)));
    expect(scene, !slides, "output.plane", "\"yz\"", "images of a sheared box slide through this plane; choose \"xy\" or \"xz\"")?;
    let Some(place) = scene.output.plane_at else { return Ok(()) };
    let depth = scene.depth_of_pictures().unwrap_or(0);
    let size = scene.domain.size[depth];
    expect(
        scene,
        (0.0..=size).contains(&place),
        "output.plane_at",
        place,
        &format!("must lie in the box, from 0 to {size} along {}", name(depth)),
    )
}

/// Refuses what an inflow and an outflow do not go with.
fn check_open(scene: &Scene) -> Result<()> {
    let mut open = scene.domain.axes.iter().enumerate().filter_map(|(axis, section)| match section {
        AxisSection::Open { inflow, .. } => Some((format!("domain.{}.inflow", name(axis)), inflow)),
        _ => None,
    });
    let Some((key, inflow)) = open.next() else { return Ok(()) };
    let expect = |right, remedy| expect(scene, right, &key, inflow, remedy);
    expect(open.next().is_none(), "only one axis may be open; make the others periodic or walls")?;
    expect(scene.flow.model.fluid(), "needs a fluid; set flow.model = \"stokes\" or \"navier-stokes\", or another boundary")?;
    expect(scene.method.constraint != ConstraintMethod::Fitted, "is for grids; set method.constraint = \"sharp\"")?;
    expect(scene.flow.drive.is_none(), "drives the flow already; remove flow.drive")
}

/// Refuses chains where their bonds are not followed.
fn check_chains(scene: &Scene) -> Result<()> {
    let Some(group) = scene.bodies.iter().position(|bodies| bodies.chain.is_some()) else { return Ok(()) };
    let beads = scene.bodies[group].chain.map_or(0, |chain| chain.beads);
    let expect = |right, remedy| expect(scene, right, &format!("{}.beads", scene.group_key(group)), beads, remedy);
    let dry = scene.flow.model == FlowModel::None;
    expect(
        scene.flow.model.fluid() || dry,
        "are beads with mass or in a fluid; set flow.model = \"none\", \"stokes\" or \"navier-stokes\"",
    )?;
    expect(dry || scene.method.constraint == ConstraintMethod::Sharp, "need method.constraint = \"sharp\"")?;
    expect(scene.time.is_some(), "move over a time step; add [time]")?;
    let fixed = scene.bodies.iter().position(|bodies| bodies.chain.is_some_and(|chain| chain.joints == Joint::Fixed));
    match fixed.filter(|_| dry) {
        Some(group) => {
            let remedy = "turns beads that a fluid turns, and there is none; remove it";
            Err(scene.refuse(&format!("{}.joints", scene.group_key(group)), "\"fixed\"", remedy))
        }
        None => Ok(()),
    }
}

/// Refuses rigid clusters where nothing holds them together.
fn check_clusters(scene: &Scene) -> Result<()> {
    let Some(group) = scene.bodies.iter().position(|bodies| bodies.cluster.is_some()) else { return Ok(()) };
    let held = scene.dry() || scene.method.constraint == ConstraintMethod::Sharp;
    let remedy = "is of clusters, which need method.constraint = \"sharp\"";
    expect(scene, held, &format!("{}.radius", scene.group_key(group)), scene.bodies[group].radius, remedy)
}

fn check_colour(scene: &Scene) -> Result<()> {
    let remedy = "tells chains, cells and clusters apart, and there are none; remove it";
    let tied = scene.bodies.iter().any(BodyGroup::together);
    expect(scene, tied || scene.output.colour != Colour::Chain, "output.colour", "\"chain\"", remedy)?;
    let sheared = AffineFlow::of(scene).is_some();
    let remedy = "is relative to a shear, which neither walls nor the box impose; remove it";
    expect(scene, sheared || scene.output.colour != Colour::NonAffine, "output.colour", "\"nonaffine\"", remedy)
}

/// Refuses tables of objects where there are none.
fn check_objects(scene: &Scene) -> Result<()> {
    let tied = scene.bodies.iter().any(BodyGroup::together);
    let remedy = "tells of chains, cells and clusters, and there are none; remove it";
    expect(scene, tied || scene.output.objects != Some(true), "output.objects", "true", remedy)
}

fn check_spacing(scene: &Scene) -> Result<()> {
    let Some(Spacing::CellsPerRadius(cells)) = scene.resolution.as_ref().map(|resolution| resolution.spacing) else { return Ok(()) };
    let remedy = "there are no bodies to measure by; give resolution.spacing instead";
    expect(scene, !scene.bodies.is_empty(), "resolution.cells_per_radius", cells, remedy)
}

/// Refuses multipliers of first order in a fluid: they let surfaces strain with the flow, in 2D (the traction of a stresslet is the Fourier mode -2) as in
/// 3D (it is of degree 2).
fn check_modes(scene: &Scene) -> Result<()> {
    let Some(Modes::Count(modes)) = scene.resolution.as_ref().map(|resolution| resolution.modes) else { return Ok(()) };
    let bears_strain = modes >= FEWEST_IN_A_FLUID || scene.scalar() || !scene.method.constraint.has_modes();
    let remedy = "lets surfaces strain with the flow: bodies would have no stresslet, and the suspension the viscosity of its fluid; must be at least 2";
    expect(scene, bears_strain, "resolution.modes", modes, remedy)
}

fn check_constraint(scene: &Scene) -> Result<()> {
    let remedy = match (scene.method.constraint, scene.flow.model) {
        (ConstraintMethod::Sharp, _) => return Ok(()),
        (_, FlowModel::None) => "has no meaning without a fluid; remove it",
        (ConstraintMethod::Fitted, _) if scene.dimension() != 2 => "makes meshes in two dimensions only; set method.constraint = \"sharp\"",
        (ConstraintMethod::Fitted, _) if scene.contact.model != ContactModel::None => {
            "leaves no room for contacts: no mesh fits between bodies that touch; set contact.model = \"none\" or method.constraint = \"sharp\""
        }
        (ConstraintMethod::Fitted, FlowModel::Scalar) if walled(scene).next().is_none() => {
            "carries no mean gradient through a fully periodic box; set method.constraint = \"sharp\""
        }
        _ => return Ok(()),
    };
    Err(scene.refuse("method.constraint", format!("{:?}", scene.method.constraint.word()), remedy))
}

fn check_contact(scene: &Scene) -> Result<()> {
    let (model, remedy) = (scene.contact.model, "contacts act over a time step; add [time]");
    expect(scene, model == ContactModel::None || scene.time.is_some(), "contact.model", format!("{:?}", model.word()), remedy)?;
    check_friction(scene)
}

/// Refuses friction where contacts have none yet, and roughness where it means nothing.
fn check_friction(scene: &Scene) -> Result<()> {
    let friction = scene.contact.friction.coefficient;
    if let Some(roughness) = scene.contact.roughness {
        let expect = |right, remedy| expect(scene, right, "contact.roughness", roughness, remedy);
        expect(!scene.dry(), "only bodies in a fluid touch at a gap; remove it")?;
    }
    let tolerance = scene.contact.tolerance;
    if tolerance != ContactSection::default().tolerance {
        let of_friction = scene.dry() && (friction > 0.0 || scene.frictions_differ());
        expect(
            scene,
            of_friction,
            "contact.tolerance",
            tolerance,
            "is that of forces of dry bodies with friction; remove it, or set contact.friction",
        )?;
    }
    check_surfaces(scene)?;
    if friction == 0.0 {
        return Ok(());
    }
    let expect = |right, remedy| expect(scene, right, "contact.friction", friction, remedy);
    let resolved = scene.dry() || scene.method.constraint == ConstraintMethod::Sharp;
    expect(resolved, "acts in dry runs and with method.constraint = \"sharp\" so far; set that or remove it")?;
    check_convex(scene)?;
    check_turning(scene)
}

/// Refuses the convex law, which is one of a step, where steps are not by Euler's rule.
fn check_convex(scene: &Scene) -> Result<()> {
    let by_euler = scene.time.as_ref().is_some_and(|time| time.scheme == Scheme::Euler);
    let convex = frictions(scene).find(|(_, law)| law.convex).filter(|_| !scene.dry() && !by_euler);
    let remedy = "acts in dry runs and in Stokes flow with time.scheme = \"euler\"; set that, or take law = \"exact\"";
    convex.map_or(Ok(()), |(key, _)| Err(scene.refuse(&format!("{key}.law"), "\"convex\"", remedy)))
}

/// Refuses surfaces that differ where friction knows one coefficient, or none.
fn check_surfaces(scene: &Scene) -> Result<()> {
    let of_groups = frictions_of_groups(scene);
    for (key, law) in of_groups.chain(scene.contact.wall_friction.map(|law| ("contact.wall_friction".into(), law))) {
        expect(
            scene,
            scene.contact.friction.coefficient > 0.0,
            &key,
            law.coefficient,
            "needs contact.friction, the coefficient of all other surfaces; set that or remove it",
        )?;
    }
    Ok(())
}

/// Friction of all surfaces, walls and groups.
fn frictions(scene: &Scene) -> impl Iterator<Item = (String, FrictionLaw)> {
    let ContactSection { friction, wall_friction, .. } = scene.contact;
    let of_walls = wall_friction.map(|law| ("contact.wall_friction".to_owned(), law));
    std::iter::once(("contact.friction".to_owned(), friction)).chain(of_walls).chain(frictions_of_groups(scene))
}

fn frictions_of_groups(scene: &Scene) -> impl Iterator<Item = (String, FrictionLaw)> {
    (0..).zip(&scene.bodies).filter_map(|(group, bodies)| Some((format!("{}.friction", scene.group_key(group)), bodies.friction?)))
}

/// Refuses friction against twisting where bodies have no such spin.
fn check_turning(scene: &Scene) -> Result<()> {
    for (key, law) in frictions(scene) {
        expect(
            scene,
            law.twisting == 0.0 || scene.dimension() == 3,
            &format!("{key}.twisting"),
            law.twisting,
            "disks do not twist about a normal; remove it",
        )?;
    }
    Ok(())
}

fn check_lubrication(scene: &Scene) -> Result<()> {
    let remedy = match (scene.lubrication.model, scene.method.constraint) {
        (LubricationModel::None, _) => return Ok(()),
        (_, _) if scene.dry() => "needs a fluid; set contact.model = \"gluey\" or remove it",
        (_, ConstraintMethod::Sharp) => return Ok(()),
        _ => "corrects the modes of the sharp method, and of no other; set method.constraint = \"sharp\"",
    };
    Err(scene.refuse("lubrication.model", "\"pairwise\"", remedy))
}

fn check_inverse(scene: &Scene) -> Result<()> {
    let remedy = "transforms need a box without an inflow; set method.inverse = \"hypre\" or \"auto\"";
    expect(
        scene,
        scene.method.inverse != Some(InverseMethod::Transform)
            || !scene.domain.axes.iter().any(|axis| matches!(axis, AxisSection::Open { .. })),
        "method.inverse",
        "\"transform\"",
        remedy,
    )
}

fn check_dry(scene: &Scene) -> Result<()> {
    let expect = |right, remedy| expect(scene, right, "flow.model", "\"none\"", remedy);
    expect(!scene.bodies.is_empty(), "no fluid and no bodies leave nothing to simulate; add [[bodies]]")?;
    expect(scene.time.is_some(), "a dry scene has no instantaneous solve; add [time]")?;
    check_masses(scene, "of a dry scene")?;
    if scene.contact.friction.coefficient > 0.0 || scene.bodies.iter().any(|bodies| bodies.motion == Motion::Wall) {
        return Ok(());
    }
    check_still_walls(scene, "without fluid and friction a moving wall does not act on bodies; remove it or set contact.friction")
}

fn check_scalar(scene: &Scene) -> Result<()> {
    check_still_walls(scene, "a moving wall does not act on a scalar")?;
    let wall = walled(scene).next();
    match (&scene.flow.drive, wall) {
        (None, Some(_)) => Ok(()),
        (None, None) => {
            let remedy = "needs a wall, where the scalar is 0; set domain.x = \"walls\" or another axis, or give flow.drive.mean_gradient";
            Err(scene.refuse("flow.model", "\"scalar\"", remedy))
        }
        (Some(Drive::MeanGradient(gradient)), Some(axis)) => {
            let remedy = format!("needs a fully periodic box, but domain.{} has walls, where the scalar is 0", name(axis));
            Err(scene.refuse("flow.drive.mean_gradient", format!("{gradient:?}"), &remedy))
        }
        (Some(Drive::MeanGradient(_)), None) if scene.flow.source != 0.0 => {
            let remedy = "must be 0 with a mean gradient: what a source brings into a fully periodic box cannot leave it";
            Err(scene.refuse("flow.source", scene.flow.source, remedy))
        }
        (Some(Drive::MeanGradient(gradient)), None) if gradient.iter().all(|&component| component == 0.0) => {
            Err(scene.refuse("flow.drive.mean_gradient", format!("{gradient:?}"), "must not be 0: nothing else drives the scalar"))
        }
        (Some(Drive::MeanGradient(_)), None) => Ok(()),
        (Some(_), _) => unreachable!("other drives of a scalar are refused by their keys"),
    }
}

fn check_masses(scene: &Scene, what: &str) -> Result<()> {
    let massless = scene.bodies.iter().position(|bodies| bodies.motion == Motion::Free && bodies.density == 0.0);
    let Some(group) = massless else { return Ok(()) };
    let remedy = format!("must be positive: free bodies {what} need mass");
    Err(scene.refuse(&format!("{}.density", scene.group_key(group)), 0, &remedy))
}

/// What a flow with inertia needs, and what it does not have yet.
fn check_inertia(scene: &Scene) -> Result<()> {
    let model = |right, remedy: &str| expect(scene, right, "flow.model", "\"navier-stokes\"", remedy);
    model(scene.time.is_some(), "has no solution at an instant; add [time], or set flow.model = \"stokes\"")?;
    let remedy = "must be positive with flow.model = \"navier-stokes\": give the mass of the fluid per volume";
    expect(scene, scene.flow.density > 0.0, "flow.density", scene.flow.density, remedy)?;
    check_masses(scene, "in a flow with inertia")?;
    let krylov = scene.method.constraint.solver() == MultiplierSolver::Krylov;
    let remedy = "is for Stokes flow only; set method.solver = \"krylov\" or flow.model = \"stokes\"";
    expect(scene, krylov, "method.solver", "\"uzawa\"", remedy)?;
    if let Some(time) = scene.time.as_ref().filter(|time| time.scheme != Scheme::TwoStep) {
        let word = Scheme::WORDS.iter().find(|(_, scheme)| *scheme == time.scheme).map_or("", |(word, _)| word);
        return Err(scene.refuse("time.scheme", format!("{word:?}"), "is for Stokes flow and dry scenes; remove it"));
    }
    let refuse = |key: &str, drive: String| {
        let remedy = "cannot drive a fully periodic box of fluid with inertia; put up walls, or give flow.drive.mean_velocity";
        Err(scene.refuse(key, drive, remedy))
    };
    match &scene.flow.drive {
        Some(Drive::ShearedBox(_)) => {
            let remedy = "has inertia in a sheared box by method.constraint = \"sharp\" only; choose it, or shear between walls";
            let word = scene.method.constraint.word();
            expect(scene, scene.method.constraint == ConstraintMethod::Sharp, "method.constraint", format!("{word:?}"), remedy)
        }
        Some(Drive::PressureGradient(vector)) if walled(scene).next().is_none() => {
            refuse("flow.drive.pressure_gradient", format!("{vector:?}"))
        }
        Some(Drive::BodyForce(vector)) if walled(scene).next().is_none() => refuse("flow.drive.body_force", format!("{vector:?}")),
        _ => Ok(()),
    }
}

/// Walls move along themselves, so only a fluid or friction would feel it.
fn check_still_walls(scene: &Scene, reason: &str) -> Result<()> {
    for (axis, section) in scene.domain.axes.iter().enumerate() {
        let AxisSection::Walls { lower, upper } = section else { continue };
        for (wall, velocity) in [("lower", lower), ("upper", upper)] {
            let (key, still) = (format!("domain.{}.{wall}", name(axis)), velocity.iter().all(|&component| component == 0.0));
            expect(scene, still, &key, format!("{velocity:?}"), &format!("must be 0: {reason}"))?;
        }
    }
    Ok(())
}

/// Only a sheared suspension of free bodies has a viscosity.
fn check_until(scene: &Scene) -> Result<()> {
    let Some(until) = scene.time.as_ref().and_then(|time| time.until) else { return Ok(()) };
    let free = !scene.bodies.is_empty() && scene.bodies.iter().all(|bodies| bodies.motion == Motion::Free);
    let known = scene.flow.model == FlowModel::Stokes && free && sheared(scene);
    let remedy = "is that of a sheared suspension of free bodies in Stokes flow; remove it, or let walls across one axis slide and others be periodic";
    expect(scene, known, "time.until.viscosity_interval", until.viscosity_interval, remedy)
}

/// Wave vectors are those of periodic axes.
fn check_structure_factor(scene: &Scene) -> Result<()> {
    let periodic = scene.domain.axes.iter().any(|axis| matches!(axis, AxisSection::Periodic));
    let remedy = "takes waves along a periodic axis, and the box has none; set domain.x = \"periodic\" or remove it";
    expect(scene, periodic || !scene.output.structure_factor, "output.structure_factor", "true", remedy)
}

/// Bodies are followed relative to a shear whose rate is known at every time.
fn check_followed(scene: &Scene) -> Result<()> {
    let by_stress = scene.shear_protocol().is_some_and(|protocol| protocol.stresses().is_some());
    let remedy = "is measured relative to a shear whose rate the scene gives, and flow.drive.shear_stress finds it; give flow.drive.shear_rate or remove it";
    let asked = [("displacements", scene.output.displacements), ("velocity_autocorrelation", scene.output.velocity_autocorrelation)];
    asked.into_iter().try_for_each(|(name, on)| expect(scene, !on || !by_stress, &format!("output.{name}"), "true", remedy))
}

/// Coefficients of drag and lift are forces on bodies whose motion is given, over time, over those of the stream's inertia.
fn check_reference(scene: &Scene) -> Result<()> {
    let Some(velocity) = &scene.output.reference_velocity else { return Ok(()) };
    let expect = |right, remedy| expect(scene, right, "output.reference_velocity", format!("{velocity:?}"), remedy);
    expect(scene.flow.model.fluid(), "is that of a flow past bodies, and nothing flows; remove it")?;
    expect(scene.time.is_some(), "coefficients of drag and lift are computed over time; add [time] or remove it")?;
    expect(scene.flow.density > 0.0, "coefficients of drag and lift are forces over those of inertia; give flow.density or remove it")?;
    let held = scene.bodies.iter().any(|bodies| bodies.motion != Motion::Free);
    expect(held, "coefficients need bodies with prescribed motion, and there are none; set bodies.motion or remove it")
}

/// Whether a background shear or sliding walls across the only axis that has walls shear the box.
fn sheared(scene: &Scene) -> bool {
    if let Some(Drive::ShearRate(protocol) | Drive::ShearedBox(protocol)) = &scene.flow.drive {
        return matches!(protocol, Protocol::Steady(rate) if *rate != 0.0);
    }
    let walled: Vec<usize> = walled(scene).collect();
    let [axis] = walled[..] else { return false };
    matches!(&scene.domain.axes[axis], AxisSection::Walls { lower, upper } if lower != upper)
}

fn check_walls(scene: &Scene, key: &str, vector: &[f64]) -> Result<()> {
    let Some(axis) = walled(scene).find(|&axis| vector[axis] != 0.0) else { return Ok(()) };
    Err(scene.refuse(key, format!("{vector:?}"), &format!("number {} must be 0: domain.{} has walls", axis + 1, name(axis))))
}
