//! Tables name their columns once and for all, and what is altered in a table or a frame is not believed.

use std::{fs, path::Path};

use crate::common::{Series, difference, folder, resume, run, said, scenes::DRY, turbid, write};

/// A sheared flow with inertia for things that are tied; the first row is that of the start.
const TIED: &str = r#"
[flow]
model = "navier-stokes"
density = 1.0
[method]
inverse = "transform"
[output]
picture = false
report = false
"#;

const CHAIN: &str = "[domain]\nsize = [4.0, 4.0]\n[resolution]\nspacing = 0.1\n[time]\nend = 0.1\nstep = 0.025\n[[chains]]\nbeads = 3\nradius = 0.3\n\
                     stretch = 40.0\nbend = 1.0\ncenters = [[1.3, 2.0], [2.0, 2.0], [2.7, 2.0]]\n";
const CELL: &str = "[domain]\nsize = [5.0, 5.0]\n[resolution]\nspacing = 0.04\n[time]\nend = 0.04\nstep = 0.01\n[[cells]]\nbeads = 24\nradius = 0.12\n\
                    stretch = 100.0\nbend = 1.0\ncenters = [[2.5, 2.5]]\n";
const CLUSTER: &str = "[domain]\nsize = [4.0, 4.0]\n[resolution]\nspacing = 0.1\n[time]\nend = 0.1\nstep = 0.025\n[[clusters]]\nshape = \"rod\"\nbeads = 3\n\
                       radius = 0.3\ncenters = [[2.0, 2.0]]\n";
const SLIDING: &str = "flow.drive={ shear_rate = 1.0, periodic = \"sheared\" }";
const WALLS: &str = "domain.y={ lower = [-2.0, 0.0], upper = [2.0, 0.0] }";

#[test]
fn every_row_of_a_sheared_run_with_inertia_and_ties_stands_under_its_names() {
    for (name, tied, way, half, end) in [
        ("chain", CHAIN, SLIDING, 0.05, 0.1),
        ("cell", CELL, WALLS, 0.02, 0.04),
        ("cluster", CLUSTER, SLIDING, 0.05, 0.1),
        ("rod", CLUSTER, WALLS, 0.05, 0.1),
    ] {
        let here = folder(&format!("tables-{name}"));
        let (scene, once, twice) = (write(&here, &format!("{TIED}{tied}")), here.join("once"), here.join("twice"));
        run(1, &scene, &once, &[way]);
        // which must be as wide as its header
        let series = Series::read(&once);
        assert_eq!(series.at(0, "viscosity_bonds"), 0.0, "{name}: what is tied bears nothing at rest, which is a number");
        assert!((1..series.rows.len()).any(|row| series.at(row, "viscosity_bonds") != 0.0), "{name}");
        for row in 0..series.rows.len() {
            let parts = ["viscosity_hydrodynamic", "viscosity_bonds", "viscosity_reynolds"].map(|part| series.at(row, part));
            let viscosity = series.at(row, "viscosity");
            assert!((parts.iter().sum::<f64>() - viscosity).abs() < 1e-12 * viscosity.abs(), "{name}: {parts:?} make up {viscosity}");
            assert_eq!(series.at(row, "iterations").fract(), 0.0, "{name}");
        }
        let energy = series.at(series.rows.len() - 1, "kinetic_energy");
        assert!(energy > 0.0 && energy < 17.0, "{name}: {energy}, which is at most that of the shear between the walls");
        run(1, &scene, &twice, &[way, &format!("time.end={half}")]);
        resume(1, &twice, &[&format!("time.end={end}")]);
        let (distance, column) = series.difference(&Series::read(&twice), &["seconds"]);
        assert!(distance < 1e-10, "{name}: {column} differs by {distance:.1e}");
    }
}

/// What a run that goes on says, and whether it does.
fn gone_on(out: &Path) -> (bool, String) {
    let output = turbid(1, &["resume", out.to_str().unwrap(), "--set", "time.end=2"]);
    (output.status.success(), said(&output))
}

#[test]
fn what_is_altered_in_a_table_is_refused_with_its_line_and_a_table_without_checksums_is_read() {
    let here = folder("tables-altered");
    let (scene, out) = (write(&here, &format!("{DRY}profiles = [\"y\"]\n")), here.join("out"));
    run(1, &scene, &out, &[]);
    for (name, line) in [("series.csv", 4), ("profile-frames.csv", 7)] {
        let table = out.join(name);
        let whole = fs::read_to_string(&table).unwrap();
        let row = whole.lines().nth(line - 1).unwrap();
        // the last digit of a number
        let digit = row.rfind(|sign: char| ('1'..'9').contains(&sign)).unwrap();
        let altered = format!("{}{}{}", &row[..digit], char::from(row.as_bytes()[digit] + 1), &row[digit + 1..]);
        fs::write(&table, whole.replacen(row, &altered, 1)).unwrap();
        let (passed, said) = gone_on(&out);
        assert!(!passed && said.contains(&format!("{name}:{line}: is not the line that the run wrote")), "{said}");
        fs::write(&table, whole).unwrap();
    }
    fs::remove_file(out.join(".series.csv.sums")).unwrap();
    fs::remove_file(out.join(".profile-frames.csv.sums")).unwrap();
    let (passed, said) = gone_on(&out);
    assert!(passed && out.join(".series.csv.sums").exists(), "{said}");
}

#[test]
fn an_altered_frame_is_set_aside() {
    let here = folder("tables-frames");
    let (scene, out) = (write(&here, DRY), here.join("out"));
    run(2, &scene, &out, &[]);
    for (frame, name) in [(1, "bodies/center"), (2, "bodies/contacts"), (3, "contacts/force")] {
        let file = hdf5::File::open_rw(out.join(format!("frames/{frame:06}.h5"))).unwrap();
        let dataset = file.dataset(name).unwrap();
        let mut numbers: Vec<f64> = dataset.read_raw().unwrap();
        if let Some(first) = numbers.first_mut() {
            *first += 1.0;
            dataset.write_raw(&numbers).unwrap();
        }
    }
    let printed = said(&turbid(1, &["animate", out.to_str().unwrap()]));
    assert!(printed.contains("000001.h5 cannot be read (its bodies/center differs from its checksum)"), "{printed}");
    let (passed, said) = gone_on(&out);
    assert!(passed && said.contains("its bodies/center differs from its checksum"), "{said}");
    assert!(said.contains("its bodies/contacts differs from its checksum") && out.join("frames/000002.h5.damaged").exists(), "{said}");
}

/// The bodies of the first frame, each with its centre and its radius.
fn balls(out: &Path) -> Vec<[f64; 3]> {
    let frame = hdf5::File::open(out.join("frames/000000.h5")).unwrap();
    let centers = frame.dataset("bodies/center").unwrap().read_raw::<f64>().unwrap();
    let radii = frame.dataset("bodies/radius").unwrap().read_raw::<f64>().unwrap();
    centers.chunks(3).zip(radii).map(|(center, radius)| [center[0], center[1], radius]).collect()
}

#[test]
fn a_table_gives_clusters_cells_and_chains_their_radii() {
    let text =
        "[domain]\nsize = [30.0, 30.0]\n[flow]\nmodel = \"none\"\n[time]\nend = 0.01\nstep = 0.01\n[contact]\nmodel = \"inelastic\"\n";
    let distance = |one: &[f64; 3], other: &[f64; 3]| (one[0] - other[0]).hypot(one[1] - other[1]);
    let rods = "[[clusters]]\nshape = \"rod\"\nbeads = 3\nradius = 0.5\nspacing = 1.25\nfile = \"places.csv\"\n";
    let cells = "[[cells]]\nbeads = 24\nradius = 0.15\nbend = 0.1\nstretch = \"rigid\"\nfile = \"places.csv\"\n";
    let chain = "[[chains]]\nbeads = 2\nradius = 0.5\nspacing = 1.25\nstretch = 10.0\nfile = \"beads.csv\"\n";
    for (name, group, balls_of_one) in [("rods", rods, 3), ("cells", cells, 24), ("chains", chain, 2)] {
        let here = folder(&format!("radii-{name}"));
        fs::write(here.join("places.csv"), "x,y,radius\n8,8,0.2\n20,20,0.3\n").unwrap();
        fs::write(here.join("beads.csv"), "x,y,radius\n8,8,0.2\n8.5,8,0.2\n20,20,0.2\n20.625,20,0.3\n").unwrap();
        let out = here.join("out");
        run(1, &write(&here, &format!("{text}{group}")), &out, &[]);
        let balls = balls(&out);
        assert_eq!(balls.len(), 2 * balls_of_one, "{name}");
        let series = Series::read(&out);
        match name {
            "chains" => assert!(series.at(0, "bond_energy").abs() < 1e-20, "bonds are at rest at 1.25 times the sum of the radii"),
            _ => {
                for (balls, radius) in balls.chunks(balls_of_one).zip([0.2, 0.3]) {
                    assert!(balls.iter().all(|ball| ball[2] == radius), "{name}: {balls:?}");
                    let spacing = if name == "rods" { 1.25 } else { 1.05 };
                    let found = distance(&balls[0], &balls[1]);
                    assert!((found - 2.0 * radius * spacing).abs() < 1e-9, "{name}: {found} of radius {radius}");
                }
            }
        }
        if name == "cells" {
            assert!(series.at(0, "area_error") < 1e-9, "membranes are at rest: {}", series.at(0, "area_error"));
        }
    }
}

/// All numbers of a text.
fn numbers_in(text: &str) -> Vec<f64> {
    text.split(|sign: char| !(sign.is_ascii_digit() || "+-.e".contains(sign))).filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn pairs_and_profiles_of_a_resumed_run_are_those_of_the_same_frames() {
    // the frame at half time is the first that counts
    let here = folder("tables-halves");
    let scene = write(&here, &format!("{DRY}pairs = true\nprofiles = [\"y\"]\nreport = false\n"));
    for (number, step) in [0.02, 0.032].into_iter().enumerate() {
        let (once, twice) = (here.join(format!("once-{number}")), here.join(format!("twice-{number}")));
        let step = format!("time.step={step}");
        run(1, &scene, &once, &[&step]);
        run(1, &scene, &twice, &[&step, "time.end=0.7"]);
        resume(1, &twice, &["time.end=1.6"]);
        for name in ["pairs.json", "profiles.csv"] {
            let [whole, halves] = [&once, &twice].map(|out| numbers_in(&fs::read_to_string(out.join(name)).unwrap()));
            assert!(whole.len() > 10 && difference(&whole, &halves) < 1e-9, "{name} of {step}");
        }
        let first = crate::common::summary(&once)["pairs"]["from_time"].as_f64().unwrap();
        assert!((first - 0.8).abs() < 1e-9, "the frame at half time is at {first}");
    }
}
