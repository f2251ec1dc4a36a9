//! Where bodies of given motion are, and velocities of dry bodies at the time of their row.

use std::{fs, path::Path};

use serde_json::Value;

use crate::common::{Series, folder, number, resume, run, scenes::BALANCE, write};

/// Bodies of every kind of given motion beside a free one; steps that no time of them is a multiple of.
const GIVEN: &str = r#"
[domain]
size = [12.0, 8.0]
y = "walls"
[[bodies]]
radius = 0.5
centers = [[1.5, 2.1]]
motion = "fixed"
[[bodies]]
radius = 0.5
centers = [[3.1, 3.3]]
motion = { velocity = [0.37, -0.11], spin = 0.7 }
[[bodies]]
radius = 0.5
centers = [[6.7, 4.9]]
motion = { amplitude = [0.0, 0.3], rotation = 0.4, frequency = 0.7, phase = 0.2 }
[[bodies]]
radius = 0.5
centers = [[9.3, 3.1]]
motion = { path = [[0, 0, 0], [0.4, 0.2, 0.1], [0.9, 0.1, 0.3]] }
[[bodies]]
radius = 0.5
centers = [[10.5, 6.0]]
density = 2.0
[contact]
model = "inelastic"
[output]
picture = false
report = false
[time]
end = 0.9
step = 0.013
"#;

/// Rounding of a place that is evaluated from its time.
const ROUNDING: f64 = 1e-13;

fn center(summary: &Value, body: usize) -> [f64; 2] {
    [0, 1].map(|axis| number(summary, &format!("bodies.{body}.center.{axis}")))
}

fn near(found: [f64; 2], expected: [f64; 2], what: &str) {
    let distance = (found[0] - expected[0]).hypot(found[1] - expected[1]);
    assert!(distance < ROUNDING, "{what}: {found:?} is {distance:.1e} from {expected:?}");
}

#[test]
fn bodies_of_given_motion_are_where_it_has_them_after_any_number_of_steps() {
    let dry = "[flow]\nmodel = \"none\"\n";
    let stokes = "[resolution]\ncells_per_radius = 3\n[method]\ninverse = \"transform\"\ntolerance = 1e-4\n";
    for (name, flow, ranks) in [("dry", dry, 1), ("dry-2", dry, 2), ("stokes", stokes, 1)] {
        let here = folder(&format!("given-{name}"));
        let (scene, out) = (write(&here, &format!("{GIVEN}{flow}")), here.join("out"));
        let end = if name == "stokes" { 0.26 } else { 0.9 };
        run(ranks, &scene, &out, &[&format!("time.end={}", 0.5 * end)]);
        let summary = resume(ranks, &out, &[&format!("time.end={end}")]);
        near(center(&summary, 0), [1.5, 2.1], name);
        near(center(&summary, 1), [3.1 + 0.37 * end, 3.3 - 0.11 * end], name);
        let swing = (std::f64::consts::TAU * 0.7 * end + 0.2).sin() - 0.2_f64.sin();
        near(center(&summary, 2), [6.7, 4.9 + 0.3 * swing], name);
        if name != "stokes" {
            near(center(&summary, 3), [9.4, 3.4], "the end of the path");
        }
        let velocity = [0, 1].map(|axis| number(&summary, &format!("bodies.1.velocity.{axis}")));
        near(velocity, [0.37, -0.11], "what is given is told");
        let angle = turned(&out, 1);
        assert!((angle - 0.7 * end).abs() < 1e-12, "{name}: turned by {angle}");
    }
}

/// The angle by which a body has turned in the last frame.
fn turned(out: &Path, body: usize) -> f64 {
    let mut frames: Vec<_> = fs::read_dir(out.join("frames")).unwrap().map(|entry| entry.unwrap().path()).collect();
    frames.sort();
    let rotation = hdf5::File::open(frames.last().unwrap()).unwrap().dataset("bodies/rotation").unwrap().read_raw::<f64>().unwrap();
    rotation[9 * body + 3].atan2(rotation[9 * body])
}

/// A disk and a chain that fall on a floor far below, one that lies on it, and one that is tied to nothing and turns.
const FALLING: &str = r#"
gravity = [0.0, -1.0]
[domain]
size = [20.0, 40.0]
y = "walls"
[flow]
model = "none"
[[bodies]]
radius = 0.5
centers = [[3.0, 30.0]]
[[bodies]]
radius = 0.5
centers = [[6.0, 0.5]]
[[bodies]]
radius = 0.5
centers = [[16.0, 30.0]]
torque = 0.1
[[chains]]
radius = 0.4
beads = 3
stretch = "rigid"
centers = [[9.0, 30.0], [9.84, 30.0], [10.68, 30.0]]
[contact]
model = "inelastic"
[output]
picture = false
report = false
[time]
end = 4.0
step = 0.1
"#;

#[test]
fn dry_velocities_are_those_of_the_time_of_their_row() {
    for ranks in [1, 2] {
        let here = folder(&format!("given-falling-{ranks}"));
        let (scene, out) = (write(&here, FALLING), here.join("out"));
        let summary = run(ranks, &scene, &out, &[]);
        let falls = |body: usize| number(&summary, &format!("bodies.{body}.velocity.1"));
        for body in [0, 2, 3, 4, 5] {
            assert!((falls(body) + 4.0).abs() < 1e-9, "body {body}: {} after a time of 4 at an acceleration of 1", falls(body));
        }
        assert!(falls(1).abs() < 1e-12, "what lies on the floor rests: {}", falls(1));
        let (disk, bead) = (std::f64::consts::PI * 0.25, std::f64::consts::PI * 0.16);
        let spin = 0.1 * 4.0 / (0.5 * disk * 0.25);
        assert!((number(&summary, "bodies.2.spin.0") - spin).abs() < 1e-9 * spin);
        let series = Series::read(&out);
        for row in [0, 1, 17, 40] {
            let time = series.at(row, "time");
            let expected = 0.5 * (2.0 * disk + 3.0 * bead) * time * time + 0.25 * disk * 0.25 * (spin * time / 4.0).powi(2);
            let found = series.at(row, "kinetic_energy");
            assert!((found - expected).abs() < 1e-9 * (1.0 + expected), "row {row}: {found} instead of {expected}");
        }
    }
}

#[test]
fn what_moves_as_it_is_told_starts_with_no_negative_energy() {
    let here = folder("given-energy");
    let (scene, out) = (write(&here, BALANCE), here.join("out"));
    run(1, &scene, &out, &["time.end=0.01"]);
    let energies = Series::read_table(&out.join("energy.csv"));
    assert_eq!(energies.at(0, "kinetic_energy"), 0.0, "only the disk of given motion moves, whose energy does not count");
    // of its density, 1, and its speed at the start, amplitude times angular frequency
    let speed = 0.3 * std::f64::consts::PI;
    let expected = 0.5 * std::f64::consts::PI * 0.25 * speed * speed;
    let found = Series::read(&out).at(0, "kinetic_energy");
    assert!((found - expected).abs() < 1e-12, "{found} instead of {expected}");
}
