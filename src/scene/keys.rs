//! A scene as keys and values, as a file writes them: what two scenes are compared by, and the text of a scene that was built in Rust.

use std::fmt::Display;

use toml_edit::Value;

use crate::body::Outline;
use crate::flow::InverseMethod;
use crate::geometry::{Protocol, RateStep};
use crate::scene::entry::word_of;
use crate::scene::groups::chains::{rest_word, word as shape_word};
use crate::scene::sections::{PLANES, PROFILES};
use crate::scene::{
    AxisSection, BodyGroup, Chain, ChainShape, Cluster, ClusterForm, Colour, ConstraintMethod, ContactModel, ContactSection, DomainSection,
    Drive, FlowModel, FlowSection, ForceTexts, InteractionSection, LubricationModel, MethodSection, Modes, Motion, MultiplierSolver,
    NormalLoad, OutputSection, Placement, ResolutionSection, Scene, Scheme, Shape, SizeDistribution, Step, TimeSection, Until,
};
use crate::{contact::FRICTION_TOLERANCE, friction::FrictionLaw};

/// Keys with their values, in the order of a scene file.
pub(super) type Keys = Vec<(String, String)>;

/// Keys and values of a scene, defaults included, without keys that mean nothing in it.
pub(super) fn keys(scene: &Scene) -> Keys {
    // without `..`, so that no new section is forgotten
    let Scene {
        name: _,
        title,
        seed,
        gravity,
        accuracy,
        domain,
        flow,
        resolution,
        method,
        bodies,
        interactions,
        contact,
        lubrication,
        time,
        output,
        locations: _,
        text: _,
    } = scene;
    let mut keys = vec![text("title", title), pair("seed", seed)];
    keys.extend(gravity.as_deref().map(|gravity| list("gravity", gravity)));
    keys.extend(of_domain(domain));
    keys.extend(of_flow(flow));
    keys.extend(accuracy.map(|accuracy| number("accuracy", accuracy)));
    keys.extend(resolution.iter().flat_map(of_resolution));
    if !scene.dry() {
        keys.extend(of_method(method, flow.model));
    }
    keys.extend(of_groups(scene, bodies));
    for (number, interaction) in interactions.iter().enumerate() {
        keys.extend(of_interaction(interaction).into_iter().map(|(key, value)| (format!("interactions[{number}].{key}"), value)));
    }
    if !scene.scalar() {
        keys.extend(of_contact(contact));
        keys.extend(of_lubrication(lubrication.model));
    }
    keys.extend(time.iter().flat_map(|time| of_time(time, scene.flow.model)));
    keys.extend(of_output(output, time.is_some(), flow.model));
    keys
}

fn of_lubrication(model: LubricationModel) -> Keys {
    match model {
        LubricationModel::None => vec![word("lubrication.model", "none")],
        LubricationModel::Pairwise { roughness } => vec![word("lubrication.model", "pairwise"), number("lubrication.roughness", roughness)],
    }
}

/// The text of a scene file that holds these keys.
pub(super) fn file_of(keys: &Keys) -> String {
    let (mut file, mut tables, mut group) = (String::new(), String::new(), None);
    for (key, value) in keys {
        let of_group = |name: &'static str| Some((name, key.strip_prefix(name)?.strip_prefix('[')?.split_once("].")?));
        let Some((name, (number, key))) = ["bodies", "chains", "cells", "clusters", "interactions"].into_iter().find_map(of_group) else {
            file += &format!("{key} = {value}\n");
            continue;
        };
        if group != Some((name, number)) {
            tables += &format!("\n[[{name}]]\n");
            group = Some((name, number));
        }
        match key.split_once('[') {
            // the list stays open for the next place
            Some((list, "0]")) => tables += &format!("{list} = [{value}]\n"),
            Some(_) => tables.insert_str(tables.len() - 2, &format!(", {value}")),
            None => tables += &format!("{key} = {value}\n"),
        }
    }
    file + &tables
}

fn pair(key: &str, value: impl Display) -> (String, String) {
    (key.to_owned(), value.to_string())
}

fn number(key: &str, value: f64) -> (String, String) {
    // a float that looks like an integer may be too long for one
    let text = if value.abs() < 1e15 { value.to_string() } else { format!("{value:?}") };
    (key.to_owned(), text.replace("NaN", "nan"))
}

fn word(key: &str, value: &str) -> (String, String) {
    pair(key, format!("{value:?}"))
}

/// A text with whatever signs.
fn text(key: &str, value: &str) -> (String, String) {
    pair(key, Value::from(value))
}

fn list(key: &str, value: &[f64]) -> (String, String) {
    (key.to_owned(), format!("{value:?}").replace("NaN", "nan"))
}

fn of_domain(domain: &DomainSection) -> Keys {
    let DomainSection { size, axes, load } = domain;
    let mut keys = vec![list("domain.size", size)];
    for (name, axis) in ["x", "y", "z"].into_iter().zip(axes) {
        match axis {
            AxisSection::Periodic => keys.push(word(&format!("domain.{name}"), "periodic")),
            AxisSection::Walls { lower, upper } => {
                keys.push(list(&format!("domain.{name}.lower"), lower));
                keys.push(list(&format!("domain.{name}.upper"), upper));
            }
            AxisSection::Open { inflow, parabolic } => {
                keys.push(number(&format!("domain.{name}.inflow"), *inflow));
                keys.push(word(&format!("domain.{name}.profile"), word_of(&PROFILES, parabolic)));
            }
        }
    }
    if let Some(NormalLoad { stress, wall_mass }) = load {
        keys.push(number("domain.normal_stress", *stress));
        keys.extend(wall_mass.map(|mass| number("domain.wall_mass", mass)));
    }
    keys
}

fn of_flow(flow: &FlowSection) -> Keys {
    let FlowSection { model, viscosity, density, drive, drive_factor, source } = flow;
    let mut keys = vec![word("flow.model", word_of(&FlowModel::WORDS, model))];
    match model {
        FlowModel::None => {}
        FlowModel::Scalar => keys.push(number("flow.source", *source)),
        FlowModel::Stokes | FlowModel::NavierStokes => {
            keys.extend([number("flow.viscosity", *viscosity), number("flow.density", *density)]);
        }
    }
    keys.extend(matches!(drive, Some(Drive::ShearedBox(_))).then(|| word("flow.drive.periodic", "sheared")));
    keys.extend(drive.iter().flat_map(|drive| match drive {
        Drive::MeanVelocity(velocity) => vec![list("flow.drive.mean_velocity", velocity)],
        Drive::PressureGradient(gradient) => vec![list("flow.drive.pressure_gradient", gradient)],
        Drive::BodyForce(force) => vec![list("flow.drive.body_force", force)],
        Drive::ShearRate(protocol) | Drive::ShearedBox(protocol) => of_protocol(protocol),
        Drive::MeanGradient(gradient) => vec![list("flow.drive.mean_gradient", gradient)],
    }));
    keys.extend(of_factor(drive_factor));
    keys
}

/// What a drive is multiplied by, but for one.
fn of_factor(factor: &Protocol) -> Keys {
    let key = "flow.drive.factor";
    match factor {
        Protocol::Steady(factor) => (*factor != 1.0).then(|| number(key, *factor)).into_iter().collect(),
        Protocol::Oscillation { frequency, .. } => {
            vec![number(&format!("{key}.amplitude"), factor.fastest()), number(&format!("{key}.frequency"), *frequency)]
        }
        _ => of_steps(key, factor, "value"),
    }
}

fn of_protocol(protocol: &Protocol) -> Keys {
    let key = "flow.drive.shear_rate";
    match protocol {
        Protocol::Steady(rate) => vec![number(key, *rate)],
        Protocol::Stress { stresses: [one], .. } => vec![number("flow.drive.shear_stress", one.rate)],
        Protocol::Stress { stresses, .. } => vec![listed("flow.drive.shear_stress", stresses, 1.0, "stress")],
        Protocol::Oscillation { amplitude, frequency } => {
            vec![number(&format!("{key}.amplitude"), *amplitude), number(&format!("{key}.frequency"), *frequency)]
        }
        Protocol::Steps { .. } => of_steps(key, protocol, "rate"),
    }
}

/// Steps of what a word names.
fn of_steps(key: &str, protocol: &Protocol, name: &str) -> Keys {
    let Protocol::Steps { steps, factor } = protocol else { return Vec::new() };
    vec![listed(key, steps, *factor, name)]
}

/// A list of steps, each times a factor.
fn listed(key: &str, steps: &[RateStep], factor: f64, name: &str) -> (String, String) {
    let until = |step: &RateStep| if step.until.is_finite() { format!("until = {:?}, ", step.until) } else { String::new() };
    let steps: Vec<String> = steps.iter().map(|step| format!("{{ {}{name} = {:?} }}", until(step), factor * step.rate)).collect();
    pair(key, format!("[{}]", steps.join(", ")))
}

fn of_resolution(resolution: &ResolutionSection) -> Keys {
    let ResolutionSection { spacing, modes } = resolution;
    let (key, spacing) = spacing.key();
    let spacing = number(key, spacing);
    let modes = match modes {
        Modes::Auto => word("resolution.modes", "auto"),
        Modes::Most => word("resolution.modes", "most"),
        Modes::Count(count) => pair("resolution.modes", count),
    };
    vec![spacing, modes]
}

fn of_method(method: &MethodSection, model: FlowModel) -> Keys {
    let MethodSection { constraint, inverse, tolerance } = method;
    let mut keys = vec![word("method.constraint", constraint.word())];
    keys.extend(match constraint {
        ConstraintMethod::Penalty(epsilon) => vec![automatic("method.epsilon", *epsilon)],
        ConstraintMethod::MeanValue(MultiplierSolver::Krylov) => vec![word("method.solver", "krylov")],
        ConstraintMethod::MeanValue(MultiplierSolver::Uzawa(step)) => {
            vec![word("method.solver", "uzawa"), automatic("method.uzawa_step", *step)]
        }
        ConstraintMethod::Sharp | ConstraintMethod::Distributed | ConstraintMethod::Fitted => vec![],
    });
    // a scalar is always solved by multigrid
    keys.extend(model.fluid().then(|| word("method.inverse", inverse.map_or("auto", InverseMethod::word))));
    keys.push(pair("method.tolerance", tolerance.text()));
    keys
}

fn automatic(key: &str, value: Option<f64>) -> (String, String) {
    value.map_or_else(|| word(key, "auto"), |value| number(key, value))
}

fn of_groups(scene: &Scene, groups: &[BodyGroup]) -> Keys {
    let of_group = |(group, bodies): (usize, &BodyGroup)| {
        let name = scene.group_key(group);
        of_bodies(bodies, scene.flow.model).into_iter().map(move |(key, value)| (format!("{name}.{key}"), value))
    };
    groups.iter().enumerate().flat_map(of_group).collect()
}

fn of_bodies(bodies: &BodyGroup, model: FlowModel) -> Keys {
    let BodyGroup {
        shape: Shape::Ball,
        radius,
        sizes,
        placement,
        region,
        rotation,
        gap,
        density,
        friction,
        motion,
        force,
        torque,
        velocity,
        spin,
        chain,
        cluster,
    } = bodies;
    let mut keys = match (chain, cluster) {
        (Some(chain), _) => of_chain(chain),
        (None, Some(cluster)) => of_cluster(cluster),
        (None, None) => vec![word("shape", "ball")],
    };
    keys.push(number("radius", *radius));
    keys.extend(sizes.iter().flat_map(of_sizes));
    keys.extend(of_placement(placement, *gap));
    keys.extend(region.iter().map(|region| pair("region", region.text())));
    if model != FlowModel::Scalar {
        keys.push(number("density", *density));
        keys.extend(friction.iter().flat_map(|law| of_friction("friction", law)));
        keys.extend(if bodies.together() { Vec::new() } else { of_motion(motion) });
    }
    let lists = [("rotation", rotation), ("force", force), ("torque", torque), ("velocity", velocity), ("spin", spin)];
    keys.extend(lists.into_iter().filter_map(|(key, numbers)| Some((key, numbers.as_deref()?))).map(|(key, numbers)| match numbers {
        [rate] => number(key, *rate),
        numbers => list(key, numbers),
    }));
    keys
}

fn of_placement(placement: &Placement, gap: f64) -> Keys {
    match placement {
        Placement::Fraction(fraction) => vec![number("fraction", *fraction), number("gap", gap)],
        Placement::Count(count) => vec![pair("count", count), number("gap", gap)],
        Placement::Centers(centers) if centers.is_empty() => vec![pair("centers", "[]")],
        Placement::Centers(centers) => (0..).zip(centers).map(|(index, center)| list(&format!("centers[{index}]"), center)).collect(),
        Placement::File(path) => vec![text("file", &path.to_string_lossy())],
    }
}

fn of_sizes(sizes: &SizeDistribution) -> Keys {
    match sizes {
        SizeDistribution::List(radii) => vec![list("sizes", radii)],
        SizeDistribution::Bidisperse { ratio, share } => vec![number("sizes.ratio", *ratio), number("sizes.share", *share)],
        SizeDistribution::LogNormal { deviation, smallest, largest } => {
            vec![number("sizes.deviation", *deviation), number("sizes.smallest", *smallest), number("sizes.largest", *largest)]
        }
    }
}

fn of_chain(chain: &Chain) -> Keys {
    let Chain { beads, spacing, stretch, bend, angle, shape, joints, outline } = chain;
    let stretch = stretch.map_or_else(|| word("stretch", "rigid"), |stretch| number("stretch", stretch));
    let mut keys = vec![pair("beads", beads), number("spacing", *spacing), stretch, number("bend", *bend)];
    // a ring has a natural angle of its own
    keys.extend((*angle != 0.0 && *bend > 0.0).then(|| number("angle", *angle)));
    if *shape != ChainShape::Cell {
        keys.extend([word("shape", shape_word(*shape)), word("joints", joints.word())]);
    } else if *outline != Outline::default() {
        keys.push(word("rest", rest_word(outline.rest)));
        keys.extend(outline.reduced_area.map(|reduced_area| number("reduced_area", reduced_area)));
    }
    keys
}

fn of_cluster(cluster: &Cluster) -> Keys {
    let Cluster { form, spacing } = cluster;
    let mut keys: Keys = form.word().map(|shape| word("shape", shape)).into_iter().collect();
    match form {
        ClusterForm::Rod(beads) => keys.push(pair("beads", beads)),
        ClusterForm::Offsets(offsets) => keys.extend((0..).zip(offsets).map(|(place, offset)| list(&format!("offsets[{place}]"), offset))),
        ClusterForm::Cross | ClusterForm::Triangle | ClusterForm::Tetrahedron => {}
    }
    keys.extend(form.word().map(|_| number("spacing", *spacing)));
    keys
}

fn of_motion(motion: &Motion) -> Keys {
    match motion {
        Motion::PathFile(path) => vec![text("motion.path", &path.to_string_lossy())],
        Motion::Free => vec![word("motion", "free")],
        Motion::Fixed => vec![word("motion", "fixed")],
        Motion::Wall => vec![word("motion", "wall")],
        Motion::Prescribed { velocity, spin } => {
            let spin = if let [rate] = spin[..] { number("motion.spin", rate) } else { list("motion.spin", spin) };
            vec![list("motion.velocity", velocity), spin]
        }
        Motion::Oscillating { amplitude, rotation, frequency, phase } => {
            let rotation = if let [angle] = rotation[..] { number("motion.rotation", angle) } else { list("motion.rotation", rotation) };
            vec![list("motion.amplitude", amplitude), rotation, number("motion.frequency", *frequency), number("motion.phase", *phase)]
        }
        Motion::Path(places) => (0..).zip(places).map(|(index, place)| list(&format!("motion.path[{index}]"), place)).collect(),
    }
}

fn of_friction(key: &str, law: &FrictionLaw) -> Keys {
    if law.is_plain() {
        return vec![number(key, law.coefficient)];
    }
    let FrictionLaw { coefficient, rolling, twisting, critical_load, convex } = *law;
    let others =
        [("rolling", rolling), ("twisting", twisting), ("critical_load", critical_load)].into_iter().filter(|(_, value)| *value > 0.0);
    let numbers = std::iter::once(("coefficient", coefficient)).chain(others).map(|(name, value)| number(&format!("{key}.{name}"), value));
    numbers.chain(convex.then(|| text(&format!("{key}.law"), "convex"))).collect()
}

fn of_interaction(interaction: &InteractionSection) -> Keys {
    let InteractionSection { name, force, constants } = interaction;
    let texts = |key: &str, texts: &[String]| (key.to_owned(), Value::from_iter(texts).to_string());
    let mut keys = vec![text("name", name)];
    keys.extend(match force {
        ForceTexts::Pair { force, reach } => vec![text("pair_force", force), number("reach", *reach)],
        ForceTexts::Body { force, torque } => {
            let torque = match &torque[..] {
                [] => None,
                [torque] => Some(text("torque", torque)),
                torque => Some(texts("torque", torque)),
            };
            std::iter::once(texts("body_force", force)).chain(torque).collect()
        }
    });
    keys.extend(constants.iter().map(|(name, value)| number(&format!("constants.{name}"), *value)));
    keys
}

fn of_contact(contact: &ContactSection) -> Keys {
    let ContactSection { model, friction, wall_friction, roughness, tolerance } = contact;
    let mut keys = vec![word("contact.model", model.word())];
    keys.extend(match model {
        ContactModel::Inelastic => {
            let friction =
                Some(friction).filter(|law| law.coefficient > 0.0).into_iter().flat_map(|law| of_friction("contact.friction", law));
            let of_walls = wall_friction.iter().flat_map(|law| of_friction("contact.wall_friction", law));
            let roughness = roughness.map(|roughness| number("contact.roughness", roughness));
            let tolerance = Some(*tolerance)
                .filter(|tolerance| *tolerance != FRICTION_TOLERANCE)
                .map(|tolerance| number("contact.tolerance", tolerance));
            friction.chain(of_walls).chain(roughness).chain(tolerance).collect()
        }
        ContactModel::None => vec![],
        ContactModel::Repulsion { stiffness, range } => vec![number("contact.stiffness", *stiffness), number("contact.range", *range)],
        ContactModel::Gluey { gamma_min } => gamma_min.map(|least| number("contact.gamma_min", least)).into_iter().collect(),
    });
    keys
}

fn of_time(time: &TimeSection, model: FlowModel) -> Keys {
    let TimeSection { step, end, scheme, travel, error, until } = time;
    let mut keys = vec![word("time.scheme", word_of(&Scheme::WORDS, scheme)), number("time.end", *end)];
    keys.extend(match step {
        Step::Auto => vec![word("time.step", "auto"), number("time.travel", *travel)],
        Step::Fixed(step) => vec![number("time.step", *step)],
    });
    if (model, *step) == (FlowModel::Stokes, Step::Auto) {
        keys.push(number("time.error", *error));
    }
    if let Some(Until { viscosity_interval, strain }) = until {
        keys.extend([number("time.until.viscosity_interval", *viscosity_interval), number("time.until.strain", *strain)]);
    }
    keys
}

fn of_output(output: &OutputSection, in_time: bool, model: FlowModel) -> Keys {
    let OutputSection {
        picture,
        report,
        plane,
        plane_at,
        colour,
        every,
        fields,
        vorticity,
        vtkhdf,
        objects,
        checkpoint,
        probe,
        pairs,
        structure_factor,
        displacements,
        velocity_autocorrelation,
        profiles,
        energy,
        reference_velocity,
    } = output;
    let mut keys = vec![
        pair("output.picture", picture),
        pair("output.pairs", pairs),
        pair("output.structure_factor", structure_factor),
        pair("output.report", report),
    ];
    keys.extend(plane.as_ref().map(|plane| word("output.plane", word_of(&PLANES, plane))));
    keys.extend(plane_at.map(|place| number("output.plane_at", place)));
    keys.extend(every.map(|every| number("output.every", every)));
    keys.extend(probe.map(|points| pair("output.probe", points)));
    if in_time {
        keys.push(pair("output.displacements", displacements));
        keys.push(pair("output.velocity_autocorrelation", velocity_autocorrelation));
        keys.push(number("output.checkpoint", *checkpoint));
        keys.extend(objects.map(|objects| pair("output.objects", objects)));
    }
    keys.extend(fields.filter(|_| model.fluid()).map(|fields| pair("output.fields", fields)));
    keys.extend(model.fluid().then(|| pair("output.vorticity", vorticity)));
    keys.extend((model != FlowModel::Scalar).then(|| pair("output.vtkhdf", vtkhdf)));
    keys.extend((model.fluid() || colour.of_bodies()).then(|| word("output.colour", word_of(&Colour::WORDS, colour))));
    let axes: Vec<&str> = profiles.iter().map(|&axis| ["x", "y", "z"][axis]).collect();
    keys.extend((!axes.is_empty()).then(|| pair("output.profiles", format!("{axes:?}"))));
    keys.extend((model == FlowModel::NavierStokes).then(|| pair("output.energy", energy)));
    keys.extend(reference_velocity.as_deref().map(|velocity| list("output.reference_velocity", velocity)));
    keys
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::error::Error;
    use crate::scene::{Locations, Spacing};

    /// Every example is the same scene when it is taken apart and built anew.
    #[test]
    fn a_scene_that_is_built_is_that_of_its_file() {
        let folders = ["examples", "examples/bench", "examples/cost", "examples/study"];
        let examples =
            folders.into_iter().flat_map(|folder| std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap());
        let scenes = examples.map(|entry| entry.unwrap().path()).filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
        let mut count = 0;
        for path in scenes {
            let read = Scene::read(&path, &[]).unwrap();
            let built = read.clone().checked().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert_eq!(Scene { text: built.text.clone(), locations: Locations::default(), ..read }, built, "{}", path.display());
            count += 1;
        }
        assert!(count > 10, "only {count} examples");
    }

    #[test]
    fn a_scene_that_is_built_passes_the_checks_of_a_file() {
        let mut scene = Scene::new("built", &[4.0, 4.0]);
        scene.title = "a \"title\"\nof two lines".into();
        scene.bodies = vec![BodyGroup::new(-1.0, Placement::Centers(vec![vec![1.0, 2.0], vec![3.0, 2.0]]))];
        scene.resolution = Some(ResolutionSection::new(Spacing::CellsPerRadius(6.0)));
        let Err(Error::Refused(refusal)) = scene.clone().checked() else { panic!("not refused") };
        assert_eq!((refusal.key.as_deref(), refusal.value.as_deref(), refusal.place.clone()), (Some("bodies[0].radius"), Some("-1"), None));
        assert_eq!(refusal.to_string(), "bodies[0].radius = -1: must be positive");
        scene.bodies[0].radius = 0.5;
        let built = scene.clone().checked().unwrap();
        assert_eq!(Scene { text: String::new(), ..built.clone() }, scene);
        assert_eq!(built.refuse("bodies[0].radius", 1, "no").to_string(), "bodies[0].radius = 1: no");
        scene.resolution = None;
        assert!(scene.checked().unwrap_err().to_string().starts_with("resolution needs one of"));
    }
}
