//! `turbid cost` as a user meets it.

use std::{
    fs,
    path::Path,
    process::Stdio,
    time::{Duration, Instant},
};

use crate::common::{command, folder, halves, number, root, run, said, turbid, write};
use serde_json::Value;

/// One fixed disk in a periodic box, three cells per radius as it is written.
const DISK: &str = r#"
title = "a disk < a box"
[domain]
size = [4.0, 4.0]
[flow]
drive = { mean_velocity = [1.0, 0.0] } # to the right
[resolution]
cells_per_radius = 3
[[bodies]]
radius = 1.0
centers = [[2.1, 1.9]]
motion = "fixed"
"#;

const GRIDS: [&str; 2] = ["--resolutions", "3,4,6"];

fn words<'a>(scene: &'a Path, out: &'a Path, arguments: &[&'a str]) -> Vec<&'a str> {
    let base = ["cost", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--repeat", "1", "--methods", "sharp"];
    [&base[..], arguments].concat()
}

/// What a study wrote, and what it printed.
fn study(scene: &Path, out: &Path, arguments: &[&str]) -> (Value, String) {
    let output = turbid(1, &words(scene, out, arguments));
    assert!(output.status.success(), "{}", said(&output));
    (results(out), String::from_utf8(output.stdout).unwrap())
}

fn results(out: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(out.join("cost.json")).unwrap()).unwrap()
}

fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value[name].as_array().unwrap()
}

#[test]
fn a_study_refers_judges_and_applies() {
    let here = folder("cost");
    let (scene, out, applied) = (write(&here, DISK), here.join("out"), here.join("applied.toml"));
    let (study, said) = study(&scene, &out, &[&GRIDS[..], &["--error", "0.05", "--apply", applied.to_str().unwrap()]].concat());
    let findings = &study["findings"];
    let points = list(findings, "points");
    let errors: Vec<f64> = points.iter().map(|point| number(point, "error").abs()).collect();
    assert_eq!(errors.len(), 3, "the scene as written is one of them: {said}");
    let (reference, uncertainty) = (number(findings, "reference.values.0"), number(findings, "reference.uncertainty"));
    assert!(errors.windows(2).all(|pair| pair[1] < pair[0]) && uncertainty > 0.0 && uncertainty < 0.02, "{errors:?} {uncertainty}");
    for (point, error) in points.iter().zip(&errors) {
        assert!(((number(point, "value") / reference - 1.0).abs() - error).abs() < 1e-12);
        assert_eq!(point["within_uncertainty"].as_bool().unwrap(), *error <= uncertainty);
        assert!(number(point, "measured.unknowns") > 100.0 && number(point, "measured.memory_bytes") > 1e6);
    }

    let cheapest = &findings["methods"][0]["cheapest"];
    assert!(cheapest["measured"].as_bool().unwrap() && number(cheapest, "error") + uncertainty <= 0.05, "{cheapest}");
    let chosen = points.iter().find(|point| point["setting"] == cheapest["setting"]).unwrap();
    assert!(fs::read_to_string(&applied).unwrap().contains("# to the right"), "comments stay");
    let summary = run(1, &applied, &here.join("applied"), &[]);
    assert!((number(&summary, "bodies.0.force.0").hypot(number(&summary, "bodies.0.force.1")) - number(chosen, "value")).abs() < 1e-9);

    let parameters: Vec<&str> =
        findings["turned"][0]["knobs"].as_array().unwrap().iter().map(|parameter| parameter["name"].as_str().unwrap()).collect();
    assert_eq!(parameters, ["grid", "modes", "tolerance"]);
    for part in ["Cheapest for 5.0 %: sharp", "seconds grow as h^", "As written (sharp, 3 cells per radius", "dominates the error"] {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
}

#[test]
fn a_study_leaves_whole_files_and_nothing_else() {
    let here = folder("cost-files");
    let out = here.join("out");
    let (study, _) = study(&write(&here, DISK), &out, &["--resolutions", "3,4", "--exact", "13.0", "--tolerances", "1e-4,1e-6"]);
    let mut names: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["cost.csv", "cost.html", "cost.json", "cost.svg"]);
    assert!(halves(&out).is_empty());
    assert_eq!(number(&study, "findings.reference.uncertainty"), 0.0);
    let table = fs::read_to_string(out.join("cost.csv")).unwrap();
    let columns = table.lines().next().unwrap().split(',').count();
    assert_eq!(table.lines().count(), 6, "two grids with two tolerances, and the scene as written: {table}");
    assert!(table.lines().all(|line| line.split('"').next().unwrap().split(',').count() == columns), "{table}");
    let page = fs::read_to_string(out.join("cost.html")).unwrap();
    let chart = fs::read_to_string(out.join("cost.svg")).unwrap();
    assert!(page.ends_with("</html>\n") && page.contains(&chart) && page.contains("a disk &lt; a box") && !page.contains("<script"));
    assert!(chart.ends_with("</svg>\n") && !chart.contains("NaN") && chart.matches("<circle").count() >= 5);
}

#[test]
fn a_study_that_is_killed_keeps_what_it_has_and_goes_on() {
    let here = folder("cost-killed");
    let (scene, out) = (write(&here, DISK), here.join("out"));
    let arguments = words(&scene, &out, &GRIDS);
    let mut started = command(1, &arguments).stdout(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while !out.join("cost.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(300), "no run came to its end");
        std::thread::sleep(Duration::from_millis(20));
    }
    started.kill().unwrap();
    started.wait().unwrap();
    let before = results(&out);
    assert!(before["findings"].is_null() && !list(&before, "records").is_empty());

    let (after, said) = study(&scene, &out, &GRIDS);
    let kept = list(&before, "records").len();
    assert_eq!(list(&after, "records")[..kept], *list(&before, "records"), "they are not measured again");
    assert!(list(&after, "records").len() > kept && !after["findings"].is_null());
    assert!(fs::read_dir(&out).unwrap().all(|entry| entry.unwrap().path().is_file()), "no run is left behind");

    let (again, said_again) = study(&scene, &out, &GRIDS);
    assert_eq!(again["records"], after["records"]);
    assert!(said_again.len() < said.len(), "nothing is run, so nothing is told of runs");
    let other = turbid(1, &words(&scene, &out, &["--set", "flow.viscosity=2"]));
    assert_eq!(other.status.code(), Some(2));
    assert!(
        crate::common::said(&other).contains("holds a study that differs in the scene; choose another folder, or start anew with --fresh")
    );
}

#[test]
fn a_scene_in_time_is_measured_by_where_its_bodies_go() {
    let here = folder("cost-time");
    let text = r#"
[domain]
size = [4.0, 4.0]
y = { lower = [-2.0, 0.0], upper = [2.0, 0.0] }
[resolution]
cells_per_radius = 3
[[bodies]]
radius = 1.0
centers = [[3.9, 2.5]]
[time]
step = 0.1
end = 0.8
"#;
    let (study, said) = study(&write(&here, text), &here.join("out"), &["--resolutions", "3,4", "--until", "0.4", "--error", "0.1"]);
    let findings = &study["findings"];
    let points = list(findings, "points");
    assert_eq!(points.len(), 6, "two grids with three steps: {said}");
    for point in points {
        let step = number(point, "setting.step.step");
        assert_eq!(number(point, "measured.steps"), (0.4 / step).round());
        assert!(number(point, "error") < 0.1, "the disk crosses a side of the box, which makes no difference: {point}");
    }
    let parameters = list(&findings["turned"][0], "knobs");
    assert_eq!(parameters.last().unwrap()["name"], "step");
    let cheapest = &findings["methods"][0]["cheapest"];
    let chosen = points.iter().find(|point| point["setting"] == cheapest["setting"]).unwrap();
    let whole = number(chosen, "measured.setup_seconds") + 2.0 * number(chosen, "measured.solve_seconds");
    assert!((number(cheapest, "seconds") - whole).abs() < 1e-12, "the scene is twice as long as the runs");
}

#[test]
fn fields_of_a_scalar_are_compared_on_a_lattice() {
    let here = folder("cost-field");
    let text = "domain = { size = [1.0, 1.0], x = \"walls\", y = \"walls\" }\nflow.model = \"scalar\"\nresolution.cells_per_radius = 4\n\
                [[bodies]]\nradius = 0.2\ncenters = [[0.4, 0.55]]\n";
    let scene = write(&here, text);
    for quantity in ["field", "gradient"] {
        let arguments = ["--resolutions", "3,6,12", "--quantity", quantity, "--probe", "12"];
        let (study, said) = study(&scene, &here.join(quantity), &arguments);
        let points = list(&study["findings"], "points");
        let errors: Vec<f64> = points.iter().map(|point| number(point, "error")).collect();
        assert!(errors[0] > 4.0 * errors[points.len() - 1] && errors[0] < 0.2, "{errors:?} {said}");
        let count = if quantity == "field" { 144 } else { 2 * 12 * 11 };
        assert_eq!(study["records"][0]["outcome"]["measured"]["values"].as_array().unwrap().len(), count);
    }
}

#[test]
fn a_probe_is_the_same_on_any_number_of_ranks() {
    let here = folder("cost-probe");
    let scene = write(&here, DISK);
    let probe = |ranks: usize| {
        let out = here.join(ranks.to_string());
        run(ranks, &scene, &out, &["output.probe=10", "method.tolerance=1e-11"]);
        let text = fs::read_to_string(out.join("probe.csv")).unwrap();
        assert_eq!(text.lines().next(), Some("x,y,u,v"));
        text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect::<Vec<Vec<f64>>>()
    };
    let one = probe(1);
    assert_eq!((one.len(), one[0][..2].to_vec(), one[1][..2].to_vec()), (100, vec![0.2, 0.2], vec![0.6, 0.2]));
    let inside = one.iter().find(|row| (row[0] - 2.2).abs() < 1e-9 && (row[1] - 1.8).abs() < 1e-9).unwrap();
    assert!(inside[2].hypot(inside[3]) < 0.02, "the disk stands still: {inside:?}");
    let mean = one.iter().map(|row| row[2]).sum::<f64>() / 100.0;
    assert!((mean - 1.0).abs() < 0.05, "{mean}");
    for ranks in [2, 3] {
        let difference =
            one.iter().flatten().zip(probe(ranks).iter().flatten()).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
        assert!(difference < 1e-9, "{difference} on {ranks} ranks");
    }
}

#[test]
fn a_study_that_cannot_be_made_is_refused() {
    let here = folder("cost-refused");
    let (scene, out) = (write(&here, DISK), here.join("out"));
    let dry = root().join("examples/avalanche.toml");
    let nowhere = here.join("none/applied.toml");
    let cases: [(usize, &[&str], &str, i32); 12] = [
        (1, &["--resolutions", "4,0"], "--resolutions 0: must be positive", 2),
        (1, &["--resolutions", "4", "--spacings", "0.1"], "cannot be used with", 2),
        (1, &["--quantity", "weight"], "--quantity weight: must be one of drag, viscosity", 2),
        (1, &["--quantity", "position"], "nothing moves at an instant", 2),
        (1, &["--body", "1"], "--body 1: must be below the number of bodies, 1", 2),
        (1, &["--exact", "1,2"], "--exact: has 2 numbers, but the drag has 1", 2),
        (1, &["--reference", "penalty"], "--reference penalty: must be one of the methods that are swept, sharp", 2),
        (1, &["--until", "1"], "--until 1: the scene is one instant", 2),
        (1, &["--apply", nowhere.to_str().unwrap()], "there is no folder", 2),
        (1, &["--launcher", "no-such-starter {ranks}"], "no-such-starter cannot be started", 2),
        (2, &[], "this study starts its own ranks", 2),
        (1, &["--resolutions", "3", "--", "-coupled_ksp_max_it", "2"], "no setting could be measured", 2),
    ];
    for (ranks, arguments, message, code) in cases {
        let output = command(ranks, &words(&scene, &out, arguments)).output().unwrap();
        assert!(said(&output).contains(message), "{arguments:?} says: {}", said(&output));
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
    }
    let output = turbid(1, &words(&dry, &out, &[]));
    assert!(said(&output).contains("flow.model = \"none\"") && output.status.code() == Some(2), "{}", said(&output));
    let applied = here.join("applied.toml");
    let output =
        turbid(1, &words(&scene, &out, &["--resolutions", "3,4", "--error", "1e-9", "--fresh", "--apply", applied.to_str().unwrap()]));
    assert!(said(&output).contains("nothing is written") && !applied.exists(), "{}", said(&output));
    assert_eq!(output.status.code(), Some(1));
}
