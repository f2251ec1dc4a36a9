//! The conditioning study: what theory predicts comes out, on any number of ranks, in whole files.

use std::{f64::consts::PI, fs, path::Path};

use crate::common::{folder, halves, number, said, turbid};
use serde_json::Value;

/// A study on small grids.
fn study(ranks: usize, out: &Path) -> Value {
    let output = turbid(ranks, &["conditioning", "--finest-2d", "64", "--finest-3d", "32", "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "on {ranks} ranks: {}", said(&output));
    let printed = String::from_utf8_lossy(&output.stdout);
    assert_eq!(printed.matches("Reading:").count(), 6, "a sentence for each table, told once: {printed}");
    serde_json::from_str(&fs::read_to_string(out.join("conditioning.json")).unwrap()).unwrap()
}

fn list<'a>(report: &'a Value, name: &str) -> &'a [Value] {
    report[name].as_array().unwrap()
}

fn is_amg(value: &Value) -> bool {
    value["method"].as_str().unwrap().ends_with("amg")
}

/// Extreme eigenvalues of minus the Laplacian with planes of unknowns on the walls across the first axis only.
fn exact_condition(dimension: f64, cells: f64) -> f64 {
    let sine = |k: f64| (k * PI / (2.0 * cells)).sin().powi(2);
    (sine(cells - 1.0) + (dimension - 1.0) * sine(cells)) / (dimension * sine(1.0))
}

#[test]
fn the_laplacian_behaves_as_theory_predicts_on_any_number_of_ranks() {
    let here = folder("conditioning");
    let reports: Vec<Value> = [1, 3].map(|ranks| study(ranks, &here.join(ranks.to_string()))).into();
    for report in &reports {
        let solves = list(report, "laplacian");
        assert_eq!(solves.len(), 5 * (3 + 3));
        for solve in solves {
            condition_is_exact(solve);
            bound_holds(solve);
        }
        list(report, "growth").iter().for_each(growth_is_as_predicted);
        multigrid_is_flat(solves);
    }
    same_numbers(&reports);
}

fn condition_is_exact(solve: &Value) {
    if solve["method"] == "none" {
        let exact = exact_condition(number(solve, "dimension"), number(solve, "cells"));
        assert!((number(solve, "condition") / exact - 1.0).abs() < 0.01, "{solve}");
        assert!((number(solve, "exact_condition") / exact - 1.0).abs() < 1e-12, "{solve}");
    }
}

fn bound_holds(solve: &Value) {
    let errors: Vec<f64> = list(solve, "errors").iter().map(|error| error.as_f64().unwrap()).collect();
    // the error starts with the whole solution, which only a true account of all steps gives back
    assert!((errors[0] - 1.0).abs() < 1e-9, "{solve}");
    assert!(errors.windows(2).all(|pair| pair[1] <= pair[0]), "conjugate gradients never lose in the energy norm");
    let root = number(solve, "condition").sqrt();
    for (iteration, error) in errors.iter().enumerate() {
        assert!(*error <= 2.0 * ((root - 1.0) / (root + 1.0)).powi(iteration as i32) * 1.0001, "{iteration}: {solve}");
    }
    assert!(number(solve, "bound_taken") <= 1.0);
    assert!(number(solve, "iterations") <= number(solve, "promised_iterations"));
    assert!(errors[number(solve, "iterations") as usize] <= 1e-8);
}

fn growth_is_as_predicted(growth: &Value) {
    if growth["method"] == "none" || growth["method"] == "jacobi" {
        assert!((number(growth, "condition.fitted") - 2.0).abs() < 0.1, "{growth}");
        assert!((number(growth, "iterations.fitted") - 1.0).abs() < 0.1, "{growth}");
    }
    if is_amg(growth) {
        assert!(number(growth, "condition.fitted").abs() < 0.1, "{growth}");
    }
}

fn multigrid_is_flat(solves: &[Value]) {
    for (dimension, method) in [(2.0, "default-amg"), (2.0, "tuned-amg"), (3.0, "default-amg"), (3.0, "tuned-amg")] {
        let own = solves.iter().filter(|solve| solve["method"] == method && number(solve, "dimension") == dimension);
        let iterations: Vec<f64> = own.map(|solve| number(solve, "iterations")).collect();
        assert!(iterations[iterations.len() - 1] <= 1.3 * iterations[0], "{method}, {dimension}D: {iterations:?}");
    }
}

/// Only factors within ranks and multigrid hierarchies depend on how unknowns are shared out.
fn same_numbers(reports: &[Value]) {
    for report in &reports[1..] {
        for (one, other) in list(&reports[0], "laplacian").iter().zip(list(report, "laplacian")) {
            if one["method"] == "none" || one["method"] == "jacobi" {
                assert!((number(one, "iterations") - number(other, "iterations")).abs() <= 1.0, "{one} and {other}");
                assert!((number(one, "condition") / number(other, "condition") - 1.0).abs() < 1e-3, "{one} and {other}");
            }
        }
        for (one, other) in list(&reports[0], "multipliers").iter().zip(list(report, "multipliers")) {
            for name in ["condition", "preconditioned"] {
                assert!((number(one, name) / number(other, name) - 1.0).abs() < 1e-6, "{one} and {other}");
            }
        }
    }
}

#[test]
fn multipliers_feel_their_modes_and_not_the_grid_and_files_are_whole() {
    let out = folder("conditioning-files");
    let report = study(1, &out);
    for growth in list(&report, "multiplier_growth") {
        assert!(number(growth, "grid.fitted").abs() < 0.05, "{growth}");
        assert!((number(growth, "modes.fitted") - 1.0).abs() < 0.1, "{growth}");
    }
    for row in list(&report, "multipliers") {
        assert!(number(row, "preconditioned") < 0.3 * number(row, "condition"), "{row}");
        if row["bodies"] == 1 {
            assert!((number(row, "condition") / (4.0 * (number(row, "modes") + 1.0)) - 1.0).abs() < 0.01, "{row}");
        }
    }
    let table = fs::read_to_string(out.join("conditioning.csv")).unwrap();
    let commas = |line: &str| line.matches(',').count();
    let heads = commas(table.lines().next().unwrap());
    assert!(table.ends_with('\n') && table.lines().all(|line| commas(line) == heads));
    for row in list(&report, "rigidity").iter().filter(|row| row["method"] == "penalty") {
        let product = number(row, "condition") * number(row, "epsilon");
        assert!((0.5..2.0).contains(&product) && number(row, "preconditioned") < 0.3 * number(row, "condition"), "{row}");
    }
    // a Laplacian's rows, the multipliers' by all methods, and two for each row of the fluid
    let rows = ["laplacian", "multipliers", "rigidity", "fluid", "fluid"].iter().map(|name| list(&report, name).len()).sum::<usize>();
    assert_eq!(table.lines().count(), 1 + rows);
    for name in ["conditioning.svg", "conditioning-3d.svg"] {
        let chart = fs::read_to_string(out.join(name)).unwrap();
        assert!(chart.starts_with("<svg") && chart.ends_with("</svg>\n") && chart.contains("predicted: 1/h"));
        assert!(!chart.contains("NaN"));
    }
    assert!(halves(&out).is_empty());
}

#[test]
fn what_cannot_be_studied_is_refused_before_any_work() {
    let here = folder("conditioning-refused");
    fs::write(here.join("file"), b"").unwrap();
    let inside = here.join("file/inside");
    let refused: [&[&str]; 6] = [
        &["--finest-2d", "many"],
        &["--finest-2d", "15"],
        &["--finest-2d", "100000"],
        &["--finest-3d", "7"],
        &["--finest-3d", "-8"],
        &["--out", inside.to_str().unwrap()],
    ];
    for options in refused {
        for ranks in [1, 2] {
            let output = turbid(ranks, &[&["conditioning"], options].concat());
            assert_eq!(output.status.code(), Some(2), "{options:?} on {ranks} ranks: {}", said(&output));
            assert!(output.stdout.is_empty(), "{options:?}");
        }
    }
}
