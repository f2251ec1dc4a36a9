//! `turbid sweep` as a user meets it.

use std::{
    fs,
    os::unix::fs::PermissionsExt,
    path::Path,
    process::Stdio,
    time::{Duration, Instant},
};

use crate::common::{command, folder, halves, number, root, run, said, turbid, write};
use serde_json::Value;

/// Disks at random in a shear at an instant.
const DISKS: &str = r#"
title = "random disks"
seed = 3
[domain]
size = [6.0, 6.0]
[flow]
drive = { shear_rate = 1.0 }
[resolution]
cells_per_radius = 3
[lubrication]
model = "pairwise"
[[bodies]]
radius = 1.0
fraction = 0.1
"#;

fn words<'a>(scene: &'a Path, out: &'a Path, arguments: &[&'a str]) -> Vec<&'a str> {
    [&["sweep", scene.to_str().unwrap(), "--out", out.to_str().unwrap()], arguments].concat()
}

/// What a sweep wrote, and what it printed.
fn sweep(scene: &Path, out: &Path, arguments: &[&str]) -> (Value, String) {
    let output = turbid(1, &words(scene, out, arguments));
    assert!(output.status.success(), "{}", said(&output));
    (results(out), String::from_utf8(output.stdout).unwrap())
}

fn results(out: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(out.join("sweep.json")).unwrap()).unwrap()
}

fn points(sweep: &Value) -> &[Value] {
    sweep["findings"]["points"].as_array().unwrap()
}

#[test]
fn a_sweep_has_means_and_intervals_over_seeds_and_tells_of_failures() {
    let here = folder("sweep");
    let (scene, out) = (write(&here, DISKS), here.join("out"));
    // so many disks have no room for the gap
    let arguments = ["--vary", "bodies.0.fraction=0.1,0.3", "--vary", "bodies.0.gap=0.05,4.0", "--seeds", "3"];
    let (found, printed) = sweep(&scene, &out, &arguments);
    let points = points(&found);
    assert_eq!(points.len(), 4, "{printed}");
    let one = run(1, &scene, &here.join("one"), &["bodies.0.gap=0.05", "seed=4"]);
    let record = &found["records"][1];
    assert_eq!(
        (record["setting"]["seed"].as_u64(), number(record, "outcome.measured.readings.0.value")),
        (Some(4), number(&one, "viscosity.relative"))
    );
    for point in points.iter().filter(|point| point["failed"] == 0) {
        let estimate = &point["quantities"][0];
        let (mean, error) = (number(estimate, "mean"), number(estimate, "standard_error"));
        let half = 0.5 * (number(estimate, "interval.1") - number(estimate, "interval.0"));
        assert!(mean > 1.1 && mean < 2.5 && error > 0.0 && (half / error - 4.3027).abs() < 1e-3, "{point}");
    }
    let crowded = &points[3];
    assert_eq!((crowded["runs"].as_u64(), crowded["failed"].as_u64()), (Some(0), Some(3)), "{printed}");
    assert!(printed.contains("bodies.0.fraction = 0.3, bodies.0.gap = 4.0: seed 3: "), "{printed}");

    let mut names: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["runs", "sweep.csv", "sweep.json", "sweep.md", "sweep.svg"]);
    // a disk of radius 1 fills 0.0873 of the box: one for 0.1, three for 0.3
    let placed: Vec<f64> = points.iter().filter(|point| point["failed"] == 0).map(|point| number(point, "fraction")).collect();
    let disk = std::f64::consts::PI / 36.0;
    assert!(placed.iter().zip([1.0, 1.0, 3.0]).all(|(placed, disks)| (placed - disk * disks).abs() < 1e-12), "{placed:?}");
    assert!(halves(&out).is_empty());
    let table = fs::read_to_string(out.join("sweep.csv")).unwrap();
    let head = "bodies.0.fraction,bodies.0.gap,fraction_placed,viscosity,viscosity.standard_error,viscosity.low,viscosity.high,viscosity.over,\
                viscosity.steady,runs,failed,seconds";
    assert_eq!((table.lines().next(), table.lines().count()), (Some(head), 5));
    assert!(table.lines().all(|line| line.split(',').count() == 12), "{table}");
    let chart = fs::read_to_string(out.join("sweep.svg")).unwrap();
    assert!(chart.ends_with("</svg>\n") && !chart.contains("NaN") && chart.contains("bodies.0.gap = 0.05"), "{chart}");
}

#[test]
fn a_sweep_that_is_killed_goes_on_with_more_values_and_only_as_the_same() {
    let here = folder("sweep-killed");
    let (scene, out) = (write(&here, DISKS), here.join("out"));
    let first = ["--vary", "bodies.0.fraction=0.1,0.2,0.3"];
    let mut started = command(1, &words(&scene, &out, &first)).stdout(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while !out.join("sweep.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(300), "no run came to its end");
        std::thread::sleep(Duration::from_millis(20));
    }
    started.kill().unwrap();
    started.wait().unwrap();
    let before = results(&out);
    let kept = before["records"].as_array().unwrap();
    let (after, _) = sweep(&scene, &out, &["--vary", "bodies.0.fraction=0.1,0.2,0.3,0.15"]);
    assert_eq!(after["records"].as_array().unwrap()[..kept.len()], kept[..], "they are not measured again");
    assert_eq!((after["records"].as_array().unwrap().len(), points(&after).len()), (4, 4));
    let other = turbid(1, &words(&scene, &out, &[&first[..], &["--set", "flow.viscosity=2"]].concat()));
    assert_eq!(other.status.code(), Some(2));
    assert!(said(&other).contains("holds a study that differs in the scene"), "{}", said(&other));
}

#[test]
fn columns_of_a_series_and_velocities_along_the_force_are_swept() {
    let here = folder("sweep-series");
    let falling = "gravity = [0, -1]\n[domain]\nsize = [4, 4]\ny = \"walls\"\n[resolution]\ncells_per_radius = 3\n[[bodies]]\nradius = 0.5\n\
                   density = 2\ncenters = [[2, 2.5]]\n[time]\nend = 0.4\nstep = 0.1\n";
    let (found, printed) = sweep(&write(&here, falling), &here.join("out"), &["--vary", "flow.viscosity=1,2"]);
    let speeds: Vec<f64> = points(&found).iter().map(|point| number(point, "quantities.0.mean")).collect();
    assert!(speeds[0] > 0.0 && (speeds[0] / speeds[1] - 2.0).abs() < 0.05, "{speeds:?} {printed}");
    let dry = "gravity = [0, -1]\n[domain]\nsize = [4, 4]\n[flow]\nmodel = \"none\"\n[[bodies]]\nradius = 0.5\ncenters = [[2, 2]]\n[time]\nend = 1\nstep = 0.1\n";
    let arguments = ["--vary", "bodies.0.density=1,3", "--quantity", "series.kinetic_energy"];
    let (found, _) = sweep(&write(&here, dry), &here.join("dry"), &arguments);
    let energies: Vec<f64> = points(&found).iter().map(|point| number(point, "quantities.0.mean")).collect();
    assert!(energies[0] > 0.0 && (energies[1] / energies[0] - 3.0).abs() < 1e-9, "{energies:?}");
}

/// With an mpirun that fails: a sweep on one rank needs no launcher.
#[test]
fn runs_on_one_rank_are_started_as_they_are_and_kept_as_asked() {
    let here = folder("sweep-kept");
    let dry = "gravity = [0, -1]\n[domain]\nsize = [4, 4]\n[flow]\nmodel = \"none\"\n[[bodies]]\nradius = 0.5\ncenters = [[2, 2]]\n[time]\nend = 1\nstep = 0.1\n";
    let scene = write(&here, dry);
    let broken = here.join("mpirun");
    fs::write(&broken, "#!/bin/sh\nexit 1\n").unwrap();
    fs::set_permissions(&broken, fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", here.display(), std::env::var("PATH").unwrap());
    let quantities = ["--vary", "bodies.0.density=1,3", "--quantity", "series.kinetic_energy,settling"];
    let kept = |keep: &str, files: &[&str]| {
        let out = here.join(keep);
        let mut command = command(1, &words(&scene, &out, &[&quantities[..], &["--keep", keep]].concat()));
        command.env_remove("OMPI_ALLOW_RUN_AS_ROOT").env_remove("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM").env("PATH", &path);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
        let found = results(&out);
        let run = found["records"][1]["outcome"]["measured"]["folder"].as_str().map(|folder| out.join(folder));
        let names: Vec<String> =
            run.iter().flat_map(|run| fs::read_dir(run).unwrap()).map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        assert!(files.iter().all(|file| names.iter().any(|name| name == file)), "{keep}: {names:?}");
        (found, names.len(), run)
    };
    let (found, count, run) = kept("series", &["summary.json", "series.csv", "scene.toml"]);
    assert_eq!((count, run.unwrap().file_name().and_then(|name| name.to_str())), (3, Some("bodies.0.density=3,seed=1")));
    let point = |point: usize, quantity: usize| number(&found, &format!("findings.points.{point}.quantities.{quantity}.mean"));
    assert!((point(1, 0) / point(0, 0) - 3.0).abs() < 1e-9 && (point(1, 1) / point(0, 1) - 1.0).abs() < 1e-12 && point(0, 1) > 0.0);
    let (_, count, _) = kept("all", &["summary.json", "series.csv", "scene.toml", "run.log"]);
    assert!(count > 3);
    assert_eq!(kept("nothing", &[]).1, 0);
    assert!(here.join("series/sweep-series.kinetic_energy.svg").exists() && !here.join("nothing/runs").exists());

    let refused = |command: &str, folder: &str, message: &str| {
        let output = turbid(1, &[command, here.join(folder).to_str().unwrap()]);
        assert!(said(&output).contains(message) && output.status.code() == Some(2), "{command} {folder}: {}", said(&output));
    };
    let first = "runs/bodies.0.density=1,seed=1";
    let named = format!("holds a sweep, not a run; name one of its runs: {}", here.join("all").join(first).display());
    for command in ["view", "animate"] {
        refused(command, "all", &named);
        refused(command, "series", "holds a sweep, not a run; `turbid sweep` keeps frames of its runs with --keep all");
        refused(command, &format!("series/{first}"), "holds no frames; `turbid sweep` keeps frames of its runs with --keep all");
    }
    refused("resume", "all", "holds a sweep, not a run; repeat its `turbid sweep` command, which goes on");
}

#[test]
fn a_sweep_that_cannot_be_made_is_refused() {
    let here = folder("sweep-refused");
    let (scene, out) = (write(&here, DISKS), here.join("out"));
    let given = root().join("examples/cubic.toml");
    let cases: [(&[&str], &str); 11] = [
        (&["--vary", "flow.viscosity=1", "--quantity", "viscosity,viscosity"], "--quantity viscosity: stands there twice"),
        (&["--vary", "bodies.0.fraction"], "must be key=value,value"),
        (&["--vary", "bodies.0.fraction=0.1:0.3:3"], "0.1:0.3:3 is no list of values; there are no ranges: separate all values by commas"),
        (&["--vary", "bodies.0.fraction=0.1..0.3"], "0.1..0.3 is no list of values"),
        (&["--vary", "bodies.0.fractions=0.1"], "fractions"),
        (&["--vary", "bodies.0.fraction=0.1,2"], "fraction"),
        (&["--vary", "seed=1,2", "--seeds", "2"], "the seed is one of the keys that are varied"),
        (&["--vary", "flow.viscosity=1", "--seeds", "0"], "--seeds"),
        (&["--vary", "flow.viscosity=1", "--quantity", "weight"], "--quantity weight: must be viscosity, drag, settling"),
        (&["--vary", "flow.viscosity=1", "--quantity", "flow.weight"], "no run came to its end"),
        (&[], "--vary"),
    ];
    for (arguments, message) in cases {
        let output = turbid(1, &words(&scene, &out, arguments));
        assert!(said(&output).contains(message), "{arguments:?} says: {}", said(&output));
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    }
    let output = turbid(1, &words(&given, &out, &["--vary", "flow.viscosity=1,2", "--seeds", "3"]));
    assert!(
        said(&output).contains("--seeds 3: the places of all bodies are given") && output.status.code() == Some(2),
        "{}",
        said(&output)
    );
}
