//! `turbid scaling` and `--profile` as a user meets them.

use std::{fs, path::Path};

use crate::common::{command, folder, number, root, run, said, turbid, write};
use serde_json::Value;

const SUSPENSION: &str = r#"
[domain]
size = [8.0, 6.0]
y = { lower = [-3.0, 0.0], upper = [3.0, 0.0] }
[resolution]
cells_per_radius = 4
[method]
inverse = "hypre"
[[bodies]]
radius = 1.0
count = 4
gap = 0.1
"#;

const CLOSED: &str = r#"
[domain]
size = [1.0, 1.0]
x = "walls"
y = "walls"
[resolution]
spacing = 0.125
"#;

const DRY: &str = r#"
gravity = [0.0, -1.0]
[domain]
size = [24.0, 12.0]
y = "walls"
[flow]
model = "none"
[[bodies]]
radius = 0.5
count = 120
gap = 0.05
[contact]
model = "inelastic"
[time]
end = 2.0
step = 0.1
"#;

/// The report of a study, and what it printed.
fn study(scene: &Path, out: &Path, arguments: &[&str]) -> (Value, String) {
    let base = ["scaling", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--repeat", "1"];
    let output = turbid(1, &[&base[..], arguments].concat());
    assert!(output.status.success(), "{}", said(&output));
    let report = serde_json::from_str(&fs::read_to_string(out.join("scaling.json")).unwrap()).unwrap();
    (report, String::from_utf8(output.stdout).unwrap())
}

/// A number of a measured row.
fn measured(report: &Value, kind: &str, row: usize, name: &str) -> f64 {
    number(report, &format!("{kind}.measured.{row}.numbers.{name}"))
}

#[test]
fn a_study_measures_strong_and_weak_scaling_and_models_more_ranks() {
    let here = folder("scaling");
    let (scene, out) = (write(&here, SUSPENSION), here.join("out"));
    let (report, said) = study(&scene, &out, &["--ranks", "2,1", "--set", "method.tolerance=1e-8", "--cores", "2"]);
    let alone = run(1, &scene, &here.join("alone"), &["method.tolerance=1e-8"]);
    let both = run(2, &scene, &here.join("both"), &["method.tolerance=1e-8"]);

    assert_eq!(measured(&report, "strong", 0, "efficiency"), 1.0);
    for (row, summary) in [&alone, &both].into_iter().enumerate() {
        assert_eq!(measured(&report, "strong", row, "iterations"), number(summary, "solver.iterations"));
    }
    for name in ["messages", "bytes", "collectives"] {
        assert_eq!(measured(&report, "strong", 0, name), 0.0, "{name} on one rank");
        assert_eq!(measured(&report, "strong", 1, name), number(&both, &format!("parallel.{name}.most")));
    }
    assert!(measured(&report, "strong", 1, "messages") > 0.0 && measured(&report, "strong", 1, "memory_bytes") > 1e6);
    assert_eq!(measured(&report, "strong", 1, "cells_imbalance"), 1.0);

    let model = report["strong"]["model"].as_array().unwrap();
    assert_eq!((model.len(), &model[10]["numbers"], model[9]["numbers"].is_null()), (11, &Value::Null, false));
    assert!(number(&report, "strong.model.9.numbers.seconds") > 0.0);
    // each of strong on one and two ranks and weak on two; on one rank both are the same run
    let checks = report["checks"].as_array().unwrap();
    let names: Vec<(&str, u64)> = checks.iter().map(|check| (check["kind"].as_str().unwrap(), check["ranks"].as_u64().unwrap())).collect();
    assert_eq!(names, [("strong", 1), ("strong", 2), ("weak", 2)]);
    for (check, row) in checks.iter().zip(["strong.measured.0", "strong.measured.1", "weak.measured.1"]) {
        assert!((number(check, "measured") / number(&report, &format!("{row}.numbers.seconds")) - 1.0).abs() < 1e-12);
        assert!(number(check, "predicted") > 0.0);
    }
    assert_eq!(measured(&report, "weak", 0, "iterations"), number(&alone, "solver.iterations"));
    for part in ["| model |", "1024 ranks do not fit", "2.00 microseconds", "hypre's are not counted"] {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
}

#[test]
fn a_dry_scene_is_studied_with_its_contacts_and_its_messages() {
    let here = folder("scaling-dry");
    let scene = write(&here, DRY);
    let (report, said) = study(&scene, &here.join("out"), &["--ranks", "1,2", "--cores", "2"]);
    let both = run(2, &scene, &here.join("both"), &[]);
    let steps = number(&both, "steps");
    for name in ["messages", "collectives"] {
        assert_eq!(measured(&report, "strong", 1, name), number(&both, &format!("parallel.{name}.most")) / steps, "{name}");
    }
    assert!(measured(&report, "strong", 1, "messages") > 0.0 && number(&report, "model.messages") > 0.0);
    assert!(number(&both, "motion.contacts") >= number(&both, "motion.island_contacts") && number(&both, "motion.island_contacts") > 0.0);
    assert_eq!((measured(&report, "strong", 1, "iterations"), number(&report, "model.cell")), (0.0, 0.0));
    for kind in ["strong", "weak"] {
        assert_eq!(report[kind]["model"].as_array().unwrap().len(), 13, "to 4096 ranks");
    }
    assert_eq!(report["checks"].as_array().unwrap().len(), 3);
    assert!(said.contains("Each measured row") && said.contains("| weak, 2 |"), "{said}");
}

#[test]
fn a_study_leaves_whole_files_and_nothing_else() {
    let here = folder("scaling-files");
    let (scene, out) = (write(&here, SUSPENSION), here.join("out"));
    let (_, said) = study(&scene, &out, &["--ranks", "1,2", "--cores", "1"]);
    let mut names: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["scaling.csv", "scaling.json", "scaling.svg"]);
    let table = fs::read_to_string(out.join("scaling.csv")).unwrap();
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(table.lines().skip(1).all(|line| line.split('"').next().unwrap().split(',').count() == columns), "{table}");
    assert!(fs::read_to_string(out.join("scaling.svg")).unwrap().ends_with("</svg>\n"));
    assert!(said.contains("| 2* |") && said.contains("* More ranks than the 1 cores"), "{said}");
}

#[test]
fn ranks_that_do_not_fit_are_marked_and_closed_boxes_do_not_grow() {
    let here = folder("scaling-misfit");
    let (report, said) = study(&write(&here, CLOSED), &here.join("out"), &["--ranks", "1,65"]);
    assert!(said.contains("measured: 65 ranks do not fit a grid of [8, 8] cells |"), "{said}");
    assert!(said.contains("Weak scaling: none: no axis of the box is periodic") && said.contains("No model: "), "{said}");
    assert_eq!((&report["model"], &report["strong"]["measured"][1]["numbers"]), (&Value::Null, &Value::Null));
    assert!(report["weak_refusal"].as_str().unwrap().contains("no axis"));
}

#[test]
fn a_scene_in_time_is_timed_by_the_step() {
    let here = folder("scaling-time");
    let scene = write(&here, &format!("{SUSPENSION}[time]\nend = 0.02\nstep = 0.01\n"));
    let (report, said) = study(&scene, &here.join("out"), &["--ranks", "1"]);
    let summary = run(1, &scene, &here.join("alone"), &[]);
    assert_eq!(measured(&report, "strong", 0, "iterations"), number(&summary, "motion.iterations") / 2.0);
    assert!(said.contains("Seconds of a step"), "{said}");
}

#[test]
fn a_study_that_cannot_be_made_is_refused() {
    let here = folder("scaling-refused");
    let scene = write(&here, SUSPENSION);
    let (path, out) = (scene.to_str().unwrap(), here.join("out"));
    let scalar = root().join("examples/scalar.toml");
    let cases: [(usize, &[&str], &str, i32); 8] = [
        (1, &[path, "--ranks", "0"], "--ranks: must be numbers from 1 up", 2),
        (1, &[path, "--ranks", "two"], "invalid value 'two'", 2),
        (1, &[path, "--launcher", "mpirun -n 2"], "where the number of ranks goes", 2),
        (1, &[path, "--launcher", "no-such-starter {ranks}"], "no-such-starter cannot be started", 2),
        (1, &[path, "--latency", "-1"], "", 2),
        (1, &[scalar.to_str().unwrap()], "flow.model = \"scalar\"", 2),
        (2, &[path], "this study starts its own ranks", 2),
        (1, &[path, "--ranks", "1", "--", "-coupled_ksp_max_it", "2"], "stopped after 2 iterations", 1),
    ];
    for (ranks, arguments, message, code) in cases {
        let output = command(ranks, &[&["scaling", "--out", out.to_str().unwrap()], arguments].concat()).output().unwrap();
        assert!(said(&output).contains(message), "{arguments:?} says: {}", said(&output));
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(!out.join("scaling.json").exists());
    }
}

#[test]
fn the_script_for_a_cluster_is_sound() {
    let script = root().join("examples/cluster/scaling.sh");
    assert!(std::process::Command::new("bash").arg("-n").arg(&script).status().unwrap().success());
    let mut dry = std::process::Command::new("bash");
    let output = dry.arg(&script).envs([("TURBID", "echo"), ("SLURM_NTASKS", "8")]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("scaling examples/dense.toml --ranks 1,2,4") && said.contains("--ntasks={ranks} --cores 8"), "{said}");
}

/// Stage names and mean seconds of a printed profile.
fn profile(text: &str) -> Vec<(String, f64)> {
    let table = text.lines().skip_while(|line| !line.starts_with("| stage |")).skip(2).take_while(|line| line.starts_with('|'));
    table
        .map(|line| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            (cells[1].to_owned(), cells[3].parse().unwrap())
        })
        .collect()
}

#[test]
fn a_profile_has_stages_that_make_up_the_run() {
    let here = folder("profile");
    let scene = write(&here, SUSPENSION);
    for ranks in [1, 2] {
        let out = here.join(ranks.to_string());
        let output = turbid(ranks, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--profile"]);
        let stages = profile(&String::from_utf8_lossy(&output.stdout));
        let (whole, parts) = stages.split_last().unwrap();
        let sum = |start: &str| parts.iter().filter(|(name, _)| name.starts_with(start)).map(|(_, seconds)| seconds).sum::<f64>();
        assert_eq!(whole.0, "all");
        assert!((sum("") - whole.1).abs() < 1e-3 * stages.len() as f64, "{stages:?}");
        let solve = number(&crate::common::summary(&out), "solver.solve_seconds");
        assert!((sum("solve") - solve).abs() < 0.2 * solve + 0.05, "{stages:?} but {solve}");
        assert_eq!(parts.iter().filter(|(name, _)| name.starts_with("solve")).count(), 4);
    }
    let quiet = turbid(1, &["run", scene.to_str().unwrap(), "--out", here.join("quiet").to_str().unwrap()]);
    assert!(profile(&String::from_utf8_lossy(&quiet.stdout)).is_empty());
}

#[test]
fn a_run_in_time_and_a_resumed_one_have_profiles_too() {
    let here = folder("profile-time");
    let scene = write(&here, &format!("{SUSPENSION}[contact]\nmodel = \"inelastic\"\n[time]\nend = 0.02\nstep = 0.01\n"));
    let out = here.join("out");
    for arguments in [
        &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--profile"][..],
        &["resume", out.to_str().unwrap(), "--set", "time.end=0.04", "--profile"],
    ] {
        let output = turbid(2, arguments);
        assert!(output.status.success(), "{}", said(&output));
        let names: Vec<String> = profile(&String::from_utf8_lossy(&output.stdout)).into_iter().map(|(name, _)| name).collect();
        for stage in ["set-up", "assembly", "contacts", "output", "all"] {
            assert!(names.iter().any(|name| name == stage), "no {stage} in {names:?}");
        }
    }
}
