//! What a run tells people: the answer on the terminal, the log, the page, pictures, and the frame of an instant.

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use crate::common::{command, folder, number, root, run, said, scenes::SPHERE, summary, turbid, words, write};

const SHEARED: &str = r#"
title = "two disks < three"
domain.size = [6.0, 4.0]
flow.drive = { shear_rate = 1.0, periodic = "sheared" }
resolution.cells_per_radius = 4
[[bodies]]
radius = 0.5
centers = [[1.0, 1.7], [2.05, 1.9]]
[[bodies]]
radius = 0.3
centers = [[4.0, 3.0]]
[lubrication]
model = "pairwise"
[contact]
model = "inelastic"
[time]
end = 1.0
step = 0.125
[output]
every = 0.3
colour = "species"
"#;

const DRY: &str = r#"
domain = { size = [4.0, 3.0], y = "walls" }
gravity = [0.0, -1.0]
flow.model = "none"
[[bodies]]
radius = 0.5
density = 1.0
centers = [[1.0, 0.5], [2.5, 0.5], [1.75, 1.4]]
[contact]
model = "inelastic"
[time]
end = 0.5
"#;

/// What a run prints.
fn printed(ranks: usize, scene: &Path, out: &Path) -> String {
    let output = turbid(ranks, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// The rest of the line that begins so.
fn line<'a>(text: &'a str, beginning: &str) -> &'a str {
    text.lines().find_map(|line| line.strip_prefix(beginning)).unwrap_or_else(|| panic!("no {beginning} in {text}")).trim()
}

fn page(out: &Path) -> String {
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    for loaded in ["src=\"http", "src=\"/", "href=\"http", "url(http", "@import"] {
        assert!(!page.contains(loaded), "the page loads {loaded}");
    }
    page
}

/// The sum of the numbers with their signs in `a flow + b lubrication - c contacts`.
fn sum(parts: &str) -> f64 {
    let mut sign = 1.0;
    let mut sum = 0.0;
    for word in parts.replace('\u{2212}', "-").split_whitespace() {
        match (word, word.parse::<f64>()) {
            ("+", _) => sign = 1.0,
            ("-", _) => sign = -1.0,
            (_, Ok(value)) => sum += sign * value,
            _ => {}
        }
    }
    sum
}

#[test]
fn the_viscosity_of_a_run_is_told_with_parts_that_add_up_and_why_it_has_no_mean() {
    let here = folder("report-sheared");
    let (scene, out) = (write(&here, SHEARED), here.join("out"));
    let output = turbid(2, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    let (printed, noted) = (String::from_utf8(output.stdout.clone()).unwrap(), said(&output));
    assert!(output.status.success(), "{noted}");
    let total: f64 = line(&printed, "relative viscosity").split(' ').next().unwrap().parse().unwrap();
    let parts = line(&printed, "made up of");
    assert!(parts.contains("flow") && parts.contains("lubrication") && parts.contains("contacts"), "{parts}");
    assert!((sum(parts) - total).abs() < 1e-9, "{parts} is not {total}");
    assert!(line(&printed, "mean viscosity").starts_with("none yet: the run is too short"), "{printed}");
    let log = fs::read_to_string(out.join("run.log")).unwrap();
    let late = "output.every = 0.3: frames come with the first step at or after";
    assert_eq!((log.matches(late).count(), noted.matches(late).count()), (1, 0), "{log}{noted}");

    let page = page(&out);
    for content in [
        "two disks &lt; three",
        "none yet: the run is too short",
        "What the viscosity is made up of",
        "lubrication",
        "viscosity_contact",
        "Solves and iterations",
        "radius 0.3000",
        "cut at",
        "--out",
        "scene.toml",
        "fields.xdmf",
    ] {
        assert_eq!(page.contains(content), content != "cut at", "{content}");
    }
    assert!(!page.contains("has not ended"));

    let log = fs::read_to_string(out.join("run.log")).unwrap();
    assert!(log.contains("started by turbid") && log.contains("on 2 ranks") && log.contains("ended at time"), "{log}");
    crate::common::resume(2, &out, &["time.end=1.5"]);
    let longer = fs::read_to_string(out.join("run.log")).unwrap();
    assert!(longer.starts_with(&log) && longer.contains("goes on from time"), "{longer}");
}

#[test]
fn an_instantaneous_solve_tells_the_drag_and_leaves_a_frame() {
    let here = folder("report-sphere");
    let (scene, out) = (write(&here, SPHERE), here.join("out"));
    let text = printed(2, &scene, &out);
    let ratio: f64 = line(&text, "drag ratio").split(' ').next().unwrap().parse().unwrap();
    let drag = number(&summary(&out), "bodies.0.force.2") / (6.0 * std::f64::consts::PI * 0.25 * 2.0);
    assert!((ratio / drag - 1.0).abs() < 1e-4 && ratio > 1.5, "{ratio} {drag}");
    assert!(line(&text, "pressure gradient").starts_with('('));

    let frame = hdf5::File::open(out.join("frames/000000.h5")).unwrap();
    assert_eq!(frame.dataset("fields/velocity").unwrap().shape(), [16, 16, 16, 3]);
    assert_eq!(frame.dataset("bodies/center").unwrap().read_raw::<f64>().unwrap(), [0.5; 3]);
    let along: Vec<f64> = frame.dataset("fields/velocity").unwrap().read_raw::<f64>().unwrap().chunks(3).map(|v| v[2]).collect();
    assert!((along.iter().sum::<f64>() / along.len() as f64 - 2.0).abs() < 1e-2);
    for shown in ["fields.xdmf", "bodies.xdmf"] {
        assert!(fs::read_to_string(out.join(shown)).unwrap().contains("frames/000000.h5"), "{shown}");
    }
    let page = page(&out);
    assert!(page.contains("drag ratio") && page.contains("cut at y = 0.5") && page.contains("speed |u| / mean velocity"));
}

/// A disk that only turns in a fluid at rest: nothing flows past it.
#[test]
fn a_body_that_turns_tells_its_torque_and_no_drag() {
    let here = folder("report-turning");
    let disk = "domain.size = [1.0, 1.0]\nresolution.spacing = 0.03125\n[[bodies]]\nradius = 0.2\ncenters = [[0.51, 0.52]]\nmotion = { spin = 2.0 }\n";
    let (scene, out) = (write(&here, disk), here.join("out"));
    let text = printed(2, &scene, &out);
    let torque: f64 = line(&text, "torque on the body").split(' ').next().unwrap().replace('\u{2212}', "-").parse().unwrap();
    let exact = number(&summary(&out), "bodies.0.torque.0");
    assert!((torque / exact - 1.0).abs() < 1e-5 && torque < -1.0, "{torque} {exact}");
    assert!(text.contains("force on the body") && !text.contains("drag coefficient"), "{text}");
    let sphere = printed(1, &write(&here, SPHERE), &here.join("sphere"));
    assert!(sphere.contains("drag ratio") && !sphere.contains("torque on the body"), "{sphere}");
}

/// A disk that is thrown into a fluid at rest has a layer of half a cell after two steps; one that is held has no Reynolds number.
#[test]
fn a_layer_that_the_grid_does_not_resolve_is_told_at_the_end() {
    let here = folder("report-layer");
    let thrown = "domain.size = [4.0, 4.0]\nflow = { model = \"navier-stokes\", density = 1.0, viscosity = 0.1 }\nresolution.cells_per_radius = 4\n\
                  time = { end = 0.04, step = 0.02 }\noutput.picture = false\n[[bodies]]\nradius = 0.5\ncenters = [[2.0, 2.0]]\ndensity = 1.0\n";
    let text = printed(2, &write(&here, &format!("{thrown}velocity = [1.0, 0.0]\n")), &here.join("thrown"));
    assert!(line(&text, "warning").contains("cells thick, choose resolution.spacing = "), "{text}");
    assert!(line(&text, "time").ends_with("0.04 in 2 steps of 0.02"), "{text}");
    assert!(line(&text, "Reynolds number").ends_with("(fastest body)") && text.contains("\nStokes number"), "{text}");
    let held = printed(1, &write(&here, &format!("{thrown}motion = \"fixed\"\n")), &here.join("held"));
    assert!(!held.contains("Reynolds number") && !held.contains("Stokes number"), "{held}");
}

#[test]
fn a_box_without_bodies_has_a_fraction_without_a_sign() {
    let here = folder("report-empty");
    let scene = write(&here, "domain.size = [1.0, 1.0]\nflow.drive = { mean_velocity = [1.0, 0.0] }\nresolution.spacing = 0.125\n");
    let text = printed(1, &scene, &here.join("out"));
    assert!(text.starts_with("0 bodies, fraction 0.0000, on 1 rank"), "{text}");
    assert!(!fs::read_to_string(here.join("out/summary.json")).unwrap().contains("\"fraction\": -0.0"));
}

#[test]
fn dry_and_scalar_runs_have_pages_too() {
    let here = folder("report-dry");
    let (scene, out) = (write(&here, DRY), here.join("out"));
    let text = printed(2, &scene, &out);
    assert!(text.contains("mean body velocity") && text.contains("of 3 free bodies"), "{text}");
    let dry = page(&out);
    assert!(dry.contains("data:image/png;base64,") && dry.contains("contacts that bear a force") && dry.contains("contact_force"));

    let out = here.join("conduction");
    let text = printed(1, &root().join("examples/conduction.toml"), &out);
    assert!(text.contains("conductivity") && page(&out).contains("conductivity"));
    assert!(fs::read_to_string(out.join("run.log")).unwrap().contains("ended"));
    let off = here.join("off");
    run(1, &scene, &off, &["output.report=false"]);
    assert!(!off.join("report.html").exists());
}

#[test]
fn a_run_that_is_stopped_says_so_on_its_page_and_in_its_log() {
    let here = folder("report-stopped");
    let (scene, out) = (write(&here, SHEARED), here.join("out"));
    assert_eq!(words(1).len(), 1, "a signal reaches the run itself");
    let arguments = ["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--set", "time.end=500"];
    let mut running = command(1, &arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while !out.join("report.html").exists() {
        assert!(start.elapsed() < Duration::from_secs(60) && running.try_wait().unwrap().is_none(), "no page");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(page(&out).contains("has not ended"), "a run under way has a page");
    assert!(Command::new("kill").arg(running.id().to_string()).status().unwrap().success());
    assert_eq!(running.wait().unwrap().code(), Some(130));
    assert!(page(&out).contains("stopped by a signal"));
    assert!(fs::read_to_string(out.join("run.log")).unwrap().contains("broke off"));
}
