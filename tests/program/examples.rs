//! The program as a user meets it: examples, ranks, refusals, exit codes.

use std::{collections::BTreeMap, fs, path::Path};

use crate::common::{Series, bodies, difference, folder, number, resume, root, run, run_again, said, turbid, write};
use serde_json::Value;

/// What the run of an example in this test changes to be done soon: lines `#+ key=value`.
fn settings(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| line.strip_prefix("#+ ")).collect()
}

/// The promises of an example, so changed: lines `#= path value tolerance`.
fn promises(text: &str) -> Vec<(String, f64, f64)> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("#= "));
    lines
        .map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            (words[0].to_owned(), words[1].parse().unwrap(), words[2].parse().unwrap())
        })
        .collect()
}

/// What an example came to: a number of its summary, `series.ROW.COLUMN`, or `frames.FRAME.QUANTITY.AXIS` as a mean over all bodies.
fn promised_number(out: &Path, summary: &Value, key: &str) -> f64 {
    let words: Vec<&str> = key.split('.').collect();
    match words[..] {
        ["series", row, column] => Series::read(out).at(row.parse().unwrap(), column),
        ["frames", frame, quantity, axis] => {
            let file = hdf5::File::open(out.join(format!("frames/{:06}.h5", frame.parse::<usize>().unwrap()))).unwrap();
            let vectors = file.dataset(&format!("bodies/{quantity}")).unwrap().read_2d::<f64>().unwrap();
            vectors.column(axis.parse().unwrap()).mean().unwrap()
        }
        _ => number(summary, key),
    }
}

/// Every second example gives the numbers of its header, from the first or the second on.
fn examples_keep_their_promises(first: usize) {
    let entries = fs::read_dir(root().join("examples")).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    paths.sort();
    assert!(paths.len() >= 12);
    for path in paths.iter().skip(first).step_by(2) {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let text = fs::read_to_string(path).unwrap();
        let promised = promises(&text);
        assert!(!promised.is_empty(), "{name} promises no number");
        let out = folder(&format!("example-{name}"));
        let summary = run(2, path, &out, &settings(&text));
        for (key, value, tolerance) in promised {
            let found = promised_number(&out, &summary, &key);
            assert!((found - value).abs() <= tolerance, "{name}: {key} is {found}, promised {value} +- {tolerance}");
        }
    }
}

// two tests: they run side by side

#[test]
fn one_half_of_the_examples_gives_the_numbers_of_their_headers() {
    examples_keep_their_promises(0);
}

#[test]
fn the_other_half_of_the_examples_gives_the_numbers_of_their_headers() {
    examples_keep_their_promises(1);
}

const SMALL_SUSPENSION: &str = r#"
[domain]
size = [12.0, 8.0]
y = { lower = [-4.0, 0.0], upper = [4.0, 0.0] }
[resolution]
cells_per_radius = 5
[method]
tolerance = 1e-9
[[bodies]]
radius = 1.0
fraction = 0.3
gap = 0.1
"#;

const SMALL_SUSPENSION_3D: &str = r#"
[domain]
size = [5.0, 4.0, 4.5]
[flow]
drive = { shear_rate = 1.0 }
[resolution]
cells_per_radius = 4
modes = 3
[method]
tolerance = 1e-9
[[bodies]]
radius = 1.0
count = 5
"#;

#[test]
fn the_result_does_not_depend_on_the_number_of_ranks() {
    for (name, text) in [("2d", SMALL_SUSPENSION), ("3d", SMALL_SUSPENSION_3D)] {
        let here = folder(&format!("ranks-{name}"));
        let scene = write(&here, text);
        let summaries: Vec<Value> = (1..=3).map(|ranks| run(ranks, &scene, &here.join(ranks.to_string()), &[])).collect();
        let reference = &summaries[0];
        for summary in &summaries[1..] {
            let difference = number(summary, "viscosity.relative") / number(reference, "viscosity.relative") - 1.0;
            assert!(difference.abs() < 1e-7, "{name}: viscosity differs by {difference:.1e}");
            let bodies = reference["bodies"].as_array().unwrap().len();
            for place in (0..bodies).flat_map(|body| [0, 1].map(|axis| format!("bodies.{body}.velocity.{axis}"))) {
                // relative to the speed of the walls or of the background over the box
                let difference = (number(summary, &place) - number(reference, &place)) / 4.0;
                assert!(difference.abs() < 1e-7, "{name}: {place} differs by {difference:.1e}");
            }
        }
    }
}

const METHODS: [&str; 4] = ["sharp", "mean-value", "distributed", "penalty"];

#[test]
fn every_method_for_a_scalar_gives_the_same_on_any_number_of_ranks() {
    let here = folder("scalar-ranks");
    let scene = root().join("examples/scalar.toml");
    for method in METHODS {
        let setting = format!("method.constraint=\"{method}\"");
        let summaries: Vec<Value> = (1..=3)
            .map(|ranks| run(ranks, &scene, &here.join(format!("{method}-{ranks}")), &[&setting, "method.tolerance=1e-10"]))
            .collect();
        for (summary, key) in summaries.iter().flat_map(|summary| ["scalar.inclusions.0.value", "scalar.energy"].map(|key| (summary, key)))
        {
            let difference = number(summary, key) / number(&summaries[0], key) - 1.0;
            assert!(difference.abs() < 1e-8, "{method}: {key} differs by {difference:.1e}");
        }
        assert!((number(&summaries[0], "scalar.inclusions.0.value") / 0.0406780 - 1.0).abs() < 3e-3, "{method}");
    }
}

#[test]
fn a_scalar_has_a_picture_of_itself_and_of_its_flux() {
    for (example, quantity) in [("scalar", "scalar u (units of the scene)"), ("conduction", "flux |q| / mean gradient")] {
        let here = folder(&format!("{example}-picture"));
        run(2, &root().join(format!("examples/{example}.toml")), &here, &["method.constraint=\"penalty\""]);
        let picture = fs::read_to_string(here.join("picture.svg")).unwrap();
        assert!(picture.contains(&format!(">{quantity}</text>")) && picture.contains("<circle"), "{example}");
    }
}

#[test]
fn a_step_of_uzawa_that_is_too_large_is_an_error_with_a_diagnosis_and_leaves_no_summary() {
    let here = folder("uzawa-diverges");
    let words = ["method.constraint=\"mean-value\"", "method.solver=\"uzawa\"", "method.uzawa_step=100.0"];
    let scene = root().join("examples/scalar.toml");
    let mut arguments = vec!["run", scene.to_str().unwrap(), "--out", here.to_str().unwrap()];
    words.iter().for_each(|word| arguments.extend(["--set", word]));
    let output = turbid(2, &arguments);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("method.uzawa_step = 100: the iteration diverged after") && said.contains("lower it"), "{said}");
    assert!(!here.join("summary.json").exists());
}

/// Scene, what its refusal must say, rank counts on which it is refused.
fn bad_scenes() -> Vec<(&'static str, String, &'static str, &'static [usize])> {
    let with = |bodies: &str| format!("[domain]\nsize = [10.0, 10.0]\n[resolution]\ncells_per_radius = 4\n{bodies}\n");
    let walled = |bodies: &str| format!("[domain]\nsize = [10.0, 10.0]\ny = \"walls\"\n[resolution]\ncells_per_radius = 4\n{bodies}\n");
    let all: &[usize] = &[1, 3];
    vec![
        ("unknown_key", "[domain]\nsize = [1.0, 1.0]\nsise = 2\n".into(), "unknown key domain.sise", all),
        ("overlap", with("[[bodies]]\nradius = 1.0\ncenters = [[2.0, 2.0], [3.5, 2.0]]"), "scene.toml:7: bodies[0].centers", all),
        ("across_the_seam", with("[[bodies]]\nradius = 1.0\ncenters = [[0.5, 2.0], [9.5, 2.0]]"), "overlaps body 0", all),
        ("outside", walled("[[bodies]]\nradius = 1.0\ncenters = [[2.0, -0.5]]"), "lies outside the box along y", all),
        (
            "in_the_lower_wall",
            walled("[[bodies]]\nradius = 1.0\ncenters = [[2.0, 0.5]]"),
            "body 0 overlaps the wall at y = 0 by 5.000e-1; move it, or enlarge domain.size",
            all,
        ),
        ("in_the_upper_wall", walled("[[bodies]]\nradius = 1.0\ncenters = [[2.0, 9.25]]"), "overlaps the wall at y = 10 by 2.500e-1", all),
        ("own_image", with("[[bodies]]\nradius = 5.5\ncenters = [[2.0, 2.0]]"), "its own periodic image", all),
        ("too_few_cells", with("[[bodies]]\nradius = 1.0\ncenters = [[2.0, 2.0]]").replace("= 4", "= 2"), "at least 3 are needed", all),
        (
            "too_many_modes",
            with("modes = 6\n[[bodies]]\nradius = 1.0\ncenters = [[2.0, 2.0]]"),
            "is too many for 4.00 cells per radius",
            all,
        ),
        ("too_full", with("[[bodies]]\nradius = 1.0\nfraction = 0.95"), "scene.toml:7: bodies[0].fraction = 0.95", all),
        ("no_body_fits", with("[[bodies]]\nradius = 1.0\nfraction = 0.001"), "less than half a body", all),
        ("too_coarse", "[domain]\nsize = [1.0, 1.0]\n[resolution]\nspacing = 0.5\n".into(), "at least 4 are needed", all),
        (
            "no_steady_state",
            with("[[bodies]]\nradius = 1.0\ncount = 2\n[flow]\ndrive = { body_force = [1.0, 0.0] }"),
            "no steady flow",
            all,
        ),
        (
            "scalar_without_walls",
            with("[[bodies]]\nradius = 1.0\ncount = 2\n[flow]\nmodel = \"scalar\""),
            "flow.model = \"scalar\": needs a wall",
            all,
        ),
        (
            "scalar_in_time",
            walled("[[bodies]]\nradius = 1.0\ncount = 2\n[flow]\nmodel = \"scalar\"\n[time]\nend = 1.0"),
            "inclusions of a scalar do not move",
            all,
        ),
        ("missing_centers", with("[[bodies]]\nradius = 1.0\nfile = \"absent.csv\""), "scene.toml:7: bodies[0].file = ", all),
        ("ranks", "[domain]\nsize = [1.0, 1.0]\n[resolution]\nspacing = 0.25\n".into(), "5 ranks do not fit", &[5]),
    ]
}

#[test]
fn bad_geometry_is_refused_on_any_number_of_ranks_and_nothing_is_written() {
    for (name, text, message, rank_counts) in bad_scenes() {
        let here = folder(&format!("bad-{name}"));
        let scene = write(&here, &text);
        for &ranks in rank_counts {
            let out = here.join("out");
            let output = turbid(ranks, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
            let said = said(&output);
            assert!(said.contains(message), "{name} on {ranks} ranks says: {said}");
            assert_eq!(said.matches(message).count(), 1, "{name} on {ranks} ranks says it once: {said}");
            assert_eq!(output.status.code(), Some(2), "{name} on {ranks} ranks: {said}");
            assert!(!out.exists(), "{name} on {ranks} ranks wrote something");
        }
    }
}

#[test]
fn an_output_folder_that_cannot_be_written_is_refused() {
    let here = folder("unwritable");
    let scene = write(&here, SMALL_SUSPENSION);
    fs::write(here.join("file"), b"").unwrap();
    let out = here.join("file/inside");
    let output = turbid(2, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("cannot be written to"));
}

#[test]
fn a_wrong_command_line_ends_with_code_2() {
    for arguments in [&["walk"][..], &["run"], &["run", "a.toml", "--colour"], &["conditioning", "--finest-2d", "many"]] {
        assert_eq!(turbid(1, arguments).status.code(), Some(2), "{arguments:?}");
    }
    assert_eq!(turbid(1, &["--help"]).status.code(), Some(0));
}

#[test]
fn an_installation_is_checked_on_any_number_of_ranks() {
    for ranks in [1, 2] {
        let output = turbid(ranks, &["doctor"]);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success() && text.contains(&format!("ranks       {ranks}")), "{text}");
        assert_eq!(text.matches("known answer right").count(), 3, "{text}");
    }
}

#[test]
fn options_after_two_dashes_reach_petsc() {
    let here = folder("petsc-options");
    let scene = write(&here, SMALL_SUSPENSION);
    let out = here.join("out");
    let base = ["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--"];
    let starved = turbid(1, &[&base[..], &["-coupled_ksp_max_it", "2"]].concat());
    assert_eq!(starved.status.code(), Some(1));
    let said = said(&starved);
    assert!(said.contains("stopped after 2 iterations") && said.contains("tolerance"), "{said}");
    assert!(!out.join("summary.json").exists());
    let watched = turbid(1, &[&base[..], &["-coupled_ksp_monitor"]].concat());
    assert!(String::from_utf8_lossy(&watched.stdout).contains("KSP Residual norm"));
}

#[test]
fn options_that_switch_convergence_off_make_no_result() {
    let here = folder("petsc-convergence");
    let scene = write(&here, &SMALL_SUSPENSION.replace("[method]\n", "[method]\ninverse = \"hypre\"\n"));
    let run = |name: &str, options: &[&str]| {
        let out = here.join(name);
        (turbid(1, &[&["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--"], options].concat()), out)
    };
    let cases: [(&[&str], i32, &str); 6] = [
        (&["-coupled_ksp_rtol", "10"], 2, "-coupled_ksp_rtol = 10 must be above 0 and at most 0.1"),
        (&["-coupled_ksp_atol", "1e3"], 1, "relative residual of 1.0e0"),
        (&["-coupled_ksp_convergence_test", "skip", "-coupled_ksp_max_it", "3"], 1, "relative residual of 9"),
        (&["-coupled_ksp_norm_type", "none", "-coupled_ksp_max_it", "3"], 1, "relative residual of 9"),
        (&["--set", "resolution.cells_per_radius=4"], 2, "--set after -- goes to PETSc"),
        (&["resolution.cells_per_radius=4"], 2, "is the value of no PETSc option"),
    ];
    for (options, code, complaint) in cases {
        let (output, out) = run("out", options);
        assert_eq!(output.status.code(), Some(code), "{options:?}: {}", said(&output));
        assert!(said(&output).contains(complaint), "{options:?}: {}", said(&output));
        assert!(!out.join("summary.json").exists(), "{options:?}");
    }
    let (misspelt, _) = run("misspelt", &["-coupled_kps_rtol", "1e-3", "-coupled_ksp_rtol", "1e-7"]);
    assert!(misspelt.status.success() && said(&misspelt).contains("had no use for -coupled_kps_rtol:"), "{}", said(&misspelt));
}

#[test]
fn options_of_petsc_hold_for_all_solves_of_a_run_in_time() {
    let here = folder("petsc-in-time");
    let scene = write(&here, &format!("{SMALL_SUSPENSION}\n[time]\nend = 0.02\nstep = 0.01\n"));
    let out = here.join("out");
    let arguments = ["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--set", "method.tolerance=\"auto\""];
    let output = turbid(1, &[&arguments[..], &["--", "-coupled_ksp_monitor", "-coupled_ksp_rtol", "1e-10"]].concat());
    assert!(output.status.success(), "{}", said(&output));
    let starts =
        String::from_utf8_lossy(&output.stdout).lines().filter(|line| line.trim_start().starts_with("0 KSP Residual norm")).count();
    let (rows, residual) = (Series::read(&out).rows.len(), number(&crate::common::summary(&out), "solver.residual"));
    assert!(starts >= rows && rows >= 2, "{starts} solves seen in {rows} rows");
    assert!(residual <= 1e-10, "{residual:.1e}");
}

#[test]
fn a_plan_names_what_is_built_and_what_is_not_and_writes_nothing() {
    let here = folder("plan");
    let scene = write(&here, SMALL_SUSPENSION);
    let output = turbid(2, &["plan", scene.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stdout);
    for part in ["built      stokes flow", "not built  contact", "not built  lubrication", "cells in [2, 1] blocks", "MB"] {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
    assert!(said.contains("built      rotation") && said.contains("time       about "), "{said}");
    assert_eq!(fs::read_dir(&here).unwrap().count(), 1);
    let output = turbid(2, &["plan", root().join("examples/scalar.toml").to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stdout);
    for part in [
        "built      scalar: one matrix",
        "built      source: 1 outside",
        "not built  mean gradient",
        "not built  motion in time",
        "4096 on the grid, 17 multipliers",
    ] {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
}

#[test]
fn a_run_leaves_a_scene_that_gives_the_same_run() {
    let here = folder("again");
    let scene = write(&here, SMALL_SUSPENSION);
    let first = run(1, &scene, &here.join("first"), &["resolution.cells_per_radius=4"]);
    let again = run(1, &here.join("first/scene.toml"), &here.join("again"), &[]);
    assert_eq!(first["bodies"], again["bodies"]);
    let from_file =
        run(1, &root().join("examples/random.toml"), &here.join("file"), &["resolution.cells_per_radius=4", "resolution.modes=3"]);
    let again = run(1, &here.join("file/scene.toml"), &here.join("file-again"), &[]);
    assert_eq!(from_file["bodies"], again["bodies"]);
    assert!(fs::read_to_string(here.join("first/picture.svg")).unwrap().trim_end().ends_with("</svg>"));
}

/// A disk held in a flow: its drag is 24.8317.
const TO_ACCURACY: &str = r#"
accuracy = 1e-2
[domain]
size = [1.0, 1.0]
[flow]
drive = { mean_velocity = [1.0, 0.0] }
[[bodies]]
radius = 0.17841241161527712
centers = [[0.513, 0.527]]
motion = "fixed"
"#;

#[test]
fn an_accuracy_is_calibrated_once_and_shown_in_the_plan() {
    let here = folder("accuracy");
    let (scene, out) = (write(&here, TO_ACCURACY), here.join("out"));
    let plan = || {
        let output = turbid(2, &["plan", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    assert!(plan().contains("0.01 asked for: turbid run calibrates the resolution"), "{}", plan());
    let first = run(2, &scene, &out, &[]);
    let relative = number(&first, "accuracy.estimated.drag");
    let bar = number(&first, "accuracy.drag.bar");
    let drag = number(&first, "bodies.0.force.0");
    assert!(relative <= 1e-2 && (bar / (relative * drag) - 1.0).abs() < 1e-3, "{bar} of {drag}");
    assert!((drag - 24.8316752488).abs() <= bar, "{drag} is off by more than {bar}");
    assert!(number(&first, "accuracy.calibration_seconds") > 0.0);
    let cells = number(&first, "accuracy.cells_per_radius");
    assert!(plan().contains(&format!("0.01 asked for: {cells} cells per radius")), "{}", plan());
    // the second run, and one on other ranks, take what the first one found
    for ranks in [1, 3] {
        let again = run_again(ranks, &scene, &out, &[]);
        assert!(again["accuracy"]["calibration_seconds"].is_null());
        assert_eq!(again["accuracy"]["estimated"], first["accuracy"]["estimated"]);
        assert!((number(&again, "bodies.0.force.0") / drag - 1.0).abs() < 1e-6);
    }
    let fresh = run(3, &scene, &here.join("fresh"), &[]);
    assert_eq!(number(&fresh, "accuracy.cells_per_radius"), cells);
    // a calibration of another scene, and half of one, are not believed
    let calibration = out.join("calibration.json");
    let whole = fs::read_to_string(&calibration).unwrap();
    for text in [whole.replace("radius = 0.178", "radius = 0.168"), whole[..whole.len() / 2].to_owned()] {
        assert_ne!(text, whole);
        fs::write(&calibration, text).unwrap();
        assert!(number(&run_again(1, &scene, &out, &[]), "accuracy.calibration_seconds") > 0.0);
    }
}

#[test]
fn a_calibration_that_does_not_converge_names_its_grid() {
    let here = folder("accuracy-starved");
    let (scene, out) = (write(&here, TO_ACCURACY), here.join("out"));
    let output = turbid(1, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--", "-coupled_ksp_max_it", "2"]);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("the calibration with 3 cells per radius did not converge"), "{said}");
    assert!(!out.join("calibration.json").exists() && !out.join("summary.json").exists());
}

#[test]
fn a_run_in_time_is_calibrated_at_its_start_and_resumed_at_the_same_resolution() {
    let here = folder("accuracy-in-time");
    let text = format!(
        "accuracy = 2e-2\n{}[time]\nend = 0.2\nstep = 0.05\n",
        SMALL_SUSPENSION.replace("[resolution]\ncells_per_radius = 5\n", "")
    );
    let text = text.replace("fraction = 0.3", "count = 3").replace("gap = 0.1", "gap = 0.5");
    let (scene, out) = (write(&here, &text), here.join("out"));
    let whole = run(2, &scene, &out, &["output.checkpoint=0"]);
    let interval = [0, 1].map(|end| number(&whole, &format!("viscosity.interval.{end}")));
    let viscosity = number(&whole, "viscosity.relative");
    assert!(interval[0] < viscosity && viscosity < interval[1] && interval[1] - interval[0] <= 4.1e-2 * viscosity, "{interval:?}");
    let cells = number(&whole, "accuracy.cells_per_radius");
    let longer = resume(1, &out, &["time.end=0.3"]);
    assert_eq!((number(&longer, "accuracy.cells_per_radius"), number(&longer, "time")), (cells, 0.3));
    assert!(longer["accuracy"]["calibration_seconds"].is_null());
}

#[test]
fn fields_that_are_off_are_no_datasets_and_change_nothing() {
    let here = folder("fields-off");
    let scene = write(&here, &format!("{SMALL_SUSPENSION}[time]\nend = 0.1\nstep = 0.05\n"));
    let runs = [true, false].map(|fields| {
        let out = here.join(fields.to_string());
        let summary = run(2, &scene, &out, &[&format!("output.fields={fields}"), &format!("output.picture={fields}")]);
        let file = hdf5::File::open(out.join("frames/000000.h5")).unwrap();
        assert_eq!(out.join("picture.svg").exists(), fields);
        (bodies(&summary), Series::read(&out), file.member_names().unwrap())
    });
    let [with, without] = runs;
    assert!(with.2.contains(&"fields".to_owned()) && !without.2.contains(&"fields".to_owned()), "{:?} and {:?}", with.2, without.2);
    assert!(difference(&with.0, &without.0) < 1e-12);
    assert!(with.1.difference(&without.1, &["seconds"]).0 < 1e-12);
    // no contact model, no columns of contacts
    assert!(!without.1.columns.iter().any(|column| column.contains("contact") || column.contains("gap")));
}

/// The rows of `profiles.csv` that belong to an axis, by the names of columns; empty cells are not numbers.
fn profile(out: &Path, axis: &str) -> Vec<BTreeMap<String, f64>> {
    let text = fs::read_to_string(out.join("profiles.csv")).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let heads = lines.next().unwrap();
    let row = |cells: Vec<&str>| {
        heads.iter().zip(cells).skip(1).map(|(head, cell)| ((*head).to_owned(), cell.parse().unwrap_or(f64::NAN))).collect()
    };
    lines.filter(|cells| cells[0] == axis).map(row).collect()
}

/// Profiles of a scene on one to three ranks, which are the same.
fn profiles(name: &str, text: &str, axes: &[&str]) -> (Value, Vec<Vec<BTreeMap<String, f64>>>) {
    let here = folder(&format!("profiles-{name}"));
    let scene = write(&here, &format!("{text}\n[output]\npicture = false\nprofiles = {axes:?}\n"));
    let out = |ranks: usize| here.join(ranks.to_string());
    let summaries: Vec<Value> = (1..=3).map(|ranks| run(ranks, &scene, &out(ranks), &[])).collect();
    for (axis, ranks) in axes.iter().flat_map(|axis| [2, 3].map(|ranks| (axis, ranks))) {
        for (one, other) in profile(&out(1), axis).iter().zip(&profile(&out(ranks), axis)) {
            for (column, value) in one {
                let difference = (value - other[column]).abs();
                assert!(
                    difference < 1e-5 || value.is_nan() && other[column].is_nan(),
                    "{name}, {column} on {ranks} ranks: {one:?} {other:?}"
                );
            }
        }
    }
    assert!(fs::read_to_string(out(1).join("profiles.svg")).unwrap().ends_with("</svg>\n"));
    (summaries[0].clone(), axes.iter().map(|axis| profile(&out(1), axis)).collect())
}

#[test]
fn profiles_have_the_shear_the_fraction_and_the_stress_of_the_box() {
    let (summary, found) = profiles("2d", SMALL_SUSPENSION, &["y", "x"]);
    let mean = |rows: &[BTreeMap<String, f64>], column: &str| rows.iter().map(|row| row[column]).sum::<f64>() / rows.len() as f64;
    for rows in &found {
        assert!((mean(rows, "fraction") - number(&summary, "fraction")).abs() < 1e-9);
        // what bodies add to a viscosity of 1 at a rate of 1
        let added = number(&summary, "viscosity.relative") - 1.0;
        assert!((mean(rows, "particle_stress_xy") / added - 1.0).abs() < 1e-6, "{added}");
    }
    let y = &found[0];
    let (bottom, top) = (y[0]["fluid_velocity_x"], y[y.len() - 1]["fluid_velocity_x"]);
    assert!(bottom < -3.0 && bottom > -4.0 && (top + bottom).abs() < 0.3, "{bottom} {top}");
    let (summary, found) = profiles("3d", SMALL_SUSPENSION_3D, &["y"]);
    assert!((mean(&found[0], "fraction") - number(&summary, "fraction")).abs() < 1e-9);
    for row in &found[0] {
        assert!((row["fluid_velocity_x"] - row["position"]).abs() < 0.6, "the background is y along x: {row:?}");
        assert!(row["particle_velocity_x"].is_nan() || (row["particle_velocity_x"] - row["position"]).abs() < 0.8, "{row:?}");
    }
}

#[test]
fn profiles_of_a_dry_pile_hold_up_its_weight() {
    let centers: Vec<[f64; 2]> = (0..12).map(|disk| [f64::from(1 + 2 * (disk / 3)), 0.6 + 1.1 * f64::from(disk % 3)]).collect();
    let pile = &format!(
        "gravity = [0.0, -1.0]\n[domain]\nsize = [8.0, 6.0]\ny = \"walls\"\n[flow]\nmodel = \"none\"\n[contact]\nmodel = \"inelastic\"\n\
         [[bodies]]\nradius = 0.5\ncenters = {centers:?}\n[time]\nend = 4.0\nstep = 0.02\n"
    );
    let (summary, found) = profiles("dry", pile, &["y"]);
    let rows = &found[0];
    assert!(!rows[0].keys().any(|name| name.starts_with("fluid")) && summary["flow"].is_null());
    let weight = 12.0 * std::f64::consts::PI * 0.25;
    let width = 8.0;
    let floor = rows[0]["particle_stress_yy"];
    assert!((floor + weight / width).abs() < 0.1 * weight / width, "the floor bears {weight} on {width}: {floor}");
    assert!(rows.last().unwrap()["fraction"] == 0.0 && rows[0]["fraction_half_width"] < 0.05);
}

#[test]
fn a_series_has_the_mean_motion_the_energy_and_the_stress() {
    let here = folder("series-means");
    let sheared = write(&here, &format!("{SMALL_SUSPENSION}[time]\nend = 0.02\nstep = 0.01\n"));
    let summary = run(2, &sheared, &here.join("sheared"), &[]);
    let series = Series::read(&here.join("sheared"));
    let last = series.rows.len() - 1;
    assert!((series.at(last, "stress_xy") / series.at(last, "viscosity") - 1.0).abs() < 1e-9);
    assert!((series.at(last, "stress_xx") - series.at(last, "stress_yy") - series.at(last, "first_normal_difference")).abs() < 1e-9);
    assert!((series.at(last, "mean_velocity_x") - number(&summary, "flow.mean_velocity.0")).abs() < 1e-12);
    assert!((series.at(last, "flow_rate_x") - 8.0 * series.at(last, "mean_velocity_x")).abs() < 1e-12);
    assert!(!series.columns.iter().any(|name| ["mean_velocity_y", "kinetic_energy"].contains(&name.as_str())), "{:?}", series.columns);
    let bodies = number(&summary, "bodies.*.velocity.0");
    assert!((series.at(last, "body_velocity_x") - bodies).abs() < 1e-12);
    let falling = write(
        &here,
        "gravity = [0.0, -2.0]\n[domain]\nsize = [8.0, 8.0]\n[flow]\nmodel = \"none\"\n[[bodies]]\nradius = 0.5\ndensity = 3.0\n\
         centers = [[1.0, 1.0], [5.0, 4.0], [6.0, 7.0]]\n[[bodies]]\nradius = 0.5\ncenters = [[3.0, 3.0]]\nmotion = \"fixed\"\n[time]\nend = 0.4\nstep = 0.1\n",
    );
    run(2, &falling, &here.join("falling"), &[]);
    let series = Series::read(&here.join("falling"));
    let last = series.rows.len() - 1;
    let (speed, mass) = (series.at(last, "body_velocity_y"), 3.0 * 3.0 * std::f64::consts::PI * 0.25);
    assert!((speed + 0.8).abs() < 0.11, "{speed}");
    assert!((series.at(last, "kinetic_energy") - 0.5 * mass * speed * speed).abs() < 1e-9, "{:?}", series.rows[last]);
}

#[test]
fn a_plan_for_other_ranks_tells_their_memory_and_seconds_without_them() {
    let here = folder("plan-ranks");
    let scene = write(&here, SMALL_SUSPENSION);
    let plan = |arguments: &[&str]| {
        let output = turbid(1, &[&["plan", scene.to_str().unwrap()], arguments].concat());
        assert!(output.status.success(), "{}", said(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let said = plan(&["--ranks", "4"]);
    for part in ["cells in [2, 2] blocks", "on the fullest of 4 ranks", " s on 4 ranks, if each has a core"] {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
    assert!(!plan(&[]).contains("fullest"));
}

#[test]
fn examples_are_listed_and_copied_and_a_new_scene_is_written_but_nothing_is_overwritten() {
    let here = folder("examples");
    let there = |arguments: &[&str]| crate::common::command(1, arguments).current_dir(&here).output().unwrap();
    let listed = String::from_utf8(there(&["examples"]).stdout).unwrap();
    assert!(listed.contains("shear3d      Shear of a suspension of free spheres"), "{listed}");
    let copied = there(&["examples", "random"]);
    assert!(copied.status.success(), "{}", said(&copied));
    assert_eq!(fs::read(here.join("random30.csv")).unwrap(), fs::read(root().join("examples/random30.csv")).unwrap());
    assert!(fs::read_to_string(here.join("random.toml")).unwrap().contains("turbid run random.toml"));
    fs::remove_file(here.join("random.toml")).unwrap();
    let again = there(&["examples", "random.toml"]);
    assert!(again.status.code() == Some(2) && said(&again).contains("random30.csv: is there already"), "{}", said(&again));
    assert!(!here.join("random.toml").exists(), "half of an example is copied");
    let wrong = there(&["examples", "rando"]);
    assert!(wrong.status.code() == Some(2) && said(&wrong).contains("must be one of array, avalanche"), "{}", said(&wrong));

    assert!(there(&["new"]).status.success() && there(&["new", "mine.toml"]).status.success());
    let again = there(&["new"]);
    assert!(again.status.code() == Some(2) && said(&again).contains("scene.toml: is there already"), "{}", said(&again));
    assert!(fs::read_to_string(here.join("mine.toml")).unwrap().contains("turbid run mine.toml"));
    let plan = there(&["plan", "mine.toml"]);
    assert!(plan.status.success() && String::from_utf8_lossy(&plan.stdout).contains("built      lubrication"), "{}", said(&plan));
}
