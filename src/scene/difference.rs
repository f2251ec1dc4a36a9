//! In which key two scenes differ, for runs that continue what another run began.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::body::read_text;
use crate::error::Result;
use crate::scene::{
    AxisSection, BodyGroup, ConstraintMethod, ContactModel, ContactSection, DomainSection, Drive, FlowModel, FlowSection, LubricationModel,
    LubricationSection, MethodSection, Modes, Motion, MultiplierSolver, Placement, ResolutionSection, Scene, Scheme, Shape, Spacing, Step,
    TimeSection,
};

/// A key in which two scenes differ, with both values as a scene file writes them; absent where a scene has no such key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// The key, written `bodies[0].radius`.
    pub key: String,
    /// The value in this scene.
    pub here: Option<String>,
    /// The value in the other scene.
    pub there: Option<String>,
}

impl Scene {
    /// The first key in which two scenes describe different runs.
    ///
    /// Title, `time.end`, `time.until` and output may differ, and so may the ways to write the same, such as a default.
    pub fn difference(&self, other: &Scene) -> Option<Difference> {
        let (here, there) = (keys(self), keys(other));
        let (ours, theirs) = (table(&here), table(&there));
        let mut names = here.iter().chain(&there).map(|(key, _)| key.as_str());
        let key = names.find(|key| ours.get(key) != theirs.get(key))?;
        let value = |table: &BTreeMap<&str, &str>| table.get(key).map(|&value| value.to_owned());
        Some(Difference { key: key.to_owned(), here: value(&ours), there: value(&theirs) })
    }

    /// Refuses a scene that describes another run than `other`, which belongs to `owner`, for example "the checkpoint".
    ///
    /// The message names the first key that differs with both values.
    pub fn same_run(&self, other: &Scene, owner: &str) -> Result<()> {
        let Some(Difference { key, here, there }) = self.difference(other) else {
            return Ok(());
        };
        let (here, there) = (here.as_deref().unwrap_or("nothing"), there.as_deref().unwrap_or("nothing"));
        let remedy = format!("{owner} has {there}; only title, time.end, time.until and output.* may differ");
        Err(self.refuse(&key, here, &remedy))
    }
}

type Keys = Vec<(String, String)>;

fn table(keys: &Keys) -> BTreeMap<&str, &str> {
    keys.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect()
}

/// Keys and values that decide what a run computes, in the order of a scene file.
fn keys(scene: &Scene) -> Keys {
    // without `..`, so that no new section is forgotten
    let Scene {
        name: _,
        title: _,
        seed,
        gravity,
        accuracy,
        domain,
        flow,
        resolution,
        method,
        bodies,
        contact,
        lubrication,
        time,
        output: _,
        locations: _,
        text: _,
    } = scene;
    let mut keys = vec![pair("seed", seed)];
    keys.extend(gravity.as_deref().map(|gravity| list("gravity", gravity)));
    keys.extend(of_domain(domain));
    keys.extend(of_flow(flow));
    keys.extend(accuracy.map(|accuracy| pair("accuracy", accuracy)));
    keys.extend(resolution.iter().flat_map(of_resolution));
    if !scene.dry() {
        keys.extend(of_method(method));
    }
    for (group, bodies) in bodies.iter().enumerate() {
        keys.extend(of_bodies(bodies).into_iter().map(|(key, value)| (format!("bodies[{group}].{key}"), value)));
    }
    keys.extend(of_contact(contact, lubrication));
    keys.extend(time.iter().flat_map(of_time));
    keys
}

fn pair(key: &str, value: impl Display) -> (String, String) {
    (key.to_owned(), value.to_string())
}

fn word(key: &str, value: &str) -> (String, String) {
    pair(key, format!("{value:?}"))
}

fn list(key: &str, value: &[f64]) -> (String, String) {
    pair(key, format!("{value:?}"))
}

fn of_domain(domain: &DomainSection) -> Keys {
    let DomainSection { size, axes } = domain;
    let mut keys = vec![list("domain.size", size)];
    for (name, axis) in ["x", "y", "z"].into_iter().zip(axes) {
        match axis {
            AxisSection::Periodic => keys.push(word(&format!("domain.{name}"), "periodic")),
            AxisSection::Walls { lower, upper } => {
                keys.push(list(&format!("domain.{name}.lower"), lower));
                keys.push(list(&format!("domain.{name}.upper"), upper));
            }
        }
    }
    keys
}

fn of_flow(flow: &FlowSection) -> Keys {
    let FlowSection { model, viscosity, density, drive, source } = flow;
    let model = match model {
        FlowModel::None => "none",
        FlowModel::Scalar => "scalar",
        FlowModel::Stokes => "stokes",
    };
    let mut keys =
        vec![word("flow.model", model), pair("flow.viscosity", viscosity), pair("flow.density", density), pair("flow.source", source)];
    keys.extend(matches!(drive, Some(Drive::ShearedBox(_))).then(|| word("flow.drive.periodic", "sheared")));
    keys.extend(drive.as_ref().map(|drive| match drive {
        Drive::MeanVelocity(velocity) => list("flow.drive.mean_velocity", velocity),
        Drive::PressureGradient(gradient) => list("flow.drive.pressure_gradient", gradient),
        Drive::BodyForce(force) => list("flow.drive.body_force", force),
        Drive::ShearRate(rate) | Drive::ShearedBox(rate) => pair("flow.drive.shear_rate", rate),
        Drive::MeanGradient(gradient) => list("flow.drive.mean_gradient", gradient),
    }));
    keys
}

fn of_resolution(resolution: &ResolutionSection) -> Keys {
    let ResolutionSection { spacing, modes } = resolution;
    let spacing = match spacing {
        Spacing::Length(spacing) => pair("resolution.spacing", spacing),
        Spacing::CellsPerRadius(cells) => pair("resolution.cells_per_radius", cells),
    };
    let modes = match modes {
        Modes::Auto => word("resolution.modes", "auto"),
        Modes::Most => word("resolution.modes", "most"),
        Modes::Count(count) => pair("resolution.modes", count),
    };
    vec![spacing, modes]
}

fn of_method(method: &MethodSection) -> Keys {
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
    keys.extend([word("method.inverse", inverse.word()), pair("method.tolerance", tolerance.text())]);
    keys
}

fn automatic(key: &str, number: Option<f64>) -> (String, String) {
    number.map_or_else(|| word(key, "auto"), |number| pair(key, number))
}

fn of_bodies(bodies: &BodyGroup) -> Keys {
    let BodyGroup { shape: Shape::Ball, radius, placement, gap, density, motion, force, torque, velocity, spin } = bodies;
    let mut keys = vec![word("shape", "ball"), pair("radius", radius)];
    keys.extend(of_placement(placement));
    keys.extend([pair("gap", gap), pair("density", density)]);
    keys.extend(of_motion(motion));
    let lists = [("force", force), ("torque", torque), ("velocity", velocity), ("spin", spin)];
    keys.extend(lists.into_iter().filter_map(|(key, numbers)| Some(list(key, numbers.as_deref()?))));
    keys
}

fn of_placement(placement: &Placement) -> Keys {
    match placement {
        Placement::Fraction(fraction) => vec![pair("fraction", fraction)],
        Placement::Count(count) => vec![pair("count", count)],
        Placement::Centers(centers) => (0..).zip(centers).map(|(index, center)| list(&format!("centers[{index}]"), center)).collect(),
        // the scene that a run leaves behind names a copy
        Placement::File(path) => vec![match read_text(path) {
            Ok(text) => pair("file", format!("{} bytes with the hash {:016x}", text.len(), hash(&text))),
            Err(_) => word("file", &path.to_string_lossy()),
        }],
    }
}

fn hash(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

fn of_motion(motion: &Motion) -> Keys {
    match motion {
        Motion::Free => vec![word("motion", "free")],
        Motion::Fixed => vec![word("motion", "fixed")],
        Motion::Prescribed { velocity, spin } => vec![list("motion.velocity", velocity), list("motion.spin", spin)],
    }
}

fn of_contact(contact: &ContactSection, lubrication: &LubricationSection) -> Keys {
    let ContactSection { model } = contact;
    let mut keys = vec![word("contact.model", model.word())];
    keys.extend(match model {
        ContactModel::None | ContactModel::Inelastic => vec![],
        ContactModel::Repulsion { stiffness, range } => vec![pair("contact.stiffness", stiffness), pair("contact.range", range)],
        ContactModel::Gluey { gamma_min } => gamma_min.map(|least| pair("contact.gamma_min", least)).into_iter().collect(),
    });
    let LubricationSection { model } = lubrication;
    match model {
        LubricationModel::None => keys.push(word("lubrication.model", "none")),
        LubricationModel::Pairwise { roughness } => {
            keys.extend([word("lubrication.model", "pairwise"), pair("lubrication.roughness", roughness)])
        }
    }
    keys
}

fn of_time(time: &TimeSection) -> Keys {
    let TimeSection { step, end: _, scheme, travel, until: _ } = time;
    let scheme = match scheme {
        Scheme::TwoStep => "two-step",
        Scheme::Midpoint => "midpoint",
        Scheme::Euler => "euler",
    };
    let step = match step {
        Step::Auto => vec![word("time.step", "auto"), pair("time.travel", travel)],
        Step::Fixed(step) => vec![pair("time.step", step)],
    };
    [vec![word("time.scheme", scheme)], step].concat()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use crate::scene::Scene;

    const SCENE: &str = r#"
title = "sinking disks"
[domain]
size = [8.0, 4.0]
y = "walls"
[flow]
viscosity = 2.0
[resolution]
spacing = 0.1
[[bodies]]
radius = 0.5
centers = [[1.0, 2.0], [3.0, 2.0]]
[time]
end = 2.0
[output]
every = 0.5
"#;

    fn with(overrides: &[&str]) -> Scene {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        Scene::parse("scene", Path::new(""), SCENE, &overrides).unwrap()
    }

    #[test]
    fn title_end_output_and_written_defaults_make_no_difference() {
        let changes = ["title=other", "time.end=9", "output={ picture = false }", "time.step=auto", "flow.density=0", "domain.x=periodic"];
        assert_eq!(with(&[]).difference(&with(&changes)), None);
        assert!(with(&[]).same_run(&with(&changes), "the checkpoint").is_ok());
    }

    #[test]
    fn a_file_is_the_same_however_its_path_is_written() {
        let root = env!("CARGO_MANIFEST_DIR");
        let from =
            |folder: &str, file: &str| Scene::parse("scene", Path::new(folder), SCENE, &[format!("bodies.0.file={root}/{file}")]).unwrap();
        let data = from("", "tests/data/random30_disks.csv");
        assert_eq!(data.difference(&from("elsewhere", "tests/../tests/data/random30_disks.csv")), None);
        assert_eq!(data.difference(&from("", "tests/data/none.csv")).unwrap().key, "bodies[0].file");
    }

    #[test]
    fn the_first_key_that_differs_is_named_with_both_values_and_its_line() {
        let refusal = |changes: &[&str]| with(&[]).same_run(&with(changes), "the checkpoint").unwrap_err().to_string();
        let cases = [
            (&["flow.viscosity=3", "seed=1"][..], "scene.toml:7: flow.viscosity = 2: the checkpoint has 3; only title"),
            (&["bodies.0.centers.1=[3, 2.5]"], "scene.toml:12: bodies[0].centers[1] = [3.0, 2.0]: the checkpoint has [3.0, 2.5]; "),
            (&["gravity=[0, 1]"], "scene.toml:1: gravity = nothing: the checkpoint has [0.0, 1.0]; "),
            (&["resolution.cells_per_radius=4"], "scene.toml:9: resolution.spacing = 0.1: the checkpoint has nothing; "),
            (&["time.step=0.5"], "scene.toml:13: time.step = \"auto\": the checkpoint has 0.5; "),
            (&["time.scheme=euler"], "scene.toml:13: time.scheme = \"two-step\": the checkpoint has \"euler\"; "),
            (&["bodies.0.file=a.csv"], "scene.toml:12: bodies[0].centers[0] = [1.0, 2.0]: the checkpoint has nothing; "),
        ];
        for (changes, message) in cases {
            assert!(refusal(changes).starts_with(message), "{}", refusal(changes));
        }
    }
}
