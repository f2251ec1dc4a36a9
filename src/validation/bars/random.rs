//! Scenes drawn at random, whose answers are solved for on a grid much finer than any that an accuracy of 1e-2 asks for.

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    error::Result,
    petsc::Session,
    run::{CalibrationAnswer, EstimatedQuantity},
    validation::known::KnownScene,
};

/// Cells per radius and order of the modes of the answers, in 2D and 3D: with films they are right to 1e-3, as twice the cells show.
const FINE: [(usize, usize); 2] = [(32, 24), (11, 10)];

/// What may be asked of a flow: its box, its drive, the motion of the bodies, and the quantity.
struct FlowKind {
    name: &'static str,
    walls: &'static str,
    flow: &'static str,
    bodies: &'static str,
    quantity: EstimatedQuantity,
}

/// Bodies that are free in a periodic box in shear.
const SHEARED: FlowKind =
    FlowKind { name: "sheared box", walls: "", flow: "drive = { shear_rate = 1.0 }", bodies: "", quantity: EstimatedQuantity::Viscosity };
const SLIDING: &str = "y = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }";
const SLIDING_IN_SPACE: &str = "y = { lower = [-1.0, 0.0, 0.0], upper = [1.0, 0.0, 0.0] }";
const CHANNEL: &str = "drive = { pressure_gradient = [-1.0, 0.0] }";
const CROSS_FLOW: &str = "drive = { mean_velocity = [1.0, 0.0] }";
const CROSS_FLOW_IN_SPACE: &str = "drive = { mean_velocity = [1.0, 0.0, 0.0] }";
const FIXED: &str = "motion = \"fixed\"";
const CLOSED: &str = "x = \"walls\"\ny = \"walls\"";
const STIRRED: &str = "motion = { velocity = [1.0, 0.0] }";
const AT_REST: &str = "drive = { mean_velocity = [0.0, 0.0] }";

const PLANE: [FlowKind; 6] = [
    SHEARED,
    FlowKind { name: "Couette cell", walls: SLIDING, flow: "", ..SHEARED },
    FlowKind { name: "channel", walls: "y = \"walls\"", flow: CHANNEL, quantity: EstimatedQuantity::Velocity, ..SHEARED },
    FlowKind { name: "fixed array", flow: CROSS_FLOW, bodies: FIXED, quantity: EstimatedQuantity::Drag, ..SHEARED },
    FlowKind { name: "closed box, stirred", walls: CLOSED, flow: "", bodies: STIRRED, quantity: EstimatedQuantity::Drag },
    FlowKind {
        name: "settling suspension",
        flow: AT_REST,
        bodies: "force = [0.0, -1.0]",
        quantity: EstimatedQuantity::Velocity,
        ..SHEARED
    },
];

const SPACE: [FlowKind; 3] = [
    FlowKind { name: "sheared box in 3D", ..SHEARED },
    FlowKind { name: "Couette cell in 3D", walls: SLIDING_IN_SPACE, flow: "", ..SHEARED },
    FlowKind { name: "fixed array in 3D", flow: CROSS_FLOW_IN_SPACE, bodies: FIXED, quantity: EstimatedQuantity::Drag, ..SHEARED },
];

/// The scene of a seed, with its answer; every sixth is in 3D. Collective.
///
/// # Errors
/// The scene cannot be solved on the fine grid.
pub fn random_scene(session: &Session, seed: u64) -> Result<KnownScene> {
    solved(session, draw(seed, seed.is_multiple_of(6)))
}

/// The same in 3D, every second one a lattice of fixed spheres. Collective.
///
/// # Errors
/// The scene cannot be solved on the fine grid.
pub fn random_scene_in_space(session: &Session, seed: u64) -> Result<KnownScene> {
    solved(session, if seed.is_multiple_of(2) { lattice(seed) } else { draw(seed, true) })
}

/// A scene with the answer of a fine grid.
fn solved(session: &Session, scene: KnownScene) -> Result<KnownScene> {
    let (cells, modes) = FINE[scene.dimension()? - 2];
    let fine = [
        format!("resolution.cells_per_radius={cells}"),
        format!("resolution.modes={modes}"),
        "method.tolerance=1e-6".to_owned(),
        "lubrication.model=\"pairwise\"".to_owned(),
    ];
    Ok(KnownScene { answer: scene.answered(session, &fine)?, ..scene })
}

/// A lattice at a fraction with gaps of 0.1 radii and more, somewhere in its cell.
fn lattice(seed: u64) -> KnownScene {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let kind = [Lattice::Simple, Lattice::BodyCentred, Lattice::FaceCentred][random.random_range(0..3)];
    let array = kind.array(random.random_range(0.05..0.4), std::array::from_fn(|_| random.random_range(0.0..0.25)));
    let scene = KnownScene { name: format!("{} {seed}", array.name), ..array };
    if random.random_bool(0.7) { with_films(scene) } else { scene }
}

/// The scene of a seed in the plane or in space, without resolution and answer.
fn draw(seed: u64, solid: bool) -> KnownScene {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let flows: &[FlowKind] = if solid { &SPACE } else { &PLANE };
    let kind = &flows[random.random_range(0..flows.len())];
    let films = random.random_bool(0.7);
    let count = if solid { random.random_range(2..=4) } else { random.random_range(2..=14) };
    let fraction = if solid { random.random_range(0.05..0.25) } else { random.random_range(0.1..0.42) };
    let gap = if films { random.random_range(0.02..0.2) } else { random.random_range(0.15..0.4) };
    let large = if random.random_bool(0.3) && count > 2 { count / 3 } else { 0 };
    let radius: f64 = 1.4;
    let (dimension, volume) = if solid { (3, 4.0 / 3.0 * PI) } else { (2, PI) };
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
    KnownScene { name, text, answer: CalibrationAnswer { quantity: kind.quantity, values: Vec::new() } }
}

/// A cubic lattice.
#[derive(Debug, Clone, Copy)]
enum Lattice {
    /// One sphere in its cell.
    Simple,
    /// Two.
    BodyCentred,
    /// Four.
    FaceCentred,
}

impl Lattice {
    fn places(self) -> (&'static str, &'static [[f64; 3]]) {
        match self {
            Lattice::Simple => ("simple cubic", &[[0.0, 0.0, 0.0]]),
            Lattice::BodyCentred => ("body-centred cubic", &[[0.0, 0.0, 0.0], [0.5, 0.5, 0.5]]),
            Lattice::FaceCentred => ("face-centred cubic", &[[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]]),
        }
    }

    /// Its fixed spheres at a fraction, the first at `corner`.
    fn array(self, fraction: f64, corner: [f64; 3]) -> KnownScene {
        let (name, places) = self.places();
        let radius = (0.75 * (fraction / places.len() as f64) / PI).cbrt();
        let centers: Vec<[f64; 3]> = places.iter().map(|place| std::array::from_fn(|axis| place[axis] + corner[axis])).collect();
        let text = format!(
            "[domain]\nsize = [1.0, 1.0, 1.0]\n[flow]\n{CROSS_FLOW_IN_SPACE}\n[method]\ninverse = \"auto\"\n\
             [[bodies]]\nradius = {radius:?}\ncenters = {centers:?}\n{FIXED}\n"
        );
        KnownScene {
            name: format!("{name} array {fraction:.3}"),
            text,
            answer: CalibrationAnswer { quantity: EstimatedQuantity::Drag, values: Vec::new() },
        }
    }
}

/// A scene with lubrication.
fn with_films(scene: KnownScene) -> KnownScene {
    KnownScene { name: format!("{}, films", scene.name), text: format!("{}[lubrication]\nmodel = \"pairwise\"\n", scene.text), ..scene }
}
