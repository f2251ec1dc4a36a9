//! The scenes: answers are published or exactly computed.

use std::f64::consts::PI;

use super::known::KnownScene;
use crate::run::{Answer, Quantity};

/// Centres of the random cell.
const RANDOM_CELL: &str = include_str!("../../../../examples/random30.csv");

/// Two walls that slide in opposite directions at unit rate, a unit apart.
const SLIDING: &str = "y = { lower = [-0.5, 0.0], upper = [0.5, 0.0] }";

/// All scenes, those in 2D first.
pub fn known_scenes() -> Vec<KnownScene> {
    let mut all = Vec::new();
    all.extend([(0.1, 24.8316752488), (0.3, 102.881303670), (0.5, 532.548118463)].map(|(fraction, drag)| square_array(fraction, drag)));
    all.extend(
        [(0.1, 1.19222418765), (0.3, 1.59811597742), (0.5, 2.25501923317), (0.7, 4.50248954865)]
            .map(|(fraction, viscosity)| disk_lattice(fraction, viscosity)),
    );
    all.extend(
        [(1.0, 0.1, 1.065294333), (1.0, 0.2, 1.291011445), (1.0, 0.3, 1.810447427), (4.0, 0.4, 1.904096049)]
            .map(|(length, radius, viscosity)| couette_viscosity(length, radius, viscosity)),
    );
    all.extend(
        [(1.0, 0.2, -0.462789970), (1.0, 0.3, -0.413733820), (4.0, 0.2, -0.451088913)]
            .map(|(length, radius, spin)| couette_spin(length, radius, spin)),
    );
    all.extend([pair_between_walls(), pair_in_a_periodic_box(), pair_that_sinks(), random_cell()]);
    all.extend([(0.1, 16.5072152), (0.125, 21.9145884), (0.25, 98.5554617)].map(|(radius, drag)| pulled_disk(radius, drag)));
    all.extend([(0.1, 0.0209579579), (0.125, 0.0171234769), (0.25, 0.005335436)].map(|(radius, flux)| channel_flux(radius, flux)));
    all.extend([(0.1, 16.92867674), (0.2, 55.04312168), (0.3, 222.7365874)].map(|(radius, drag)| closed_box_disk(radius, drag)));
    all.extend([(0.064, 2.810198125), (0.125, 4.291589200), (0.216, 7.44195364)].map(|(fraction, drag)| cubic_array(fraction, drag)));
    all.extend(
        [(0.027, 1.066332554), (0.216, 1.542367097), (0.343, 1.99744245)].map(|(fraction, viscosity)| sphere_lattice(fraction, viscosity)),
    );
    all.push(closed_box_sphere());
    all.extend([(0.125, 4.291589200), (0.216, 7.44195364)].map(|(fraction, drag)| with_films(cubic_array(fraction, drag))));
    all.extend(
        [(Lattice::BodyCentred, 7.0417), (Lattice::FaceCentred, 7.0532)]
            .map(|(lattice, drag)| with_films(lattice.array(0.2, [0.03, 0.07, 0.11], drag))),
    );
    all
}

/// A scene with one kind of body: lines of its `[domain]`, `[flow]` and `[[bodies]]`.
#[derive(Clone, Copy)]
struct SceneDraft<'a> {
    size: &'a str,
    walls: &'a str,
    flow: &'a str,
    radius: f64,
    centers: &'a str,
    motion: &'a str,
}

/// A free disk in a periodic box, and a sphere in one; centres are in no special place on any grid.
const SQUARE: SceneDraft = SceneDraft { size: "[1.0, 1.0]", walls: "", flow: "", radius: 0.15, centers: "[[0.513, 0.527]]", motion: "" };
const CUBE: SceneDraft = SceneDraft { size: "[1.0, 1.0, 1.0]", centers: "[[0.513, 0.527, 0.481]]", ..SQUARE };
const CHANNEL: SceneDraft = SceneDraft { walls: "y = \"walls\"", centers: "[[0.513, 0.5]]", ..SQUARE };
const PAIR: SceneDraft = SceneDraft { centers: "[[0.3, 0.4], [0.65, 0.62]]", ..SQUARE };

const FIXED: &str = "motion = \"fixed\"";
const MOVED: &str = "motion = { velocity = [1.0, 0.0] }";
const CROSS_FLOW: &str = "drive = { mean_velocity = [1.0, 0.0] }";
const AT_REST: &str = "drive = { mean_velocity = [0.0, 0.0] }";
const SHEAR: &str = "drive = { shear_rate = 1.0 }";

impl SceneDraft<'_> {
    fn known(&self, name: impl Into<String>, quantity: Quantity, values: &[f64]) -> KnownScene {
        let SceneDraft { size, walls, flow, radius, centers, motion } = self;
        let bodies = format!("[[bodies]]\nradius = {radius:?}\ncenters = {centers}\n{motion}\n");
        let text = format!("[domain]\nsize = {size}\n{walls}\n[flow]\n{flow}\n[method]\ninverse = \"auto\"\n{bodies}");
        KnownScene { name: name.into(), text, answer: Answer { quantity, values: values.to_vec() } }
    }
}

/// Radius of a disk that fills a part of the unit box.
pub fn disk_radius(fraction: f64) -> f64 {
    (fraction / PI).sqrt()
}

/// Radius of a sphere that fills a part of the unit box.
pub fn sphere_radius(fraction: f64) -> f64 {
    (0.75 * fraction / PI).cbrt()
}

/// Fixed disks at a fraction, with their drag.
pub fn square_array(fraction: f64, drag: f64) -> KnownScene {
    let draft = SceneDraft { flow: CROSS_FLOW, radius: disk_radius(fraction), motion: FIXED, ..SQUARE };
    draft.known(format!("square array {fraction}"), Quantity::Drag, &[drag, 0.0, 0.0])
}

/// Free disks at a fraction in shear, with their viscosity.
pub fn disk_lattice(fraction: f64, viscosity: f64) -> KnownScene {
    let draft = SceneDraft { flow: SHEAR, radius: disk_radius(fraction), ..SQUARE };
    draft.known(format!("square lattice {fraction}"), Quantity::Viscosity, &[viscosity])
}

fn couette(length: f64, radius: f64, quantity: Quantity, values: &[f64]) -> KnownScene {
    let draft = SceneDraft { size: &format!("[{length:?}, 1.0]"), walls: SLIDING, radius, ..CHANNEL };
    draft.known(format!("disk of {radius} in a Couette cell of {length}"), quantity, values)
}

/// A free disk between sliding walls, a cell of some length, with the viscosity.
pub fn couette_viscosity(length: f64, radius: f64, viscosity: f64) -> KnownScene {
    couette(length, radius, Quantity::Viscosity, &[viscosity])
}

/// The same with the spin.
pub fn couette_spin(length: f64, radius: f64, spin: f64) -> KnownScene {
    couette(length, radius, Quantity::Velocity, &[0.0, 0.0, spin * radius])
}

fn pair_between_walls() -> KnownScene {
    let spins = [-0.406080384, -0.402670314].map(|spin| 0.15 * spin);
    let velocities = [-0.053755754, 0.018929646, spins[0], 0.083329666, -0.018834326, spins[1]];
    SceneDraft { walls: SLIDING, ..PAIR }.known("two disks in a Couette cell", Quantity::Velocity, &velocities)
}

/// Two free disks between sliding walls, with their viscosity.
pub fn sheared_pair_between_walls() -> KnownScene {
    KnownScene { answer: Answer { quantity: Quantity::Viscosity, values: vec![1.3813693532] }, ..pair_between_walls() }
}

/// Two free disks in shear.
pub fn pair_in_a_periodic_box() -> KnownScene {
    SceneDraft { flow: SHEAR, ..PAIR }.known("two disks in a periodic box", Quantity::Viscosity, &[1.3457188363])
}

fn pair_that_sinks() -> KnownScene {
    let (draft, spin) = (SceneDraft { flow: AT_REST, motion: "force = [1.0, 0.0]", ..PAIR }, 0.15 * 0.078226653);
    let velocities = [0.049167859, 0.004072376, -spin, 0.049167859, 0.004072376, spin];
    draft.known("two disks that sink", Quantity::Velocity, &velocities)
}

fn random_cell() -> KnownScene {
    let lines = RANDOM_CELL.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let centers = format!("[{}]", lines.map(|line| format!("[{line}]")).collect::<Vec<_>>().join(", "));
    let draft = SceneDraft { flow: SHEAR, radius: 0.05641895835477563, centers: &centers, ..SQUARE };
    draft.known("random cell of 30 disks", Quantity::Viscosity, &[2.2380])
}

/// A disk that is pulled along a channel, with its drag.
pub fn pulled_disk(radius: f64, drag: f64) -> KnownScene {
    let draft = SceneDraft { flow: AT_REST, radius, motion: MOVED, ..CHANNEL };
    draft.known(format!("disk of {radius} pulled along a channel"), Quantity::Drag, &[-drag, 0.0, 0.0])
}

fn channel_flux(radius: f64, flux: f64) -> KnownScene {
    let draft = SceneDraft { flow: "drive = { pressure_gradient = [-1.0, 0.0] }", radius, motion: FIXED, ..CHANNEL };
    draft.known(format!("fixed disk of {radius} in a channel"), Quantity::MeanVelocity, &[flux, 0.0])
}

/// A disk that is moved through a closed box, with its drag.
pub fn closed_box_disk(radius: f64, drag: f64) -> KnownScene {
    let draft = SceneDraft { walls: "x = \"walls\"\ny = \"walls\"", radius, centers: "[[0.5, 0.5]]", motion: MOVED, ..SQUARE };
    draft.known(format!("disk of {radius} in a closed box"), Quantity::Drag, &[-drag, 0.0, 0.0])
}

/// Fixed spheres at a fraction, with their drag over that of a lone one.
pub fn cubic_array(fraction: f64, drag: f64) -> KnownScene {
    let radius = sphere_radius(fraction);
    let draft = SceneDraft { flow: "drive = { mean_velocity = [1.0, 0.0, 0.0] }", radius, motion: FIXED, ..CUBE };
    let values = [6.0 * PI * radius * drag, 0.0, 0.0, 0.0, 0.0, 0.0];
    draft.known(format!("cubic array {fraction}"), Quantity::Drag, &values)
}

/// A cubic lattice.
#[derive(Debug, Clone, Copy)]
pub enum Lattice {
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

    /// Its fixed spheres at a fraction, the first at `corner`, with their drag over that of a lone one.
    pub fn array(self, fraction: f64, corner: [f64; 3], drag: f64) -> KnownScene {
        let (name, places) = self.places();
        let radius = sphere_radius(fraction / places.len() as f64);
        let centers: Vec<[f64; 3]> = places.iter().map(|place| std::array::from_fn(|axis| place[axis] + corner[axis])).collect();
        let (flow, centers) = ("drive = { mean_velocity = [1.0, 0.0, 0.0] }", format!("{centers:?}"));
        let values = [6.0 * PI * radius * drag, 0.0, 0.0, 0.0, 0.0, 0.0].repeat(places.len());
        let draft = SceneDraft { flow, radius, centers: &centers, motion: FIXED, ..CUBE };
        draft.known(format!("{name} array {fraction:.3}"), Quantity::Drag, &values)
    }
}

/// A scene with lubrication.
pub fn with_films(scene: KnownScene) -> KnownScene {
    KnownScene { name: format!("{}, films", scene.name), text: format!("{}[lubrication]\nmodel = \"pairwise\"\n", scene.text), ..scene }
}

/// Free spheres at a fraction in shear, with their viscosity.
pub fn sphere_lattice(fraction: f64, viscosity: f64) -> KnownScene {
    let draft = SceneDraft { flow: SHEAR, radius: sphere_radius(fraction), ..CUBE };
    draft.known(format!("cubic lattice {fraction}"), Quantity::Viscosity, &[viscosity])
}

/// A sphere that is moved through a closed box.
pub fn closed_box_sphere() -> KnownScene {
    let walls = "x = \"walls\"\ny = \"walls\"\nz = \"walls\"";
    let draft = SceneDraft { walls, radius: 0.2, centers: "[[0.5, 0.5, 0.5]]", motion: "motion = { velocity = [1.0, 0.0, 0.0] }", ..CUBE };
    let values = [-6.0 * PI * 0.2 * 3.12345, 0.0, 0.0, 0.0, 0.0, 0.0];
    draft.known("sphere in a closed box", Quantity::Drag, &values)
}
