//! From the text of a scene file to a checked scene.

use std::{io::ErrorKind, path::Path};

use toml_edit::{Document, Item, TomlError, Value};

use crate::body::read_text;
use crate::error::{Error, Offer, Refusal, Result};
use crate::scene::key::Key;
use crate::scene::locations::{Lines, Locations};
use crate::scene::table::Table;
use crate::scene::{
    ContactSection, DomainSection, FlowModel, FlowSection, InteractionSection, LubricationSection, MethodSection, OutputSection,
    ResolutionSection, Scene, TimeSection, accuracy, check, groups::bodies, keys, overrides, scalar,
};

/// Keys at the top of a scene file.
pub(super) const KEYS: [Key; 17] = [
    Key::new("title", "text", "\"Disks in shear\"", "One line for people.").default("\"\""),
    Key::new("seed", "whole number", "7", "Seed of all random numbers: the same seed gives the same packing.")
        .default("1")
        .range("at least 0"),
    Key::new("gravity", "list of numbers", "[0.0, -9.81]", "Acceleration of bodies and fluid.").unit("length/time^2"),
    Key::new(
        "accuracy",
        "number",
        "1e-2",
        "Relative error that drag and viscosity may have: the run chooses grid and modes itself, and attaches \
        error bars. It takes the place of [resolution]. With inertia it is that of forces on bodies which stay where they are, in a flow that is \
        steady at time.end, and of the largest velocities of free bodies that do not touch.",
    )
    .unit("ratio")
    .range("1e-5 to 0.5"),
    Key::new("domain", "table", "{ size = [8.0, 8.0], y = \"walls\" }", "The box.").default("required"),
    Key::new("flow", "table", "{ viscosity = 2.0 }", "The fluid and what drives it.").default("Stokes flow of viscosity 1"),
    Key::new("resolution", "table", "{ cells_per_radius = 6 }", "How fine the grid and the multipliers are.")
        .default("required with a fluid or a scalar, unless accuracy is given"),
    Key::new("method", "table", "{ inverse = \"auto\" }", "How the equations are solved.").default("all its defaults"),
    Key::new("bodies", "list of tables", "[{ radius = 0.5, count = 3 }]", "Groups of disks or spheres that are alike."),
    Key::new(
        "chains",
        "list of tables",
        "[{ count = 1, beads = 4, radius = 0.4, stretch = \"rigid\" }]",
        "Groups of chains or rings of beads.",
    )
    .needs("time.end = 1.0"),
    Key::new(
        "cells",
        "list of tables",
        "[{ count = 1, beads = 48, diameter = 3.0, stretch = \"rigid\", bend = 0.016 }]",
        "Groups of red cells.",
    )
    .needs("time.end = 1.0"),
    Key::new(
        "clusters",
        "list of tables",
        "[{ count = 1, shape = \"rod\", beads = 3, radius = 0.4 }]",
        "Groups of rigid bodies that are made of \
        several balls.",
    ),
    Key::new("interactions", "list of tables", "[{ pair_force = \"-3 / r^4\", reach = 2.0 }]", "Forces on bodies that are given by expressions."),
    Key::new("contact", "table", "{ model = \"inelastic\" }", "What happens between bodies that touch.")
        .default("nothing")
        .needs("time.end = 1.0"),
    Key::new("lubrication", "table", "{ model = \"pairwise\" }", "What happens between bodies that nearly touch.")
        .default("nothing is added"),
    Key::new("time", "table", "{ end = 10.0 }", "End and steps of the run.").default("one instantaneous solve"),
    Key::new("output", "table", "{ picture = false }", "What the run writes.").default("all its defaults"),
];

/// Most bytes of a scene file, which takes fifty times as many to read.
const LONGEST_FILE: u64 = 2_000_000;

/// What is to be done about a longer one.
const TOO_LONG: &str = "a scene file may hold 2 MB; place many bodies by fraction, count or a table (bodies.file = \"centers.csv\")";

impl Scene {
    /// The scene of a file with `key=value` overrides; refused with file and line if anything is not right.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Scene> {
        let unreadable = |source: std::io::Error| match source.kind() {
            ErrorKind::NotFound => Refusal::from(format!("{}: no such file", path.display())).offering(Offer::NewScene),
            _ => Error::File { path: path.to_owned(), source },
        };
        let length = std::fs::metadata(path).map_err(unreadable)?.len();
        if length > LONGEST_FILE {
            let size = length as f64 / 1e6;
            return Err(Error::refused(format!("{}:1: holds {size:.1} MB: {TOO_LONG}", path.display())));
        }
        let text = read_text(path)?;
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        load(&file, path.parent().unwrap_or(Path::new("")), &text, overrides)
    }

    /// The scene of a text that calls itself `name`; files it names are looked for in `folder`.
    pub fn parse(name: &str, folder: &Path, text: &str, overrides: &[String]) -> Result<Scene> {
        load(&format!("{name}.toml"), folder, text, overrides)
    }

    /// This scene with the text of a file that gives it, once that text has passed the checks of every file.
    ///
    /// # Errors
    /// [`Error::Refused`] with key, value and remedy.
    pub fn checked(self) -> Result<Scene> {
        let file = keys::file_of(&keys::keys(&self));
        let built = load(&format!("{}.toml", self.name), Path::new(""), &file, &[]);
        let built = built.map_err(|error| match error {
            Error::Refused(refusal) => Refusal { place: None, ..*refusal }.into(),
            other => other,
        })?;
        Ok(Scene { locations: Locations::default(), ..built })
    }

    /// An error with the place of the key that it begins with, if it is a refusal of what no reader of the file could know.
    pub fn place(&self, error: Error) -> Error {
        self.locations.place(error, &KEYS.map(|key| key.name))
    }

    /// The texts of the files that the scene names, with the names that copies of them have beside the scene.
    ///
    /// # Errors
    /// [`Error::Refused`] with the line that names a file which cannot be read.
    pub fn files(&self) -> Result<Vec<(String, String)>> {
        let file = |(group, key, path)| {
            let text = read_text(path).map_err(|error| self.unreadable(group, key, error))?;
            Ok((copied(group, key), text))
        };
        self.tables().map(file).collect()
    }

    /// The name of a group in keys: `bodies[0]`, or `chains[0]` for the first group of chains.
    pub fn group_key(&self, group: usize) -> String {
        let section = self.bodies[group].section();
        let before = self.bodies[..group].iter().filter(|bodies| bodies.section() == section).count();
        format!("{section}[{before}]")
    }

    /// The tables that the scene names, with the numbers of their groups and their keys in these.
    pub fn tables(&self) -> impl Iterator<Item = (usize, &'static str, &Path)> {
        let groups = self.bodies.iter().enumerate();
        groups.flat_map(|(group, bodies)| bodies.tables().map(move |(key, path)| (group, key, path)))
    }

    /// The refusal of a file that cannot be read, at the line that names it by a key of a group; other errors stay.
    pub fn unreadable(&self, group: usize, key: &str, error: Error) -> Error {
        let Error::File { path, source } = error else { return error };
        let remedy = format!("cannot be read ({source}); paths start from the folder of the scene");
        self.refuse(&format!("{}.{key}", self.group_key(group)), format!("{:?}", path.to_string_lossy()), &remedy)
    }

    /// The text of a scene that names copies of its files beside it.
    ///
    /// # Errors
    /// The scene cannot be written so.
    pub fn copied_text(&self) -> Result<String> {
        let copy = |(group, key, _)| format!("{}.{key}={:?}", self.group_key(group), copied(group, key));
        let copies: Vec<String> = self.tables().map(copy).collect();
        Ok(Scene::parse(&self.name, Path::new("."), &self.text, &copies)?.text)
    }

    /// The text of a scene that gives the same scene from any folder.
    ///
    /// # Errors
    /// A file that it names is gone.
    pub fn movable_text(&self) -> Result<String> {
        let absolute = self.tables().map(|(group, key, path)| {
            let path = path.canonicalize().map_err(|source| Error::File { path: path.to_owned(), source })?;
            Ok(format!("{}.{key}={:?}", self.group_key(group), path.to_string_lossy()))
        });
        Ok(Scene::parse(&self.name, Path::new("."), &self.text, &absolute.collect::<Result<Vec<_>>>()?)?.text)
    }
}

/// The name of the copy of a table.
fn copied(group: usize, key: &str) -> String {
    let what = if key == "file" { "bodies" } else { "path" };
    format!("{what}-{group}.csv")
}

fn load(file: &str, folder: &Path, text: &str, overrides: &[String]) -> Result<Scene> {
    let original = Document::parse(text).map_err(|error| misspelt(file, text, &error))?;
    let mut locations = Locations::of(file, &original);
    let mut document = original.into_mut();
    for change in overrides {
        overrides::apply(&mut document, &mut locations, change)?;
    }
    let text = document.to_string();
    let content = Item::Table(document.into_table()).into_value().expect("a table is a value");
    let scene = read(file, folder, &content, locations)?;
    let scene = Scene { text, ..scene };
    check::check(&scene)?;
    Ok(scene)
}

fn misspelt(file: &str, text: &str, error: &TomlError) -> Error {
    let line = error.span().map_or(1, |span| Lines::of(text).at(&span));
    let message = error.message().lines().collect::<Vec<_>>().join("; ");
    Error::refused(format!("{file}:{line}: not valid TOML: {message}"))
}

fn read(file: &str, folder: &Path, content: &Value, locations: Locations) -> Result<Scene> {
    let root = Table::root(content, &locations, &KEYS)?;
    let domain = DomainSection::read(&root)?;
    let dimension = domain.size.len();
    let flow = FlowSection::read(&root, dimension)?;
    let model = flow.model;
    let accuracy = root.get("accuracy").map(|entry| accuracy::read(&entry, &root, model)).transpose()?;
    if model == FlowModel::Scalar {
        scalar::refuse_keys(&root)?;
    }
    let output = OutputSection::read(&root, dimension, &flow)?;
    Ok(Scene {
        name: Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        title: root.get("title").map_or(Ok(""), |entry| entry.text())?.to_owned(),
        seed: root.get("seed").map_or(Ok(1), |entry| entry.whole(0))?,
        gravity: root.get("gravity").map(|entry| entry.vector(dimension)).transpose()?,
        domain,
        flow,
        accuracy,
        resolution: if accuracy.is_some() { None } else { ResolutionSection::read(&root, model)? },
        method: MethodSection::read(&root, model)?,
        bodies: [
            bodies::read(&root, folder, dimension, model)?,
            bodies::read_chains(&root, folder, dimension)?,
            bodies::read_cells(&root, folder, dimension)?,
            bodies::read_clusters(&root, folder, dimension)?,
        ]
        .concat(),
        interactions: InteractionSection::read_all(&root, dimension)?,
        contact: ContactSection::read(&root)?,
        lubrication: LubricationSection::read(&root)?,
        time: TimeSection::read(&root, model)?,
        output,
        locations,
        text: String::new(),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::{Path, PathBuf};

    use crate::error::Error;
    use crate::scene::{
        AxisSection, ContactModel, Drive, Modes, Motion, OutputSection, Placement, ResolutionSection, Scene, Scheme, Shape, Spacing, Step,
        TimeSection, Tolerance,
    };

    const FLAT: &str = r#"
title = "A disk between moving walls"
seed = 7
gravity = [0, -1.5]
[domain]
size = [8, 4.0]
y = { lower = [-1.0, 0.0], upper = [1, 0] }
[flow]
model = "stokes"
viscosity = 2
density = 0.5
drive = { mean_velocity = [1.0, 0.0] }
[resolution]
cells_per_radius = 6
modes = 9
[method]
constraint = "sharp"
inverse = "hypre"
tolerance = 1e-8
[[bodies]]
shape = "ball"
radius = 0.5
centers = [[1, 2], [3.0, 2.0]]
density = 3
motion = { velocity = [0.5, 0.0], spin = 2 }
[[bodies]]
radius = 1
fraction = 0.3
gap = 0
force = [0.0, -1.0]
torque = 0.25
[contact]
model = "none"
[lubrication]
model = "none"
[output]
picture = false
"#;

    const DEEP: &str = r#"
[domain]
size = [4.0, 4.0, 4.0]
x = "walls"
[resolution]
spacing = 0.25
[[bodies]]
radius = 0.5
file = "centers.csv"
motion = { velocity = [0.0, 0.0, 1.0] }
[[bodies]]
radius = 0.5
count = 3
torque = [0.0, 0.0, 1.0]
"#;

    fn parse(text: &str) -> Scene {
        Scene::parse("scene", Path::new("folder"), text, &[]).unwrap()
    }

    #[test]
    fn a_scene_in_two_dimensions_is_read_in_full() {
        let scene = parse(FLAT);
        assert_eq!(scene.dimension(), 2);
        assert_eq!((scene.name.as_str(), scene.seed), ("scene", 7));
        assert_eq!(scene.title, "A disk between moving walls");
        assert_eq!(scene.gravity, Some(vec![0.0, -1.5]));
        let walls = AxisSection::Walls { lower: vec![-1.0, 0.0], upper: vec![1.0, 0.0] };
        assert_eq!(scene.domain.size, [8.0, 4.0]);
        assert_eq!(scene.domain.axes, [AxisSection::Periodic, walls]);
        assert_eq!((scene.flow.viscosity, scene.flow.density), (2.0, 0.5));
        assert_eq!(scene.flow.drive, Some(Drive::MeanVelocity(vec![1.0, 0.0])));
        assert_eq!(scene.resolution, Some(ResolutionSection { spacing: Spacing::CellsPerRadius(6.0), modes: Modes::Count(9) }));
        assert_eq!(scene.method.tolerance, Tolerance::Fixed(1e-8));
        assert!(!scene.output.picture);
        assert_eq!(scene.text, FLAT);
    }

    #[test]
    fn groups_of_bodies_are_read_in_order() {
        let bodies = parse(FLAT).bodies;
        let centers = vec![vec![1.0, 2.0], vec![3.0, 2.0]];
        let motion = Motion::Prescribed { velocity: vec![0.5, 0.0], spin: vec![2.0] };
        assert_eq!((bodies[0].shape, bodies[0].radius), (Shape::Ball, 0.5));
        assert_eq!(bodies[0].placement, Placement::Centers(centers));
        assert_eq!((bodies[0].gap, bodies[0].density), (0.05, 3.0));
        assert_eq!(bodies[0].motion, motion);
        assert_eq!(bodies[1].placement, Placement::Fraction(0.3));
        assert_eq!((bodies[1].gap, bodies[1].density), (0.0, 1.0));
        assert_eq!(bodies[1].motion, Motion::Free);
        assert_eq!(bodies[1].force, Some(vec![0.0, -1.0]));
        assert_eq!(bodies[1].torque, Some(vec![0.25]));
    }

    #[test]
    fn tables_of_places_are_files_of_the_scene() {
        let motion = "motion = { path = \"path.csv\" }";
        let scene = parse(&format!("{}\n[time]\nend = 1.0\n", DEEP.replace("motion = { velocity = [0.0, 0.0, 1.0] }", motion)));
        assert_eq!(scene.bodies[0].motion, Motion::PathFile(PathBuf::from("folder/path.csv")));
        let tables: Vec<(usize, &str, &Path)> = scene.tables().collect();
        assert_eq!(tables, [(0, "file", Path::new("folder/centers.csv")), (0, "motion.path", Path::new("folder/path.csv"))]);
        let copied = scene.copied_text().unwrap();
        assert!(copied.contains("\"bodies-0.csv\"") && copied.contains("\"path-0.csv\""), "{copied}");
        let gone = crate::body::read_text(Path::new("folder/path.csv")).unwrap_err();
        let refusal = scene.unreadable(0, "motion.path", gone).to_string();
        assert!(
            refusal.starts_with("scene.toml:10: bodies[0].motion.path = \"folder/path.csv\": cannot be read (No such file"),
            "{refusal}"
        );
        assert!(refusal.ends_with("paths start from the folder of the scene"), "{refusal}");
    }

    #[test]
    fn a_scene_in_three_dimensions_turns_with_three_numbers() {
        let scene = parse(DEEP);
        assert_eq!(scene.dimension(), 3);
        let rest = AxisSection::Walls { lower: vec![0.0; 3], upper: vec![0.0; 3] };
        assert_eq!(scene.domain.axes, [rest, AxisSection::Periodic, AxisSection::Periodic]);
        let file = PathBuf::from("folder/centers.csv");
        assert_eq!(scene.bodies[0].placement, Placement::File(file));
        let motion = Motion::Prescribed { velocity: vec![0.0, 0.0, 1.0], spin: vec![0.0; 3] };
        assert_eq!(scene.bodies[0].motion, motion);
        assert_eq!(scene.bodies[1].placement, Placement::Count(3));
        assert_eq!(scene.bodies[1].torque, Some(vec![0.0, 0.0, 1.0]));
    }

    #[test]
    fn what_a_scene_leaves_out_has_defaults() {
        let scene = parse("domain.size = [1, 1]\nresolution.spacing = 0.1");
        assert_eq!((scene.title.as_str(), scene.seed, &scene.gravity), ("", 1, &None));
        assert_eq!(scene.domain.axes, [AxisSection::Periodic, AxisSection::Periodic]);
        assert_eq!((scene.flow.viscosity, scene.flow.density), (1.0, 0.0));
        assert_eq!(scene.flow.drive, None);
        assert_eq!(scene.resolution, Some(ResolutionSection { spacing: Spacing::Length(0.1), modes: Modes::Auto }));
        assert_eq!(scene.method.tolerance.at_an_instant(), 1e-6);
        assert!(scene.bodies.is_empty() && scene.output.picture);
    }

    const DRY: &str = r#"
gravity = [0.0, -9.81]
domain = { size = [4.0, 4.0], y = "walls" }
flow.model = "none"
contact.model = "inelastic"
[[bodies]]
radius = 0.5
count = 3
velocity = [1.0, 0.0]
spin = -2
[time]
end = 2
travel = 0.25
scheme = "midpoint"
"#;

    #[test]
    fn a_dry_scene_has_bodies_that_start_with_a_velocity_and_no_resolution() {
        let scene = parse(DRY);
        assert!(scene.dry() && scene.resolution.is_none() && !scene.stores_fields());
        assert_eq!(scene.contact.model, ContactModel::Inelastic);
        assert_eq!((&scene.bodies[0].velocity, &scene.bodies[0].spin), (&Some(vec![1.0, 0.0]), &Some(vec![-2.0])));
        assert_eq!(
            scene.time,
            Some(TimeSection { step: Step::Auto, end: 2.0, scheme: Scheme::Midpoint, travel: 0.25, error: 4.6875e-3, until: None })
        );
    }

    #[test]
    fn time_and_its_output_are_read_with_their_defaults() {
        let scene = parse(&format!("{FLAT}[time]\nend = 3"));
        assert_eq!(
            scene.time,
            Some(TimeSection { step: Step::Auto, end: 3.0, scheme: Scheme::TwoStep, travel: 0.1, error: 3e-4, until: None })
        );
        assert_eq!(scene.output, OutputSection { picture: false, ..OutputSection::default() });
        let text = format!("{FLAT}every = 5\nfields = false\ncheckpoint = 0\nprobe = 16\n[time]\nend = 3\nstep = 3\nscheme = \"euler\"");
        let scene = parse(&text);
        assert_eq!(scene.time.map(|time| (time.step, time.scheme)), Some((Step::Fixed(3.0), Scheme::Euler)));
        assert_eq!(
            scene.output,
            OutputSection {
                picture: false,
                every: Some(5.0),
                fields: Some(false),
                checkpoint: 0.0,
                probe: Some(16),
                ..OutputSection::default()
            }
        );
        assert_eq!(parse(FLAT).time, None);
    }

    #[test]
    fn later_refusals_name_the_line_of_the_key_or_of_the_table_around_it() {
        let scene = parse(FLAT);
        let refusal = |key| scene.refuse(key, 3, "no").to_string();
        assert_eq!(refusal("bodies[0].radius"), "scene.toml:22: bodies[0].radius = 3: no");
        assert_eq!(refusal("bodies.1.radius"), "scene.toml:27: bodies[1].radius = 3: no");
        assert_eq!(refusal("bodies[0].centers[1]"), "scene.toml:23: bodies[0].centers[1] = 3: no");
        assert_eq!(refusal("bodies[1].motion"), "scene.toml:26: bodies[1].motion = 3: no");
        assert_eq!(refusal("flow.drive.shear_rate"), "scene.toml:12: flow.drive.shear_rate = 3: no");
        assert_eq!(refusal("ranks"), "scene.toml:1: ranks = 3: no");
    }

    #[test]
    fn refusals_that_begin_with_a_key_get_its_place_and_others_stay() {
        let scene = parse(FLAT);
        let placed = |text: &str| scene.place(Error::refused(text)).to_string();
        assert_eq!(placed("flow.drive: has no steady flow"), "scene.toml:12: flow.drive: has no steady flow");
        assert_eq!(placed("method.inverse = \"transform\" needs"), "scene.toml:18: method.inverse = \"transform\" needs");
        for text in ["scene.toml:3: flow.drive = 3", "out: holds another run", "centers.csv:3: found 2", "2 ranks do not fit"] {
            assert_eq!(placed(text), text);
        }
    }

    #[test]
    fn a_file_that_is_too_long_is_refused_unread() {
        let path = std::env::temp_dir().join(format!("turbid-long-{}.toml", std::process::id()));
        std::fs::write(&path, vec![b'#'; 2_000_001]).unwrap();
        let error = Scene::read(&path, &[]).unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        assert!(error.contains(":1: holds 2.0 MB: a scene file may hold 2 MB"), "{error}");
    }

    #[test]
    fn an_unreadable_file_is_named() {
        let error = Scene::read(Path::new("/nowhere/scene.toml"), &[]).unwrap_err();
        assert_eq!(error.to_string(), "/nowhere/scene.toml: no such file; write a scene, or copy an example");
        let pipe = std::env::temp_dir().join(format!("turbid-scene-{}.toml", std::process::id()));
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [Path::new("/dev/null"), Path::new("/dev/zero"), &pipe] {
            let error = Scene::read(path, &[]).unwrap_err();
            assert_eq!(error.to_string(), format!("{}: is no regular file; copy what it gives into one", path.display()));
        }
        std::fs::remove_file(&pipe).unwrap();
        assert!(Scene::read(Path::new("/"), &[]).unwrap_err().to_string().contains("directory"));
    }
}
