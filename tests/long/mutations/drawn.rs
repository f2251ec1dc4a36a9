//! Scenes drawn from the whole space of keys, most of them with motion in time: small boxes in which a few objects lie apart.
//!
//! A seed gives the same scene in any [`Units`].

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    objects::{self, Objects},
    units::{Units, powers},
};

/// A scene, and what of it its checks must know.
pub struct Drawn {
    pub text: String,
    pub dimension: usize,
    pub inertia: bool,
    /// Rate of the shear of a box whose images slide or lie still.
    pub background_rate: f64,
    /// Time of which steps in a sheared box are multiples where the grid may not be oblique: its images slide by a cell, or by two without inertia, in whose steps
    /// there is a midpoint; zero in others.
    pub slide: f64,
    /// Two walls shear what is between them, and nothing else drives it.
    pub couette: bool,
    /// Axes along which everything may lie elsewhere and nothing changes.
    pub movable: [bool; 3],
    pub end: Option<f64>,
    pub size: Vec<f64>,
    pub objects: Objects,
}

/// A random source and the lines of a scene so far.
pub struct Draft {
    random: ChaCha8Rng,
    pub units: Units,
    pub dimension: usize,
    pub lines: Vec<String>,
    pub size: Vec<f64>,
    pub spacing: f64,
    pub model: Model,
    pub drive: Drive,
}

/// The model of the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    Stokes,
    NavierStokes,
    Dry,
}

/// What bounds the box and drives the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    Couette,
    Sheared,
    FixedImages,
    Channel,
    Closed,
    Inflow,
    Periodic,
}

impl Draft {
    fn of(seed: u64, units: Units) -> Draft {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let dimension = if random.random_bool(0.88) { 2 } else { 3 };
        let size = if dimension == 2 { vec![8.0, 6.0] } else { vec![4.0; 3] };
        let spacing = if dimension == 2 { 1.0 / 6.0 } else { 0.2 };
        let (model, drive) = (Model::Stokes, Drive::Periodic);
        Draft { random, units, dimension, lines: Vec::new(), size, spacing, model, drive }
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.random.random_bool(probability)
    }

    pub fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.random.random_range(0..choices.len())]
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.random.random_range(low..high)
    }

    pub fn line(&mut self, key: &str, value: impl std::fmt::Display) {
        self.lines.push(format!("{key} = {value}"));
    }

    pub fn section(&mut self, name: &str) {
        self.lines.push(name.to_owned());
    }

    pub fn number(&self, value: f64, powers: [i32; 3]) -> String {
        format!("{:?}", self.units.number(value, powers))
    }

    pub fn vector(&self, values: &[f64], powers: [i32; 3]) -> String {
        let numbers: Vec<String> = values[..self.dimension].iter().map(|&value| self.number(value, powers)).collect();
        format!("[{}]", numbers.join(", "))
    }

    /// What is one number in two dimensions and a vector in three.
    pub fn turning(&self, values: &[f64], powers: [i32; 3]) -> String {
        if self.dimension == 2 { self.number(values[0], powers) } else { self.vector(values, powers) }
    }

    pub fn direction(&mut self, size: f64) -> Vec<f64> {
        (0..3).map(|_| self.between(-size, size)).collect()
    }

    pub fn periodic(&self, axis: usize) -> bool {
        match self.drive {
            Drive::Couette | Drive::Channel => axis != 1,
            Drive::Closed => false,
            Drive::Inflow => axis > 1,
            Drive::Sheared | Drive::FixedImages | Drive::Periodic => true,
        }
    }
}

/// The scene of a seed.
pub fn draw(seed: u64, units: Units) -> Drawn {
    let draft = &mut Draft::of(seed, units);
    draft.model = draft.one_of(&[Model::Stokes, Model::Stokes, Model::NavierStokes, Model::Dry]);
    draft.drive = drive(draft);
    let instant = draft.model == Model::Stokes && (draft.drive == Drive::FixedImages || draft.chance(0.1));
    let end = (!instant).then(|| draft.one_of(&[0.05, 0.1, 0.2]));
    let objects = objects::layout(draft, instant);
    let gravity = draft.model == Model::Dry || (draft.drive == Drive::Closed && draft.chance(0.7));
    if gravity {
        let down = draft.direction(2.0);
        draft.line("gravity", draft.vector(&down, powers::ACCELERATION));
    }
    domain(draft);
    let (background_rate, driven) = flow(draft);
    if draft.model != Model::Dry {
        numerics(draft, &objects);
    }
    let driven = objects::write(draft, &objects, end.is_some()) || driven || gravity;
    if end.is_some() {
        contact(draft);
    }
    end.iter().for_each(|&end| time(draft, end));
    output(draft, end, objects.chains.is_empty() && objects.cells.is_empty());
    // last, so that nothing else is drawn otherwise
    friction(draft, &objects);
    let (inertia, sheared) = (draft.model == Model::NavierStokes, draft.drive == Drive::Sheared);
    let cells = if inertia { 1.0 } else { 2.0 };
    let whole = sheared && (inertia || draft.lines.iter().any(|line| line.starts_with("constraint = ")));
    let carried = background_rate != 0.0 && (objects.given || sheared && end.is_some());
    Drawn {
        text: draft.lines.join("\n") + "\n",
        dimension: draft.dimension,
        inertia,
        background_rate,
        slide: if whole { cells * draft.spacing / (background_rate.abs() * draft.size[1]) } else { 0.0 },
        couette: draft.drive == Drive::Couette && !driven,
        // along y a shear carries bodies to other places between the points of the grid
        movable: [0, 1, 2].map(|axis| axis < draft.dimension && draft.periodic(axis) && !(axis == 1 && carried)),
        end,
        size: draft.size.clone(),
        objects,
    }
}

fn drive(draft: &mut Draft) -> Drive {
    match draft.model {
        Model::Dry => draft.one_of(&[Drive::Closed, Drive::Periodic]),
        Model::Stokes => draft.one_of(&[
            Drive::Couette,
            Drive::Couette,
            Drive::Sheared,
            Drive::Sheared,
            Drive::FixedImages,
            Drive::Channel,
            Drive::Closed,
            Drive::Inflow,
            Drive::Periodic,
        ]),
        Model::NavierStokes => {
            draft.one_of(&[Drive::Couette, Drive::Sheared, Drive::Channel, Drive::Closed, Drive::Inflow, Drive::Periodic])
        }
    }
}

fn domain(draft: &mut Draft) {
    draft.section("[domain]");
    let size = draft.size.clone();
    draft.line("size", draft.vector(&size, powers::LENGTH));
    match draft.drive {
        Drive::Couette => {
            let speed = draft.between(0.5, 2.0);
            let [lower, upper] = [-speed, speed].map(|speed| draft.vector(&[speed, 0.0, 0.0], powers::VELOCITY));
            draft.line("y", format!("{{ lower = {lower}, upper = {upper} }}"));
        }
        Drive::Channel => draft.line("y", "\"walls\""),
        Drive::Closed => ["x", "y", "z"][..draft.dimension].iter().for_each(|axis| draft.line(axis, "\"walls\"")),
        Drive::Inflow => {
            let profile = draft.one_of(&["parabolic", "uniform"]);
            draft.line("x", format!("{{ inflow = {}, profile = \"{profile}\" }}", draft.number(0.7, powers::VELOCITY)));
            draft.line("y", "\"walls\"");
        }
        Drive::Sheared | Drive::FixedImages | Drive::Periodic => {}
    }
}

/// The fluid; gives the rate of a background shear, and whether something else drives the flow.
fn flow(draft: &mut Draft) -> (f64, bool) {
    draft.section("[flow]");
    let word = match draft.model {
        Model::Stokes => "stokes",
        Model::NavierStokes => "navier-stokes",
        Model::Dry => "none",
    };
    draft.line("model", format!("\"{word}\""));
    if draft.model == Model::Dry {
        return (0.0, false);
    }
    let viscosity = draft.one_of(&[0.3, 1.0, 4.0]);
    draft.line("viscosity", draft.number(viscosity, powers::viscosity(draft.dimension)));
    if draft.model == Model::NavierStokes || draft.chance(0.2) {
        let density = draft.between(0.2, 1.5);
        draft.line("density", draft.number(density, powers::density(draft.dimension)));
    }
    let rate = draft.between(0.3, 1.0) * if draft.chance(0.2) { -1.0 } else { 1.0 };
    let along = [draft.between(-1.0, 1.0), 0.0, 0.0];
    let pushed = draft.chance(0.15);
    let drive = match draft.drive {
        Drive::Sheared => format!("{{ shear_rate = {}, periodic = \"sheared\" }}", draft.number(rate, powers::RATE)),
        Drive::FixedImages => format!("{{ shear_rate = {} }}", draft.number(rate, powers::RATE)),
        Drive::Periodic if draft.model == Model::NavierStokes => {
            format!("{{ mean_velocity = {} }}", draft.vector(&along, powers::VELOCITY))
        }
        Drive::Channel | Drive::Periodic => match draft.one_of(&[0, 1, 2]) {
            0 => format!("{{ mean_velocity = {} }}", draft.vector(&along, powers::VELOCITY)),
            1 => format!("{{ pressure_gradient = {} }}", draft.vector(&along, powers::body_force(draft.dimension))),
            _ => format!("{{ body_force = {} }}", draft.vector(&along, powers::body_force(draft.dimension))),
        },
        Drive::Couette if pushed => {
            format!("{{ body_force = {} }}", draft.vector(&along, powers::body_force(draft.dimension)))
        }
        Drive::Couette | Drive::Closed | Drive::Inflow => return (0.0, false),
    };
    draft.line("drive", drive);
    match draft.drive {
        Drive::Sheared | Drive::FixedImages => (rate, false),
        _ => (0.0, true),
    }
}

/// The grid, the modes and the method.
fn numerics(draft: &mut Draft, objects: &Objects) {
    draft.section("[resolution]");
    let spacing = draft.spacing;
    draft.line("spacing", draft.number(spacing, powers::LENGTH));
    if draft.chance(0.2) {
        let modes = draft.one_of(&["1", "2", "3", "\"most\""]);
        draft.line("modes", modes);
    }
    draft.section("[method]");
    let plain = objects.plain() && draft.model == Model::Stokes;
    if plain && draft.chance(0.3) {
        let word = draft.one_of(&["penalty", "mean-value", "distributed", "fitted"]);
        draft.line("constraint", format!("\"{word}\""));
    }
    let open = matches!(draft.drive, Drive::Closed | Drive::Inflow) && !draft.chance(0.1);
    let inverse = draft.one_of(if open { &["auto", "hypre"] } else { &["auto", "auto", "hypre", "transform"] });
    draft.line("inverse", format!("\"{inverse}\""));
    draft.line("tolerance", "1e-9");
    if draft.model == Model::Stokes && draft.chance(0.4) || draft.model == Model::NavierStokes && draft.chance(0.3) {
        draft.section("[lubrication]");
        draft.line("model", "\"pairwise\"");
        if draft.chance(0.5) {
            draft.line("roughness", "1e-3");
        }
    }
}

fn contact(draft: &mut Draft) {
    let model = draft.one_of(&["none", "inelastic", "inelastic", "repulsion", "gluey"]);
    draft.section("[contact]");
    draft.line("model", format!("\"{model}\""));
    if model == "repulsion" {
        draft.line("range", "0.2");
    }
}

/// Friction at half of the contacts that may have it.
fn friction(draft: &mut Draft, objects: &Objects) {
    let tied = !(objects.chains.is_empty() && objects.cells.is_empty() && objects.clusters.is_empty());
    let place = draft.lines.iter().position(|line| line.contains("model = \"inelastic\""));
    let possible = draft.model != Model::Dry || !tied;
    let Some(place) = place.filter(|_| possible && draft.chance(0.5)) else { return };
    let coefficient = draft.one_of(&[0.1, 0.5, 2.0]);
    draft.lines.insert(place + 1, format!("friction = {coefficient:?}"));
    if draft.model != Model::Dry {
        draft.lines.insert(place + 2, "roughness = 0.02".into());
    }
}

fn time(draft: &mut Draft, end: f64) {
    draft.section("[time]");
    draft.line("end", draft.number(end, powers::TIME));
    let steps = draft.one_of(&[2.0, 3.0, 4.0]);
    // repulsion allows short steps only
    let stiff = draft.lines.iter().any(|line| line.contains("repulsion"));
    if draft.chance(if stiff { 0.1 } else { 0.7 }) {
        draft.line("step", draft.number(end / steps, powers::TIME));
    }
    if draft.model == Model::Stokes {
        let scheme = draft.one_of(&["two-step", "two-step", "midpoint", "euler"]);
        draft.line("scheme", format!("\"{scheme}\""));
    }
}

fn output(draft: &mut Draft, end: Option<f64>, no_bonds: bool) {
    draft.section("[output]");
    let picture = draft.chance(0.05);
    draft.line("picture", picture);
    let report = draft.chance(0.05);
    draft.line("report", report);
    if draft.model != Model::Dry && draft.chance(0.1) {
        draft.line("probe", 8);
    }
    let Some(end) = end else { return };
    draft.line("every", draft.number(end / 2.0, powers::TIME));
    for (key, value, probability) in [("pairs", "true", 0.1), ("checkpoint", "0", 0.2)] {
        if draft.chance(probability) {
            draft.line(key, value);
        }
    }
    if draft.model == Model::NavierStokes && no_bonds && draft.chance(0.3) {
        draft.line("energy", true);
    }
    if draft.model != Model::Dry && draft.chance(0.1) {
        draft.line("profiles", "\"y\"");
    }
}
