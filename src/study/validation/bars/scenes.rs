//! The scenes: answers are published or exactly computed.

use std::f64::consts::PI;

use super::known::KnownScene;
use crate::study::calibration::{Answer, Quantity};

/// Centres of the random cell.
const RANDOM_CELL: &str = include_str!("../../../../examples/random30.csv");

/// Two walls that slide in opposite directions at unit rate, a unit apart.
const SLIDING: &str = "y = { lower = [-0.5, 0.0], upper = [0.5, 0.0] }";

/// All scenes, those in 2D first.
pub fn known_scenes() -> Vec<KnownScene> {
    let mut all = Vec::new();
    all.extend([(0.1, 24.8316752488), (0.3, 102.881303670), (0.5, 532.548118463)].map(square_array));
    all.extend([(0.1, 1.19222418765), (0.3, 1.59811597742), (0.5, 2.25501923317), (0.7, 4.50248954865)].map(disk_lattice));
    all.extend([(1.0, 0.1, 1.065294333), (1.0, 0.2, 1.291011445), (1.0, 0.3, 1.810447427), (4.0, 0.4, 1.904096049)].map(couette_viscosity));
    all.extend([(1.0, 0.2, -0.462789970), (1.0, 0.3, -0.413733820), (4.0, 0.2, -0.451088913)].map(couette_spin));
    all.extend([pair_between_walls(), pair_in_a_periodic_box(), pair_that_sinks(), random_cell()]);
    all.extend([(0.1, 16.5072152), (0.125, 21.9145884), (0.25, 98.5554617)].map(pulled_disk));
    all.extend([(0.1, 0.0209579579), (0.125, 0.0171234769), (0.25, 0.005335436)].map(channel_flux));
    all.extend([(0.1, 16.92867674), (0.2, 55.04312168), (0.3, 222.7365874)].map(closed_box_disk));
    all.extend([(0.064, 2.810198125), (0.125, 4.291589200), (0.216, 7.44195364)].map(cubic_array));
    all.extend([(0.027, 1.066332554), (0.216, 1.542367097), (0.343, 1.99744245)].map(sphere_lattice));
    all.push(closed_box_sphere());
    all
}

/// A scene in a box of height 1 with these lines in `[domain]` and `[flow]`, and these groups of bodies.
fn known(name: String, [size, axes, flow, bodies]: [&str; 4], (quantity, values): (Quantity, &[f64])) -> KnownScene {
    let text = format!("[domain]\nsize = {size}\n{axes}\n[flow]\n{flow}\n[method]\ninverse = \"auto\"\n{bodies}");
    KnownScene { name, text, answer: Answer { quantity, values: values.to_vec() } }
}

fn body(radius: f64, centers: &str, rest: &str) -> String {
    format!("[[bodies]]\nradius = {radius:?}\ncenters = {centers}\n{rest}\n")
}

/// A centre in no special place on any grid.
const DISK: &str = "[[0.513, 0.527]]";
const SPHERE: &str = "[[0.513, 0.527, 0.481]]";
const FIXED: &str = "motion = \"fixed\"";
const MOVED: &str = "motion = { velocity = [1.0, 0.0] }";
const CROSS_FLOW: &str = "drive = { mean_velocity = [1.0, 0.0] }";
const SHEAR: &str = "drive = { shear_rate = 1.0 }";

fn disk_radius(fraction: f64) -> f64 {
    (fraction / PI).sqrt()
}

/// Radius of a sphere that fills a part of the unit box.
pub fn sphere_radius(fraction: f64) -> f64 {
    (0.75 * fraction / PI).cbrt()
}

/// Fixed disks at a fraction, with their drag.
pub fn square_array((fraction, drag): (f64, f64)) -> KnownScene {
    let disk = body(disk_radius(fraction), DISK, FIXED);
    known(format!("square array {fraction}"), ["[1.0, 1.0]", "", CROSS_FLOW, &disk], (Quantity::Drag, &[drag, 0.0, 0.0]))
}

/// Free disks at a fraction in shear, with their viscosity.
pub fn disk_lattice((fraction, viscosity): (f64, f64)) -> KnownScene {
    let disk = body(disk_radius(fraction), DISK, "");
    known(format!("square lattice {fraction}"), ["[1.0, 1.0]", "", SHEAR, &disk], (Quantity::Viscosity, &[viscosity]))
}

fn couette(length: f64, radius: f64, answer: (Quantity, &[f64])) -> KnownScene {
    let (size, disk) = (format!("[{length:?}, 1.0]"), body(radius, "[[0.513, 0.5]]", ""));
    known(format!("disk of {radius} in a Couette cell of {length}"), [&size, SLIDING, "", &disk], answer)
}

/// The same with its viscosity.
pub fn couette_viscosity((length, radius, viscosity): (f64, f64, f64)) -> KnownScene {
    couette(length, radius, (Quantity::Viscosity, &[viscosity]))
}

/// A free disk between sliding walls: length of the cell, radius, spin.
pub fn couette_spin((length, radius, spin): (f64, f64, f64)) -> KnownScene {
    couette(length, radius, (Quantity::Velocity, &[0.0, 0.0, spin * radius]))
}

const PAIR: &str = "[[0.3, 0.4], [0.65, 0.62]]";

fn pair_between_walls() -> KnownScene {
    let spins = [-0.406080384, -0.402670314].map(|spin| 0.15 * spin);
    let velocities = [-0.053755754, 0.018929646, spins[0], 0.083329666, -0.018834326, spins[1]];
    let disks = body(0.15, PAIR, "");
    known("two disks in a Couette cell".into(), ["[1.0, 1.0]", SLIDING, "", &disks], (Quantity::Velocity, &velocities))
}

/// The same with their viscosity.
pub fn pair_between_walls_sheared() -> KnownScene {
    KnownScene { answer: Answer { quantity: Quantity::Viscosity, values: vec![1.3813693532] }, ..pair_between_walls() }
}

/// Two free disks in shear.
pub fn pair_in_a_periodic_box() -> KnownScene {
    let disks = body(0.15, PAIR, "");
    known("two disks in a periodic box".into(), ["[1.0, 1.0]", "", SHEAR, &disks], (Quantity::Viscosity, &[1.3457188363]))
}

fn pair_that_sinks() -> KnownScene {
    let (disks, spin) = (body(0.15, PAIR, "force = [1.0, 0.0]"), 0.15 * 0.078226653);
    let velocities = [0.049167859, 0.004072376, -spin, 0.049167859, 0.004072376, spin];
    let drive = "drive = { mean_velocity = [0.0, 0.0] }";
    known("two disks that sink".into(), ["[1.0, 1.0]", "", drive, &disks], (Quantity::Velocity, &velocities))
}

fn random_cell() -> KnownScene {
    let centers: Vec<String> =
        RANDOM_CELL.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).map(|line| format!("[{line}]")).collect();
    let disks = body(0.05641895835477563, &format!("[{}]", centers.join(", ")), "");
    known("random cell of 30 disks".into(), ["[1.0, 1.0]", "", SHEAR, &disks], (Quantity::Viscosity, &[2.2380]))
}

/// A disk that is pulled along a channel: radius and drag.
pub fn pulled_disk((radius, drag): (f64, f64)) -> KnownScene {
    let (disk, drive) = (body(radius, "[[0.513, 0.5]]", MOVED), "drive = { mean_velocity = [0.0, 0.0] }");
    let answer = [-drag, 0.0, 0.0];
    known(format!("disk of {radius} pulled along a channel"), ["[1.0, 1.0]", "y = \"walls\"", drive, &disk], (Quantity::Drag, &answer))
}

fn channel_flux((radius, flux): (f64, f64)) -> KnownScene {
    let (disk, drive) = (body(radius, "[[0.513, 0.5]]", FIXED), "drive = { pressure_gradient = [-1.0, 0.0] }");
    known(
        format!("fixed disk of {radius} in a channel"),
        ["[1.0, 1.0]", "y = \"walls\"", drive, &disk],
        (Quantity::MeanVelocity, &[flux, 0.0]),
    )
}

/// A disk that is moved through a closed box, with its drag.
pub fn closed_box_disk((radius, drag): (f64, f64)) -> KnownScene {
    let disk = body(radius, "[[0.5, 0.5]]", MOVED);
    let answer = [-drag, 0.0, 0.0];
    known(format!("disk of {radius} in a closed box"), ["[1.0, 1.0]", "x = \"walls\"\ny = \"walls\"", "", &disk], (Quantity::Drag, &answer))
}

/// Fixed spheres at a fraction, with their drag over that of a lone one.
pub fn cubic_array((fraction, drag): (f64, f64)) -> KnownScene {
    let radius = sphere_radius(fraction);
    let (sphere, drive) = (body(radius, SPHERE, FIXED), "drive = { mean_velocity = [1.0, 0.0, 0.0] }");
    let answer = [6.0 * PI * radius * drag, 0.0, 0.0, 0.0, 0.0, 0.0];
    known(format!("cubic array {fraction}"), ["[1.0, 1.0, 1.0]", "", drive, &sphere], (Quantity::Drag, &answer))
}

/// Free spheres at a fraction in shear, with their viscosity.
pub fn sphere_lattice((fraction, viscosity): (f64, f64)) -> KnownScene {
    let sphere = body(sphere_radius(fraction), SPHERE, "");
    known(format!("cubic lattice {fraction}"), ["[1.0, 1.0, 1.0]", "", SHEAR, &sphere], (Quantity::Viscosity, &[viscosity]))
}

/// A sphere that is moved through a closed box.
pub fn closed_box_sphere() -> KnownScene {
    let sphere = body(0.2, "[[0.5, 0.5, 0.5]]", "motion = { velocity = [1.0, 0.0, 0.0] }");
    let answer = [-6.0 * PI * 0.2 * 3.12345, 0.0, 0.0, 0.0, 0.0, 0.0];
    let walls = "x = \"walls\"\ny = \"walls\"\nz = \"walls\"";
    known("sphere in a closed box".into(), ["[1.0, 1.0, 1.0]", walls, "", &sphere], (Quantity::Drag, &answer))
}
