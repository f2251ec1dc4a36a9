//! What comes in at the door and what must not come out, as a user meets it: refusals are soon told and cost little, whatever is asked for;
//! output that nobody takes is no accident; no result holds a number that is none.

use std::{
    fmt::Write,
    fs,
    path::Path,
    process::{Command, Output, Stdio},
    time::{Duration, Instant},
};

use crate::common::{PROGRAM, folder, said, settle, turbid, write};
use turbid::petsc::INDEX_BITS;

/// Address space of a refusal in kilobytes: what MPI and PETSc take when they start, and 200 MB.
const KILOBYTES: usize = 900_000;

/// Seconds of a refusal, those of a start on a busy machine included.
const SECONDS: Duration = Duration::from_secs(6);

const EMPTY: &str = "[domain]\nsize = [8.0, 8.0]\n[resolution]\ncells_per_radius = 6\n";

/// A dry scene, whose bodies fall.
const DRY: &str = "gravity = [0.0, -1.0]\n[domain]\nsize = [8.0, 8.0]\ny = \"walls\"\n[flow]\nmodel = \"none\"\n[contact]\nmodel = \"inelastic\"\n\
    [time]\nend = 1.0\n";

/// The program within a limit of its address space.
fn limited(arguments: &[&str]) -> Output {
    let mut command = Command::new("bash");
    command.args(["-c", &format!("ulimit -v {KILOBYTES}; exec \"$0\" \"$@\""), PROGRAM]).args(arguments);
    settle(&mut command);
    command.output().unwrap()
}

fn bodies(placed: &str) -> String {
    format!("[[bodies]]\nradius = 1.0\n{placed}\n")
}

/// Two chains, cells or rods of so many beads, whose radius is such.
fn chain(section: &str, beads: usize, radius: f64) -> String {
    let rods = section == "clusters";
    let (time, ties) =
        if rods { ("", "shape = \"rod\"\ndensity = 1.0") } else { ("[time]\nend = 1.0\n", "stretch = \"rigid\"\nbend = 1.0") };
    format!("{time}[[{section}]]\nradius = {radius:?}\nbeads = {beads}\ncount = 2\n{ties}\n")
}

/// Names, scenes and what their refusals say.
fn refused() -> Vec<(&'static str, String, &'static str)> {
    let repeated = |line: &str, count: usize| line.repeat(count);
    vec![
        ("wide", EMPTY.to_owned() + &bodies("centers = [[4.0, 4.0]]").replace("1.0\n", "100.0\n"), "overlaps its own periodic image"),
        ("same", EMPTY.to_owned() + &bodies(&format!("centers = [{}]", repeated("[4.0, 4.0],", 30_000))), "overlaps body 0"),
        ("crowd", EMPTY.to_owned() + &bodies("count = 30000"), "bodies[0].count = 30000: "),
        ("crowd-dry", DRY.to_owned() + &bodies("count = 30000"), "bodies[0].count = 30000: "),
        ("many", EMPTY.to_owned() + &bodies("count = 1000000000000"), "bodies[0].count = 1000000000000: "),
        ("most", EMPTY.to_owned() + &bodies("count = 9223372036854775807"), "bodies[0].count = 9223372036854775807: "),
        ("dust", EMPTY.to_owned() + &bodies("fraction = 0.3").replace("1.0\n", "1e-6\n"), "bodies[0].fraction = 0.3: "),
        ("dry-dust", DRY.to_owned() + &bodies("fraction = 0.3").replace("1.0\n", "1e-6\n"), "bodies[0].fraction = 0.3: "),
        ("fine", EMPTY.replace("= 6", "= 1e3") + &bodies("count = 2"), "resolution.cells_per_radius = 1000: takes "),
        (
            "finer",
            EMPTY.replace("= 6", "= 1e30") + &bodies("count = 2"),
            "scene.toml:4: resolution.cells_per_radius = 1000000000000000000000000000000: asks for",
        ),
        (
            "beyond-indices",
            EMPTY.replace("= 6", "= 4000") + &bodies("count = 2"),
            if INDEX_BITS == 32 {
                "resolution.cells_per_radius = 4000: asks for 1.024e9 cells, more than 32-bit indices number; coarsen it, raise the radii, \
                 shrink domain.size, or build with 64-bit indices (package libpetsc64-real-dev, TURBID_INDEX_BITS=64)"
            } else {
                "use 3 ranks or more"
            },
        ),
        (
            "beyond-a-rank",
            EMPTY.replace("8.0, 8.0", "8.0, 8.0, 8.0").replace("= 6", "= 82.5") + &bodies("count = 2"),
            "use 2 ranks or more",
        ),
        ("coarse", EMPTY.replace("cells_per_radius = 6", "spacing = 3.0"), "scene.toml:4: resolution.spacing = 3: leaves 3 cells along x"),
        ("thick", EMPTY.replace("6", "6\n[flow]\nviscosity = 1e307"), "scene.toml:6: flow.viscosity = 1e307: must be 0 or from 1e-60"),
        ("heavy", DRY.to_owned() + &bodies("count = 2\ndensity = 1e308"), "bodies[0].density = 1e308: must be 0 or from 1e-60"),
        ("pulled", DRY.replace("-1.0", "-1e308") + &bodies("count = 2"), "scene.toml:1: gravity[1] = -1e308: must be 0 or from 1e-60"),
        ("vast", EMPTY.replace("8.0, 8.0", "1e200, 1e200") + &bodies("count = 2"), "scene.toml:2: domain.size[0] = 1e200: "),
        (
            "exact",
            EMPTY.to_owned() + "[method]\ntolerance = 1e-30\n" + &bodies("count = 2"),
            "method.tolerance = 1e-30: must be \"auto\", or at least",
        ),
        (
            "pushed",
            EMPTY.replace("6", "6\n[flow]\ndrive = { body_force = [1.0, 0.0] }") + &bodies("count = 2"),
            "scene.toml:6: flow.drive: under a uniform force",
        ),
        (
            "links",
            EMPTY.to_owned() + &chain("chains", 1_000_000_000, 0.1),
            "chains[0].beads = 1000000000: beads would fill 4.909e5 of the box",
        ),
        ("long-links", EMPTY.to_owned() + &chain("chains", 1_000_000, 1e-4), "chains[0].radius = 0.0001: is of chains 209.99"),
        ("ring", EMPTY.to_owned() + &chain("chains", 1_000_000, 1e-4).replace("count", "shape = \"ring\"\ncount"), "is of chains 66.8"),
        ("outline", EMPTY.to_owned() + &chain("cells", 1_000_000, 1e-4), "cells[0].beads = 1000000: must be at most 10000"),
        (
            "rod",
            DRY.to_owned() + &chain("clusters", 1_000_000_000, 0.1),
            "clusters[0].beads = 1000000000: beads would fill 4.909e5 of the box",
        ),
        (
            "rods",
            DRY.to_owned() + &chain("clusters", 5, 0.1).replace("= 2", "= 1000000000"),
            "clusters[0].count = 1000000000: clusters would fill",
        ),
        (
            "at-the-inflow",
            EMPTY.replace("size", "x = { inflow = 1.0 }\ny = \"walls\"\nsize") + &bodies("centers = [[1.5, 4.0]]"),
            "bodies[0].centers = [1.5, 4.0]: comes to 0.5000 from where fluid flows in or out along x, and must keep 5 cells, 0.8333",
        ),
        (
            "no-room-at-the-inflow",
            EMPTY.replace("size = [8.0", "x = { inflow = 1.0 }\ny = \"walls\"\nsize = [5.0") + &bodies("count = 1"),
            "domain.size = [5.0, 8.0]: leaves bodies no place between inflow and outflow",
        ),
        (
            "span",
            EMPTY.replace("8.0, 8.0]", "8.0, 2.0]\ny = { lower = [-1.0, 0.0], upper = [1.0, 0.0] }") + &bodies("centers = [[4.0, 1.0]]"),
            "scene.toml:7: bodies[0].radius = 1: touches both walls along y",
        ),
        (
            "short",
            EMPTY.replace("6", "6\n[flow]\ndrive = { shear_rate = 1.0, periodic = \"sheared\" }")
                + &bodies("count = 2")
                + "[time]\nend = 1e-3\n[method]\nconstraint = \"penalty\"\n",
            "scene.toml:11: time.end = 0.001: the images of the sheared box slide by whole cells",
        ),
    ]
}

#[test]
fn what_cannot_be_is_refused_soon_and_in_little_memory() {
    let mut failures = String::new();
    for (name, text, message) in refused() {
        let here = folder(&format!("door-{name}"));
        let scene = write(&here, &text);
        let out = here.join("out");
        let start = Instant::now();
        let output = limited(&["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        let (code, said, taken) = (output.status.code(), said(&output), start.elapsed());
        if code != Some(2) || !said.contains(message) || taken > SECONDS || out.join("summary.json").exists() {
            writeln!(failures, "{name}: {code:?} after {taken:?}: {}", said.chars().take(400).collect::<String>()).unwrap();
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

#[test]
fn commands_with_numbers_beyond_reason_are_refused_soon() {
    let scene = write(&folder("door-commands"), &(EMPTY.to_owned() + &bodies("count = 2")));
    let path = scene.to_str().unwrap();
    let long = write(&folder("door-cells"), &EMPTY.replace("cells_per_radius = 6", "spacing = 0.0008"));
    let cases: [(&[&str], &str); 6] = [
        (&["scaling", path, "--ranks", "1000000000"], "--ranks 1000000000: must be at most"),
        (&["scaling", path, "--set", "bodies.0.count=9223372036854775807"], "bodies[0].count = 9223372036854775807: "),
        (&["validation", "--bars", "0"], "--bars 0: "),
        (&["run", long.to_str().unwrap()], "--force"),
        (&["rum", path], "turbid: rum: no such command; did you mean run? commands: run, resume, "),
        (&["help", "rum"], "rum"),
    ];
    for (arguments, message) in cases {
        let start = Instant::now();
        let output = limited(arguments);
        assert!(said(&output).contains(message), "{arguments:?} says: {}", said(&output));
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(start.elapsed() < SECONDS, "{arguments:?} takes {:?}", start.elapsed());
    }
}

/// A plan of what is too large to run here, and of a long box, is made soon without building it.
#[test]
fn plans_are_cheap_whatever_they_plan() {
    let large = EMPTY.replace("cells_per_radius = 6", "spacing = 0.0008");
    let long = EMPTY.replace("8.0, 8.0", "2e4, 4.0").replace("6", "6\nmodes = 4\n[method]\ninverse = \"hypre\"") + &bodies("count = 2");
    for (name, text, message) in [("large", large, "asks for --force"), ("long", long, "time       ")] {
        let scene = write(&folder(&format!("door-plan-{name}")), &text);
        let start = Instant::now();
        let output = limited(&["plan", scene.to_str().unwrap()]);
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && printed.contains(message), "{name}: {printed}{}", said(&output));
        assert!(start.elapsed() < 2 * SECONDS, "{name} takes {:?}", start.elapsed());
    }
}

/// Bodies that fall through a floor are told of before and at the start of a run.
#[test]
fn plans_and_runs_warn_of_walls_that_hold_nothing() {
    let scene = write(&folder("door-fall"), &(DRY.replace("inelastic", "none") + &bodies("centers = [[4.0, 6.0]]\ndensity = 1.0")));
    let (path, message) = (scene.to_str().unwrap(), "bodies pass through walls without contact.model");
    let plan = turbid(1, &["plan", path]);
    assert!(String::from_utf8_lossy(&plan.stdout).contains(&format!("warning    {message}")), "{}", said(&plan));
    let run = turbid(2, &["run", path, "--out", folder("door-fall-out").to_str().unwrap()]);
    assert_eq!((run.status.code(), said(&run).matches(message).count()), (Some(0), 1), "{}", said(&run));
}

/// The program with its standard output led elsewhere by a shell.
fn led(shell: &str, scene: &Path) -> Output {
    let mut command = Command::new("bash");
    command.args(["-c", &format!("set -o pipefail; {shell}"), PROGRAM, scene.to_str().unwrap()]);
    settle(&mut command);
    command.output().unwrap()
}

#[test]
fn a_reader_that_leaves_is_no_error_and_a_full_device_is_one() {
    let scene = write(&folder("door-pipes"), &(EMPTY.to_owned() + &bodies("count = 2")));
    let quiet = led("\"$0\" plan \"$1\" | true", &scene);
    assert_eq!((quiet.status.code(), said(&quiet)), (Some(0), String::new()));
    for shell in ["\"$0\" plan \"$1\" > /dev/full", "\"$0\" --help > /dev/full", "\"$0\" lubrication > /dev/full"] {
        let full = led(shell, &scene);
        assert_eq!(full.status.code(), Some(2), "{shell}: {}", said(&full));
        assert!(!said(&full).contains("panicked"), "{shell}: {}", said(&full));
    }
    let silent = led("\"$0\" plan no-such.toml 2> /dev/full", &scene);
    assert_eq!(silent.status.code(), Some(2));
}

#[test]
fn a_wrong_command_line_is_told_by_every_start_of_several_ranks() {
    for round in 0..10 {
        let output = turbid(2, &["rum", "scene.toml"]);
        let said = said(&output);
        assert!(
            said.matches("rum: no such command; did you mean run?").count() == 1 && said.contains("commands: run, "),
            "round {round}: {said}"
        );
        assert_eq!(output.status.code(), Some(2), "round {round}");
    }
}

/// Forces so strong that steps lead nowhere, and masses at the edge of what is allowed: an error or finite numbers, never neither.
#[test]
fn extreme_numbers_that_are_allowed_end_with_an_error_or_with_numbers() {
    let wet = EMPTY.replace("6", "4\nmodes = 3\n[flow]\nviscosity = VISCOSITY\ndrive = { mean_velocity = [1.0, 0.0] }")
        + &bodies("centers = [[4.0, 4.0]]");
    let scenes = [
        DRY.replace("-1.0", "-1e60") + &bodies("centers = [[4.0, 4.0]]"),
        DRY.to_owned() + &bodies("centers = [[4.0, 1.0]]\ndensity = 1e60"),
        DRY.to_owned() + &bodies("centers = [[4.0, 1.0]]\ndensity = 1e-60"),
        DRY.replace("end = 1.0", "end = 4.0")
            + &bodies("centers = [[4.0, 2.0]]\ndensity = 1e-60")
            + &bodies("centers = [[4.5, 4.5]]\ndensity = 1e60"),
        wet.replace("VISCOSITY", "1e60"),
        wet.replace("VISCOSITY", "1e-60"),
    ];
    for (number, text) in scenes.iter().enumerate() {
        let here = folder(&format!("door-extreme-{number}"));
        let (scene, out) = (write(&here, text), here.join("out"));
        let mut command = crate::common::command(1, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        let output = command.stdin(Stdio::null()).output().unwrap();
        assert!(!said(&output).contains("panicked"), "{number}: {}", said(&output));
        match output.status.code() {
            Some(0) => {
                let summary = fs::read_to_string(out.join("summary.json")).unwrap();
                let centers: Vec<f64> = crate::common::bodies(&serde_json::from_str(&summary).unwrap());
                assert!(centers.iter().all(|value| value.is_finite()), "{number}");
                let height = crate::common::number(&serde_json::from_str(&summary).unwrap(), "bodies.0.center.1");
                assert!((1.0 - 1e-6..=7.0 + 1e-6).contains(&height), "{number}: a body is in the wall: {height}");
            }
            code => assert!(matches!(code, Some(1 | 2)) && said(&output).starts_with("turbid: "), "{number}: {code:?} {}", said(&output)),
        }
    }
}
