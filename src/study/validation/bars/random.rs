//! Scenes drawn at random, whose answers are solved for on a grid much finer than any that an accuracy of 1e-2 asks for.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::KnownScene;
use crate::{
    error::{Error, Result},
    petsc::Session,
    scene::Scene,
    simulation::{FlowSolver, Setup, Suspension},
    study::{Answer, Quantity},
};

/// Cells per radius and order of the modes of the answers, in 2D and 3D: with films they are right to 1e-3, as twice the cells show.
const FINE: [(usize, usize); 2] = [(32, 24), (11, 10)];

/// What may be asked of a flow: its box, its drive, the motion of the bodies, and the quantity.
struct Kind {
    name: &'static str,
    walls: &'static str,
    flow: &'static str,
    bodies: &'static str,
    quantity: Quantity,
}

const PLANE: [Kind; 6] = [
    Kind { name: "sheared box", walls: "", flow: "drive = { shear_rate = 1.0 }", bodies: "", quantity: Quantity::Viscosity },
    Kind {
        name: "Couette cell",
        walls: "y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }",
        flow: "",
        bodies: "",
        quantity: Quantity::Viscosity,
    },
    Kind {
        name: "channel",
        walls: "y = \"walls\"",
        flow: "drive = { pressure_gradient = [-1.0, 0.0] }",
        bodies: "",
        quantity: Quantity::Velocity,
    },
    Kind {
        name: "fixed array",
        walls: "",
        flow: "drive = { mean_velocity = [1.0, 0.0] }",
        bodies: "motion = \"fixed\"",
        quantity: Quantity::Drag,
    },
    Kind {
        name: "closed box, stirred",
        walls: "x = \"walls\"\ny = \"walls\"",
        flow: "",
        bodies: "motion = { velocity = [1.0, 0.0] }",
        quantity: Quantity::Drag,
    },
    Kind {
        name: "settling crowd",
        walls: "",
        flow: "drive = { mean_velocity = [0.0, 0.0] }",
        bodies: "force = [0.0, -1.0]",
        quantity: Quantity::Velocity,
    },
];

const SPACE: [Kind; 3] = [
    Kind { name: "sheared box in 3D", walls: "", flow: "drive = { shear_rate = 1.0 }", bodies: "", quantity: Quantity::Viscosity },
    Kind {
        name: "Couette cell in 3D",
        walls: "y = { lower = [-1.0, 0.0, 0.0], upper = [1.0, 0.0, 0.0] }",
        flow: "",
        bodies: "",
        quantity: Quantity::Viscosity,
    },
    Kind {
        name: "fixed array in 3D",
        walls: "",
        flow: "drive = { mean_velocity = [1.0, 0.0, 0.0] }",
        bodies: "motion = \"fixed\"",
        quantity: Quantity::Drag,
    },
];

/// The scene of a seed, with its answer; every sixth is in 3D. Collective.
///
/// # Errors
/// The scene cannot be solved on the fine grid.
pub fn random_scene(session: &Session, seed: u64) -> Result<KnownScene> {
    let (name, text, quantity) = draw(seed);
    let dimension = if seed.is_multiple_of(6) { 3 } else { 2 };
    let (cells, modes) = FINE[dimension - 2];
    let fine = [
        format!("resolution.cells_per_radius={cells}"),
        format!("resolution.modes={modes}"),
        "method.tolerance=1e-6".to_owned(),
        "lubrication.model=\"pairwise\"".to_owned(),
    ];
    let scene = Scene::parse("random", Path::new("."), &text, &fine)?;
    let answers = if dimension == 2 { answers::<2>(session, &scene)? } else { answers::<3>(session, &scene)? };
    let missing = || Error::Diverged(format!("{name} has no {}", quantity.word()));
    let answer = answers.into_iter().find(|answer| answer.quantity == quantity).ok_or_else(missing)?;
    Ok(KnownScene { name, text, answer })
}

fn answers<const D: usize>(session: &Session, scene: &Scene) -> Result<Vec<Answer>> {
    let mut suspension = Suspension::new(session, session.world().agree(Setup::<D>::of(scene))?)?;
    let solution = suspension.solve(&mut |_, _| ())?;
    Answer::all(&suspension, &solution)
}

/// Name, text without resolution, and quantity of the scene of a seed.
fn draw(seed: u64) -> (String, String, Quantity) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let solid = seed.is_multiple_of(6);
    let kinds: &[Kind] = if solid { &SPACE } else { &PLANE };
    let kind = &kinds[random.random_range(0..kinds.len())];
    let films = random.random_bool(0.7);
    let count = if solid { random.random_range(2..=4) } else { random.random_range(2..=14) };
    let fraction = if solid { random.random_range(0.05..0.25) } else { random.random_range(0.1..0.42) };
    let gap = if films { random.random_range(0.02..0.2) } else { random.random_range(0.15..0.4) };
    let large = if random.random_bool(0.3) && count > 2 { count / 3 } else { 0 };
    let radius: f64 = 1.4;
    let (dimension, volume) = if solid { (3, 4.0 / 3.0 * std::f64::consts::PI) } else { (2, std::f64::consts::PI) };
    let bodies = volume * ((count - large) as f64 + large as f64 * radius.powi(dimension));
    let side = (bodies / fraction).powf(1.0 / f64::from(dimension)).max(2.0 * radius + 0.6);
    let size = vec![format!("{side:.4}"); dimension as usize].join(", ");
    let group = |radius: f64, count: usize| match count {
        0 => String::new(),
        _ => format!("[[bodies]]\nradius = {radius:?}\ncount = {count}\ngap = {gap:.4}\n{}\n", kind.bodies),
    };
    let lubrication = if films { "[lubrication]\nmodel = \"pairwise\"\n" } else { "" };
    let text = format!(
        "seed = {seed}\n[domain]\nsize = [{size}]\n{}\n[flow]\n{}\n[method]\ninverse = \"auto\"\n{lubrication}{}{}",
        kind.walls,
        kind.flow,
        group(1.0, count - large),
        group(radius, large)
    );
    let name = format!("{} {seed}: {count} at {fraction:.2}, gap {gap:.2}{}", kind.name, if films { ", films" } else { "" });
    (name, text, kind.quantity)
}
